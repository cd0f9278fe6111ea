//! The instruments that measure a rendering.

use super::Clock;
use super::CostMode;

/// The instruments of a [`CostMode`].
#[derive(Debug, Clone, Copy)]
pub enum Meter {
    /// No instrument.
    Off,
    /// Counters only.
    Counters,
    /// Counters, and a clock for rays one by one.
    SingleRayTime(Clock),
    /// Counters, and a clock for waves.
    Time(Clock),
}

impl Meter {
    /// Creates the instruments of a mode. If there are times, calibrates a clock, which takes about
    /// 0.5 ms.
    pub fn new(mode: CostMode) -> Self {
        match mode {
            CostMode::None => Self::Off,
            CostMode::Counters => Self::Counters,
            CostMode::SingleRayTime => Self::SingleRayTime(Clock::calibrated()),
            CostMode::Time => Self::Time(Clock::calibrated()),
        }
    }

    /// Returns the mode of these instruments.
    pub fn mode(&self) -> CostMode {
        match self {
            Self::Off => CostMode::None,
            Self::Counters => CostMode::Counters,
            Self::SingleRayTime(_) => CostMode::SingleRayTime,
            Self::Time(_) => CostMode::Time,
        }
    }

    /// Returns the clock, if there is one.
    pub fn clock(&self) -> Option<&Clock> {
        match self {
            Self::SingleRayTime(clock) | Self::Time(clock) => Some(clock),
            Self::Off | Self::Counters => None,
        }
    }
}
