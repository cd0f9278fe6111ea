//! The words, numbers and names of columns in tables of comma-separated values.

use std::io::BufRead;
use std::str::FromStr;

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder, Trim};
use memchr::memchr2;

use super::fault::cut;
use super::{FileFault, FileLocation, GeometryFileReader, Result};

/// Starts to read a table, whose values are separated by commas, or by semicolons or tabs if there
/// is no comma in its first line.
pub(super) fn open_table(mut file: GeometryFileReader) -> Result<Reader<GeometryFileReader>> {
    let start = file.fill_buf()?;
    let line = &start[..memchr2(b'\n', b'\r', start).unwrap_or(start.len())];
    let mut separators = b",;\t".iter().filter(|separator| line.contains(separator));
    let separator = *separators.next().unwrap_or(&b',');
    let mut builder = ReaderBuilder::new();
    Ok(builder
        .trim(Trim::All)
        .delimiter(separator)
        .from_reader(file))
}

/// Returns true if a table has a column of this name.
pub(super) fn has_column(file: GeometryFileReader, name: &str) -> Result<bool> {
    let mut table = open_table(file)?;
    let header = table.byte_headers().map_err(of_table)?;
    Ok(header.iter().any(|known| known == name.as_bytes()))
}

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

/// Creates the fault of a missing column, with the table's first line and an example of one that has
/// it.
pub(super) fn missing_column(name: &str, first: &ByteRecord, example: &str) -> FileFault {
    let expected = format!(
        "a first line such as `{example}`, not `{}`",
        columns(first).join(",")
    );
    FileFault::new(format!("there is no column `{name}`"), expected)
}

/// Returns the names of the first columns of a table.
pub(super) fn columns(first: &ByteRecord) -> Vec<String> {
    let names = first.iter().take(MAX_LISTED).map(String::from_utf8_lossy);
    names.map(|name| cut(&name).into_owned()).collect()
}

/// Maximum number of names of columns in a message.
const MAX_LISTED: usize = 8;

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
