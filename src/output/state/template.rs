//! Filling in a state that carries keys.

/// The template with every `value="…" fill="KEY"` replaced by
/// `value="VALUE"`; a key that `value` does not know keeps what the template
/// has. Values are escaped to ASCII.
pub(crate) fn fill(template: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut filled = String::with_capacity(template.len());
    for line in template.split_inclusive('\n') {
        let Some((element, key, rest)) = marked(line) else {
            filled += line;
            continue;
        };
        let (before, old) = element.rsplit_once(" value=\"").unwrap_or((element, ""));
        let new = value(key).map_or_else(|| old.to_owned(), |text| escape(&text));
        filled += &format!("{before} value=\"{new}\"{rest}");
    }
    filled
}

/// `<Element … value="OLD` and `KEY` and what follows its quote, of a line
/// that has a key.
fn marked(line: &str) -> Option<(&str, &str, &str)> {
    let (element, mark) = line.split_once("\" fill=\"")?;
    let (key, rest) = mark.split_once('"')?;
    Some((element, key, rest))
}

/// XML text in ASCII, other characters by their numbers: a PNG's text chunk
/// holds no more.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            ' '..='~' => escaped.push(character),
            other => escaped += &format!("&#{};", u32::from(other)),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marked_values_are_replaced_and_the_marks_go() {
        let template =
            "<P>\n <E index=\"0\" value=\"old\" fill=\"a.b(0.5)\"/>\n <E value=\"1\"/>\n</P>";
        let filled = fill(template, |key| {
            assert_eq!(key, "a.b(0.5)");
            Some("<é & \"ü\">".to_owned())
        });
        let expected = "<P>\n <E index=\"0\" value=\"&lt;&#233; &amp; &quot;&#252;&quot;&gt;\"/>\n <E value=\"1\"/>\n</P>";
        assert_eq!(filled, expected);
        let kept = fill(template, |_| None);
        assert!(kept.contains("value=\"old\"/>"), "{kept}");
    }
}
