//! The study file as serde types.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::point::scene_names;
use super::step::leave_out;
use super::{Case, Factor, Launcher, LeftOutStep, PlotSpec, StudyPoint, StudyStep, Vary};
use math::sampling::uniform;
use scene::yaml::{Refusal, YamlFile, deserialize};
use world::kinds;
use world::values::{self, NonEmpty};

/// A study file.
///
/// ```
/// # use scene::yaml;
/// # use raycost_tools::study::StudyPlan;
/// let plan: StudyPlan = yaml::from_str("
/// title: Threads
/// scenes: [../seed_extended.yaml]
/// vary: { threads: [1, 2], cost: [counters, time] }
/// repeats: 5
/// ").unwrap();
/// # assert_eq!(plan.points().len(), 4);
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyPlan {
    /// The title of tables and plots.
    #[serde(with = "values::Name")]
    pub title: String,
    /// Scene files, relative to the study's folder; at least one.
    #[serde(with = "Scenes")]
    pub scenes: Vec<PathBuf>,
    /// The factors that are crossed.
    #[serde(default)]
    pub vary: Vary,
    /// Levels that change together, such as the image size with the threads; each case is crossed
    /// with [`vary`](Self::vary).
    #[serde(default)]
    pub cases: Vec<Case>,
    /// Steps from one way of rendering to another, in place of `vary` and `cases`: each adds to the
    /// settings of the steps before.
    #[serde(default)]
    pub steps: Vec<StudyStep>,
    /// Flags of `raycost render` for all runs.
    #[serde(default)]
    pub flags: Vec<String>,
    /// The command that starts a run on several `ranks`, such as `mpirun -n {ranks}`.
    #[serde(default)]
    pub launcher: Option<Launcher>,
    /// Runs of each point that enter the statistics; 10 if not given.
    #[serde(default = "ten", with = "values::Between::<1, 100_000>")]
    pub repeats: u32,
    /// Earlier runs of each point that are ignored; 1 if not given.
    #[serde(default = "values::one", with = "values::Between::<0, 1000>")]
    pub warm_up: u32,
    /// Time in seconds after which no further run starts; no limit if not given.
    #[serde(default, with = "values::Positive")]
    pub time_budget_s: Option<f32>,
    /// The plots to draw.
    #[serde(default)]
    pub plots: Vec<PlotSpec>,
    /// If true, measures the machine's limits once and draws the points below them, as
    /// `roofline.svg`; no if not given.
    #[serde(default)]
    pub roofline: bool,
    /// The `vary`, `cases`, `flags` and `repeats` (3) of `--quick`, to test the study.
    #[serde(default)]
    pub quick: Option<QuickPlan>,
}

/// Replacements for a smaller study.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuickPlan {
    /// Replaces [`StudyPlan::vary`].
    #[serde(default)]
    pub vary: Option<Vary>,
    /// Replaces [`StudyPlan::cases`].
    #[serde(default)]
    pub cases: Option<Vec<Case>>,
    /// Replaces [`StudyPlan::flags`], for smaller images.
    #[serde(default)]
    pub flags: Option<Vec<String>>,
    /// Replaces [`StudyPlan::repeats`]; 3 if not given.
    #[serde(default = "three", with = "values::Between::<1, 100_000>")]
    pub repeats: u32,
}

/// One run that a study makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlannedRun {
    /// Index of the run's point in [`StudyPlan::points`].
    pub point: usize,
    /// The round, from 0; the first [`StudyPlan::warm_up`] rounds are warm-up.
    pub round: u32,
}

impl YamlFile for StudyPlan {
    fn from_yaml(text: &str) -> Result<Self, Refusal> {
        deserialize(text)
    }
}

impl StudyPlan {
    /// Maximum number of runs of a study: at one second each, a little more than a day.
    pub const MAX_RUNS: u64 = 100_000;

    /// Returns the plan with the replacements for `--quick`.
    pub fn into_quick(mut self) -> Self {
        let quick = self.quick.take();
        self.repeats = quick.as_ref().map_or_else(three, |quick| quick.repeats);
        self.warm_up = self.warm_up.min(1);
        if let Some(quick) = quick {
            self.vary = quick.vary.unwrap_or(self.vary);
            self.cases = quick.cases.unwrap_or(self.cases);
            self.flags = quick.flags.unwrap_or(self.flags);
        }
        self
    }

    /// Returns the total number of runs, warm-up included, saturating.
    pub fn n_runs(&self) -> u64 {
        let levels = self.vary.0.values().map(Vec::len);
        let lists = [self.scenes.len(), self.cases.len(), self.steps.len()];
        let counts = lists.map(|count| count.max(1)).into_iter();
        let rounds = u64::from(self.warm_up) + u64::from(self.repeats);
        counts
            .chain(levels)
            .fold(rounds, |n, count| n.saturating_mul(count as u64))
    }

    /// Removes the steps with a reason why they cannot be made, and those that change nothing on
    /// this machine. Returns the removed ones.
    pub fn leave_out(
        &mut self,
        why_not: impl FnMut(&StudyStep) -> Option<String>,
    ) -> Vec<LeftOutStep> {
        leave_out(&mut self.steps, why_not)
    }

    /// Returns all points: scene by scene, then step by step, or case by case, then level by level.
    pub fn points(&self) -> Vec<StudyPoint> {
        let scenes = self.scenes.iter().zip(scene_names(&self.scenes));
        let scenes = scenes.map(|(scene, name)| StudyPoint::from_scene(scene, name));
        let cases = scenes.flat_map(|point| {
            if !self.steps.is_empty() {
                points_of_steps(&self.steps, &point)
            } else if self.cases.is_empty() {
                vec![point]
            } else {
                let of_case = |case: &Case| with_case(&point, case);
                self.cases.iter().map(of_case).collect()
            }
        });
        let cross = |points: Vec<StudyPoint>, (factor, levels): (&Factor, &Vec<Value>)| {
            let with_levels = |point: &StudyPoint| {
                let points = levels.iter().map(|level| point.with(factor, level));
                points.collect::<Vec<_>>()
            };
            points.iter().flat_map(with_levels).collect()
        };
        self.vary.0.iter().fold(cases.collect(), cross)
    }

    /// Returns all runs, round by round. Each round has all points once, in a pseudo-random order
    /// that depends only on the round.
    pub fn runs(&self) -> Vec<PlannedRun> {
        let n_points = self.points().len();
        let round_of = |round: u32| {
            let mut points: Vec<usize> = (0..n_points).collect();
            let key = |point: usize| uniform([u64::from(round), point as u64, 0])[0];
            points.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
            points
                .into_iter()
                .map(move |point| PlannedRun { point, round })
        };
        (0..self.warm_up + self.repeats)
            .flat_map(round_of)
            .collect()
    }
}

/// Returns the point with all levels of a case.
fn with_case(point: &StudyPoint, case: &Case) -> StudyPoint {
    let with = |point: StudyPoint, (factor, level): (&Factor, &Value)| point.with(factor, level);
    case.0.iter().fold(point.clone(), with)
}

/// Returns the points of all steps in a scene.
fn points_of_steps(steps: &[StudyStep], scene: &StudyPoint) -> Vec<StudyPoint> {
    let mut settings = Case::default();
    let point = |step: &StudyStep| {
        settings = settings.joined_with(&step.set);
        scene.at_step(step, &settings)
    };
    steps.iter().map(point).collect()
}

kinds! {
    Scenes: Vec<PathBuf> = NonEmpty::<PathBuf>::of("scene file");
}

fn three() -> u32 {
    3
}

fn ten() -> u32 {
    10
}
