//! Collects the doc comments of fields and variants from sources.
//!
//! The sources are formatted, so that a line shows what it is: a type begins with `struct` or
//! `enum`, a list of kinds with the name of its macro, and both end with `}` in the first
//! column.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Returns lines of type, name and comment, which may be empty, with tabs between them.
pub fn collect(folders: &[&Path]) -> String {
    let mut files: Vec<PathBuf> = folders.iter().flat_map(|folder| sources(folder)).collect();
    files.sort();
    let mut found = String::new();
    for file in files {
        let text = fs::read_to_string(&file).expect("a source");
        // A type's name is unique; a macro may be used in several files.
        of_source(&text, &file.display().to_string(), &mut found);
    }
    found
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of sources");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}

fn of_source(text: &str, file: &str, found: &mut String) {
    let mut owner = None;
    let mut comment = Vec::new();
    let mut in_attribute = false;
    for line in text.lines() {
        let code = line.trim();
        if in_attribute || code.starts_with("#[") {
            in_attribute = !code.ends_with(']');
        } else if let Some(doc) = code.strip_prefix("///") {
            comment.push(doc.trim());
        } else if line == "}" {
            owner = None;
        } else if let Some(name) = owner_of(line) {
            owner = Some(format!("{file} {name}"));
            comment.clear();
        } else if let (Some(owner), Some(name)) = (&owner, name_of(code)) {
            let text = plain(&comment);
            writeln!(found, "{owner}\t{name}\t{text}").expect("a string");
            comment.clear();
        } else {
            comment.clear();
        }
    }
}

/// The name of the type or of the macro whose list begins on this line.
fn owner_of(line: &str) -> Option<&str> {
    let begin = line.strip_suffix(" {")?;
    let item = begin.strip_prefix("pub(super) ").unwrap_or(begin);
    let item = item.strip_prefix("pub(crate) ").unwrap_or(item);
    let item = item.strip_prefix("pub ").unwrap_or(item);
    let name = item.strip_prefix("struct ").or(item.strip_prefix("enum "));
    name.or_else(|| begin.strip_suffix('!'))
}

/// The key in scene files of the field, the variant or the row on this line.
fn name_of(code: &str) -> Option<String> {
    if let Some(quoted) = code.strip_prefix('"') {
        return Some(quoted.split('"').next()?.to_owned());
    }
    let code = match code.strip_prefix("pub") {
        Some(rest) => rest.split_once(' ')?.1,
        None => code,
    };
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let end = code.find(|c| !is_word(c)).unwrap_or(code.len());
    let (word, rest) = code.split_at(end);
    let is_item = rest.starts_with([':', ',', '(']) || rest.starts_with(" {") || rest.is_empty();
    (is_item && !word.is_empty()).then(|| snake_case(word))
}

fn snake_case(word: &str) -> String {
    let mut snake = String::new();
    for c in word.chars() {
        if c.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
    }
    snake
}

/// A comment as one paragraph up to its first example, without links.
fn plain(comment: &[&str]) -> String {
    let before_code = comment.iter().take_while(|line| !line.starts_with("```"));
    let lines: Vec<&str> = before_code
        .copied()
        .filter(|line| !line.is_empty())
        .collect();
    let mut text = lines.join(" ").replace('\t', " ");
    while let Some(start) = text.find("[`") {
        let Some(length) = text[start..].find("`]") else {
            break;
        };
        let name = text[start + 1..=start + length].to_owned();
        let mut end = start + length + 2;
        if text[end..].starts_with('(') {
            end += text[end..].find(')').map_or(0, |close| close + 1);
        }
        text.replace_range(start..end, &name);
    }
    text
}
