//! Checks of a study file beyond the types of its values.

use std::collections::HashSet;
use std::hash::Hash;

use serde_json::json;

use super::factor_level::size_of_level;
use super::metric_list::{MetricNeed, OVERHEAD, StudyMetric};
use super::overhead::{COST, has_overheads};
use super::point::{STEP, scene_names};
use super::{Case, Factor, FlagFactor, PlotSpec, StudyPlan, StudyStep, Vary};
use host::text::did_you_mean;
use scene::yaml::{Fault, FieldPath};

/// The flags of `raycost render` that override a value of the scene, and the value.
pub const OVERRIDING: [(&str, &str); 18] = [
    ("width", "image.width"),
    ("height", "image.height"),
    ("crop", "image.crop"),
    ("spp", "image.samples_per_pixel"),
    ("samples", "image.samples_per_pixel"),
    ("until-noise", "image.adaptive"),
    ("seed", "image.seed"),
    ("max-depth", "shading.max_depth"),
    ("exposure", "film.exposure"),
    ("tone-curve", "film.tone_curve"),
    ("acceleration", "acceleration"),
    ("cost", "cost"),
    ("no-cost", "cost"),
    ("repeats", "repeats"),
    ("tile-size", "tiles.size"),
    ("tile-order", "tiles.order"),
    ("compress", "compress"),
    ("count", "sphere_cloud.count"),
];

/// Maximum number of bytes of a file's name on most systems.
const MAX_FILE_NAME: usize = 255;

impl StudyPlan {
    /// Checks that no point occurs twice, that there is a launcher exactly where ranks are varied,
    /// and that plots name factors and metrics of the study.
    ///
    /// # Errors
    /// The first mistake.
    pub fn check(&self) -> Result<(), Fault> {
        self.check_points()?;
        self.check_overridden()?;
        self.check_steps()?;
        self.check_launcher()?;
        let factors = self.factor_names();
        for (number, plot) in self.plots.iter().enumerate() {
            let path = key("plots").index(number);
            check_plot(plot, &factors, path.clone())?;
            self.check_overhead(plot, path.clone())?;
            self.check_fit(plot, path)?;
        }
        Ok(())
    }

    /// Checks that a plot of overheads has points to compare.
    fn check_overhead(&self, plot: &PlotSpec, path: FieldPath) -> Result<(), Fault> {
        let place = match plot.y.iter().position(|name| name == OVERHEAD) {
            Some(number) => path.key("y").index(number),
            None if plot.x == OVERHEAD => path.key("x"),
            None => return Ok(()),
        };
        if has_overheads(self) {
            return Ok(());
        }
        let message = format!("`{OVERHEAD}` compares points with and without measurement");
        let fault = Fault::new(place, message, "has no values here");
        Err(fault.with_help("add `none` and another mode to `cost`"))
    }

    /// Checks that the levels along a fitted law are numbers or sizes.
    fn check_fit(&self, plot: &PlotSpec, path: FieldPath) -> Result<(), Fault> {
        let in_vary = self.vary.0.iter();
        let in_vary =
            in_vary.flat_map(|(factor, levels)| levels.iter().map(move |one| (factor, one)));
        let in_cases = self.cases.iter().flat_map(|case| &case.0);
        let mut levels = in_vary
            .chain(in_cases)
            .filter(|(factor, _)| factor.name() == plot.x);
        let has_names = ["scene", STEP].contains(&&*plot.x)
            || levels.any(|(_, level)| size_of_level(level).is_none());
        if !plot.fit || !has_names {
            return Ok(());
        }
        let message = format!("a law needs numbers, and `{}` has names", plot.x);
        let fault = Fault::new(path.key("fit"), message, "has nothing to grow with");
        Err(fault.with_help("leave out `fit`, or plot over a factor of numbers"))
    }

    /// Returns the names of all factors, the scene first.
    fn factor_names(&self) -> Vec<&str> {
        let in_cases = self.cases.iter().flat_map(|case| &case.0);
        let in_cases = in_cases.map(|(factor, _)| factor.name());
        let in_vary = self.vary.0.keys().map(Factor::name);
        let step = (!self.steps.is_empty()).then_some(STEP);
        let mut names = vec!["scene"];
        for name in step.into_iter().chain(in_cases).chain(in_vary) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
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
        for factor in self.vary.0.keys() {
            if in_cases().any(|(other, _)| other == factor) {
                let name = factor.name();
                let message = format!("`{name}` is in `cases`, too");
                let fault = Fault::at_key(key("vary").key(name), message, "has two values");
                return Err(fault.with_help("leave it in one of the two"));
            }
        }
        Ok(())
    }

    /// Checks that no flag overrides a value that the study varies: the value would have no effect.
    fn check_overridden(&self) -> Result<(), Fault> {
        let mut factors: Vec<(FieldPath, &Factor)> = Vec::new();
        factors.extend(self.vary.0.keys().map(|factor| (key("vary"), factor)));
        for (number, case) in self.cases.iter().enumerate() {
            factors.extend(
                case.0
                    .keys()
                    .map(|factor| (key("cases").index(number), factor)),
            );
        }
        let of_factors = factors.iter().flat_map(|(_, factor)| factor.flag_names());
        let of_study = self.flags.iter().filter_map(|flag| flag.strip_prefix("--"));
        let of_study = of_study.map(|flag| flag.split('=').next().unwrap_or(flag));
        let given: Vec<&str> = of_factors.copied().chain(of_study).collect();
        for (path, factor) in &factors {
            let Factor::Setting(setting) = factor else {
                continue;
            };
            let overrides =
                |value: &str| setting.ends_with(value) || setting.starts_with(&format!("{value}."));
            let found = OVERRIDING
                .iter()
                .find(|(flag, value)| given.contains(flag) && overrides(value));
            if let Some((flag, _)) = found {
                let message = format!("`--{flag}` overrides `{setting}`");
                let fault = Fault::at_key(path.clone().key(setting), message, "has no effect");
                return Err(fault.with_help("leave one of the two out"));
            }
        }
        Ok(())
    }

    /// Checks that steps have different names, change something, and stand alone.
    fn check_steps(&self) -> Result<(), Fault> {
        if self.steps.is_empty() {
            return Ok(());
        }
        let path = key("steps");
        let has_cases = !self.cases.is_empty();
        if has_cases || !self.vary.0.is_empty() {
            let other = if has_cases { "cases" } else { "vary" };
            let message = format!("a study with `steps` has no `{other}`");
            let fault = Fault::at_key(key(other), message, "would multiply the steps");
            return Err(fault.with_help("leave one of the two out"));
        }
        let names: Vec<&str> = self.steps.iter().map(|step| &*step.name).collect();
        check_differ(&names, &path)?;
        for (number, step) in self.steps.iter().enumerate() {
            let path = path.clone().index(number);
            match (&step.command, step.set.0.is_empty()) {
                (None, false) => {}
                (Some(command), true) => command.check(path.key("command"))?,
                (command, _) => {
                    let message = if command.is_some() {
                        "a step has either `set` or `command`"
                    } else {
                        "a step needs `set` or `command`"
                    };
                    let expected = "expected one of the two";
                    return Err(Fault::new(path, message, expected));
                }
            }
        }
        self.check_pictures()
    }

    /// Checks that the picture of each step has a file name of its own.
    fn check_pictures(&self) -> Result<(), Fault> {
        let mut known = HashSet::new();
        for (number, point) in self.points().iter().enumerate() {
            let file = point.picture().unwrap_or_default();
            let path = key("steps").index(number % self.steps.len()).key("name");
            if file.len() > MAX_FILE_NAME {
                let message = format!(
                    "the picture of `{path}` would have a file name of {} bytes",
                    file.len()
                );
                let expected = format!("expected at most {MAX_FILE_NAME}, with the scene's name");
                return Err(Fault::new(path, message, expected));
            }
            if !known.insert(file.clone()) {
                let message = format!("the pictures of two steps would be the file `{file}`");
                return Err(Fault::new(path, message, "expected another name"));
            }
        }
        Ok(())
    }

    /// Checks that there is a launcher exactly where ranks are varied.
    fn check_launcher(&self) -> Result<(), Fault> {
        let is_ranks = |factor: &Factor| *factor == Factor::Flag(FlagFactor::Ranks);
        let in_cases = self.cases.iter().flat_map(|case| &case.0);
        let ranks_in_cases = in_cases.map(|(factor, _)| factor).any(is_ranks);
        let ranks_in_vary = self.vary.0.keys().any(is_ranks);
        let ranks_in_steps = self.steps.iter().any(StudyStep::has_ranks);
        let has_ranks = ranks_in_vary || ranks_in_cases || ranks_in_steps;
        let (path, message, help) = match (&self.launcher, has_ranks) {
            (None, true) => (
                key(match (ranks_in_vary, ranks_in_cases) {
                    (true, _) => "vary",
                    (_, true) => "cases",
                    _ => "steps",
                }),
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

/// Returns the path of a key of the study.
fn key(name: &str) -> FieldPath {
    FieldPath::default().key(name)
}

/// Checks that no item of the list at `path` occurs twice.
fn check_differ<T: Eq + Hash>(list: &[T], path: &FieldPath) -> Result<(), Fault> {
    let mut known = HashSet::new();
    let twice = list.iter().position(|item| !known.insert(item));
    let Some(twice) = twice else { return Ok(()) };
    let message = format!("`{path}` has an item twice");
    let fault = Fault::new(path.clone().index(twice), message, "is there already");
    Err(fault.with_help("leave one of them out: `repeats` measures each point several times"))
}

fn check_vary(vary: &Vary, path: &FieldPath) -> Result<(), Fault> {
    for (factor, levels) in &vary.0 {
        check_differ(levels, &path.clone().key(factor.name()))?;
    }
    Ok(())
}

fn check_cases(cases: &[Case], path: &FieldPath) -> Result<(), Fault> {
    let values: Vec<_> = cases.iter().map(|case| json!(case)).collect();
    check_differ(&values, path)
}

/// Checks the names of a plot in a study of these factors.
fn check_plot(plot: &PlotSpec, factors: &[&str], path: FieldPath) -> Result<(), Fault> {
    if !factors.contains(&&*plot.x) {
        let kind = "factor or metric";
        check_metric(&plot.x, factors, kind, path.clone().key("x"))?;
    }
    for (number, name) in plot.y.iter().enumerate() {
        let path = path.clone().key("y").index(number);
        check_metric(name, factors, "metric", path)?;
    }
    for (number, name) in plot.by.iter().flatten().enumerate() {
        if !factors.contains(&&**name) {
            let path = path.clone().key("by").index(number);
            return Err(unknown(name, "factor", path, factors, &[]));
        }
    }
    Ok(())
}

/// Checks that runs of a study of these factors may have a metric.
fn check_metric(name: &str, factors: &[&str], kind: &str, path: FieldPath) -> Result<(), Fault> {
    let all = StudyMetric::all();
    let Some(metric) = all.iter().find(|metric| metric.name == name) else {
        return Err(unknown(name, kind, path, factors, &all));
    };
    let needed: &[&str] = match metric.need {
        MetricNeed::Nothing => return Ok(()),
        MetricNeed::ThreadsOrRanks => &["threads", "ranks"],
        MetricNeed::RanksOnly => &["ranks"],
        MetricNeed::Cost => &[COST],
        MetricNeed::Steps => &[STEP],
    };
    if needed.iter().any(|factor| factors.contains(factor)) {
        return Ok(());
    }
    let (lacks, help) = match metric.need {
        MetricNeed::Steps => ("has no `steps`".to_owned(), "add `steps` to the study"),
        _ => (
            format!("varies no `{}`", needed.join("` or `")),
            "add the factor to `vary`",
        ),
    };
    let message = format!("the study {lacks}, which `{name}` needs");
    Err(Fault::new(path, message, "has no values here").with_help(help))
}

/// Returns the fault of a name that is neither a factor nor a metric.
fn unknown(
    name: &str,
    kind: &str,
    path: FieldPath,
    factors: &[&str],
    metrics: &[StudyMetric],
) -> Fault {
    let of_study = format!("the factors of this study are `{}`", factors.join("`, `"));
    let list = "`raycost study --list-metrics` lists the metrics";
    if kind == "metric" && (factors.contains(&name) || FlagFactor::NAMES.contains(&name)) {
        let message = format!("`{name}` is a factor, not a metric");
        return Fault::new(path, message, "expected a metric").with_help(list);
    }
    if FlagFactor::NAMES.contains(&name) {
        let message = format!("this study does not vary `{name}`");
        let expected = format!("expected a {kind} of the study");
        return Fault::new(path, message, expected)
            .with_help(format!("add it to `vary`; {of_study}"));
    }
    let metric_names = metrics.iter().map(|metric| &*metric.name);
    let known: Vec<&str> = match kind {
        "metric" => metric_names.collect(),
        _ => factors.iter().copied().chain(metric_names).collect(),
    };
    let listed = match kind {
        "metric" => list.to_owned(),
        "factor" => of_study,
        _ => format!("{of_study}; {list}"),
    };
    let help = match did_you_mean(name, known) {
        Some(meant) => format!("{meant} ({listed})"),
        None => listed,
    };
    let message = format!("there is no {kind} `{name}`");
    Fault::new(path, message, format!("expected a {kind}")).with_help(help)
}
