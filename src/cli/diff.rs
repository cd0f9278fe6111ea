//! `raycost diff`.

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{Failure, keyword, names_and_lengths, on_threads, shell_word, shown};
use host::folder::{OutputFolder, Written};
use host::text::{self, Diagnostic};
use output::results::read_unchanged;
use tools::diff::foreign::{self, ForeignDiff, ForeignFile};
use tools::diff::{self, Diff, DiffJson, Gate, Limit, Side};
use tracer::cost::Metric;

/// Compare the costs of two outputs, or an output with the file of another program
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost diff out/before out/after
  raycost diff out/before out/after --fail-above 5%
  raycost diff out/before mine.png
  raycost diff out/before times.npy --by time_ns

Exit code 3: B costs more than `--fail-above` allows.")]
pub(super) struct DiffArguments {
    /// Output folder A, the baseline; or a file of another program: PNG, PPM, PFM,
    /// OpenEXR or NPY
    a: PathBuf,

    /// Output folder B, with a picture of the same size; or a file, if A is a folder
    b: PathBuf,

    /// Folder to write to [default: out/diff-A-B]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Print the whole comparison as JSON
    #[arg(long)]
    json: bool,

    /// Fail if B's total cost exceeds A's by more than this, such as `5%`: its time,
    /// by more than noise explains, or the sum of node visits and primitive tests if
    /// a time is missing
    #[arg(long, value_name = "PERCENT")]
    fail_above: Option<Limit>,

    /// Metric to compare another program's cost map with [default: time_ns, or
    /// node_visits if the output has no times]
    #[arg(long, value_name = "METRIC", value_parser = keyword::<Metric>())]
    by: Option<Metric>,
}

pub(super) fn run(arguments: &DiffArguments) -> Result<(), Failure> {
    on_threads(|| compare(arguments))
}

fn compare(arguments: &DiffArguments) -> Result<(), Failure> {
    let DiffArguments { a, b, .. } = arguments;
    match [a, b].map(|path| path.is_file()) {
        [false, false] => compare_outputs(arguments),
        [true, false] => compare_with_file(arguments, [b, a], 0),
        [false, true] => compare_with_file(arguments, [a, b], 1),
        [true, true] => {
            let message = "A and B are files: one has to be an output folder";
            let help = "give a folder that `raycost render` wrote, such as out/seed_sphere";
            Err(Diagnostic::new(message).with_help(help).into())
        }
    }
}

fn compare_outputs(arguments: &DiffArguments) -> Result<(), Failure> {
    if arguments.by.is_some() {
        let message = "`--by` is for the cost map of another program";
        let help = "leave it out: all metrics of two outputs are compared";
        return Err(Diagnostic::new(message).with_help(help).into());
    }
    let folders: [&Path; 2] = [&arguments.a, &arguments.b];
    let (sides, diff) = read_unchanged(&folders, || {
        let sides = Side::open(folders)?;
        let diff = Diff::compare(&sides)?;
        Ok((sides, diff))
    })?;
    let gate = match arguments.fail_above {
        Some(limit) => {
            sides.iter().try_for_each(Side::require_whole)?;
            Some(Gate::new(&diff, limit)?)
        }
        None => None,
    };
    let out = folder_for(arguments, sides.each_ref().map(Side::label));
    let folder = OutputFolder::create(&out, 0)?;
    diff::refuse_foreign(&folder)?;
    let written = diff::write(&diff, &sides, gate.as_ref(), &folder)?;
    let text = if arguments.json {
        json_text(&DiffJson::new(&diff, &sides, gate.as_ref()))?
    } else {
        let report = diff::report(&diff, &sides, gate.as_ref());
        report + &written_line(&out, &written) + &next_line(&out)
    };
    text::print(&text)?;
    match gate.filter(|gate| !gate.passed) {
        Some(gate) => Err(Failure::Gate(Diagnostic::new(gate.sentence()))),
        None => Ok(()),
    }
}

/// Compares an output with a file of another program, whose position is 0 for A, 1 for B.
fn compare_with_file(
    arguments: &DiffArguments,
    [output, file]: [&PathBuf; 2],
    position: usize,
) -> Result<(), Failure> {
    if arguments.fail_above.is_some() {
        let message = "`--fail-above` compares two outputs, not one with a file";
        return Err(Diagnostic::new(message).with_help("leave it out").into());
    }
    let diff = read_unchanged(&[output], || {
        let output = Side::alone(output)?;
        let file = ForeignFile::read(file, output.size())?;
        ForeignDiff::compare(output, file, position, arguments.by)
    })?;
    let label = diff.file.label();
    let labels = foreign::in_order([diff.output.label(), &label], position);
    let out = folder_for(arguments, labels);
    let folder = OutputFolder::create(&out, 0)?;
    diff::refuse_foreign(&folder)?;
    let written = foreign::write(&diff, &folder)?;
    let text = if arguments.json {
        json_text(&foreign::to_json(&diff))?
    } else {
        format!(
            "{}\n{}",
            foreign::report(&diff),
            written_line(&out, &written)
        )
    };
    Ok(text::print(&text)?)
}

/// Returns the folder to write to.
fn folder_for(arguments: &DiffArguments, [a, b]: [&str; 2]) -> PathBuf {
    match &arguments.out {
        Some(out) => out.clone(),
        None => Path::new("out").join(format!("diff-{a}-{b}").replace('/', "-")),
    }
}

fn json_text(json: &impl Serialize) -> io::Result<String> {
    let json = serde_json::to_string_pretty(json)?;
    Ok(text::visible_json(&(json + "\n")))
}

fn written_line(out: &Path, written: &[Written]) -> String {
    format!(
        "wrote     {}: {}\n",
        shown(out),
        names_and_lengths(written).join(", ")
    )
}

fn next_line(out: &Path) -> String {
    let state = shell_word(&out.join(diff::STATE.name));
    format!("next      paraview --state={state}\n")
}
