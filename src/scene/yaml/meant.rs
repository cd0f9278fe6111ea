//! Values in another notation: `4px`, `50%`, `(0, 0, 0)`, `0 0 0`, `red`.

/// The colors that are most often written as words.
const COLORS: [(&str, &str); 10] = [
    ("black", "#000000"),
    ("white", "#ffffff"),
    ("gray", "#808080"),
    ("grey", "#808080"),
    ("red", "#ff0000"),
    ("green", "#00ff00"),
    ("blue", "#0000ff"),
    ("yellow", "#ffff00"),
    ("orange", "#ff8000"),
    ("purple", "#800080"),
];

/// Returns advice on a text that is given instead of numbers or a color.
pub(super) fn advice(written: &str, expected: &str) -> Option<String> {
    let bare = written.trim_matches(['"', '\'']);
    let is_mapping = expected.starts_with("struct ") || expected.contains("{ ");
    if let Some((key, value)) = bare.split_once(':').filter(|_| is_mapping) {
        return Some(format!("put a space after the `:`: `{key}: {value}`"));
    }
    if expected.contains("color")
        && let Some(color) = color_of(bare)
    {
        return Some(format!("did you mean `\"{color}\"`?"));
    }
    if bare.contains('(') && expected.contains('[') {
        let (_, list) = expected.split_once('[')?;
        let (list, _) = list.split_once(']')?;
        return Some(format!("put a list in brackets, as in `[{list}]`"));
    }
    if !expected.contains("number") && !expected.contains("angle") {
        return None;
    }
    let words: Vec<&str> = bare.split_whitespace().collect();
    let is_number = |word: &&str| word.parse::<f64>().is_ok();
    if words.len() > 1 && words.iter().all(is_number) {
        let list = words.join(", ");
        return Some(format!("put commas between the numbers: `{list}`"));
    }
    let (number, unit) = with_unit(bare)?;
    Some(match unit {
        "%" => format!("did you mean `{}`?", number / 100.0),
        "rad" => format!(
            "did you mean `{:.1}`? Angles are in degrees",
            number.to_degrees()
        ),
        _ => format!("write the number without its unit: `{number}`"),
    })
}

/// Returns the color of a word, or of `#rgb`, in six digits.
fn color_of(word: &str) -> Option<String> {
    let word = word.to_lowercase();
    if let Some(short) = word.strip_prefix('#') {
        let is_short = short.len() == 3 && short.bytes().all(|digit| digit.is_ascii_hexdigit());
        let digits = || short.chars().flat_map(|digit| [digit, digit]);
        return is_short.then(|| format!("#{}", digits().collect::<String>()));
    }
    let known = COLORS.iter().find(|(name, _)| *name == word);
    known.map(|(_, color)| (*color).to_owned())
}

/// Splits a text into a number and its unit.
fn with_unit(text: &str) -> Option<(f64, &str)> {
    let end = text.find(|c: char| c.is_alphabetic() || c == '°' || c == '%')?;
    let (number, unit) = text.split_at(end);
    let is_unit = unit.chars().count() <= 7 && !unit.contains(|c: char| c.is_numeric());
    let number = number.trim().parse().ok().filter(|_| is_unit)?;
    Some((number, unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_notations_get_advice() {
        let number = "a number from 0 to 1";
        for (written, expected, part) in [
            ("width:4", "a size such as { width: 400 }", "`width: 4`"),
            ("4px", number, "without its unit: `4`"),
            ("50 %", number, "`0.5`"),
            ("3.14159rad", "an angle in degrees", "`180.0`"),
            ("40°", "an angle in degrees", "`40`"),
            ("0 0 1", number, "`0, 0, 1`"),
            ("(0", "a point [x, y, z]", "`[x, y, z]`"),
            ("Red", "a color", "`\"#ff0000\"`"),
            ("\"#f80\"", "a color", "`\"#ff8800\"`"),
        ] {
            let advice = advice(written, expected).unwrap();
            assert!(advice.contains(part), "{written}: {advice}");
        }
        for (written, expected) in [
            ("many", number),
            ("1e5x7", number),
            ("4px", "a text"),
            ("ivory", "a color"),
            ("#ff00", "a color"),
        ] {
            assert_eq!(advice(written, expected), None, "{written}");
        }
    }
}
