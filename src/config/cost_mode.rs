//! The `cost` section.

use serde::{Deserialize, Deserializer, Serialize};

use crate::text;

/// The cost measured for each pixel. All modes give the same picture, and the
/// three modes with counters the same counters.
///
/// ```
/// # use raycost::config::CostMode;
/// let cost: CostMode = raycost::yaml::from_str("counters").unwrap();
/// # assert_eq!(cost, CostMode::Counters);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum CostMode {
    /// Nothing; traces rays in streams
    None,
    /// Node visits, primitive tests and rays; traces rays in streams
    Counters,
    /// Counters, and the time of each tile, attributed to its pixels by their
    /// counters; traces rays in streams
    AttributedTime,
    /// Counters and nanoseconds; traces rays one by one
    #[default]
    Time,
}

impl CostMode {
    /// Whether node visits, primitive tests and rays are counted.
    pub fn has_counters(self) -> bool {
        self != Self::None
    }

    /// Whether each pixel has a time: its own, or its share of its tile's.
    pub fn has_time(self) -> bool {
        matches!(self, Self::AttributedTime | Self::Time)
    }

    /// The name of the kernel: `single_ray` if each pixel is timed, which excludes
    /// the other, `stream`, as it traces the rays of many pixels together.
    pub fn kernel(self) -> &'static str {
        match self {
            Self::None | Self::Counters | Self::AttributedTime => "stream",
            Self::Time => "single_ray",
        }
    }
}

impl<'de> Deserialize<'de> for CostMode {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        text::keyword(d)
    }
}
