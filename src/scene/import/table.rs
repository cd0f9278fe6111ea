//! The words, numbers and names of columns in tables of comma-separated values.

use std::str::FromStr;

use csv::{ByteRecord, ErrorKind};

use super::fault::cut;
use super::{FileFault, FileLocation, Result};

/// Returns one field of a row; every row has as many fields as the header.
pub(super) fn word(row: &ByteRecord, column: usize) -> &str {
    str::from_utf8(&row[column]).unwrap_or("\u{fffd}")
}

/// Parses a word as a number.
pub(super) fn number<T: FromStr>(word: &str) -> Result<T> {
    word.parse()
        .map_err(|_| FileFault::new(format!("`{}` is not a number", cut(word)), "a number"))
}

/// Creates the fault of a name that two columns have.
pub(super) fn named_twice(name: &str) -> FileFault {
    let problem = format!("two columns are named `{}`", cut(name));
    FileFault::new(problem, "different names")
}

/// Creates the fault of a missing column, with an example of a first line that has it.
pub(super) fn missing_column(name: &str, header: &str) -> FileFault {
    let problem = format!("there is no column `{name}`");
    FileFault::new(problem, format!("a first line such as `{header}`"))
}

/// Creates the fault of a table that cannot be read.
pub(super) fn of_table(error: csv::Error) -> FileFault {
    let line = error
        .position()
        .map(|position| FileLocation::Line(position.line()));
    let fault = match error.into_kind() {
        ErrorKind::Io(error) => FileFault::from(error),
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => FileFault::new(
            format!("{len} fields"),
            format!("{expected_len}, as in line 1"),
        ),
        _ => FileFault::new("the table is damaged", "comma-separated values"),
    };
    match line {
        Some(line) => fault.at(line),
        None => fault,
    }
}
