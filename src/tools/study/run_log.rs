//! The log of runs, `runs.jsonl`.
//!
//! JSON Lines: a header with the provenance of the runs, which is all that determines them besides
//! their points, then one line per run. An incomplete last line, from an interrupted write, is cut
//! off when the study continues.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{RunMetrics, StudyPoint};
use base::numbers::bytes;
use host::available_memory;
use host::files;
use host::folder::WriteError;
use host::provenance::difference;
use host::text::Diagnostic;

/// Version of the format; files of other versions are refused.
const FORMAT: u32 = 2;
/// Maximum length of a line in bytes; a run has a few thousand.
const MAX_LINE: u64 = 1 << 20;
/// Greatest number of bytes of memory for a byte of the file: for values of the shortest keys.
const MEMORY_PER_BYTE: u64 = 40;

/// A log of runs, open for appending.
#[derive(Debug)]
pub struct RunLog {
    file: File,
    /// The runs so far, in the order of the file.
    pub runs: Vec<Run>,
    /// The places of the runs, by round and point.
    places: HashMap<String, usize>,
}

/// One run of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The point's values, by factor name.
    pub point: Map<String, Value>,
    /// The round, from 0.
    pub round: u32,
    /// The metrics of the run.
    pub metrics: RunMetrics,
}

/// Returns a text that is equal for equal rounds and points.
fn key_of(round: u32, point: &Map<String, Value>) -> String {
    let mut point = point.clone();
    point.sort_keys();
    format!("{round} {}", Value::Object(point))
}

/// The first line of the file.
#[derive(Serialize, Deserialize)]
struct RunLogHeader {
    raycost_study: u32,
    /// Provenance of the runs by key: machine and program; flags, launcher and a hash of the
    /// contents of each scene.
    made_by: Value,
}

/// Reasons why a log of runs cannot be opened.
#[derive(Debug)]
pub enum RunLogError {
    /// It is not a log of these runs.
    Foreign(Diagnostic),
    /// It cannot be read or written.
    Write(WriteError),
}

impl From<Diagnostic> for RunLogError {
    fn from(fault: Diagnostic) -> Self {
        Self::Foreign(fault)
    }
}

impl RunLog {
    /// Opens the log at `path`, or creates one for runs with the provenance `made_by`.
    ///
    /// # Errors
    /// If the file cannot be read or written, is not a log of runs, has a run twice, or if its runs
    /// have another provenance. The file stays unchanged.
    pub fn open(path: &Path, made_by: &Value) -> Result<Self, RunLogError> {
        let failed = |error| cannot_open(path, error);
        let mut options = OpenOptions::new();
        options.read(true).append(true).create(true);
        let mut file = files::open_to_change(&mut options, path).map_err(failed)?;
        if file.metadata().map_err(failed)?.len() == 0 {
            let header = RunLogHeader {
                raycost_study: FORMAT,
                made_by: made_by.clone(),
            };
            // Otherwise the next run would refuse half a header as a file of another program.
            append(&mut file, &header)
                .inspect_err(|_| drop(fs::remove_file(path)))
                .map_err(failed)?;
            return Ok(Self {
                file,
                runs: Vec::new(),
                places: HashMap::new(),
            });
        }
        check_length(&file).map_err(failed)?;
        let mut lines = CompleteLines::new(&file).map_err(failed)?;
        check_header(path, lines.next().map_err(failed)?.as_deref(), made_by)?;
        let mut runs: Vec<Run> = Vec::new();
        let mut places = HashMap::new();
        while let Some(line) = lines.next().map_err(failed)? {
            let run = serde_json::from_str(&line);
            let run: Run = run.map_err(|error| invalid_run(path, runs.len() + 2, &error))?;
            if let Some(first) = places.insert(key_of(run.round, &run.point), runs.len()) {
                return Err(duplicate_run(path, [first + 2, runs.len() + 2]).into());
            }
            runs.push(run);
        }
        let whole = lines.n_bytes;
        file.set_len(whole).map_err(failed)?;
        Ok(Self { file, runs, places })
    }

    /// Returns true if the log has this round of the point.
    pub fn has(&self, point: &StudyPoint, round: u32) -> bool {
        self.places.contains_key(&key_of(round, &point.values))
    }

    /// Appends a run; it is on the disk when this returns.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn add(&mut self, run: Run) -> io::Result<()> {
        append(&mut self.file, &run)?;
        self.file.sync_data()?;
        let place = self.runs.len();
        self.places.insert(key_of(run.round, &run.point), place);
        self.runs.push(run);
        Ok(())
    }
}

/// Checks that the runs of a file fit into the free memory.
fn check_length(file: &File) -> io::Result<()> {
    let most = available_memory() / MEMORY_PER_BYTE;
    if file.metadata()?.len() <= most {
        return Ok(());
    }
    let message = format!("it is longer than {}, which fit into memory", bytes(most));
    Err(io::Error::new(io::ErrorKind::InvalidData, message))
}

/// The complete lines of a file.
struct CompleteLines {
    reader: BufReader<File>,
    /// Length of the lines so far in bytes, with their line ends.
    n_bytes: u64,
}

impl CompleteLines {
    fn new(file: &File) -> io::Result<Self> {
        let mut file = file.try_clone()?;
        file.seek(SeekFrom::Start(0))?;
        Ok(Self {
            reader: BufReader::new(file),
            n_bytes: 0,
        })
    }

    /// Returns the next line without its line end; `None` at the end of the file or at an
    /// incomplete line.
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

/// Checks that the first line is a header of runs with the same provenance.
fn check_header(path: &Path, header: Option<&str>, made_by: &Value) -> Result<(), Diagnostic> {
    let (name, folder) = (path.display(), path.parent().unwrap_or(path).display());
    let remedy = format!("give another folder by `--out`, or delete `{folder}` to measure anew");
    let Some(header) = header.and_then(|line| serde_json::from_str::<RunLogHeader>(line).ok())
    else {
        let message = format!("`{name}` holds no results of a study");
        return Err(Diagnostic::new(message).with_help(remedy));
    };
    if header.raycost_study != FORMAT {
        let found = header.raycost_study;
        let message = format!(
            "`{name}` has format {found} of results, which this raycost does not continue: it has \
             {FORMAT}"
        );
        return Err(Diagnostic::new(message).with_help(remedy));
    }
    match difference(&header.made_by, made_by) {
        None => Ok(()),
        Some(difference) => {
            let message = format!("the runs in `{name}` were made with {difference}");
            Err(Diagnostic::new(message).with_help(remedy))
        }
    }
}

fn cannot_open(path: &Path, error: io::Error) -> RunLogError {
    if error.kind() != io::ErrorKind::InvalidData {
        return RunLogError::Write(WriteError::new(path, error));
    }
    let message = format!("cannot use `{}`: {error}", path.display());
    RunLogError::Foreign(Diagnostic::new(message).with_help("give another folder by `--out`"))
}

fn duplicate_run(path: &Path, [first, again]: [usize; 2]) -> Diagnostic {
    Diagnostic::new(format!(
        "line {again} of `{}` is the same run as line {first}: it would count twice",
        path.display()
    ))
    .with_help("remove one of the two lines")
}

fn invalid_run(path: &Path, line: usize, error: &serde_json::Error) -> Diagnostic {
    Diagnostic::new(format!(
        "line {line} of `{}` is not a run: {error}",
        path.display()
    ))
    .with_help("remove the line to have it measured again")
}
