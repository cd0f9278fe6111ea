//! The study file as serde types.

use std::fmt;
use std::path::PathBuf;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};

use super::factor::Form;
use super::{Factor, Level, Plot, Point};
use crate::sampling::uniform;
use crate::yaml;

/// A whole study file.
///
/// ```
/// # use raycost::{study::Plan, yaml};
/// let plan: Plan = yaml::from_str("
/// title: Threads
/// scenes: [../seed_extended.yaml]
/// vary: { threads: [1, 2], cost: [counters, time] }
/// repeats: 5
/// ").unwrap();
/// # assert_eq!(plan.points().len(), 4);
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// What the study is about, in a few words.
    #[serde(deserialize_with = "yaml::name")]
    pub title: String,
    /// Scene files, relative to the study's folder, at least one.
    #[serde(deserialize_with = "scenes")]
    pub scenes: Vec<PathBuf>,
    /// What is varied; every choice of one with every choice of the others.
    #[serde(default)]
    pub vary: Vary,
    /// What changes together, such as the size with the threads: each case with
    /// every choice of what is varied.
    #[serde(default)]
    pub cases: Vec<Case>,
    /// Flags that all runs have.
    #[serde(default)]
    pub flags: Vec<String>,
    /// Runs of each point that count; 10 if not given.
    #[serde(default = "ten", deserialize_with = "repeats")]
    pub repeats: u32,
    /// Runs of each point before them, which do not; 1 if not given.
    #[serde(default = "one", deserialize_with = "warm_up")]
    pub warm_up: u32,
    /// Seconds after which no further run begins; no limit if not given.
    #[serde(default, deserialize_with = "budget")]
    pub time_budget_s: Option<f32>,
    /// What is drawn of it.
    #[serde(default)]
    pub plots: Vec<Plot>,
    /// Whether the runs are held against what the machine gives at most, which is
    /// measured once: `roofline.svg`. No if not given.
    #[serde(default)]
    pub roofline: bool,
    /// What `--quick` takes instead, to see the study work.
    #[serde(default)]
    pub quick: Option<Quick>,
}

/// A smaller matrix.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quick {
    /// Takes the place of all that is varied.
    #[serde(default)]
    pub vary: Option<Vary>,
    /// Takes the place of all cases.
    #[serde(default)]
    pub cases: Option<Vec<Case>>,
    /// Takes the place of the flags, for smaller pictures.
    #[serde(default)]
    pub flags: Option<Vec<String>>,
    /// Takes the place of the repeats.
    #[serde(default = "three", deserialize_with = "repeats")]
    pub repeats: u32,
}

/// The factors and their levels, in the order of the file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vary(pub Vec<(Factor, Vec<Level>)>);

/// A level of each of some factors.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Case(pub Vec<(Factor, Level)>);

/// One turn of a study: a point to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Turn {
    /// The point's index.
    pub point: usize,
    /// Which run of the point; the first ones are for warming up.
    pub round: u32,
}

impl Plan {
    /// Most runs of a study: at a second each they take a day.
    pub const MAX_RUNS: u64 = 100_000;

    /// The plan with what `quick` says.
    pub fn quickened(mut self) -> Self {
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

    /// How many runs the plan makes in all, warm-up included; `u64::MAX` for
    /// more than that.
    pub fn n_runs(&self) -> u64 {
        let levels = self.vary.0.iter().map(|(_, levels)| levels.len());
        let counts = [self.scenes.len(), self.cases.len().max(1)].into_iter();
        let rounds = u64::from(self.warm_up) + u64::from(self.repeats);
        counts
            .chain(levels)
            .fold(rounds, |n, count| n.saturating_mul(count as u64))
    }

    /// All combinations, scene by scene and case by case.
    pub fn points(&self) -> Vec<Point> {
        let scenes = self.scenes.iter().map(|scene| Point::of_scene(scene));
        let cases = scenes.flat_map(|point| match self.cases.is_empty() {
            true => vec![point],
            false => self.cases.iter().map(|case| case.of(&point)).collect(),
        });
        let choose = |points: Vec<Point>, (factor, levels): &(Factor, Vec<Level>)| {
            let with_levels = |point: &Point| {
                let points = levels.iter().map(|level| point.with(*factor, level));
                points.collect::<Vec<_>>()
            };
            points.iter().flat_map(with_levels).collect()
        };
        self.vary.0.iter().fold(cases.collect(), choose)
    }

    /// Every run, round after round; each round has all points once, in an
    /// order of its own, which is always the same.
    pub fn turns(&self) -> Vec<Turn> {
        let n_points = self.points().len();
        let round_of = |round: u32| {
            let mut points: Vec<usize> = (0..n_points).collect();
            let key = |point: usize| uniform([u64::from(round), point as u64, 0])[0];
            points.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
            points.into_iter().map(move |point| Turn { point, round })
        };
        (0..self.warm_up + self.repeats)
            .flat_map(round_of)
            .collect()
    }
}

impl Case {
    /// The point with all of its levels.
    fn of(&self, point: &Point) -> Point {
        let with = |point: Point, (factor, level): &(Factor, Level)| point.with(*factor, level);
        self.0.iter().fold(point.clone(), with)
    }
}

impl<'de> Deserialize<'de> for Vary {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_map(FactorsVisitor(Form::List)).map(Self)
    }
}

impl<'de> Deserialize<'de> for Case {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let factors = d.deserialize_map(FactorsVisitor(Form::One))?.into_iter();
        let one =
            |(factor, levels): (Factor, Vec<Level>)| Some((factor, levels.into_iter().next()?));
        Ok(Self(factors.filter_map(one).collect()))
    }
}

struct FactorsVisitor(Form);

impl<'de> Visitor<'de> for FactorsVisitor {
    type Value = Vec<(Factor, Vec<Level>)>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self.0 {
            Form::List => "lists by name, such as { threads: [1, 2] }",
            Form::One => "values by name, such as { threads: 1, image_size: [512, 512] }",
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut factors = Vec::new();
        while let Some(factor) = map.next_key::<Factor>()? {
            factors.push((factor, factor.next_levels(&mut map, self.0)?));
        }
        Ok(factors)
    }
}

fn scenes<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<PathBuf>, D::Error> {
    yaml::non_empty(d, "scene file")
}

fn repeats<'de, D: Deserializer<'de>>(d: D) -> Result<u32, D::Error> {
    yaml::whole(d, 1..=100_000)
}

fn warm_up<'de, D: Deserializer<'de>>(d: D) -> Result<u32, D::Error> {
    yaml::whole(d, 0..=1000)
}

fn budget<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f32>, D::Error> {
    yaml::positive(d).map(Some)
}

fn one() -> u32 {
    1
}

fn three() -> u32 {
    3
}

fn ten() -> u32 {
    10
}
