//! `raycost study`.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use clap::Parser;
use serde_json::{Value, json};

use super::progress::StudyBar;
use super::tables::{closing_lines, last_lines, write_figure, write_tables};
use super::{Cli, Failure, studies};
use crate::folder::{Replace, Scratch, lock_folder, refuse_file, write_file};
use crate::instruments::HardwareCounters;
use crate::output;
use crate::stop;
use crate::study::{
    Figure, Limits, Metrics, Plan, Point, Results, Row, Run, Standing, Turn, rows, standings,
};
use crate::text::{self, Diagnostic, numbers};
use crate::yaml::{self, Fault, Source};

/// Measure how the cost of scenes depends on what you vary
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost study configs/studies/tiles.yaml
  raycost study configs/studies/image_size.yaml --quick --out /tmp/sizes
  raycost study --quick

A study that was stopped goes on where it was when the same command is given
again: a run that has ended is never measured again.")]
pub(super) struct Arguments {
    /// Study files, or folders of them [default: configs/studies]
    #[arg(value_name = "STUDY")]
    studies: Vec<PathBuf>,

    /// Folder to write to [default: out/studies/<the study's name>]; of several
    /// studies each has one in it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Take the smaller matrix of each study, to see it work
    #[arg(long)]
    quick: bool,

    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

/// The runs of a study in its folder.
const RUNS: &str = "runs.jsonl";

/// A study file that was read and can be run.
struct Study {
    plan: Plan,
    points: Vec<Point>,
    /// The study file's folder, which scenes are relative to.
    folder: PathBuf,
    /// Where results go.
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (named, out, quick) = (
        &arguments.studies,
        arguments.out.as_deref(),
        arguments.quick,
    );
    let files = studies::files(named, out, quick)?.into_iter();
    let read = files.map(|(file, out)| Study::read(&file, out, quick));
    let studies = read.collect::<Result<Vec<_>, Failure>>()?;
    let made_by = made_by();
    // All are opened before anything is measured: a file of others stops all.
    let locks = studies.iter().map(|study| study.lock());
    let _locks = locks.collect::<Result<Vec<File>, Failure>>()?;
    let opened = studies.iter().map(|study| study.open(&made_by));
    let opened = opened.collect::<Result<Vec<_>, Failure>>()?;
    let mut n_left = 0;
    for (study, mut results) in studies.iter().zip(opened) {
        let left = study.measure(&mut results, arguments.quiet)?;
        n_left += left;
        let n_processors = made_by["machine"]["logical_cpus"].as_u64();
        let rows = rows(&study.plan, &results, n_processors);
        let standings = study.standings(&rows, &made_by)?;
        write_tables(
            &study.out,
            &study.plan,
            &rows,
            standings.as_deref(),
            &made_by,
        )?;
        if !arguments.quiet {
            let lines = closing_lines(&study.plan, &rows, standings.as_deref(), &study.out);
            text::print(&lines)?;
        }
    }
    if !arguments.quiet {
        text::print(&last_lines(&made_by, n_left))?;
    }
    Ok(())
}

impl Study {
    /// Reads a study file, and makes sure that each of its points can be run.
    fn read(file: &Path, out: PathBuf, quick: bool) -> Result<Self, Failure> {
        let source = Source::read(file)?;
        let mut plan: Plan = source.parse()?;
        if quick {
            plan = plan.quickened();
        }
        if plan.n_runs() > Plan::MAX_RUNS {
            let message = format!("the study has {} runs", numbers::count(plan.n_runs()));
            let expected = format!("expected at most {}", numbers::count(Plan::MAX_RUNS));
            let fault = Fault::new(yaml::Path::default(), message, expected)
                .with_help("vary less at once, or lower `repeats`");
            return Err(source.point_at(fault).into());
        }
        let study = Self {
            points: plan.points(),
            plan,
            folder: source.folder().to_owned(),
            out,
        };
        for point in &study.points {
            check(&study.plan, point, &study.folder)?;
        }
        Ok(study)
    }

    /// Locks its folder; makes sure that no table or plot in it is someone
    /// else's: a folder with runs is a study's.
    fn lock(&self) -> Result<File, Failure> {
        let lock = lock_folder(&self.out)?;
        if !self.out.join(RUNS).exists() {
            let failed = |error| cannot_write(&self.out, &error);
            for entry in fs::read_dir(&self.out).map_err(failed)?.flatten() {
                let name = entry.file_name();
                let name = name.to_str().unwrap_or_default();
                let is_ours = |own: &&str| name.starts_with(*own);
                if ["statistics.", "plot-", "roofline."].iter().any(is_ours) {
                    return Err(refuse_file(&entry.path()).into());
                }
            }
        }
        Ok(lock)
    }

    /// Its results so far.
    fn open(&self, made_by: &Value) -> Result<Results, Failure> {
        if self.plan.roofline {
            Limits::read_from(&self.limits_path(), made_by)?;
        }
        Ok(Results::open(&self.out.join(RUNS), made_by)?)
    }

    /// Makes the runs that are left; gives how many are still left in the end.
    fn measure(&self, results: &mut Results, quiet: bool) -> Result<usize, Failure> {
        let turns = self.plan.turns().into_iter();
        let is_left = |turn: &Turn| !results.has(&self.points[turn.point], turn.round);
        let todo: Vec<Turn> = turns.filter(is_left).collect();
        let bar = StudyBar::new(todo.len() as u64, quiet);
        let start = Instant::now();
        let budget = self.plan.time_budget_s.map(Duration::from_secs_f32);
        for (n_done, turn) in todo.iter().enumerate() {
            if budget.is_some_and(|budget| start.elapsed() >= budget) {
                bar.clear();
                return Ok(todo.len() - n_done);
            }
            let point = &self.points[turn.point];
            bar.begin(&point.label());
            stop::check()?;
            let metrics = one_run(&self.plan, point, &self.folder, &self.out)?;
            let run = Run {
                point: point.values.clone(),
                round: turn.round,
                metrics,
            };
            let failed = |error| cannot_write(&self.out, &error);
            results.add(run).map_err(failed)?;
            bar.advance();
        }
        bar.clear();
        Ok(0)
    }

    /// Where its points stand under the machine's limits, if that is asked for;
    /// draws it, too. The limits are measured where the folder has none yet.
    fn standings(&self, rows: &[Row], made_by: &Value) -> Result<Option<Vec<Standing>>, Failure> {
        if !self.plan.roofline {
            return Ok(None);
        }
        let path = self.limits_path();
        let limits = match Limits::read_from(&path, made_by)? {
            Some(limits) => limits,
            None => {
                let limits = Limits::measure();
                write_file(&path, Replace::Known, |file| {
                    Ok(serde_json::to_writer_pretty(
                        file,
                        &limits.to_file(made_by),
                    )?)
                })?;
                limits
            }
        };
        let standings = standings(rows, &limits);
        if let Some(figure) = Figure::roofline(&self.plan.title, &standings, &limits) {
            write_figure(&figure, &self.out, "roofline")?;
        }
        Ok(Some(standings))
    }

    fn limits_path(&self) -> PathBuf {
        self.out.join("limits.json")
    }
}

/// Makes sure that a point can be run before any is.
fn check(plan: &Plan, point: &Point, folder: &Path) -> Result<(), Failure> {
    let words = ["raycost", "check"].map(str::to_owned).into_iter();
    let scene = folder.join(&point.scene).display().to_string();
    let flags = point.flags.iter().chain(&plan.flags).cloned();
    let words: Vec<String> = words.chain([scene]).chain(flags.clone()).collect();
    // Threads are no matter of `check`.
    let words = words.iter().filter(|word| !word.starts_with("--threads="));
    let refused = |error: clap::Error| {
        let text = error.to_string();
        let reason = text.lines().next().unwrap_or_default();
        let reason = reason.trim_start_matches("error: ");
        Diagnostic::new(format!("cannot run {}: {reason}", point.label()))
            .with_help("see `raycost render --help` for the flags")
    };
    let cli = Cli::try_parse_from(words).map_err(refused)?;
    Ok(cli.find_fault()?)
}

/// Renders a point in a process of its own, into a folder that goes again. The
/// process ends when this one does, however that happens.
fn one_run(plan: &Plan, point: &Point, folder: &Path, out: &Path) -> Result<Metrics, Failure> {
    let failed = |what: String| Failure::Machine(Diagnostic::new(what));
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut command = Command::new(program);
    command
        .arg("render")
        .arg(folder.join(&point.scene))
        .args(["--quiet", "--hardware-counters"]);
    let scratch = Scratch::create(out)?;
    let out = scratch.path();
    command.arg("--out").arg(&out).arg("--while-input-is-open");
    let flags = || plan.flags.iter().chain(&point.flags);
    // The rounds of the study are its repeats: a run whose number of renderings
    // went by its time could not be held against another.
    if !flags().any(|flag| flag.starts_with("--repeats")) {
        command.arg("--repeats=1");
    }
    command.args(flags());
    let start = Instant::now();
    let output = output_of(&mut command).map_err(|error| failed(error.to_string()))?;
    let process_ms = start.elapsed().as_secs_f64() * 1e3;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let message = format!("a run of {} failed", point.label());
        return Err(Failure::Machine(Diagnostic::new(message).with_note(said)));
    }
    let text = fs::read_to_string(out.join("summary.json"));
    let text = text.map_err(|error| failed(format!("a run left no summary: {error}")))?;
    let summary: Value = serde_json::from_str(&text)
        .map_err(|error| failed(format!("a run left a broken summary: {error}")))?;
    Ok(Metrics::of(&summary, process_ms))
}

/// What a process says that watches its standard input: it closes when this
/// process ends, and as soon as this one is asked to.
fn output_of(command: &mut Command) -> io::Result<Output> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.stderr(Stdio::piped()).spawn()?;
    let input = child.stdin.take();
    // Lives on in this thread until the process has ended.
    let input = Mutex::new(input);
    let close = || {
        if let Ok(mut input) = input.lock() {
            input.take();
        }
    };
    stop::watching(close, || child.wait_with_output())?
}

/// What the runs have in common: those of others are not theirs.
fn made_by() -> Value {
    json!({
        "machine": output::machine(),
        "build": output::build(),
        "no_hardware_counters": HardwareCounters::start().why_not(),
    })
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    let message = format!("cannot write to `{}`: {error}", path.display());
    Failure::Machine(Diagnostic::new(message).with_help("give another folder by `--out`"))
}
