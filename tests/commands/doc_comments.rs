//! `raycost schema` shows the doc comments that keys and keywords have in the sources.
//!
//! The sources are formatted, so that a line shows what it is: a type begins with `struct` or
//! `enum`, a list of kinds with the name of its macro, and both end with `}` in the first
//! column.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use crate::common::in_repository;

/// The folders and files whose doc comments describe the keys of scene and study files.
const DOCUMENTED: [&str; 18] = [
    "math/sampling",
    "vtk/codec",
    "scene/animation",
    "scene/config",
    "tools/study",
    "tracer/accel/acceleration.rs",
    "tracer/cost/arrays.rs",
    "tracer/cost/cost_mode.rs",
    "tracer/cost/ratio.rs",
    "world/shading.rs",
    "world/background",
    "world/camera",
    "world/color",
    "world/fog",
    "world/geometry",
    "world/light",
    "world/material",
    "world/material/image",
];

/// `RAYCOST_BLESS=1 cargo test --test commands doc_comments::` writes them anew; then build, and
/// write the schemas anew.
#[test]
fn they_are_those_of_the_sources() {
    let kept = in_repository("src/tools/schema/doc_comments.tsv");
    let collected = collect();
    if std::env::var_os("RAYCOST_BLESS").is_some() {
        fs::write(&kept, &collected).unwrap();
    }
    let kept = fs::read_to_string(kept).unwrap();
    let differs = |(kept, now): (&str, &str)| (kept != now).then(|| now.to_owned());
    let changed = kept.lines().zip(collected.lines()).find_map(differs);
    assert!(kept == collected, "{changed:?}: set RAYCOST_BLESS=1");
}

/// Returns lines of type, name and comment, which may be empty, with tabs between them.
fn collect() -> String {
    let src = in_repository("src");
    let (mut files, folders): (Vec<PathBuf>, Vec<PathBuf>) =
        (DOCUMENTED.iter().map(|path| src.join(path))).partition(|path| path.is_file());
    files.extend(
        (folders
            .iter()
            .flat_map(|folder| fs::read_dir(folder).unwrap()))
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "rs")),
    );
    files.sort();
    let mut found = String::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        // A type's name is unique; a macro may be used in several files.
        let file = file.strip_prefix(&src).unwrap().display().to_string();
        of_source(&text, &file, &mut found);
    }
    found
}

fn of_source(text: &str, file: &str, found: &mut String) {
    let mut owner = None;
    let mut comment = Vec::new();
    let mut in_attribute = false;
    let mut in_keywords = false;
    for line in text.lines() {
        // An enum of keywords stands in a macro.
        in_keywords = line == "keywords! {" || (in_keywords && line != "}");
        let inner = line.strip_prefix("    ").filter(|_| in_keywords);
        let line = inner.unwrap_or(line);
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
            writeln!(found, "{owner}\t{name}\t{text}").unwrap();
            comment.clear();
        } else {
            comment.clear();
        }
    }
}

/// The name of the type or of the macro whose list begins on this line.
fn owner_of(line: &str) -> Option<&str> {
    let begin = line
        .strip_suffix(" {")
        .filter(|begin| !begin.starts_with(' '))?;
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
    if let Some(keyword) = rest.strip_prefix(" = \"") {
        return keyword.strip_suffix("\",").map(str::to_owned);
    }
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
