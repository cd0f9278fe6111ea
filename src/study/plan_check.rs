//! Checks of a study file beyond the types of its values.

use super::point::scene_names;
use super::{Case, Factor, FlagFactor, StudyPlan, Vary};
use crate::yaml::{Fault, FieldPath};

impl StudyPlan {
    /// Checks that no point occurs twice, and that there is a launcher where ranks are varied and
    /// nowhere else.
    ///
    /// # Errors
    /// The first mistake.
    pub fn check(&self) -> Result<(), Fault> {
        self.check_points()?;
        self.check_launcher()
    }

    /// Checks that no point occurs twice: its runs would count for both.
    fn check_points(&self) -> Result<(), Fault> {
        let names: Vec<String> = scene_names(&self.scenes).collect();
        check_differ(&names, &key("scenes"))?;
        let quick = self.quick.as_ref();
        let of_quick = |name| key("quick").key(name);
        let quick_vary = quick.and_then(|quick| quick.vary.as_ref());
        let quick_cases = quick.and_then(|quick| quick.cases.as_ref());
        check_vary(&self.vary, &key("vary"))?;
        check_cases(&self.cases, &key("cases"))?;
        if let Some(vary) = quick_vary {
            check_vary(vary, &of_quick("vary"))?;
        }
        if let Some(cases) = quick_cases {
            check_cases(cases, &of_quick("cases"))?;
        }
        let in_cases = || self.cases.iter().flat_map(|case| &case.0);
        for (factor, _) in &self.vary.0 {
            if in_cases().any(|(other, _)| other == factor) {
                let name = factor.name();
                let message = format!("`{name}` is in `cases`, too");
                let fault = Fault::of_key(key("vary").key(name), message, "has two values");
                return Err(fault.with_help("leave it in one of the two"));
            }
        }
        Ok(())
    }

    /// Checks that there is a launcher where ranks are varied, and nowhere else.
    fn check_launcher(&self) -> Result<(), Fault> {
        let is_ranks = |factor: &Factor| *factor == Factor::Flag(FlagFactor::Ranks);
        let in_cases = self.cases.iter().flat_map(|case| &case.0);
        let ranks_in_cases = in_cases.map(|(factor, _)| factor).any(is_ranks);
        let ranks_in_vary = self.vary.0.iter().any(|(factor, _)| is_ranks(factor));
        let (path, message, help) = match (&self.launcher, ranks_in_vary || ranks_in_cases) {
            (None, true) => (
                key(if ranks_in_vary { "vary" } else { "cases" }),
                "`ranks` need a `launcher`",
                "add `launcher: \"mpirun -n {ranks}\"`",
            ),
            (Some(_), false) => (
                key("launcher"),
                "a `launcher` needs the factor `ranks`",
                "add `ranks: [1, 2, 4]` to `vary`, or leave the launcher out",
            ),
            (Some(launcher), true) => return launcher.check(key("launcher")),
            (None, false) => return Ok(()),
        };
        Err(Fault::new(path, message, "one is there without the other").with_help(help))
    }
}

/// The path of a key of the study.
fn key(name: &str) -> FieldPath {
    FieldPath::default().key(name)
}

/// Checks that no item of the list at `path` is there twice.
fn check_differ<T: PartialEq>(list: &[T], path: &FieldPath) -> Result<(), Fault> {
    let twice = (0..list.len()).find(|&n| list[..n].contains(&list[n]));
    let Some(twice) = twice else { return Ok(()) };
    let message = format!("`{path}` has an item twice");
    let fault = Fault::new(path.clone().index(twice), message, "is there already");
    Err(fault.with_help("leave one of them out: `repeats` measures each point several times"))
}

fn check_vary(vary: &Vary, path: &FieldPath) -> Result<(), Fault> {
    for (factor, levels) in &vary.0 {
        let values: Vec<_> = levels.iter().map(|level| &level.value).collect();
        check_differ(&values, &path.clone().key(factor.name()))?;
    }
    Ok(())
}

fn check_cases(cases: &[Case], path: &FieldPath) -> Result<(), Fault> {
    let value_of = |case: &Case| -> serde_json::Map<_, _> {
        let levels = case.0.iter();
        let level = levels.map(|(factor, level)| (factor.name().to_owned(), level.value.clone()));
        level.collect()
    };
    let values: Vec<_> = cases.iter().map(value_of).collect();
    check_differ(&values, path)
}
