//! `objects.csv`: the cost of each object and each material.

use std::io::{self, BufReader, Read};

use super::Results;
use crate::summary::FILE as SUMMARY;
use crate::writers::{OBJECTS_CSV, rows_per_thing};
use base::files;
use base::text::{Diagnostic, numbers, text_of_cell};
use scene::yaml::MAX_NAME;

/// Maximum number of bytes of a row: a quoted name of the longest characters, and the numbers.
const MAX_ROW: u64 = 2 * 4 * MAX_NAME as u64 + 1024;

/// The cells of the table as text; names are unescaped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ObjectsTable {
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows, each as long as `columns`.
    pub rows: Vec<Vec<String>>,
}

impl ObjectsTable {
    /// Returns the index of the column with this name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

impl Results {
    /// Reads `objects.csv`; `None` if the folder has no such file.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or has more rows than the objects and materials of the
    /// summary allow.
    pub fn objects(&self) -> Result<Option<ObjectsTable>, Diagnostic> {
        let file = match files::open(&self.folder().join(OBJECTS_CSV.name)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            file => file.map_err(|error| self.no_table(&error.to_string()))?,
        };
        let n_bytes = file.metadata().map_or(0, |metadata| metadata.len());
        let most_rows = self.most_rows();
        let most_bytes = (most_rows as u64 + 1).saturating_mul(MAX_ROW);
        if n_bytes > most_bytes {
            return Err(self.longer_than_its_scene(most_rows));
        }
        let file = BufReader::new(file.take(most_bytes));
        let mut table = csv::Reader::from_reader(file);
        let damaged = |error: csv::Error| self.no_table(&error.to_string());
        let columns = cells(table.headers().map_err(damaged)?);
        let name = columns.iter().position(|column| column == "name");
        let mut rows = Vec::new();
        for record in table.records() {
            if rows.len() == most_rows {
                return Err(self.longer_than_its_scene(most_rows));
            }
            let mut row = cells(&record.map_err(damaged)?);
            if let Some(name) = name.and_then(|name| row.get_mut(name)) {
                *name = text_of_cell(name).to_owned();
            }
            rows.push(row);
        }
        self.check_length(OBJECTS_CSV.name)?;
        Ok(Some(ObjectsTable { columns, rows }))
    }

    /// Returns the maximum number of rows of this scene's table; "nothing" counts as one more
    /// object and one more material.
    fn most_rows(&self) -> usize {
        let summary = &self.summary;
        (summary.objects.len() + summary.materials.len() + 2) * rows_per_thing()
    }

    fn longer_than_its_scene(&self, most_rows: usize) -> Diagnostic {
        self.mixed(format!(
            "{} is longer than the {} of the objects and materials in {SUMMARY}",
            OBJECTS_CSV.name,
            numbers::counted(most_rows as u64, "row")
        ))
    }

    /// Returns the error for an unusable table.
    pub fn no_table(&self, why: &str) -> Diagnostic {
        let path = self.folder().join(OBJECTS_CSV.name);
        Diagnostic::new(format!("cannot read `{}`: {why}", path.display()))
            .with_help("render the scene again with `--also objects`")
    }
}

fn cells(record: &csv::StringRecord) -> Vec<String> {
    record.iter().map(str::to_owned).collect()
}
