//! One run of a study: a process of `raycost render`, or of another program.

use std::io;
use std::path::{self, Path, PathBuf};
use std::process::{ChildStdin, Command, Output, Stdio};
use std::sync::Mutex;
use std::time::Instant;

use crate::cli::Failure;
use base::stop;
use host::advice;
use host::files;
use host::folder::{Replace, Scratch, write_file};
use host::signals;
use host::text::Diagnostic;
use output::summary::{self, Summary};
use tools::study::{RunMetrics, StepCommand, StudyPlan, StudyPoint};

/// The file of the picture.
const IMAGE: &str = "image.png";
/// Maximum length of a picture in bytes that a step keeps.
const MAX_IMAGE: u64 = 1 << 30;

/// Renders a point in a separate process, into a temporary folder in `out`. `folder` is the folder
/// of the study file. A process of raycost ends when this one does, even if this one is killed; another
/// program is asked to end when a signal asks this one to stop. A point of a step leaves its picture in `out`.
///
/// # Errors
/// If the process cannot be started, fails, or leaves no valid summary.
pub(super) fn render(
    plan: &StudyPlan,
    point: &StudyPoint,
    folder: &Path,
    out: &Path,
) -> Result<RunMetrics, Failure> {
    let failed = |message: String| Failure::Machine(Diagnostic::new(message));
    let scratch = Scratch::create(out)?;
    let of_run = scratch.path();
    let command = match &point.command {
        None => raycost(plan, point, folder, &of_run),
        Some(step) => other_program(step, plan, point, folder, &of_run),
    };
    let mut command = command.map_err(|error| failed(error.to_string()))?;
    let start = Instant::now();
    let output = output_of(&mut command, point.command.is_some()).map_err(|error| {
        let program = command.get_program().to_string_lossy();
        let message = Diagnostic::new(format!("cannot run `{program}`: {error}"));
        Failure::Machine(match advice(&error) {
            Some(help) => message.with_help(help),
            None => message,
        })
    })?;
    let process_ms = start.elapsed().as_secs_f64() * 1e3;
    if !output.status.success() {
        let messages = String::from_utf8_lossy(&output.stderr);
        let message = match &point.command {
            None => format!("a run of {} failed", point.label()),
            Some(_) => {
                let last = messages.trim_end().lines().last().unwrap_or_default();
                format!("its command failed, {}: {last}", output.status)
            }
        };
        return Err(Failure::Machine(
            Diagnostic::new(message).with_note(messages),
        ));
    }
    if let Some(name) = point.picture() {
        keep_picture(&of_run.join(IMAGE), &out.join(name))?;
    }
    if point.command.is_some() {
        let output = String::from_utf8_lossy(&output.stdout);
        return Ok(RunMetrics::parse(&output, process_ms));
    }
    let summary = Summary::read(&of_run.join(summary::FILE)).map_err(Failure::Machine)?;
    Ok(RunMetrics::from_summary(&summary, process_ms))
}

/// Returns the command that renders a point into the folder `out`, through the launcher if it has
/// ranks.
fn raycost(plan: &StudyPlan, point: &StudyPoint, folder: &Path, out: &Path) -> io::Result<Command> {
    let program = std::env::current_exe()?;
    let launched = plan.launcher.as_ref().zip(point.ranks);
    let mut command = match launched.map(|(launcher, n_ranks)| launcher.words(n_ranks)) {
        None => Command::new(program),
        Some(words) => {
            let mut command = Command::new(&words[0]);
            command.args(&words[1..]).arg(program);
            command
        }
    };
    command
        .arg("render")
        .arg(folder.join(&point.scene))
        .args(["--quiet", "--hardware-counters"]);
    command.arg("--out").arg(out).arg("--while-input-is-open");
    let flags = || plan.flags.iter().chain(&point.flags);
    // The rounds of the study are its repeats. A run that chose its number of repeats by its time
    // would not be comparable with another one.
    if !flags().any(|flag| flag.starts_with("--repeats")) {
        command.arg("--repeats=1");
    }
    command.args(flags());
    Ok(command)
}

/// Returns the command of a step, in the folder of the study, from which relative paths lead.
fn other_program(
    step: &StepCommand,
    plan: &StudyPlan,
    point: &StudyPoint,
    folder: &Path,
    out: &Path,
) -> io::Result<Command> {
    let image = path::absolute(out)?.join(IMAGE);
    let [scene, image] = [&point.scene, &image].map(|path| path.to_string_lossy());
    let words = step.words(&scene, &image, &plan.flags);
    let mut program = PathBuf::from(&words[0]);
    if program.components().count() > 1 {
        program = path::absolute(folder.join(program))?;
    }
    let mut command = Command::new(program);
    command.args(&words[1..]).current_dir(folder);
    Ok(command)
}

/// Copies the picture of a run, if there is one, over that of an earlier run.
fn keep_picture(from: &Path, to: &Path) -> Result<(), Failure> {
    if from.is_file() {
        let failed = |error| super::cannot_write(to, &error);
        let image = files::read(from, MAX_IMAGE).map_err(failed)?;
        write_file(to, Replace::Known, |file| {
            io::Write::write_all(file, &image)
        })?;
    }
    Ok(())
}

/// Returns the output of a process. Its standard input closes, and another program is asked to end,
/// as soon as a signal asks this process to stop.
fn output_of(command: &mut Command, is_other: bool) -> io::Result<Output> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    command.stderr(Stdio::piped());
    // This thread keeps the input open until the process has ended.
    let held = Mutex::new(None);
    let take = || held.lock().ok().and_then(|mut held| held.take());
    let end = || {
        if let Some((_, id)) = take()
            && is_other
        {
            ask_to_end(id);
        }
    };
    signals::watching(end, || {
        let mut child = command.spawn()?;
        let input: Option<ChildStdin> = child.stdin.take();
        if let Ok(mut held) = held.lock() {
            *held = Some((input, child.id()));
        }
        // A signal may have arrived before the process started.
        if stop::is_requested() {
            end();
        }
        let output = child.wait_with_output();
        // From here on the id may be of another process.
        drop(take());
        output
    })?
}

/// Asks a process to end.
#[cfg(unix)]
fn ask_to_end(id: u32) {
    use rustix::process::{Pid, Signal, kill_process};

    if let Some(id) = i32::try_from(id).ok().and_then(Pid::from_raw) {
        let _ = kill_process(id, Signal::TERM);
    }
}

/// Does nothing on systems without such a request.
#[cfg(not(unix))]
fn ask_to_end(_: u32) {}
