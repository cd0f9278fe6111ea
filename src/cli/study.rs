//! `raycost study`.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use clap::Parser;
use serde_json::{Value, json};

use super::progress::StudyBar;
use super::{Cli, Failure};
use crate::output::{self, HardwareCounters, format::duration, write_file};
use crate::study::{
    Figure, Limits, Metrics, Plan, Point, Results, Row, Run, Standing, Turn, rows, standings,
    verdict, write_csv,
};
use crate::yaml::{Diagnostic, Source};

/// Measure how the cost of scenes depends on what you vary
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost study configs/studies/threads.yaml
  raycost study configs/studies/image_size.yaml --quick --out /tmp/sizes

A study that was stopped goes on where it was when the same command is given
again: a run that has ended is never measured again.")]
pub(super) struct Arguments {
    /// The study's YAML file
    study: PathBuf,

    /// Folder to write to [default: out/studies/<the study's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Take the study's smaller matrix, to see it work
    #[arg(long)]
    quick: bool,

    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

impl Arguments {
    /// The folder to write to.
    fn out(&self) -> PathBuf {
        let stem = self.study.file_stem().unwrap_or_default().to_string_lossy();
        let suffix = if self.quick { "-quick" } else { "" };
        let default = || Path::new("out/studies").join(format!("{stem}{suffix}"));
        self.out.clone().unwrap_or_else(default)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let source = Source::read(&arguments.study)?;
    let mut plan: Plan = source.parse()?;
    if arguments.quick {
        plan = plan.quickened();
    }
    let points = plan.points();
    let folder = source.folder();
    for point in &points {
        check(&plan, point, folder)?;
    }
    let out = arguments.out();
    fs::create_dir_all(&out).map_err(|error| cannot_write(&out, &error))?;
    let made_by = made_by();
    let mut results = Results::open(&out.join("runs.jsonl"), &made_by)?;
    let limits = plan.roofline.then(|| limits(&out, &made_by)).transpose()?;
    let turns = plan.turns();
    let left = measure(arguments, &plan, &turns, &points, folder, &mut results)?;
    let rows = rows(&plan, &results);
    let standings = limits.as_ref().map(|limits| standings(&rows, limits));
    if let Some((limits, standings)) = limits.as_ref().zip(standings.as_ref())
        && let Some(figure) = Figure::roofline(&plan.title, standings, limits)
    {
        write_figure(&figure, &out, "roofline")?;
    }
    write_tables(&out, &plan, &rows, standings.as_deref(), &made_by)?;
    if !arguments.quiet {
        let lines = closing_lines(&plan, &rows, standings.as_deref(), &made_by, &out, left);
        io::stdout().write_all(lines.as_bytes())?;
    }
    Ok(())
}

/// The machine's limits, measured where the folder has none yet.
fn limits(out: &Path, made_by: &Value) -> Result<Limits, Failure> {
    let path = out.join("limits.json");
    if let Some(limits) = Limits::read_from(&path, made_by)? {
        return Ok(limits);
    }
    let limits = Limits::measure();
    write_file(&path, |file| {
        Ok(serde_json::to_writer_pretty(
            file,
            &limits.to_file(made_by),
        )?)
    })?;
    Ok(limits)
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
    Ok(cli.check_alone()?)
}

/// Makes the runs that are left; gives how many are still left in the end.
fn measure(
    arguments: &Arguments,
    plan: &Plan,
    turns: &[Turn],
    points: &[Point],
    folder: &Path,
    results: &mut Results,
) -> Result<usize, Failure> {
    let todo: Vec<&Turn> = turns
        .iter()
        .filter(|turn| !results.has(&points[turn.point], turn.round))
        .collect();
    let bar = StudyBar::new(todo.len() as u64, arguments.quiet);
    let start = Instant::now();
    let budget = plan.time_budget_s.map(Duration::from_secs_f32);
    for (n_done, turn) in todo.iter().enumerate() {
        if budget.is_some_and(|budget| start.elapsed() > budget) {
            bar.clear();
            return Ok(todo.len() - n_done);
        }
        let point = &points[turn.point];
        bar.begin(&point.label());
        let metrics = one_run(plan, point, folder, &arguments.out().join("run"))?;
        let run = Run {
            point: point.values.clone(),
            round: turn.round,
            metrics,
        };
        results
            .add(run)
            .map_err(|error| cannot_write(&arguments.out(), &error))?;
        bar.advance();
    }
    bar.clear();
    Ok(0)
}

/// Renders a point in a process of its own, into a folder that goes again.
fn one_run(plan: &Plan, point: &Point, folder: &Path, out: &Path) -> Result<Metrics, Failure> {
    let failed = |what: String| Failure::Machine(Diagnostic::new(what));
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let mut command = Command::new(program);
    command
        .arg("render")
        .arg(folder.join(&point.scene))
        .args(["--quiet", "--hardware-counters"]);
    command.arg("--out").arg(out);
    command.args(&plan.flags).args(&point.flags);
    let start = Instant::now();
    let output = command
        .output()
        .map_err(|error| failed(error.to_string()))?;
    let process_ms = start.elapsed().as_secs_f64() * 1e3;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(failed(format!("a run of {} failed\n{said}", point.label())));
    }
    let text = fs::read_to_string(out.join("summary.json"));
    let text = text.map_err(|error| failed(format!("a run left no summary: {error}")))?;
    let summary: Value = serde_json::from_str(&text)
        .map_err(|error| failed(format!("a run left a broken summary: {error}")))?;
    fs::remove_dir_all(out).map_err(|error| cannot_write(out, &error))?;
    Ok(Metrics::of(&summary, process_ms))
}

/// What the runs have in common: those of others are not theirs.
fn made_by() -> Value {
    json!({
        "machine": output::machine(),
        "build": output::build(),
        "no_hardware_counters": HardwareCounters::start().why_not(),
    })
}

fn write_tables(
    out: &Path,
    plan: &Plan,
    rows: &[Row],
    standings: Option<&[Standing]>,
    made_by: &Value,
) -> Result<(), Failure> {
    write_file(&out.join("statistics.csv"), |file| write_csv(rows, file))?;
    for (number, plot) in plan.plots.iter().enumerate() {
        let Some(figure) = Figure::of(plot, &plan.title, rows) else {
            continue;
        };
        let name = format!("plot-{}-{}-over-{}", number + 1, plot.y.join("-"), plot.x);
        write_figure(&figure, out, &name)?;
    }
    let mut all = json!({ "title": plan.title, "made_by": made_by, "rows": rows });
    if let Some(standings) = standings {
        all["roofline"] = json!(standings);
    }
    write_file(&out.join("statistics.json"), |file| {
        Ok(serde_json::to_writer_pretty(file, &all)?)
    })?;
    Ok(())
}

/// Writes a plot as SVG and as PNG.
fn write_figure(figure: &Figure, out: &Path, name: &str) -> Result<(), Failure> {
    let path_of = |ending| out.join(format!("{name}.{ending}"));
    write_file(&path_of("svg"), |file| {
        file.write_all(figure.to_svg()?.as_bytes())
    })?;
    write_file(&path_of("png"), |file| file.write_all(&figure.to_png()?))?;
    Ok(())
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    let message = format!("cannot write to `{}`: {error}", path.display());
    Failure::Machine(Diagnostic::new(message).with_help("give another folder by `--out`"))
}

/// What was found and where it is.
fn closing_lines(
    plan: &Plan,
    rows: &[Row],
    standings: Option<&[Standing]>,
    made_by: &Value,
    out: &Path,
    n_left: usize,
) -> String {
    let mut text = format!("{}\n\n", plan.title);
    let shown = rows.iter().filter(|row| row.metric == "render_wall_ms");
    for row in shown {
        let values = row.point.iter().map(|(name, value)| match value {
            Value::String(text) => format!("{name} {text}"),
            number => format!("{name} {number}"),
        });
        let statistics = &row.statistics;
        let ms = |ms: f64| duration(Duration::from_secs_f64(ms / 1e3));
        text += &format!(
            "{:<48} {:>9}  95 % [{}, {}], {} runs\n",
            values.collect::<Vec<_>>().join(", "),
            ms(statistics.median),
            ms(statistics.low_95),
            ms(statistics.high_95),
            statistics.n,
        );
    }
    if let Some(standings) = standings {
        let nothing = || "no run had counters and a hierarchy: nothing to hold up".to_owned();
        text += &format!("\nbound   {}\n", verdict(standings).unwrap_or_else(nothing));
    }
    text += &format!(
        "\nwrote   {}: runs.jsonl, statistics.csv, statistics.json\n",
        out.display()
    );
    if let Some(reason) = made_by["no_hardware_counters"].as_str() {
        text += &format!("note    cycles, instructions and misses: {reason}\n");
    }
    if n_left > 0 {
        text += &format!("left    {n_left} runs when the time was up: give the command again\n");
    }
    text
}
