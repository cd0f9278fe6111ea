//! `raycost budget`.

mod measure;

use std::path::{Path, PathBuf};

use clap::builder::ArgPredicate;

use super::scene::SceneArguments;
use super::{Failure, keyword, shell_word, shown};
use base::Keyword;
use base::numbers::{bytes, counted};
use host::folder::{Replace, refuse_foreign_file};
use host::text::{self, Diagnostic};
use measure::{CountedScene, measure};
use tools::budget::{self, Allowance, BudgetCheck, BudgetFormat, CostBudget, Growth, SceneBudget};

/// Keep the exact totals of all counters of scenes, and check later that nothing grew
///
/// Writes the totals of scenes by kind of ray and by object to a file. `--check` renders the scenes of that file again,
/// and fails if a counter grew: counters are the same on every machine and number of threads, so that no growth is noise.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost budget configs/blocks.yaml configs/spot.yaml --width 200 --height 150
  raycost budget --check
  raycost budget --check --allow node_visits=0.5%
  raycost budget --check --acceleration high
  raycost budget --update

Exit code 3: a total exceeds its budget.")]
#[command(mut_arg("scene", |scene| scene
    .index(1)
    .help("Scene to measure; with `--check` and `--update`, the budget [default: budget.json]")
    .required(false)
    .required_unless_present_any(["check", "update"])
    .hide_default_value(true)
    .default_value_ifs([
        ("check", ArgPredicate::IsPresent, budget::FILE),
        ("update", ArgPredicate::IsPresent, budget::FILE),
    ])))]
#[command(mut_arg("out", |out| out
    .value_name("FILE")
    .help("File to write [default: budget.json; with `--update`, the budget]")))]
pub(super) struct BudgetArguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Further scenes
    #[arg(index = 2, value_name = "SCENE", conflicts_with_all = ["check", "update"])]
    others: Vec<PathBuf>,

    /// Render the scenes of the budget, and fail if a total grew. Flags change the scenes of the budget
    #[arg(long, conflicts_with_all = ["out", "update"])]
    check: bool,

    /// Render the scenes of the budget, and write their totals
    #[arg(long)]
    update: bool,

    /// Growth of a counter that passes, such as `node_visits=0.5%`; can be repeated
    #[arg(long, value_name = "COUNTER=PERCENT", requires = "check")]
    allow: Vec<Allowance>,

    /// Check the totals of this file, which `raycost budget` wrote, instead of rendering
    #[arg(long, value_name = "FILE", requires = "check")]
    measured: Option<PathBuf>,

    /// Also write the files of each rendering, as `raycost render` does, to a folder in this one
    #[arg(long, value_name = "DIR", conflicts_with = "measured")]
    keep: Option<PathBuf>,

    /// Print the result in this format
    #[arg(long, value_name = "FORMAT", value_parser = keyword::<BudgetFormat>())]
    format: Option<BudgetFormat>,

    /// Frame of an animated scene [default: the first]
    #[arg(long, value_name = "N", conflicts_with_all = ["check", "update"])]
    frame: Option<u32>,

    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Print only errors
    #[arg(long, short, conflicts_with = "format")]
    quiet: bool,
}

pub(super) fn run(arguments: &BudgetArguments) -> Result<(), Failure> {
    arguments.scene.refuse_also()?;
    if arguments.check {
        return check(arguments);
    }
    if let Some(format @ (BudgetFormat::Markdown | BudgetFormat::Badge)) = arguments.format {
        let message = format!("`--format {}` shows the result of a check", format.name());
        return Err(Diagnostic::new(message).with_help("add `--check`").into());
    }
    write(arguments)
}

/// Measures scenes, and writes their budget.
fn write(arguments: &BudgetArguments) -> Result<(), Failure> {
    let scenes = &arguments.scene;
    let budget = if arguments.update {
        Some(CostBudget::read(&scenes.scene)?)
    } else {
        None
    };
    let default = match budget {
        Some(_) => &scenes.scene,
        None => Path::new(budget::FILE),
    };
    let out = scenes.given_out().unwrap_or(default);
    refuse_foreign_file(out, Replace::Marked)?;
    CostBudget::refuse_other_file(out)?;
    let measured = match budget {
        Some(budget) => measure_again(arguments, &budget)?,
        None => {
            let files = [&scenes.scene].into_iter().chain(&arguments.others);
            let scene =
                |file: &PathBuf| CountedScene::new(file, scenes.all_flags(), arguments.frame);
            let scenes: Vec<CountedScene> = files.map(scene).collect::<Result<_, _>>()?;
            measure(arguments, &scenes)?
        }
    };
    let budget = CostBudget::new(measured);
    let written = budget.write(out)?;
    if arguments.format.is_some() {
        return super::json::print(&budget::benchmark(&budget.scenes));
    }
    if !arguments.quiet {
        let n_scenes = counted(budget.scenes.len() as u64, "scene");
        let length = bytes(written.bytes);
        text::print(&format!(
            "wrote   {} ({length}): the totals of {n_scenes}\n",
            shown(out)
        ))?;
    }
    Ok(())
}

/// Measures the scenes of a budget. Flags of the command line replace flags of the same name, except
/// for `--set`, which both may have.
fn measure_again(
    arguments: &BudgetArguments,
    budget: &CostBudget,
) -> Result<Vec<SceneBudget>, Failure> {
    let given = arguments.scene.all_flags();
    let name = |flag: &String| flag.split('=').next().map(str::to_owned);
    let is_kept = |flag: &&String| {
        flag.starts_with("--set=") || given.iter().all(|other| name(other) != name(flag))
    };
    let again = |scene: &SceneBudget| {
        let flags = scene.flags.iter().filter(is_kept).chain(&given);
        CountedScene::new(
            Path::new(&scene.scene),
            flags.cloned().collect(),
            scene.frame,
        )
    };
    let scenes: Vec<CountedScene> = budget.scenes.iter().map(again).collect::<Result<_, _>>()?;
    measure(arguments, &scenes)
}

/// Compares the totals of the scenes of a budget now with it.
fn check(arguments: &BudgetArguments) -> Result<(), Failure> {
    let file = &arguments.scene.scene;
    let budget = CostBudget::read(file)?;
    let now = match &arguments.measured {
        Some(_) if arguments.scene.changes_scene() => {
            let message = "flags that change a scene need a rendering, and `--measured` makes none";
            return Err(Diagnostic::new(message).with_help("leave them out").into());
        }
        Some(measured) => CostBudget::read(measured)?.scenes,
        None => measure_again(arguments, &budget)?,
    };
    let check = BudgetCheck::new(&budget, &now, &arguments.allow)?;
    let update = format!("raycost budget --update {}", shell_word(file));
    let n_exceeding = check.n(Growth::Exceeding);
    match arguments.format {
        None if arguments.quiet => {}
        None => {
            let mut report = budget::report(&check);
            if n_exceeding == 0 && check.n(Growth::Shrunk) > 0 {
                report += &format!("update the budget to keep the gain: {update}\n");
            }
            text::print(&report)?;
        }
        Some(BudgetFormat::Markdown) => text::print(&budget::markdown(&check))?,
        Some(BudgetFormat::BenchmarkJson) => super::json::print(&budget::benchmark(&now))?,
        Some(BudgetFormat::Badge) => super::json::print(&budget::badge(&check))?,
    }
    if n_exceeding == 0 {
        return Ok(());
    }
    let grown = counted(n_exceeding, "total");
    let message = format!(
        "more work than the budget `{}` allows: {grown} grew",
        shown(file)
    );
    let help = format!("if the growth is meant, `{update}`, or allow some by `--allow`");
    Err(Failure::Gate(Diagnostic::new(message).with_help(help)))
}
