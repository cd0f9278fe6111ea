//! What is measured while a picture is rendered.

use super::Clock;
use crate::config::CostMode;

/// The instruments of a [`CostMode`].
#[derive(Debug, Clone, Copy)]
pub enum Meter {
    /// None.
    Off,
    /// Counters alone.
    Counters,
    /// Counters, and this clock.
    Time(Clock),
}

impl Meter {
    /// What the mode asks for; calibrates a clock, which takes about 0.5 ms, only
    /// where pixels are timed.
    pub fn new(mode: CostMode) -> Self {
        match mode {
            CostMode::None => Self::Off,
            CostMode::Counters => Self::Counters,
            CostMode::Time => Self::Time(Clock::calibrated()),
        }
    }

    /// The mode that these are the instruments of.
    pub fn mode(&self) -> CostMode {
        match self {
            Self::Off => CostMode::None,
            Self::Counters => CostMode::Counters,
            Self::Time(_) => CostMode::Time,
        }
    }

    /// The clock, if there is one.
    pub fn clock(&self) -> Option<&Clock> {
        match self {
            Self::Time(clock) => Some(clock),
            Self::Off | Self::Counters => None,
        }
    }
}
