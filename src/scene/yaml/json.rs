//! JSON as YAML.

/// Converts JSON to YAML. YAML lacks some characters that JSON has in its strings, or ends a line at
/// them: they are escaped.
pub fn yaml_of_json(json: &str) -> String {
    let mut yaml = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '\u{7f}'..='\u{9f}'
            | '\u{2028}'
            | '\u{2029}'
            | '\u{feff}'
            | '\u{fffe}'
            | '\u{ffff}' => {
                yaml += &format!("\\u{:04x}", u32::from(c));
            }
            c => yaml.push(c),
        }
    }
    yaml
}

/// Quotes a text for YAML.
pub fn quoted(text: &str) -> String {
    yaml_of_json(&serde_json::Value::from(text).to_string())
}
