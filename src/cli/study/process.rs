//! One run of a study: a process of `raycost render`.

use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::time::Instant;

use crate::cli::Failure;
use base::folder::Scratch;
use base::stop;
use base::text::Diagnostic;
use output::summary::{self, Summary};
use tools::study::{RunMetrics, StudyPlan, StudyPoint};

/// Renders a point in a separate process, into a temporary folder in `out`. `folder` is the folder
/// of the study file. The process ends when this one does, even if this one is killed.
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
    let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
    let launched = plan.launcher.as_ref().zip(point.ranks());
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
    let scratch = Scratch::create(out)?;
    let out = scratch.path();
    command.arg("--out").arg(&out).arg("--while-input-is-open");
    let flags = || plan.flags.iter().chain(&point.flags);
    // The rounds of the study are its repeats. A run that chose its number of repeats by its time
    // would not be comparable with another one.
    if !flags().any(|flag| flag.starts_with("--repeats")) {
        command.arg("--repeats=1");
    }
    command.args(flags());
    let start = Instant::now();
    let output = output_of(&mut command).map_err(|error| failed(error.to_string()))?;
    let process_ms = start.elapsed().as_secs_f64() * 1e3;
    if !output.status.success() {
        let messages = String::from_utf8_lossy(&output.stderr);
        let message = format!("a run of {} failed", point.label());
        return Err(Failure::Machine(
            Diagnostic::new(message).with_note(messages),
        ));
    }
    let summary = Summary::read(&out.join(summary::FILE)).map_err(Failure::Machine)?;
    Ok(RunMetrics::of(&summary, process_ms))
}

/// Returns the output of a process that ends when its standard input closes: that happens when this
/// process ends, and as soon as a signal asks this process to stop.
fn output_of(command: &mut Command) -> io::Result<Output> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.stderr(Stdio::piped()).spawn()?;
    let input = child.stdin.take();
    // This thread keeps the input open until the process has ended.
    let input = Mutex::new(input);
    let close = || {
        if let Ok(mut input) = input.lock() {
            input.take();
        }
    };
    stop::watching(close, || child.wait_with_output())?
}
