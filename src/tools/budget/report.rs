//! The result of a check as lines for a terminal, or as Markdown, JSON for a chart or a badge.

use serde_json::{Value, json};

use super::check::{BudgetCheck, BudgetRow, Growth, SceneCheck};
use super::file::SceneBudget;
use crate::diff::table;
use base::keywords;
use base::numbers::{count, counted};
use host::text::one_line;

/// Greatest number of rows that a scene has on the terminal.
const MAX_ROWS: usize = 16;

keywords! {
    /// A format of the result in place of lines for the terminal.
    pub enum BudgetFormat {
        /// Tables for a summary or a comment on GitHub
        Markdown = "markdown",
        /// Totals as github-action-benchmark reads them (customSmallerIsBetter)
        BenchmarkJson = "benchmark-json",
        /// A badge as shields.io reads it (endpoint)
        Badge = "badge",
    }
}

/// Returns lines with what grew and what shrank in each scene.
pub fn report(check: &BudgetCheck) -> String {
    let mut text = String::new();
    for check in &check.scenes {
        text += &format!("{}: {}\n", one_line(&check.scene.label()), verdict(check));
        let head = ["part", "counter", "budget", "now", "change", ""].map(str::to_owned);
        if !check.rows.is_empty() {
            let rows = check.rows.iter().take(MAX_ROWS).map(row_cells);
            text += &table(std::iter::once(head).chain(rows));
        }
        if check.rows.len() > MAX_ROWS {
            text += &format!("and {} more\n", check.rows.len() - MAX_ROWS);
        }
    }
    text
}

/// Returns the part, the counter, its totals, the change, and the change in percent.
fn row_cells(row: &BudgetRow) -> [String; 6] {
    let sign = if row.now > row.budget { "+" } else { "-" };
    let mut percent = match row.budget {
        0 => "new".to_owned(),
        budget => format!("{:+.2} %", 100.0 * (row.now as f64 / budget as f64 - 1.0)),
    };
    if row.growth == Growth::Allowed {
        percent += " (allowed)";
    }
    [
        one_line(&row.part).into_owned(),
        row.counter.to_owned(),
        count(row.budget),
        count(row.now),
        sign.to_owned() + &count(row.now.abs_diff(row.budget)),
        percent,
    ]
}

/// Describes the result of a scene.
fn verdict(check: &SceneCheck) -> String {
    let parts = [
        (Growth::Exceeding, "grew"),
        (Growth::Allowed, "grew within what is allowed"),
        (Growth::Shrunk, "shrank"),
    ];
    let parts = parts
        .map(|(growth, what)| (check.n(growth), what))
        .into_iter();
    let parts = parts.filter(|(n, _)| *n > 0);
    let parts: Vec<String> = parts
        .map(|(n, what)| format!("{} {what}", counted(n, "total")))
        .collect();
    if parts.is_empty() {
        "the same totals".to_owned()
    } else {
        parts.join(", ")
    }
}

/// Returns the result as Markdown.
pub fn markdown(check: &BudgetCheck) -> String {
    let mut text = String::new();
    for check in &check.scenes {
        let scene = check.scene.label().replace('`', "'");
        text += &format!("### `{}`: {}\n\n", one_line(&scene), verdict(check));
        if check.rows.is_empty() {
            continue;
        }
        text += "| part | counter | budget | now | change | |\n|---|---|--:|--:|--:|--:|\n";
        for row in &check.rows {
            let cells = row_cells(row).map(|cell| cell.replace('|', "\\|"));
            text += &format!("| {} |\n", cells.join(" | "));
        }
        text += "\n";
    }
    text
}

/// Returns the totals of the whole pictures as an array that github-action-benchmark reads.
pub fn benchmark(scenes: &[SceneBudget]) -> Value {
    let entries = scenes.iter().flat_map(|scene| {
        let label = scene.label();
        scene.totals.iter().map(move |(counter, total)| {
            json!({
                "name": format!("{label}: {counter}"),
                "unit": counter.replace('_', " "),
                "value": total,
                "extra": format!("seed {}, config {}", scene.image.seed, scene.config),
            })
        })
    });
    entries.collect()
}

/// Returns a badge, an endpoint of shields.io.
pub fn badge(check: &BudgetCheck) -> Value {
    let (message, color) = match (check.n(Growth::Exceeding), check.n(Growth::Shrunk)) {
        (0, 0) => ("within budget".to_owned(), "brightgreen"),
        (0, n) => (format!("{} shrank", counted(n, "total")), "blue"),
        (n, _) => (format!("{} grew", counted(n, "total")), "red"),
    };
    json!({ "schemaVersion": 1, "label": "render cost", "message": message, "color": color })
}
