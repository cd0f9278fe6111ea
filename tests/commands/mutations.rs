//! Damaged scene files give a scene or an error, never a panic.

use crate::common::generators::cases;
use crate::resolved::assert_resolves;
use std::ops::Range;
use std::path::Path;

use host::text::Diagnostic;
use output::estimate::Memory;
use proptest::prelude::*;
use scene::build::Geometries;
use scene::config::Config;
use scene::yaml::Source;

/// Tokens that break YAML or change a value.
const TOKENS: &[&str] = &[
    "[",
    "]",
    "{",
    "}",
    ":",
    ": ",
    ",",
    "- ",
    "? ",
    "#",
    " #",
    "\"",
    "'",
    "|",
    ">",
    "&a ",
    "*a",
    "!t ",
    "!!int ",
    "<<",
    "%",
    "@",
    "`",
    "\\",
    "\t",
    " ",
    "  ",
    "\n",
    "\r",
    "\r\n",
    "\n---\n",
    "\n...\n",
    "~",
    "null",
    "true",
    "yes",
    "0",
    "-1",
    "1e400",
    "-0",
    ".nan",
    "-.inf",
    "0x1F",
    "1_000",
    "99999999999999999999",
    "\"#ff0000\"",
    "red",
    "{}",
    "[]",
    "[0, 0, 0]",
    "é",
    "🔴",
    "\u{0}",
    "\u{1b}",
    "\u{85}",
    "\u{2028}",
    "\u{feff}",
    "\u{202e}",
];

/// The words of a YAML text: a mutation moves whole ones, too.
fn words(text: &str) -> Vec<Range<usize>> {
    let mut words: Vec<Range<usize>> = Vec::new();
    for (at, c) in text.char_indices() {
        let end = at + c.len_utf8();
        match words.last_mut().filter(|_| c.is_alphanumeric() || c == '_') {
            Some(word)
                if text[word.clone()]
                    .chars()
                    .all(|c| c.is_alphanumeric() || c == '_') =>
            {
                word.end = end;
            }
            _ => words.push(at..end),
        }
    }
    words
}

/// A change of the text: what is removed from where, and what is inserted.
#[derive(Debug, Clone)]
enum Mutation {
    Delete(prop::sample::Index, usize),
    Insert(prop::sample::Index, &'static str),
    Replace(prop::sample::Index, &'static str),
    Copy(prop::sample::Index, usize, prop::sample::Index),
    CopyLine(prop::sample::Index, prop::sample::Index),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let index = any::<prop::sample::Index>;
    let token = || prop::sample::select(TOKENS);
    prop_oneof![
        (index(), 1..9_usize).prop_map(|(at, n)| Mutation::Delete(at, n)),
        (index(), token()).prop_map(|(at, token)| Mutation::Insert(at, token)),
        (index(), token()).prop_map(|(at, token)| Mutation::Replace(at, token)),
        (index(), 1..9_usize, index()).prop_map(|(from, n, to)| Mutation::Copy(from, n, to)),
        (index(), index()).prop_map(|(from, to)| Mutation::CopyLine(from, to)),
    ]
}

impl Mutation {
    fn apply(&self, text: &mut String) {
        let words = words(text);
        if words.is_empty() {
            return;
        }
        let run = |at: usize, n: usize| words[at].start..words[(at + n).min(words.len()) - 1].end;
        match self {
            Self::Delete(at, n) => text.replace_range(run(at.index(words.len()), *n), ""),
            Self::Insert(at, token) => text.insert_str(words[at.index(words.len())].start, token),
            Self::Replace(at, token) => text.replace_range(run(at.index(words.len()), 1), token),
            Self::Copy(from, n, to) => {
                let copied = text[run(from.index(words.len()), *n)].to_owned();
                text.insert_str(words[to.index(words.len())].start, &copied);
            }
            Self::CopyLine(from, to) => {
                let mut lines: Vec<&str> = text.split_inclusive('\n').collect();
                let line = lines[from.index(lines.len())];
                lines.insert(to.index(lines.len()), line);
                *text = lines.concat();
            }
        }
    }
}

/// A scene with every section and every kind of each.
const FULL: &str = include_str!("../full.yaml");

/// The texts of `configs/`, and the full one.
pub fn originals() -> Vec<String> {
    let folder = crate::common::in_repository("configs");
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let configs = paths.filter(|path| path.is_file());
    let texts = configs.map(|path| std::fs::read_to_string(path).unwrap());
    texts.chain([FULL.to_owned()]).collect()
}

/// Bytes of memory that there are.
const MEMORY: u64 = 96 << 20;

/// All that `raycost check` does, on a machine with little memory.
fn check(source: &Source) -> Result<(), Diagnostic> {
    let mut config: Config = source.parse()?;
    assert_resolves(&config);
    let mut check = || {
        let geometries = Geometries::read(&mut config, Path::new("configs"), MEMORY)?;
        Memory::estimate(&config, &geometries).check(MEMORY)?;
        scene::build::scene(&config, geometries).map(drop)
    };
    check().map_err(|fault| source.point_at(fault))
}

#[test]
fn the_full_scene_is_fine() {
    check(&Source::new("full.yaml", FULL)).unwrap();
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn damaged_scenes_get_a_message_or_are_fine(
        mut text in prop::sample::select(originals()),
        mutations in prop::collection::vec(mutation(), 1..4),
    ) {
        for mutation in &mutations {
            mutation.apply(&mut text);
        }
        if let Err(diagnostic) = check(&Source::new("scene.yaml", text)) {
            let plain = diagnostic.to_string();
            prop_assert!(plain.contains("--> scene.yaml:"), "{plain}");
            let is_plain = !plain.contains('\u{1b}');
            prop_assert!(is_plain, "{plain}");
            prop_assert!(plain.lines().all(|line| line.chars().count() < 400), "{plain}");
            let is_styled = diagnostic.render(true).contains('\u{1b}');
            prop_assert!(is_styled);
        }
    }
}
