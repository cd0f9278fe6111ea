//! Templates of states, and the replacement of marked values.

use std::path::Path;

/// The replacement of a marked value.
#[derive(Clone, Debug, PartialEq)]
pub enum StateValue {
    /// The value of an attribute.
    One(String),
    /// The values of all elements of a property.
    Many(Vec<String>),
}

impl From<String> for StateValue {
    fn from(text: String) -> Self {
        Self::One(text)
    }
}

impl From<&str> for StateValue {
    fn from(text: &str) -> Self {
        Self::One(text.to_owned())
    }
}

/// Replaces the attribute before each `fill="KEY"` by `value(KEY)` and removes the keys. A key of a
/// `<Property>` replaces all of its elements. If `value` returns `None`, the template's value stays.
/// New values are escaped to ASCII.
pub fn fill(template: &str, value: impl Fn(&str) -> Option<StateValue>) -> String {
    let mut filled = String::with_capacity(template.len());
    let mut lines = template.split_inclusive('\n');
    while let Some(line) = lines.next() {
        let Some((before, old, key, after)) = marked(line) else {
            filled += line;
            continue;
        };
        match value(key) {
            None => filled += &format!("{before}=\"{old}\"{after}"),
            Some(StateValue::One(new)) => {
                filled += &format!("{before}=\"{}\"{after}", escape(&new))
            }
            Some(StateValue::Many(new)) => {
                filled += &format!("{before}=\"{}\"{after}", new.len());
                for (index, value) in new.iter().enumerate() {
                    let value = escape(value);
                    filled += &format!("<Element index=\"{index}\" value=\"{value}\"/>\n");
                }
                let is_old = |line: &&str| line.trim_start().starts_with("<Element ");
                filled += lines
                    .by_ref()
                    .find(|line| !is_old(line))
                    .unwrap_or_default();
            }
        }
    }
    filled
}

/// Returns a state in which the path of each file that is in `folder`, wherever the state looks for
/// it, is the path in `folder`.
pub fn relocated(state: &str, folder: &Path) -> String {
    const VALUE: &str = "value=\"";
    let mut values = state.split(VALUE);
    let mut relocated = values.next().unwrap_or_default().to_owned();
    for rest in values {
        let (value, after) = rest.split_once('"').unwrap_or((rest, ""));
        let name = value
            .rsplit_once(['/', '\\'])
            .map(|(_, name)| folder.join(name));
        let path = name.filter(|path| path.is_file());
        let path = path.map(|path| escape(&path.to_string_lossy()));
        relocated += &format!("{VALUE}{}\"{after}", path.as_deref().unwrap_or(value));
    }
    relocated
}

/// Splits a line with a key into the text before the attribute's `=`, the attribute's value, the key,
/// and the text after it; `None` without a key.
fn marked(line: &str) -> Option<(&str, &str, &str, &str)> {
    let (element, mark) = line.split_once("\" fill=\"")?;
    let (key, after) = mark.split_once('"')?;
    let (before, old) = element.rsplit_once("=\"")?;
    Some((before, old, key, after))
}

/// Escapes XML text to ASCII, as text chunks of PNGs require: other characters become character
/// references, and those that XML does not have appear as text.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            ' '..='~' => escaped.push(character),
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {
                escaped.extend(character.escape_default());
            }
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
            Some("<é & \"ü\">".into())
        });
        let expected = "<P>\n <E index=\"0\" value=\"&lt;&#233; &amp; &quot;&#252;&quot;&gt;\"/>\n <E value=\"1\"/>\n</P>";
        assert_eq!(filled, expected);
        let kept = fill(template, |_| None);
        assert!(kept.contains("value=\"old\"/>"), "{kept}");
    }

    #[test]
    fn characters_that_xml_does_not_have_appear_as_text() {
        assert_eq!(
            escape("a\u{1b}[31m\t\u{85}\u{ffff}"),
            "a\\u{1b}[31m&#9;&#133;\\u{ffff}"
        );
    }

    #[test]
    fn a_marked_property_gets_as_many_elements_as_there_are_values() {
        let template = "<Property name=\"a\" number_of_elements=\"1\" fill=\"k\">\n <Element index=\"0\" value=\"old\"/>\n</Property>\n<Other/>\n";
        let filled = fill(template, |_| {
            Some(StateValue::Many(vec!["x".into(), "y".into()]))
        });
        let expected = "<Property name=\"a\" number_of_elements=\"2\">\n<Element index=\"0\" value=\"x\"/>\n<Element index=\"1\" value=\"y\"/>\n</Property>\n<Other/>\n";
        assert_eq!(filled, expected);
    }
}
