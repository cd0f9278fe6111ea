//! `objects.csv`: the cost of each object and each material.

use std::fs::File;
use std::io::{self, BufReader, Read, Take};

use super::Results;
use crate::summary::FILE as SUMMARY;
use crate::writers::{OBJECTS_CSV, rows_per_thing};
use base::numbers;
use host::files;
use host::text::{Diagnostic, text_of_cell};
use world::values::MAX_NAME;

/// Maximum number of bytes of a row: a quoted name of the longest characters, and the numbers.
const MAX_ROW: u64 = 2 * 4 * MAX_NAME as u64 + 1024;

/// The table, whose rows are read one by one: those of many objects would take many times the
/// memory of their file.
#[derive(Debug)]
pub struct ObjectsTable<'a> {
    results: &'a Results,
    columns: Vec<String>,
    most_rows: usize,
    rows: csv::Reader<BufReader<Take<File>>>,
}

impl ObjectsTable<'_> {
    /// Returns the names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Returns the index of the column with this name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// Calls `visit` with the cells of each row as text, as many as there are columns; names are
    /// unescaped.
    ///
    /// # Errors
    /// The file is damaged, or has more rows than the objects and materials of the summary allow.
    pub fn read_rows(mut self, mut visit: impl FnMut(&[&str])) -> Result<(), Diagnostic> {
        let name = self.column("name");
        for (n_before, record) in self.rows.records().enumerate() {
            if n_before == self.most_rows {
                return Err(self.results.longer_than_its_scene(self.most_rows));
            }
            let record = record.map_err(|error| self.results.no_table(&error.to_string()))?;
            let mut row: Vec<&str> = record.iter().collect();
            if let Some(name) = name.and_then(|name| row.get_mut(name)) {
                *name = text_of_cell(name);
            }
            visit(&row);
        }
        self.results.check_length(OBJECTS_CSV.name)
    }
}

impl Results {
    /// Opens `objects.csv`; `None` if the folder has no such file.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or is longer than the objects and materials of the
    /// summary allow.
    pub fn objects(&self) -> Result<Option<ObjectsTable<'_>>, Diagnostic> {
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
        let mut rows = csv::Reader::from_reader(BufReader::new(file.take(most_bytes)));
        let columns = rows.headers();
        let columns = columns.map_err(|error| self.no_table(&error.to_string()))?;
        Ok(Some(ObjectsTable {
            results: self,
            columns: columns.iter().map(str::to_owned).collect(),
            most_rows,
            rows,
        }))
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
