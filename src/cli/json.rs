//! Results as JSON on standard output, one line each, for `--json`.

use std::io;
use std::path::Path;

use serde::Serialize;
use serde_json::json;

use super::Failure;
use crate::session::RenderError;
use host::files::read_text;
use host::folder::SUMMARY;
use host::text::{self, Diagnostic};
use output::summary::MAX_BYTES;

/// Prints a value as a line. Its 32-bit numbers have their shortest digits; within a
/// [`serde_json::Value`] they would have those of 64 bits.
pub(super) fn print(value: &impl Serialize) -> Result<(), Failure> {
    // Cannot fail: all keys are strings.
    Ok(print_text(
        &serde_json::to_string(value).unwrap_or_default(),
    )?)
}

/// Prints the `summary.json` of a written folder as a line, after the key `out` with the folder.
pub(super) fn print_summary(folder: &Path) -> Result<(), RenderError> {
    let path = folder.join(SUMMARY);
    let summary = read_text(&path, MAX_BYTES).map_err(|error| {
        let message = format!("cannot read `{}`: {error}", path.display());
        RenderError::Machine(Diagnostic::new(message))
    })?;
    // The numbers keep their digits: only line ends and indents go, which no string has.
    let line: String = summary.lines().map(str::trim_start).collect();
    let members = line.strip_prefix('{').unwrap_or(&line);
    Ok(print_text(&format!(
        "{{\"out\": {},{members}",
        json!(folder.to_string_lossy())
    ))?)
}

fn print_text(json: &str) -> io::Result<()> {
    text::print(&(text::visible_json(json) + "\n"))
}
