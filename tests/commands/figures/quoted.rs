//! Texts and what they quote.

use std::fs;
use std::ops::Range;
use std::path::PathBuf;

use crate::common::in_repository;

const OPENED: &str = " -->";

/// What stands after a number that was measured.
const UNITS: [&str; 11] = [
    "%", "ns", "µs", "ms", "s", "seconds", "minutes", "kB", "MB", "GB", "times",
];

/// A text of the project.
pub struct Document {
    pub path: PathBuf,
    pub text: String,
}

/// A figure in a text.
pub struct Quote {
    pub name: String,
    /// Where it stands, without its markers.
    pub range: Range<usize>,
    /// File and line.
    pub place: String,
}

/// The README and all chapters of the book.
pub fn documents() -> Vec<Document> {
    let chapters = fs::read_dir(in_repository("docs")).unwrap();
    let chapters = chapters.map(|entry| entry.unwrap().path());
    let is_text = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "md");
    let mut paths: Vec<PathBuf> = chapters.filter(is_text).collect();
    paths.push(in_repository("README.md"));
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).unwrap();
        Document { path, text }
    };
    paths.into_iter().map(read).collect()
}

impl Document {
    pub fn name(&self) -> String {
        self.path
            .file_name()
            .unwrap()
            .to_string_lossy()
            .into_owned()
    }

    /// The figures in the order of the text.
    pub fn quotes(&self) -> Vec<Quote> {
        self.quotes_of("figure")
    }

    /// The quotes between markers with this word, in the order of the text.
    pub fn quotes_of(&self, marker: &str) -> Vec<Quote> {
        let (opening, closing) = (format!("<!-- {marker}: "), format!("<!-- /{marker} -->"));
        let mut quotes = Vec::new();
        for (start, _) in self.text.match_indices(&opening) {
            let line = self.text[..start].lines().count();
            let place = format!("{}:{line}", self.name());
            let name_at = start + opening.len();
            let rest = &self.text[name_at..];
            let (name, _) = rest
                .split_once(OPENED)
                .unwrap_or_else(|| panic!("{place}: no name"));
            let begin = name_at + name.len() + OPENED.len();
            let length = self.text[begin..].find(&closing);
            let length = length.unwrap_or_else(|| panic!("{place}: no end of `{name}`"));
            quotes.push(Quote {
                name: name.to_owned(),
                range: begin..begin + length,
                place,
            });
        }
        quotes
    }

    /// The lines that are no code, by their numbers, without figures.
    pub fn prose(&self) -> Vec<(usize, String)> {
        let mut text = self.text.clone();
        for quote in self.quotes().into_iter().rev() {
            // Lines keep their numbers.
            let breaks = "\n".repeat(text[quote.range.clone()].matches('\n').count());
            text.replace_range(quote.range, &breaks);
        }
        let mut is_code = false;
        let mut prose = Vec::new();
        for (index, line) in text.lines().enumerate() {
            if line.starts_with("```") {
                is_code = !is_code;
            } else if !is_code && !line.starts_with("    ") {
                prose.push((index + 1, line.to_owned()));
            }
        }
        prose
    }
}

/// The first number with the unit of a measurement.
pub fn measured(line: &str) -> Option<String> {
    let digits = line.char_indices().filter(|(_, c)| c.is_ascii_digit());
    digits.into_iter().find_map(|(at, _)| {
        let rest = &line[at + 1..];
        let after = rest.trim_start_matches([' ', '\u{a0}']);
        let unit = UNITS.iter().find(|unit| {
            let ends = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            after.strip_prefix(**unit).is_some_and(ends)
        })?;
        // `8s` is no time, `5%` is a share.
        let is_apart = after.len() < rest.len() || *unit == "%";
        is_apart.then(|| format!("{} {unit}", &line[at..=at]))
    })
}
