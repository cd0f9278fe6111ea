//! `raycost study`.

mod check;
mod files;
mod intervals;
mod launcher;
mod made_by;
mod process;
mod report;
mod scene_files;
mod steps;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Parser;
use serde_json::{Value, json};

pub(super) use check::{check, is_study, refuse_flags, refuse_study};
use report::StudyResults;
use scene_files::SceneFiles;

use super::progress;
use super::{Cli, Failure, thread_pool};
use base::numbers;
use base::stop;
use host::default_threads;
use host::folder::{Lock, Replace, lock_folder, refuse_file, write_file};
use host::text::{self, Diagnostic};
use render::instruments::MachineLimits;
use scene::yaml::{self, Fault, Source};
use tools::study::{
    Figure, LeftOutStep, LimitsFile, PlannedRun, RooflinePoint, Run, RunLog, RunLogError,
    StatisticsRow, StudyMetric, StudyPlan, StudyPoint, overhead_rows, roofline_points,
    scaling_rows, statistics_rows, step_rows,
};

/// Measure how the cost of scenes depends on what you vary
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost study configs/studies/tiles.yaml
  raycost study configs/studies/image_size.yaml --quick --out /tmp/sizes
  raycost study --quick
  raycost study --list-metrics

The same command continues an interrupted study and repeats no finished run.
`raycost check STUDY` checks a study and its scenes without a run.")]
pub(super) struct StudyArguments {
    /// Study files, or folders of them [default: configs/studies]
    #[arg(value_name = "STUDY")]
    studies: Vec<PathBuf>,

    /// Output folder [default: out/studies/STUDY]; several studies get a
    /// folder each inside it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Run the smaller matrix of each study, to test it
    #[arg(long)]
    quick: bool,

    /// Let a study start any command: the `command` of a step, and a `launcher` other than
    /// `mpirun`, `mpiexec` and `srun` with plain options
    #[arg(long)]
    allow_commands: bool,

    /// List the metrics for plots, with their units, and end
    #[arg(long, exclusive = true)]
    list_metrics: bool,

    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

/// The log of runs in a study's folder.
const RUN_LOG: &str = "runs.jsonl";

/// A checked study and its folders.
struct Study {
    plan: StudyPlan,
    points: Vec<StudyPoint>,
    scenes: SceneFiles,
    /// The study file's folder, to which the paths of scenes are relative.
    folder: PathBuf,
    /// The output folder.
    out: PathBuf,
    /// The steps that cannot be made here.
    left_out: Vec<LeftOutStep>,
}

/// The runs of a study that are still missing.
#[derive(Default)]
struct Missing {
    /// Runs that the time budget left.
    n_runs: usize,
    /// Steps whose command failed.
    failed: Vec<LeftOutStep>,
}

pub(super) fn run(arguments: &StudyArguments) -> Result<(), Failure> {
    if arguments.list_metrics {
        return Ok(text::print(&StudyMetric::table())?);
    }
    let (named, out, quick) = (
        &arguments.studies,
        arguments.out.as_deref(),
        arguments.quick,
    );
    let files = files::find(named, out, quick)?.into_iter();
    let read = files.map(|(file, out)| {
        let source = Source::read(&file)?;
        check::refuse_scene(&source)?;
        Study::parse(&source, out, quick, arguments.allow_commands)
    });
    let studies = read.collect::<Result<Vec<_>, Failure>>()?;
    let made_by = made_by::describe_tables();
    let measured_by = made_by::describe_measurements(&made_by)?;
    // Open all studies before the first run: a foreign file in one of them stops all.
    let locks = studies.iter().map(|study| study.lock());
    let _locks = locks.collect::<Result<Vec<Lock>, Failure>>()?;
    let opened = studies.iter().map(|study| study.open(&measured_by));
    let opened = opened.collect::<Result<Vec<_>, Failure>>()?;
    let mut n_left = 0;
    for (study, mut log) in studies.iter().zip(opened) {
        let missing = study.measure(&mut log, arguments.quiet)?;
        n_left += missing.n_runs;
        let n_processors = made_by["machine"]["logical_cpus"].as_u64();
        let mut rows = statistics_rows(&study.plan, &log.runs, n_processors);
        rows.extend(scaling_rows(&study.plan, &log.runs, &rows));
        rows.extend(overhead_rows(&study.plan, &log.runs, &rows));
        rows.extend(step_rows(&study.plan, &log.runs, &study.out));
        let points = study.roofline(&rows, &measured_by)?;
        let left_out = [&study.left_out[..], &missing.failed].concat();
        let results = StudyResults {
            plan: &study.plan,
            rows: &rows,
            points: points.as_deref(),
            left_out: &left_out,
        };
        let of_plots = report::write_tables(&study.out, &results, &made_by)?;
        if !arguments.quiet {
            text::print(&report::lines_of(&results, &of_plots, &study.out))?;
        }
    }
    if !arguments.quiet {
        text::print(&report::last_lines(&made_by, n_left))?;
    }
    Ok(())
}

impl Study {
    /// Checks a study, and that each of its points can be rendered. Unless `any_command`, its
    /// launcher has to be harmless.
    fn parse(
        source: &Source,
        out: PathBuf,
        quick: bool,
        any_command: bool,
    ) -> Result<Self, Failure> {
        let mut plan: StudyPlan = source.parse()?;
        let point_at = |fault| source.point_at(fault);
        plan.check().map_err(point_at)?;
        if quick {
            plan = plan.into_quick();
            plan.check().map_err(point_at)?;
        }
        if plan.n_runs() > StudyPlan::MAX_RUNS {
            let message = format!("the study has {} runs", numbers::count(plan.n_runs()));
            let expected = format!("expected at most {}", numbers::count(StudyPlan::MAX_RUNS));
            let fault = Fault::new(yaml::FieldPath::default(), message, expected)
                .with_help("vary less at once, or lower `repeats`");
            return Err(point_at(fault).into());
        }
        launcher::check(&plan, any_command).map_err(point_at)?;
        let left_out = steps::leave_out(&mut plan, any_command);
        // A scene is never standard input, whose name is `-`.
        let folder = match source.folder() {
            none if none == Path::new("") => PathBuf::from("."),
            folder => folder.to_owned(),
        };
        let points = plan.points();
        let files_of = |point: &StudyPoint| checked_files(&plan, point, &folder);
        Ok(Self {
            scenes: SceneFiles::read(&points, files_of)?,
            points,
            plan,
            folder,
            out,
            left_out,
        })
    }

    /// Locks the output folder and checks that it has no foreign table or plot. A folder with a log
    /// of runs belongs to a study.
    fn lock(&self) -> Result<Lock, Failure> {
        let lock = lock_folder(&self.out)?;
        if !self.out.join(RUN_LOG).exists() {
            let failed = |error| cannot_write(&self.out, &error);
            for entry in fs::read_dir(&self.out).map_err(failed)?.flatten() {
                let name = entry.file_name();
                let name = name.to_str().unwrap_or_default();
                let is_reserved = |prefix: &&str| name.starts_with(*prefix);
                if ["statistics.", "plot-", "roofline.", "step-"]
                    .iter()
                    .any(is_reserved)
                {
                    return Err(refuse_file(&entry.path()).into());
                }
            }
        }
        Ok(lock)
    }

    /// Opens the log of runs; checks the file of limits, too.
    fn open(&self, measured_by: &Value) -> Result<RunLog, Failure> {
        if self.plan.roofline {
            LimitsFile::read(&self.limits_path(), measured_by)?;
        }
        let mut made_by = measured_by.clone();
        made_by["n_threads"] = json!(default_threads());
        made_by["flags"] = json!(self.plan.flags);
        made_by["launcher"] = json!(self.plan.launcher);
        made_by["scenes"] = self.scenes.hashes();
        RunLog::open(&self.out.join(RUN_LOG), &made_by).map_err(|error| match error {
            RunLogError::Foreign(fault) => fault.into(),
            RunLogError::Write(error) => error.into(),
        })
    }

    /// Makes the missing runs until the time budget ends. Returns the runs that are still missing.
    fn measure(&self, log: &mut RunLog, quiet: bool) -> Result<Missing, Failure> {
        let mut missing = Missing::default();
        let planned = self.plan.runs().into_iter();
        let is_missing = |run: &PlannedRun| !log.has(&self.points[run.point], run.round);
        let todo: Vec<PlannedRun> = planned.filter(is_missing).collect();
        let bar = progress::bar(todo.len() as u64, quiet);
        let start = Instant::now();
        let budget = self.plan.time_budget_s.map(Duration::from_secs_f32);
        for (n_done, planned) in todo.iter().enumerate() {
            if budget.is_some_and(|budget| start.elapsed() >= budget) {
                missing.n_runs = todo.len() - n_done;
                break;
            }
            let point = &self.points[planned.point];
            let step = point.step().unwrap_or_default();
            if missing.failed.iter().any(|failed| failed.step == step) {
                bar.inc(1);
                continue;
            }
            bar.set_message(text::one_line(&point.label()).into_owned());
            stop::check()?;
            let metrics = match process::render(&self.plan, point, &self.folder, &self.out) {
                Err(Failure::Machine(failure)) if point.command.is_some() => {
                    stop::check()?;
                    let (step, reason) = (step.to_owned(), failure.message().to_owned());
                    missing.failed.push(LeftOutStep { step, reason });
                    bar.inc(1);
                    continue;
                }
                rendered => rendered?,
            };
            self.scenes.check(point, &self.out)?;
            let run = Run {
                point: point.values.clone(),
                round: planned.round,
                metrics,
            };
            let failed = |error| cannot_write(&self.out, &error);
            log.add(run).map_err(failed)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(missing)
    }

    /// Returns the points in the roofline model, if the study requests it; writes the plot, too.
    /// Measures the limits if the folder does not have them yet.
    fn roofline(
        &self,
        rows: &[StatisticsRow],
        measured_by: &Value,
    ) -> Result<Option<Vec<RooflinePoint>>, Failure> {
        if !self.plan.roofline {
            return Ok(None);
        }
        let path = self.limits_path();
        let limits = match LimitsFile::read(&path, measured_by)? {
            Some(limits) => limits,
            None => {
                let limits = thread_pool(None)?.install(MachineLimits::measure);
                let content = LimitsFile::new(limits.clone(), measured_by);
                write_file(&path, Replace::Known, |file| {
                    Ok(serde_json::to_writer_pretty(file, &content)?)
                })?;
                limits
            }
        };
        let points = roofline_points(rows, &limits);
        if let Some(figure) = Figure::roofline(&self.plan.title, &points, &limits) {
            report::write_figure(&figure, &self.out, "roofline")?;
        }
        Ok(Some(points))
    }

    fn limits_path(&self) -> PathBuf {
        self.out.join("limits.json")
    }
}

/// Checks that a point can be rendered, before the first run. Returns the files of its scene.
fn checked_files(
    plan: &StudyPlan,
    point: &StudyPoint,
    folder: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    let refused = |error: clap::Error| {
        let text = error.to_string();
        let reason = text.lines().next().unwrap_or_default();
        let reason = reason.trim_start_matches("error: ");
        Diagnostic::new(format!("cannot run {}: {reason}", point.label()))
            .with_help("see `raycost render --help` for the flags")
    };
    let flags: Vec<&String> = point.flags.iter().chain(&plan.flags).collect();
    let scene = folder.join(&point.scene).display().to_string();
    let parse = |command: &str, flags: Vec<&String>| {
        // With the folder of the run, so that flags may not name another one.
        let words = ["raycost", command, "--out=out", &scene].into_iter();
        Cli::try_parse_from(words.chain(flags.into_iter().map(String::as_str)))
    };
    // `check` has none of these.
    let of_render = [
        "--device=",
        "--threads=",
        "--pin=",
        "--simd=",
        "--traversal=",
    ];
    let is_of_check = |word: &&String| !of_render.iter().any(|flag| word.starts_with(flag));
    let of_check = flags.iter().copied().filter(is_of_check).collect();
    let files = parse("check", of_check).map_err(refused)?.checked_files()?;
    parse("render", flags).map_err(refused)?;
    Ok(files)
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    let message = format!("cannot write to `{}`: {error}", path.display());
    Failure::Machine(Diagnostic::new(message).with_help("give another folder by `--out`"))
}
