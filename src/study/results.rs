//! The file that runs are appended to.
//!
//! JSON, an object a line: first what made the runs, then a run a line. A line
//! is written whole or, if the machine stops in the middle of it, cut when the
//! study goes on.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{Metrics, Point};
use crate::text::Diagnostic;

/// The format's number: files of others are refused.
const FORMAT: u32 = 1;
/// Longest line that is read, in bytes; a run has a few thousand.
const MAX_LINE: u64 = 1 << 20;

/// A results file, open to be added to.
#[derive(Debug)]
pub struct Results {
    file: File,
    /// The runs so far, in the order that they were made.
    pub runs: Vec<Run>,
}

/// One run of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The point's values by factor.
    pub point: Map<String, Value>,
    /// Which run of the point, from 0.
    pub round: u32,
    /// What it told.
    pub metrics: Metrics,
}

impl Run {
    /// Whether the other one is the same run of the same point.
    fn is_again(&self, other: &Self) -> bool {
        (self.round, &self.point) == (other.round, &other.point)
    }
}

/// The first line.
#[derive(Serialize, Deserialize)]
struct Header {
    raycost_study: u32,
    /// What made the runs: machine, compiler, version.
    made_by: Value,
}

impl Results {
    /// Opens the file, or begins one for runs that are made by this program on
    /// this machine, as `made_by` tells.
    ///
    /// # Errors
    /// A file that cannot be read or written, that is no results file, or whose
    /// runs were made by another program or on another machine. It is left as
    /// it is.
    pub fn open(path: &Path, made_by: &Value) -> Result<Self, Diagnostic> {
        let failed = |error| cannot_open(path, &error);
        let mut options = OpenOptions::new();
        let options = options.read(true).append(true).create(true);
        let mut file = options.open(path).map_err(failed)?;
        if file.metadata().map_err(failed)?.len() == 0 {
            let header = Header {
                raycost_study: FORMAT,
                made_by: made_by.clone(),
            };
            append(&mut file, &header).map_err(failed)?;
            return Ok(Self {
                file,
                runs: Vec::new(),
            });
        }
        let mut lines = Lines::of(&file).map_err(failed)?;
        check(path, lines.next().map_err(failed)?.as_deref(), made_by)?;
        let mut runs = Vec::new();
        while let Some(line) = lines.next().map_err(failed)? {
            let run = serde_json::from_str(&line);
            let run: Run = run.map_err(|error| not_a_run(path, runs.len() + 2, &error))?;
            if let Some(first) = runs.iter().position(|other| run.is_again(other)) {
                return Err(made_twice(path, [first + 2, runs.len() + 2]));
            }
            runs.push(run);
        }
        let whole = lines.n_bytes;
        file.set_len(whole).map_err(failed)?;
        Ok(Self { file, runs })
    }

    /// Whether the run has been made.
    pub fn has(&self, point: &Point, round: u32) -> bool {
        let is_it = |run: &Run| run.round == round && run.point == point.values;
        self.runs.iter().any(is_it)
    }

    /// Adds a run, on the disk before this returns.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn add(&mut self, run: Run) -> io::Result<()> {
        append(&mut self.file, &run)?;
        self.file.sync_data()?;
        self.runs.push(run);
        Ok(())
    }
}

/// Lines that end.
struct Lines {
    reader: BufReader<File>,
    /// Bytes of the lines so far.
    n_bytes: u64,
}

impl Lines {
    fn of(file: &File) -> io::Result<Self> {
        let mut file = file.try_clone()?;
        file.seek(SeekFrom::Start(0))?;
        Ok(Self {
            reader: BufReader::new(file),
            n_bytes: 0,
        })
    }

    /// The next line, without what ends it; one that does not end is none.
    fn next(&mut self) -> io::Result<Option<String>> {
        let mut line = String::new();
        let n = (&mut self.reader).take(MAX_LINE).read_line(&mut line)?;
        if n as u64 == MAX_LINE {
            let message = "a line of it is longer than 1 MiB";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        if !line.ends_with('\n') {
            return Ok(None);
        }
        self.n_bytes += n as u64;
        Ok(Some(line.trim_end().to_owned()))
    }
}

fn append(file: &mut File, value: &impl Serialize) -> io::Result<()> {
    let mut line = serde_json::to_string(value)?;
    line.push('\n');
    file.write_all(line.as_bytes())
}

/// Makes sure that the first line is that of runs like ours.
fn check(path: &Path, header: Option<&str>, made_by: &Value) -> Result<(), Diagnostic> {
    let remedy = "give another folder by `--out`, or move the file away to measure anew";
    let name = path.display();
    let Some(header) = header.and_then(|line| serde_json::from_str::<Header>(line).ok()) else {
        let message = format!("`{name}` holds no results of a study");
        return Err(Diagnostic::new(message).with_help(remedy));
    };
    if header.raycost_study != FORMAT {
        let found = header.raycost_study;
        let message = format!("`{name}` has format {found} of results, this raycost has {FORMAT}");
        return Err(Diagnostic::new(message).with_help(remedy));
    }
    let difference = differing(&header.made_by, made_by);
    match difference {
        None => Ok(()),
        Some(key) => {
            let message = format!("the runs in `{name}` were made with another {key}");
            Err(Diagnostic::new(message).with_help(remedy))
        }
    }
}

/// The first key whose value differs.
pub(super) fn differing<'a>(before: &'a Value, now: &'a Value) -> Option<&'a str> {
    let now = now.as_object()?;
    let is_other = |(key, value): &(&String, &Value)| before.get(key.as_str()) != Some(*value);
    now.iter().find(is_other).map(|(key, _)| key.as_str())
}

fn cannot_open(path: &Path, error: &io::Error) -> Diagnostic {
    Diagnostic::new(format!("cannot use `{}`: {error}", path.display()))
        .with_help("give a folder that can be written to by `--out`")
}

fn made_twice(path: &Path, [first, again]: [usize; 2]) -> Diagnostic {
    Diagnostic::new(format!(
        "line {again} of `{}` is the same run as line {first}: it would count twice",
        path.display()
    ))
    .with_help("remove one of the two lines")
}

fn not_a_run(path: &Path, line: usize, error: &serde_json::Error) -> Diagnostic {
    Diagnostic::new(format!(
        "line {line} of `{}` is no run: {error}",
        path.display()
    ))
    .with_help("remove the line to have it measured again")
}
