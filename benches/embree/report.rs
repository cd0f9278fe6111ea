//! The table of results and goals.

use std::fmt;

use math::statistics::Ratio;
use serde::Serialize;
use tools::study::SampleStatistics;

use crate::ffi::Quality;
use crate::rays::Kind;

/// The quantity that is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Discipline {
    /// Building the hierarchy.
    Build,
    /// One ray at a time against Embree's one ray at a time.
    Single(Kind),
    /// One ray at a time against tinybvh's one ray at a time.
    SingleAgainstTinyBvh(Kind),
    /// Batches against Embree's one ray at a time.
    Stream(Kind),
    /// Batches against Embree's one ray at a time in a robust scene.
    StreamAgainstRobust(Kind),
    /// Batches against Embree's packets of 16.
    StreamAgainstPackets(Kind),
}

/// A result.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    pub discipline: Discipline,
    /// raycost, with counters.
    pub ours: Speed,
    /// tinybvh, or Embree with the faster of its instruction sets.
    pub rival: Speed,
    /// raycost's speed over the rival's.
    pub ratio: Ratio,
    /// tinybvh's hierarchy, or the faster instruction set of Embree.
    pub isa: &'static str,
    /// The overhead of the counters, relative to the time without them.
    pub counters_cost: Option<f64>,
}

/// Million rays or primitives per second: the median and its 95 % confidence interval.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Speed {
    pub median: f64,
    pub interval: [f64; 2],
}

impl Speed {
    /// Computes the speed from the times for `n` rays or primitives, at least one, in seconds.
    fn of(n: usize, seconds: &[f64]) -> Self {
        let speed = |seconds: f64| n as f64 / seconds / 1e6;
        let statistics = SampleStatistics::from_values(seconds).expect("each kernel runs");
        let [low, high] = statistics.spread();
        Self {
            median: speed(statistics.median),
            interval: [speed(high), speed(low)],
        }
    }
}

impl Outcome {
    /// Computes an outcome from the times for `n` rays or primitives, in seconds.
    pub fn new(
        discipline: Discipline,
        n: usize,
        ours: &[f64],
        rival: &[f64],
        isa: &'static str,
    ) -> Self {
        Self {
            discipline,
            ours: Speed::of(n, ours),
            rival: Speed::of(n, rival),
            ratio: Ratio::estimate(ours, rival).expect("each kernel runs"),
            isa,
            counters_cost: None,
        }
    }
}

/// A line of the table.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub scene: String,
    /// raycost's and the rival's build quality.
    pub quality: [&'static str; 2],
    pub n_threads: usize,
    pub outcome: Outcome,
    /// The goal: the minimum ratio, if there is one.
    pub goal: Option<f64>,
}

/// Returns the goal of a scene of spheres or of triangles, against a build of this quality:
/// the minimum ratio.
pub fn goal(discipline: Discipline, quality: Quality, of_spheres: bool) -> Option<f64> {
    use Discipline::{
        Build, Single, SingleAgainstTinyBvh, Stream, StreamAgainstPackets, StreamAgainstRobust,
    };
    match (discipline, of_spheres) {
        (Build, _) => (quality == Quality::Medium).then_some(1.0),
        (Single(_) | SingleAgainstTinyBvh(_), _) => Some(1.1),
        (Stream(Kind::Primary), false) => Some(1.6),
        (Stream(_), false) => Some(1.7),
        (StreamAgainstRobust(Kind::Primary), _) | (StreamAgainstRobust(_), true) => None,
        (StreamAgainstRobust(_), false) => Some(2.1),
        (Stream(Kind::Primary), true) => Some(2.2),
        (Stream(_), true) => Some(3.0),
        (StreamAgainstPackets(Kind::Primary), _) => Some(1.0),
        (StreamAgainstPackets(_), _) => None,
    }
}

/// The head of the table of rows, in Markdown.
pub const HEAD: &str = "\
| scene | quality | threads | race | raycost | rival | ratio | goal | counters cost |
|---|---|--:|---|--:|--:|--:|---|--:|";

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Outcome {
            discipline,
            ours,
            rival,
            ratio,
            isa,
            counters_cost,
        } = &self.outcome;
        let [ours, rival] = [ours.median, rival.median];
        let [scene, our_quality, their_quality] = [&*self.scene, self.quality[0], self.quality[1]];
        let ratio = ratio.estimate;
        let goal = match self.goal {
            Some(goal) if ratio >= goal => format!("{goal}, reached"),
            Some(goal) => format!("{goal}, missed"),
            None => String::new(),
        };
        let counters =
            counters_cost.map_or(String::new(), |cost| format!("{:+.0} %", 100.0 * cost));
        write!(
            f,
            "| {scene} | {our_quality} / {their_quality} | {} | {discipline} | {ours:.2} \
             | {rival:.2} ({isa}) | {ratio:.2} | {goal} | {counters} |",
            self.n_threads,
        )
    }
}

impl fmt::Display for Discipline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Build => write!(f, "build"),
            Self::Single(kind) => write!(f, "{kind}, single"),
            Self::SingleAgainstTinyBvh(kind) => write!(f, "{kind}, single / tinybvh"),
            Self::Stream(kind) => write!(f, "{kind}, stream"),
            Self::StreamAgainstRobust(kind) => write!(f, "{kind}, stream / robust"),
            Self::StreamAgainstPackets(kind) => write!(f, "{kind}, stream / packets of 16"),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Primary => "primary",
            Self::Diffuse => "diffuse",
            Self::AmbientOcclusion => "occlusion",
            Self::Shadow => "shadow",
        })
    }
}
