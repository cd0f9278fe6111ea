//! The report of `raycost check` on a study.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{Failure, Study};
use crate::cli::{shell_word, shown};
use base::numbers::{count, counted};
use host::text::{Diagnostic, one_line};
use scene::yaml::Source;
use tools::study::{LeftOutStep, StudyPlan};

/// A key that every study has, and no scene.
const SCENES: &str = "scenes";

/// A key of scenes, and of no study.
const OBJECTS: &str = "objects";

/// Returns true if a text is a study, not a scene.
pub(in crate::cli) fn is_study(source: &Source) -> bool {
    source.has_key(SCENES)
}

/// Refuses a scene in the place of a study.
///
/// # Errors
/// The text is a scene.
pub(super) fn refuse_scene(source: &Source) -> Result<(), Diagnostic> {
    if is_study(source) || !source.has_key(OBJECTS) {
        return Ok(());
    }
    let name = source.name();
    let message = format!("`{}` is a scene, not a study", one_line(name));
    let scene = shell_word(Path::new(name));
    Err(Diagnostic::new(message).with_help(format!(
        "to render it: `raycost render {scene}`; a study names it in `scenes`"
    )))
}

/// Refuses a study in the place of a scene.
///
/// # Errors
/// The text is a study.
pub(in crate::cli) fn refuse_study(source: &Source) -> Result<(), Diagnostic> {
    if !is_study(source) {
        return Ok(());
    }
    let name = source.name();
    let message = format!("`{}` is a study, not a scene", one_line(name));
    let study = shell_word(Path::new(name));
    Err(Diagnostic::new(message).with_help(format!("to run it: `raycost study {study}`")))
}

/// A study whose scenes can be rendered here.
pub(in crate::cli) struct CheckedStudy {
    /// The file, or `-`.
    name: String,
    study: Study,
    /// The runs of the small matrix.
    n_quick_runs: u64,
}

/// Checks a study with its small matrix, and every scene that it names.
///
/// # Errors
/// The first fault of the study or of a scene, or if it cannot run here.
pub(in crate::cli) fn check(source: &Source) -> Result<CheckedStudy, Failure> {
    let stem = Path::new(source.name()).file_stem().unwrap_or_default();
    let out = Path::new("out/studies").join(stem);
    let quick = Study::parse(source, PathBuf::new(), true, true)?;
    Ok(CheckedStudy {
        name: source.name().to_owned(),
        study: Study::parse(source, out, false, true)?,
        n_quick_runs: quick.plan.n_runs(),
    })
}

impl CheckedStudy {
    /// Returns the report for other programs.
    pub(in crate::cli) fn json(&self) -> Value {
        let plan = &self.study.plan;
        json!({
            "study": self.name,
            "title": plan.title,
            "scenes": self.study.scenes.names(),
            "n_points": self.study.points.len(),
            "n_runs": plan.n_runs(),
            "n_quick_runs": self.n_quick_runs,
            "n_plots": plan.plots.len(),
            "out": self.study.out.to_string_lossy(),
        })
    }

    /// Returns the lines of the report.
    pub(in crate::cli) fn lines(&self) -> String {
        let (study, name) = (&self.study, one_line(&self.name));
        let plan = &study.plan;
        let scenes = study.scenes.names().into_iter();
        let scenes: Vec<_> = scenes.map(|name| one_line(name).into_owned()).collect();
        let mut lines = vec![
            (
                "study",
                format!("{name} is fine: {}", one_line(&plan.title)),
            ),
            ("scenes", scenes.join(", ")),
            ("points", points(plan, study.points.len())),
            (
                "runs",
                format!(
                    "{}: {} and {} of each point; {} with `raycost study --quick`",
                    count(plan.n_runs()),
                    counted(u64::from(plan.warm_up), "warm-up run"),
                    counted(u64::from(plan.repeats), "measured run"),
                    count(self.n_quick_runs),
                ),
            ),
            ("plots", count(plan.plots.len() as u64)),
        ];
        if let Some(launcher) = &plan.launcher {
            let note = match launcher.suspect() {
                None => "",
                Some(_) => ", which only runs with `raycost study --allow-commands`",
            };
            lines.push(("starts", format!("{}{note}", one_line(launcher.command()))));
        }
        for command in plan.steps.iter().filter_map(|step| step.command.as_ref()) {
            let note = "only with `raycost study --allow-commands`";
            lines.push(("starts", format!("{}, {note}", one_line(command.text()))));
        }
        for LeftOutStep { step, reason } in &study.left_out {
            let note = format!("`{}`: {}", one_line(step), one_line(reason));
            lines.push(("omitted", note));
        }
        lines.push(("files", format!("in {}", shown(&study.out))));
        let line = |(name, text): (&str, String)| format!("{name:<7} {text}\n");
        lines.into_iter().map(line).collect()
    }
}

/// Returns the number of points and of the levels that are crossed.
fn points(plan: &StudyPlan, n_points: usize) -> String {
    let lists = [(plan.steps.len(), "step"), (plan.cases.len(), "case")];
    let lists = lists.into_iter().filter(|(n, _)| *n > 0);
    let lists = lists.map(|(n, name)| counted(n as u64, name));
    let levels = plan.vary.0.iter();
    let levels = levels.map(|(factor, levels)| format!("{} of {}", levels.len(), factor.name()));
    let scenes = counted(plan.scenes.len() as u64, "scene");
    let crossed: Vec<String> = [scenes].into_iter().chain(lists).chain(levels).collect();
    format!(
        "{}: {}",
        count(n_points as u64),
        one_line(&crossed.join(", "))
    )
}

/// Returns the fault of a scene's flags that are given for a study.
pub(in crate::cli) fn refuse_flags() -> Diagnostic {
    Diagnostic::new("the flags of a scene do not change a study")
        .with_help("leave them out, or add them to `flags` in the study")
}
