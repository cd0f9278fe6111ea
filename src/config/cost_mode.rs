//! The `cost` section.

use serde::{Deserialize, Serialize};

/// What is measured of each pixel while it is rendered. The picture is the same
/// in all modes, and the counters in both that have them.
///
/// ```
/// # use raycost::config::CostMode;
/// let cost: CostMode = raycost::yaml::from_str("counters").unwrap();
/// # assert_eq!(cost, CostMode::Counters);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case", expecting = "`none`, `counters` or `time`")]
pub enum CostMode {
    /// Nothing; rays are traced in streams
    None,
    /// Nodes, tests and rays; rays are traced in streams
    Counters,
    /// Counters and nanoseconds; each ray is traced alone
    #[default]
    Time,
}

impl CostMode {
    /// Whether nodes, tests and rays are counted.
    pub fn has_counters(self) -> bool {
        self != Self::None
    }

    /// Whether every pixel has a time of its own. Rays of a stream have none:
    /// they wait for one another.
    pub fn has_time(self) -> bool {
        self == Self::Time
    }

    /// How rays are traced: many at once, or, where each pixel is timed, one
    /// after the other.
    pub fn kernel(self) -> &'static str {
        match self {
            Self::None | Self::Counters => "stream",
            Self::Time => "single_ray",
        }
    }
}
