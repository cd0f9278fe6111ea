//! The `cost` section.

use serde::{Deserialize, Deserializer, Serialize};

use crate::text;

/// The cost measured for each pixel. All modes give the same picture, and the
/// two modes with counters the same counters.
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
    /// Counters and nanoseconds; traces rays one by one
    #[default]
    Time,
}

impl CostMode {
    /// Whether node visits, primitive tests and rays are counted.
    pub fn has_counters(self) -> bool {
        self != Self::None
    }

    /// Whether each pixel is timed. This excludes streams, which process the
    /// rays of many pixels together.
    pub fn has_time(self) -> bool {
        self == Self::Time
    }

    /// The name of the kernel: `stream`, or `single_ray` if pixels are timed.
    pub fn kernel(self) -> &'static str {
        match self {
            Self::None | Self::Counters => "stream",
            Self::Time => "single_ray",
        }
    }
}

impl<'de> Deserialize<'de> for CostMode {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        text::keyword(d)
    }
}
