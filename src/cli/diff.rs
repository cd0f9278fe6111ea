//! `raycost diff`.

use std::path::{Path, PathBuf};

use super::{Failure, on_threads, shell_word, shown};
use base::folder::{OutputFolder, Written};
use base::text::numbers::bytes;
use base::text::{self, Diagnostic};
use output::results::read_unchanged;
use tools::diff::{self, Diff, Gate, Limit, Side};

/// Compare the costs of two outputs
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost diff out/before out/after
  raycost diff out/before out/after --fail-above 5%

Exit code 3: B costs more than `--fail-above` allows.")]
pub(super) struct DiffArguments {
    /// Output folder A, the baseline
    a: PathBuf,

    /// Output folder B, with a picture of the same size
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
}

pub(super) fn run(arguments: &DiffArguments) -> Result<(), Failure> {
    on_threads(|| compare(arguments))
}

fn compare(arguments: &DiffArguments) -> Result<(), Failure> {
    let folders: [&Path; 2] = [&arguments.a, &arguments.b];
    let (sides, diff) = read_unchanged(&folders, || {
        let sides = Side::open(folders)?;
        let diff = Diff::of(&sides)?;
        Ok((sides, diff))
    })?;
    let gate = match arguments.fail_above {
        Some(limit) => Some(Gate::of(&diff, limit)?),
        None => None,
    };
    let out = out(arguments, &sides);
    let folder = OutputFolder::create(&out, 0)?;
    diff::refuse_foreign(&folder)?;
    let written = diff::write(&diff, &sides, gate.as_ref(), &folder)?;
    let text = if arguments.json {
        let json = format!("{:#}\n", diff::to_json(&diff, &sides, gate.as_ref()));
        text::visible_json(&json)
    } else {
        let report = diff::report(&diff, &sides, gate.as_ref());
        report + &closing_lines(&out, &written)
    };
    text::print(&text)?;
    match gate.filter(|gate| !gate.passed) {
        Some(gate) => Err(Failure::Gate(Diagnostic::new(gate.sentence()))),
        None => Ok(()),
    }
}

/// Returns the folder to write to.
fn out(arguments: &DiffArguments, [a, b]: &[Side; 2]) -> PathBuf {
    match &arguments.out {
        Some(out) => out.clone(),
        None => {
            let name = format!("diff-{}-{}", a.label(), b.label());
            Path::new("out").join(name.replace('/', "-"))
        }
    }
}

fn closing_lines(out: &Path, written: &[Written]) -> String {
    let files: Vec<String> = written
        .iter()
        .map(|written| format!("{} ({})", written.file, bytes(written.bytes)))
        .collect();
    format!(
        "wrote     {}: {}\nnext      paraview --state={}\n",
        shown(out),
        files.join(", "),
        shell_word(&out.join(diff::STATE.name)),
    )
}
