//! The comparison of a budget with the totals of a rendering now.

use std::cmp::Ordering;
use std::str::FromStr;

use indexmap::IndexMap;
use serde_json::json;

use super::file::{CostBudget, RayTotals, SceneBudget};
use crate::diff::{Limit, Setting, compare_runs};
use base::numbers::counted;
use host::text::{Diagnostic, did_you_mean};
use scene::yaml::json_of;
use tracer::cost::{Metric, RayKind};

/// The part of the totals of the whole picture.
const WHOLE: &str = "whole picture";

/// An allowed growth of a counter, such as `node_visits=0.5%`.
#[derive(Debug, Clone)]
pub struct Allowance {
    counter: String,
    limit: Limit,
}

/// A total of a scene, in its budget and now.
#[derive(Debug, Clone)]
pub(super) struct BudgetRow {
    /// The whole picture, the rays of a kind, or an object.
    pub(super) part: String,
    /// Name of the counter.
    pub(super) counter: &'static str,
    pub(super) budget: u64,
    pub(super) now: u64,
    pub(super) growth: Growth,
}

/// How a total compares with its budget, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Growth {
    /// It grew by more than is allowed.
    Exceeding,
    /// It grew by no more than is allowed.
    Allowed,
    /// It shrank.
    Shrunk,
}

/// The totals of scenes that differ from their budgets.
#[derive(Debug)]
pub struct BudgetCheck<'a> {
    pub(super) scenes: Vec<SceneCheck<'a>>,
}

/// The totals of a scene that differ from its budget.
#[derive(Debug)]
pub(super) struct SceneCheck<'a> {
    /// The scene now.
    pub(super) scene: &'a SceneBudget,
    pub(super) rows: Vec<BudgetRow>,
}

impl FromStr for Allowance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=');
        let (counter, limit) =
            parts.ok_or("expected a counter and a percentage, such as `node_visits=0.5%`")?;
        if counters().all(|name| name != counter) {
            let meant = did_you_mean(counter, counters());
            let all: Vec<&str> = counters().collect();
            let help = meant.unwrap_or_else(|| format!("expected one of {}", all.join(", ")));
            return Err(format!("`{counter}` is not a counter: {help}"));
        }
        Ok(Self {
            counter: counter.to_owned(),
            limit: limit.parse()?,
        })
    }
}

/// Returns the names of the counters in their order.
fn counters() -> impl Iterator<Item = &'static str> {
    let metrics = Metric::ALL.into_iter().filter(|metric| !metric.is_timed());
    metrics.map(|metric| metric.name).chain([CAMERA_RAYS])
}

/// The counter of `summary.json` that is not a metric of pixels.
const CAMERA_RAYS: &str = "camera_rays";

impl<'a> BudgetCheck<'a> {
    /// Compares the totals of scenes now with their budgets.
    ///
    /// # Errors
    /// The budgets are of other pictures.
    pub fn new(
        budget: &CostBudget,
        now: &'a [SceneBudget],
        allowed: &[Allowance],
    ) -> Result<Self, Diagnostic> {
        let pairs = budget.scenes.iter().zip(now);
        let check = |(budget, now)| SceneCheck::new(budget, now, allowed);
        let scenes = pairs.map(check).collect::<Result<_, _>>()?;
        if now.len() == budget.scenes.len() {
            return Ok(Self { scenes });
        }
        let [n, n_now] =
            [&budget.scenes[..], now].map(|scenes| counted(scenes.len() as u64, "scene"));
        let message = format!("the budget is of {n}, the measured totals are of {n_now}");
        let help = "measure the scenes of the budget: `raycost budget --update --out FILE`";
        Err(Diagnostic::new(message).with_help(help))
    }

    /// Returns the number of totals that compare so with their budgets.
    pub fn n(&self, growth: Growth) -> u64 {
        self.scenes.iter().map(|scene| scene.n(growth)).sum()
    }
}

impl<'a> SceneCheck<'a> {
    fn new(
        budget: &SceneBudget,
        now: &'a SceneBudget,
        allowed: &[Allowance],
    ) -> Result<Self, Diagnostic> {
        refuse_other_picture(budget, now)?;
        let [before, after] = [budget, now].map(totals);
        let mut rows = Vec::new();
        let only_now = after.keys().filter(|key| !before.contains_key(*key));
        for (part, counter) in before.keys().chain(only_now) {
            let key = (part.clone(), *counter);
            let [budget, now] =
                [&before, &after].map(|totals| totals.get(&key).copied().unwrap_or(0));
            let mut limits = allowed.iter().filter(|allowed| allowed.counter == *counter);
            let growth = match now.cmp(&budget) {
                Ordering::Equal => continue,
                Ordering::Less => Growth::Shrunk,
                Ordering::Greater
                    if limits.any(|one| one.limit.allows(now as f64 / budget as f64)) =>
                {
                    Growth::Allowed
                }
                Ordering::Greater => Growth::Exceeding,
            };
            rows.push(BudgetRow {
                part: part.clone(),
                counter,
                budget,
                now,
                growth,
            });
        }
        rows.sort_by_key(|row| row.growth);
        Ok(Self { scene: now, rows })
    }

    /// Returns the number of totals that compare so with the budget.
    pub(super) fn n(&self, growth: Growth) -> u64 {
        self.rows.iter().filter(|row| row.growth == growth).count() as u64
    }
}

/// Returns all totals of a scene by the part and the counter: of the whole picture, of each kind of
/// ray, and of each object.
fn totals(scene: &SceneBudget) -> IndexMap<(String, &'static str), u64> {
    let mut totals = IndexMap::new();
    for counter in counters() {
        if let Some(total) = scene.totals.get(counter) {
            totals.insert((WHOLE.to_owned(), counter), *total);
        }
    }
    let mut add = |part: String, rays: RayTotals| {
        for (counter, n) in [
            (Metric::RAYS.name, rays.rays),
            (Metric::NODE_VISITS.name, rays.node_visits),
            (Metric::PRIMITIVE_TESTS.name, rays.primitive_tests),
        ] {
            totals.insert((part.clone(), counter), n);
        }
    };
    for kind in RayKind::ALL {
        let mut sum = RayTotals::default();
        let of_kind = scene.objects.values();
        of_kind
            .filter_map(|kinds| kinds.get(kind.name()))
            .for_each(|rays| sum.add(*rays));
        add(format!("{} rays", kind.name()), sum);
    }
    for (object, kinds) in &scene.objects {
        let mut sum = RayTotals::default();
        kinds.values().for_each(|rays| sum.add(*rays));
        add(format!("object {object}"), sum);
    }
    totals
}

/// Checks that a budget is of the picture that the scene gives now.
///
/// # Errors
/// The budget is of another picture.
fn refuse_other_picture(budget: &SceneBudget, now: &SceneBudget) -> Result<(), Diagnostic> {
    // Cannot fail: all keys are strings.
    let images =
        [budget, now].map(|scene| json!({ "image": json_of(&scene.image).unwrap_or_default() }));
    let changes = compare_runs(&images);
    let name = now.label();
    let message = if (&budget.scene, budget.frame) != (&now.scene, now.frame) {
        format!("the budget is of `{}`, not of `{name}`", budget.label())
    } else if !changes.is_empty() {
        let changes: Vec<String> = changes.iter().map(Setting::to_string).collect();
        let changes = changes.join(", ");
        format!("the budget of `{name}` is of another picture: {changes}")
    } else if budget.config != now.config {
        format!(
            "the budget of `{name}` is of another config: the scene, or a file that it names, has changed"
        )
    } else {
        return Ok(());
    };
    let help = "a budget compares the work of one picture: if the new one is meant, `raycost budget --update`";
    Err(Diagnostic::new(message).with_help(help))
}

impl SceneBudget {
    /// Returns the scene with its flags.
    pub fn label(&self) -> String {
        let frame = self.frame.map(|frame| format!("--frame={frame}"));
        let words = std::iter::once(&self.scene)
            .chain(&self.flags)
            .chain(&frame);
        words.cloned().collect::<Vec<_>>().join(" ")
    }
}
