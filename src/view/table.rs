//! `objects.csv`, where it was asked for.

use serde_json::json;

use super::payload::Payload;
use crate::results::Results;
use crate::yaml::Diagnostic;

/// The file's name.
const FILE: &str = "objects.csv";

/// A table of text.
#[derive(Debug)]
pub(super) struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads the table, if the folder has it.
    pub(super) fn read(results: &Results) -> Result<Option<Self>, Diagnostic> {
        let path = results.folder().join(FILE);
        if !path.exists() {
            return Ok(None);
        }
        let damaged = |error: csv::Error| {
            Diagnostic::new(format!("cannot read `{}`: {error}", path.display()))
                .with_help("render the scene again with `--also objects`")
        };
        let mut reader = csv::Reader::from_path(&path).map_err(damaged)?;
        let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let columns = cells(reader.headers().map_err(damaged)?);
        let rows = reader.records().map(|record| Ok(cells(&record?)));
        let rows = rows.collect::<Result<_, _>>().map_err(damaged)?;
        Ok(Some(Self { columns, rows }))
    }

    pub(super) fn payload(self) -> Payload {
        let text = json!({ "columns": self.columns, "rows": self.rows }).to_string();
        Payload::of_bytes("objects-table", text.as_bytes())
    }
}
