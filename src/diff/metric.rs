//! The arrays of `frame.vti` that are costs.

use std::time::Duration;

use crate::text::numbers;

/// A cost metric of pixels: an array of `frame.vti`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CostMetric {
    /// The array's name in `frame.vti`.
    pub array: &'static str,
    /// Its name in tables.
    pub name: &'static str,
    /// Its unit in pictures.
    pub(super) unit: &'static str,
}

const fn count(array: &'static str, name: &'static str) -> CostMetric {
    CostMetric {
        array,
        name,
        unit: name,
    }
}

impl CostMetric {
    /// Thread time: the only metric with noise.
    pub const TIME: Self = Self {
        array: "time_ns",
        name: "time",
        unit: "ns",
    };
    /// BVH nodes entered.
    pub const NODE_VISITS: Self = count("node_visits", "node visits");
    /// Ray-primitive tests.
    pub const PRIMITIVE_TESTS: Self = count("primitive_tests", "primitive tests");
    /// Longest path in bounces: aggregated by maximum, not by sum.
    pub const DEPTH: Self = count("depth", "longest path");

    /// All metrics, in the order of the tables.
    pub const ALL: [Self; 8] = [
        Self::TIME,
        Self::NODE_VISITS,
        Self::PRIMITIVE_TESTS,
        count("rays", "rays"),
        count("shadow_rays", "shadow rays"),
        count("reflection_rays", "reflection rays"),
        count("refraction_rays", "refraction rays"),
        Self::DEPTH,
    ];

    /// Adds a pixel's value to the total of several pixels.
    pub(super) fn add(self, sum: f64, value: f64) -> f64 {
        match self {
            Self::DEPTH => sum.max(value),
            _ => sum + value,
        }
    }

    /// Formats a value or a total.
    pub(super) fn label(self, value: f64) -> String {
        match self {
            Self::TIME => numbers::duration(Duration::from_nanos(value as u64)),
            _ => numbers::count(value as u64),
        }
    }

    /// Formats a change, with its sign.
    pub(super) fn change_label(self, change: f64) -> String {
        match change {
            0.0 => "0".to_owned(),
            ..0.0 => format!("-{}", self.label(-change)),
            _ => format!("+{}", self.label(change)),
        }
    }
}

/// Returns `b / a`; 1 if both are equal, even 0, and infinity if only `a` is 0.
pub fn ratio([a, b]: [f64; 2]) -> f64 {
    if a == b { 1.0 } else { b / a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{CostMode, Repeats};
    use crate::film::columns;

    #[test]
    fn every_array_of_the_film_is_a_cost_metric_or_a_known_other_array() {
        let others = [
            "RGB",
            "Normals",
            "distance",
            "footprint",
            "object",
            "material",
            "tile",
            "thread",
        ];
        let costs = CostMetric::ALL.map(|metric| metric.array);
        for column in columns(CostMode::Time, Repeats::ONCE) {
            let n = costs
                .iter()
                .chain(&others)
                .filter(|name| **name == column.name);
            assert_eq!(n.count(), 1, "{}", column.name);
        }
    }

    #[test]
    fn ratios_of_zero_are_defined() {
        assert_eq!(ratio([0.0, 0.0]), 1.0);
        assert_eq!(ratio([0.0, 3.0]), f64::INFINITY);
        assert_eq!(ratio([3.0, 0.0]), 0.0);
        assert_eq!(ratio([4.0, 3.0]), 0.75);
    }
}
