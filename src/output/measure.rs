//! The cost metrics that heatmaps show.

use std::time::Duration;

use crate::cost::Counter;
use crate::film::{Film, Strip};
use crate::text::numbers;

/// A cost metric of pixels.
#[derive(Clone, Copy)]
pub(super) struct Measure {
    /// The array's name in files.
    pub(super) array: &'static str,
    /// Its name within a sentence.
    pub(super) name: &'static str,
    /// Its label on an axis.
    pub(super) axis: &'static str,
    /// Its unit.
    pub(super) unit: &'static str,
    values: Values,
}

#[derive(Clone, Copy)]
enum Values {
    Times(fn(&Strip) -> &Vec<f32>),
    Counts(fn(&Film, &Strip, &mut Vec<u32>)),
}

/// In order of preference.
const MEASURES: [Measure; 4] = [
    Measure {
        array: "time_ns",
        name: "time per pixel",
        axis: "Time per pixel (ns)",
        unit: "ns",
        values: Values::Times(|strip| &strip.time_ns),
    },
    Measure {
        array: "node_visits",
        name: "BVH nodes visited per pixel",
        axis: "BVH nodes visited per pixel",
        unit: "node visits",
        values: Values::Counts(|film, strip, counts| {
            film.counts(strip, Counter::NodeVisits, counts);
        }),
    },
    Measure {
        array: "primitive_tests",
        name: "primitive tests per pixel",
        axis: "Primitive tests per pixel",
        unit: "primitive tests",
        values: Values::Counts(|film, strip, counts| {
            film.counts(strip, Counter::PrimitiveTests, counts);
        }),
    },
    Measure {
        array: "rays",
        name: "rays per pixel",
        axis: "Rays per pixel",
        unit: "rays",
        values: Values::Counts(Film::rays),
    },
];

impl Measure {
    /// Returns the two preferred metrics among those that are not zero in the
    /// film: without a hierarchy, for example, there are no node visits. `None`
    /// for a film without cost.
    pub(super) fn best_two(film: &Film) -> Option<[Self; 2]> {
        let mut shown = MEASURES.into_iter().filter(|measure| match measure.values {
            Values::Times(_) => film.cost.has_time(),
            Values::Counts(counts) => {
                let mut of_strip = Vec::new();
                film.strips.iter().any(|strip| {
                    counts(film, strip, &mut of_strip);
                    of_strip.iter().any(|&count| count > 0)
                })
            }
        });
        Some([shown.next()?, shown.next()?])
    }

    /// Returns its values, row-major, row 0 on top; counts above 2^24 are rounded.
    pub(super) fn of(self, film: &Film) -> Vec<f32> {
        match self.values {
            Values::Times(array) => film.rows(array).collect::<Vec<_>>().concat(),
            Values::Counts(counts) => {
                let (mut of_strip, mut all) = (Vec::new(), Vec::new());
                for strip in &film.strips {
                    counts(film, strip, &mut of_strip);
                    all.extend(of_strip.iter().map(|&count| count as f32));
                }
                all
            }
        }
    }

    /// Formats one of its values, or a sum of them; a time with its unit.
    pub(super) fn label(self, value: f64) -> String {
        match self.values {
            Values::Times(_) => numbers::duration(Duration::from_nanos(value as u64)),
            Values::Counts(_) => numbers::count(value as u64),
        }
    }
}
