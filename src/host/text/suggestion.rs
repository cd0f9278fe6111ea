//! Spelling suggestions: "did you mean …?"

use std::path::Path;

/// Least similarity, from 0 to 1, of a suggestion.
const MIN_SIMILARITY: f64 = 0.6;
/// Longest word that is compared, in bytes: a longer one is not a typo.
const MAX_WORD: usize = 64;

/// Maximum number of files of a folder to search for a similar name.
const MAX_NAMES: usize = 1000;

/// Words of other programs, each with the word that means the same here.
const SYNONYMS: [(&str, &str); 12] = [
    ("ball", "sphere"),
    ("cube", "box"),
    ("cuboid", "box"),
    ("floor", "plane"),
    ("fov", "fov_y_deg"),
    ("ground", "plane"),
    ("model", "mesh"),
    ("obj", "mesh"),
    ("quad", "rectangle"),
    ("samples", "samples_per_pixel"),
    ("spp", "samples_per_pixel"),
    ("square", "rectangle"),
];

/// Returns "did you mean `x`?" with the known word most similar to `word`, or
/// `None` if none is similar enough. A known word that means the same comes first.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    if word.len() > MAX_WORD {
        return None;
    }
    let word = word.to_lowercase();
    let known: Vec<&str> = known.into_iter().collect();
    let synonym = SYNONYMS.iter().find(|(other, _)| *other == word);
    if let Some((_, meant)) = synonym.filter(|(_, meant)| known.contains(meant)) {
        return Some(format!("did you mean `{meant}`?"));
    }
    known
        .into_iter()
        .map(|candidate| (similarity(&word, candidate), candidate))
        .filter(|((best, _), _)| *best >= MIN_SIMILARITY)
        .max_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal))
        .map(|(_, candidate)| format!("did you mean `{candidate}`?"))
}

/// Returns the similarity of `word` to a known word or to one of its parts
/// (`depth` of `max_depth`, or the initials), whichever is larger; and, to
/// break ties, the similarity to the whole known word.
fn similarity(word: &str, known: &str) -> (f64, f64) {
    let known = known.to_lowercase();
    let whole = strsim::normalized_damerau_levenshtein(word, &known);
    let initials: String = known
        .split('_')
        .filter_map(|part| part.chars().next())
        .collect();
    let of_parts = known
        .split('_')
        .chain([initials.as_str()])
        .filter(|part| part.len() > 2)
        .map(|part| strsim::normalized_damerau_levenshtein(word, part));
    (of_parts.fold(whole, f64::max), whole)
}

/// Returns "did you mean `1000`?" for a text that is almost a number: `1_000`,
/// `"1000"`, `0,5`, `010`; or, for a whole number, `1,000`, `1e3`, `1000.0`.
pub fn number_meant(written: &str, is_whole: bool) -> Option<String> {
    let comma = if is_whole { "" } else { "." };
    let bare = written.trim_matches(['"', '\'']).replace('_', "");
    let number: f64 = bare.replace(',', comma).parse().ok()?;
    // A longer number would need an exponent.
    let is_short = number == 0.0 || (1e-6..=1e9).contains(&number.abs());
    let is_meant = is_short && (!is_whole || number.fract() == 0.0);
    is_meant.then(|| format!("did you mean `{number}`?"))
}

/// Returns the likely reason why a file is missing; `None` if it exists, or no reason is known.
pub fn why_missing(path: &Path) -> Option<String> {
    if path.exists() {
        return None;
    }
    let text = path.to_string_lossy();
    let mut steps = text.split(['/', '\\']);
    if steps.any(|step| step.starts_with(['~', '$'])) {
        return Some("`~` and `$` have no meaning here: write the whole path".to_owned());
    }
    if cfg!(unix) && text.contains('\\') {
        return Some("write `/` between folders".to_owned());
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Some(format!("there is no folder `{}`", folder.display()));
    }
    let entries = folder.read_dir().into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let names: Vec<String> = names.take(MAX_NAMES).collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    did_you_mean(&name, names.iter().map(String::as_str))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typos_get_a_suggestion() {
        let known = [
            "bvh",
            "brute_force",
            "sphere",
            "sphere_grid",
            "samples_per_pixel",
            "red",
            "MirrorBall",
        ];
        let pairs = [
            ("bhv", "bvh"),
            ("BVH", "bvh"),
            ("force", "brute_force"),
            ("spheres", "sphere"),
            ("grid", "sphere_grid"),
            ("spp", "samples_per_pixel"),
            ("rde", "red"),
            ("mirrorball", "MirrorBall"),
        ];
        for (word, meant) in pairs {
            let expected = format!("did you mean `{meant}`?");
            assert_eq!(did_you_mean(word, known), Some(expected), "{word}");
        }
        for strange in ["", "x", "glass", "cylinder", &"s".repeat(1 << 20)] {
            assert_eq!(did_you_mean(strange, known), None);
        }
    }

    #[test]
    fn almost_numbers_get_a_suggestion() {
        let meant = |written, is_whole| number_meant(written, is_whole);
        for written in ["1_000", "\"1000\"", "1,000", "1e3", "1000.0", "01000"] {
            let expected = Some("did you mean `1000`?".to_owned());
            assert_eq!(meant(written, true), expected, "{written}");
        }
        assert_eq!(meant("0,5", false), Some("did you mean `0.5`?".to_owned()));
        for (written, is_whole) in [("0.5", true), ("1e300", false), ("inf", false), ("x", true)] {
            assert_eq!(meant(written, is_whole), None, "{written}");
        }
    }
}
