//! Series of files, one per time step: files whose names differ by a number, such as
//! `step_%04d.vtu`, and ParaView's lists, `.pvd` and `.series`; or one file with all steps,
//! `.vtkhdf`.

use std::fs;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::fault::cut;
use super::vtk::{self, ListedStep};
use super::{DataFile, FileFault, Result, extension};
use host::files;

/// The files of a series in the order of their times, at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSeries(pub Vec<TimeStep>);

/// A file of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeStep {
    /// Path, relative to the same folder as the path of the series.
    pub file: PathBuf,
    /// The time step within the file, if it has several.
    pub step: Option<usize>,
    /// Time, greater than in the steps before.
    pub time: f64,
}

/// Maximum number of time steps of a series.
const MAX_STEPS: usize = 100_000;
/// Maximum length of a list in bytes.
const MAX_LIST: u64 = 64 << 20;
/// Maximum number of digits of a number in a file's name.
const MAX_DIGITS: usize = 15;

/// Returns true if a file, given by its full path, stands for a series of files, of which no step is
/// chosen: a file that has the name of a pattern is only itself.
pub fn is_series<'a>(file: impl Into<DataFile<'a>>) -> bool {
    let DataFile { path, step } = file.into();
    let is_list = is_list(path) && !(vtk::is_collection(path) && step.is_some());
    is_list || Pattern::find(path).is_some_and(|_| !path.is_file())
}

/// Returns true if the file's extension belongs to a list of the files of a series.
pub(super) fn is_list(path: &Path) -> bool {
    vtk::is_collection(path) || extension(path) == "series"
}

/// Returns the time steps of a geometry file whose path is relative to `folder`: of a series of
/// files, or of a VTKHDF file with several, unless the scene chooses one of them. `None` for a
/// still.
///
/// # Errors
/// As [`read_series`], or a VTKHDF file cannot be read or is damaged.
pub fn time_steps(folder: &Path, file: DataFile) -> Result<Option<DataSeries>> {
    let DataFile { path, step } = file;
    let full = folder.join(path);
    if is_series(DataFile { path: &full, step }) {
        if let Some(step) = step {
            let problem = format!("it is a series of files, and `step` is {step}");
            let fault = FileFault::new(problem, "the name of the step's file, without `step`");
            return Err(fault.in_file(&full));
        }
        return read_series(folder, path).map(Some);
    }
    if !vtk::is_hdf(path) || step.is_some() {
        return Ok(None);
    }
    let times = vtk::read_times(&full).and_then(|times| {
        let named = |(step, &time): (usize, &f64)| ListedStep::new(format!("step {step}"), time);
        check_times(&times.iter().enumerate().map(named).collect::<Vec<_>>())?;
        Ok(times)
    });
    let times = times.map_err(|fault| fault.in_file(&full))?;
    let step = |(step, time): (usize, f64)| TimeStep {
        file: path.to_owned(),
        step: Some(step),
        time,
    };
    let steps: Vec<TimeStep> = times.into_iter().enumerate().map(step).collect();
    Ok((steps.len() > 1).then_some(DataSeries(steps)))
}

/// Finds the files of a series in `folder`, to which its path is relative.
///
/// # Errors
/// A list cannot be read or is damaged, a file is missing, or there is no file at all.
pub fn read_series(folder: &Path, path: &Path) -> Result<DataSeries> {
    let full = folder.join(path);
    let steps = match Pattern::find(path) {
        Some(pattern) => pattern.steps(&full),
        None if vtk::is_collection(path) => {
            read_list(&full).and_then(|text| vtk::read_collection(&text))
        }
        None => read_list(&full).and_then(|text| read_json(&text)),
    };
    let beside = path.parent().unwrap_or(Path::new(""));
    let steps = steps.and_then(|steps| checked(steps, &folder.join(beside)));
    let steps = steps.map_err(|fault| fault.in_file(&full))?;
    let step = |(number, step): (usize, ListedStep)| match &step.files[..] {
        [file] => TimeStep {
            file: beside.join(file),
            step: None,
            time: step.time,
        },
        // The reader puts the parts together.
        _ => TimeStep {
            file: path.to_owned(),
            step: Some(number),
            time: step.time,
        },
    };
    Ok(DataSeries(
        steps.into_iter().enumerate().map(step).collect(),
    ))
}

/// Returns the steps if their times ascend and their files exist.
fn checked(steps: Vec<ListedStep>, folder: &Path) -> Result<Vec<ListedStep>> {
    if steps.is_empty() {
        return Err(FileFault::new("it has no time steps", "at least one file"));
    }
    check_times(&steps)?;
    let mut files = steps.iter().flat_map(|step| &step.files);
    if let Some(file) = files.find(|file| !folder.join(file).is_file()) {
        let problem = format!("its time step `{file}` is missing");
        return Err(FileFault::new(problem, "the files of all time steps"));
    }
    Ok(steps)
}

/// Checks that the times ascend.
fn check_times(steps: &[ListedStep]) -> Result<()> {
    if steps.len() > MAX_STEPS {
        let problem = format!("it has {} time steps", steps.len());
        return Err(FileFault::new(problem, format!("at most {MAX_STEPS}")));
    }
    if let Some(step) = steps.iter().find(|step| !step.time.is_finite()) {
        let problem = format!("the time of `{}` is {}", cut(&step.files[0]), step.time);
        return Err(FileFault::new(problem, "a number"));
    }
    for pair in steps.windows(2) {
        let [before, ListedStep { files, time }] = pair else {
            continue;
        };
        if before.time >= *time {
            let (file, before) = (cut(&files[0]), before.time);
            let problem = format!("the time of `{file}` is {time}, after {before}");
            return Err(FileFault::new(
                problem,
                "times that ascend, one file for each",
            ));
        }
    }
    Ok(())
}

/// A file name with a placeholder for a number: `step_%04d.vtu`.
struct Pattern {
    before: String,
    /// Minimum number of digits.
    width: usize,
    after: String,
}

impl Pattern {
    /// Parses the pattern in the last part of a path; `None` if it has none.
    fn find(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (before, rest) = name.split_once('%')?;
        let (digits, after) = rest.split_once('d')?;
        let width = match digits {
            "" => 1,
            _ => digits.strip_prefix('0')?.parse().ok()?,
        };
        (1..=MAX_DIGITS).contains(&width).then(|| Self {
            before: before.to_owned(),
            width,
            after: after.to_owned(),
        })
    }

    /// Returns the number in a file's name; `None` if it does not match.
    fn number_in(&self, name: &str) -> Option<u64> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let is_number = digits.bytes().all(|digit| digit.is_ascii_digit());
        let is_padded =
            digits.len() == self.width || digits.len() > self.width && !digits.starts_with('0');
        let is_short = digits.len() <= MAX_DIGITS;
        (is_number && is_padded && is_short).then(|| digits.parse().ok())?
    }

    fn name_of(&self, number: u64) -> String {
        let Self {
            before,
            width,
            after,
        } = self;
        format!("{before}{number:0width$}{after}")
    }

    /// Returns the files that match, by their numbers, which are their times.
    fn steps(&self, path: &Path) -> Result<Vec<ListedStep>> {
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        let mut numbers = Vec::new();
        for entry in fs::read_dir(folder.unwrap_or(Path::new(".")))? {
            let name = entry?.file_name();
            numbers.extend(name.to_str().and_then(|name| self.number_in(name)));
            if numbers.len() > MAX_STEPS {
                let problem = format!("more than {MAX_STEPS} files match");
                return Err(FileFault::new(problem, "fewer time steps"));
            }
        }
        if numbers.is_empty() {
            let expected = format!("files such as `{}`", self.name_of(0));
            return Err(FileFault::new("no file matches", expected));
        }
        numbers.sort_unstable();
        self.refuse_gaps(&numbers)?;
        let named = |number: u64| ListedStep::new(self.name_of(number), number as f64);
        Ok(numbers.into_iter().map(named).collect())
    }

    /// Checks that consecutive numbers differ by the same amount, such as 10 for a simulation that
    /// writes every tenth step.
    fn refuse_gaps(&self, numbers: &[u64]) -> Result<()> {
        let gaps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
        let Some(stride) = gaps.min() else {
            return Ok(());
        };
        let gap = numbers.windows(2).find(|pair| pair[1] - pair[0] != stride);
        let Some(&[before, after]) = gap else {
            return Ok(());
        };
        let missing = self.name_of(before + stride);
        let [before, after] = [before, after].map(|number| self.name_of(number));
        let problem =
            format!("the time step `{missing}` is missing, between `{before}` and `{after}`");
        Err(FileFault::new(problem, "numbers at equal distances"))
    }
}

/// A list of files as ParaView writes and reads it: `.vtu.series` and the like.
#[derive(Deserialize)]
struct SeriesList {
    files: Vec<SeriesEntry>,
}

#[derive(Deserialize)]
struct SeriesEntry {
    name: String,
    time: f64,
}

fn read_json(text: &[u8]) -> Result<Vec<ListedStep>> {
    let list: SeriesList = serde_json::from_slice(text).map_err(|error| {
        let problem = format!("it is not a list of files: {error}");
        FileFault::new(problem, r#"{ "files": [{ "name": …, "time": … }, …] }"#)
    })?;
    Ok(list
        .files
        .into_iter()
        .map(|entry| ListedStep::new(entry.name, entry.time))
        .collect())
}

fn read_list(path: &Path) -> Result<Vec<u8>> {
    Ok(files::read(path, MAX_LIST)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(name: &str) -> Option<Pattern> {
        Pattern::find(Path::new(name))
    }

    #[test]
    fn a_pattern_has_a_number_in_its_name() {
        for name in ["a%04d.vtu", "%d", "x/%02d_y.stl"] {
            assert!(pattern(name).is_some(), "{name}");
        }
        for name in [
            "a.vtu",
            "a%s.vtu",
            "a%4d.vtu",
            "a%0d.vtu",
            "a%099d.vtu",
            "%04d/a.vtu",
            "a%-4d",
        ] {
            assert!(pattern(name).is_none(), "{name}");
        }
    }

    #[test]
    fn numbers_are_those_that_the_pattern_would_write() {
        let pattern = pattern("a%03d.vtu").unwrap();
        for (name, number) in [
            ("a007.vtu", Some(7)),
            ("a1234.vtu", Some(1234)),
            ("a07.vtu", None),
            ("a0007.vtu", None),
            ("a-07.vtu", None),
            ("b007.vtu", None),
            ("a007.vtp", None),
            ("a99999999999999999999.vtu", None),
        ] {
            assert_eq!(pattern.number_in(name), number, "{name}");
            assert!(number.is_none_or(|number| pattern.name_of(number) == name));
        }
    }

    #[test]
    fn a_missing_number_is_named() {
        let pattern = pattern("a%03d.vtu").unwrap();
        for fine in [&[5][..], &[0, 1, 2], &[10, 20, 30]] {
            pattern.refuse_gaps(fine).unwrap();
        }
        for (numbers, missing) in [
            (&[0, 1, 3, 4][..], "a002.vtu"),
            (&[0, 10, 20, 40], "a030.vtu"),
        ] {
            let fault = pattern.refuse_gaps(numbers).unwrap_err();
            assert!(fault.problem.contains(missing), "{}", fault.problem);
        }
    }
}
