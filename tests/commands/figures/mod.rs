//! Every measured figure that the README or the book quotes is that of
//! `docs/results`.
//!
//! Figures stand between markers, which no reader sees:
//! `<!-- figure: counters -->2 to 4 %<!-- /figure -->`. `docs/figures` writes
//! them anew from the results: it runs the first test here with
//! `UPDATE_FIGURES=1`. What is measured and not marked is found by its unit.

pub mod quoted;
mod results;
mod words;

use std::fs;

use crate::common::in_repository;
use quoted::{Document, Quote, documents};
use results::{FIGURES, Results};

/// Bytes that the kept results may have: what the documents need, and no runs.
const MOST_BYTES: u64 = 870_000;

/// Numbers with a unit that are not measured: settings, definitions, and what a
/// text says of a single example.
const NOT_MEASURED: &[&str] = &[
    "95 %",
    "5%",
    "15 minutes",
    "32 times more",
    "20 to 40 MB",
    "limit of 10 MB",
    "at most 10 %",
    "256 points, within 2 %",
    "less than 0.2 ms",
    "in at most 1 %",
    "10 %, the terminal",
    "takes 100 to 500 ns",
    "after every 0.1 ms",
    "hottest 1 %",
    "The 1 % and the 99 % quantiles",
    "or 4 ms",
    "which cover 96.1 %",
    "1.5 times its memory",
    "7 % more samples",
    "64 per pixel (3 % with",
    "0.7 % at 640 x 480",
    "at most 8 times the mean",
];

#[test]
fn every_figure_is_that_of_the_results() {
    let results = Results::read();
    compare(&documents(), "figure", |quote| {
        let figure = results.figure(&quote.name);
        figure.unwrap_or_else(|| panic!("{}: there is no figure `{}`", quote.place, quote.name))
    });
}

/// Compares all quotes between markers with this word with what they should be, or, with
/// `UPDATE_FIGURES=1`, writes them anew.
pub fn compare(documents: &[Document], marker: &str, expected: impl Fn(&Quote) -> String) {
    let update = std::env::var_os("UPDATE_FIGURES").is_some();
    let mut stale = Vec::new();
    for document in documents {
        let mut text = document.text.clone();
        // From the end: places before a quote stay where they are.
        for quote in document.quotes_of(marker).into_iter().rev() {
            let expected = expected(&quote);
            let found = &document.text[quote.range.clone()];
            if found != expected {
                stale.push(format!(
                    "{}: `{}` is {expected:?}, not {found:?}",
                    quote.place, quote.name
                ));
                text.replace_range(quote.range, &expected);
            }
        }
        if update && text != document.text {
            fs::write(&document.path, text).unwrap();
        }
    }
    let remedy = "run docs/figures, and read the sentences around these figures";
    assert!(update || stale.is_empty(), "{}\n{remedy}", stale.join("\n"));
}

#[test]
fn every_figure_is_quoted_somewhere() {
    let quotes = documents()
        .iter()
        .flat_map(Document::quotes)
        .collect::<Vec<_>>();
    for (name, _) in FIGURES {
        assert!(
            quotes.iter().any(|quote| quote.name == *name),
            "`{name}` is not quoted"
        );
    }
}

/// What has the unit of a measurement is marked, or is known to be none.
#[test]
fn no_measured_figure_is_typed_in() {
    let mut typed_in = Vec::new();
    // Another test compares the numbers of the course with the program's.
    let others = documents()
        .into_iter()
        .filter(|document| document.name() != "course.md");
    for document in others {
        for (number, line) in document.prose() {
            let mut line = line;
            for phrase in NOT_MEASURED {
                line = line.replace(phrase, "");
            }
            if let Some(found) = quoted::measured(&line) {
                typed_in.push(format!("{}:{number}: {found:?}", document.name()));
            }
        }
    }
    let remedy = "mark each as a figure, with its source in tests/commands/figures/results.rs, or, \
                  if it is not measured, add the phrase to NOT_MEASURED";
    assert!(typed_in.is_empty(), "{}\n{remedy}", typed_in.join("\n"));
}

#[test]
fn the_kept_results_are_small() {
    let folder = in_repository("docs/results");
    let sizes = fs::read_dir(folder).unwrap().map(|entry| {
        let entry = entry.unwrap();
        assert!(entry.path().is_file(), "{:?} holds runs", entry.path());
        entry.metadata().unwrap().len()
    });
    let n_bytes: u64 = sizes.sum();
    assert!(n_bytes < MOST_BYTES, "{n_bytes} bytes of results");
}

/// Figures of different programs are not comparable. The studies of 16 cores, on another machine,
/// may be of an earlier program, which the report names.
#[test]
fn all_results_are_of_one_program() {
    let results = Results::read();
    let (wide, others): (Vec<_>, Vec<_>) =
        (results.programs().into_iter()).partition(|(file, _)| file.contains("_16_"));
    for programs in [wide, others] {
        for (file, commit) in &programs {
            let first = &programs[0];
            assert_eq!(
                commit, &first.1,
                "{file} and {} are of different programs",
                first.0
            );
        }
    }
}

#[test]
fn figures_are_found_in_a_text() {
    let text = "a <!-- figure: x -->1 %<!-- /figure --> b\n```sh\n9 %\n```\nand 7 ms, <!-- figure: y -->\n2\n<!-- /figure -->";
    let document = Document {
        path: "some.md".into(),
        text: text.to_owned(),
    };
    let quotes = document.quotes();
    let found: Vec<(&str, &str)> = quotes
        .iter()
        .map(|quote| (quote.name.as_str(), &text[quote.range.clone()]))
        .collect();
    assert_eq!(found, [("x", "1 %"), ("y", "\n2\n")]);
    let prose: Vec<String> = document
        .prose()
        .into_iter()
        .filter_map(|(_, line)| quoted::measured(&line))
        .collect();
    assert_eq!(prose, ["7 ms"]);
    for (line, expected) in [
        ("1.2 times as fast", Some("2 times")),
        ("in 3 s.", Some("3 s")),
        ("3 sizes", None),
    ] {
        assert_eq!(quoted::measured(line).as_deref(), expected);
    }
}
