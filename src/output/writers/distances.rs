//! Distances of the hits.

use math::statistics::Histogram;
use render::film::Film;

/// Multiple of the median distance at which the horizon begins. A view of all points would show
/// nothing of a scene whose plane reaches to its horizon; within this distance, the scene still
/// fills most of the picture.
const HORIZON: f32 = 4.0;

/// The quantiles of the distances.
const PERCENT: [u64; 4] = [1, 50, 99, 100];

/// The distances of the hits along their camera rays, to .05 %.
#[derive(Debug, Clone, Copy)]
pub(super) struct Distances {
    /// The lower median; `None` without hits.
    pub(super) median: Option<f32>,
    /// Maximum distance that states show. ParaView clips points 1000 times nearer than the farthest
    /// one, and a plane has hits up to its horizon.
    pub(super) max_shown: f64,
}

impl Distances {
    /// Returns the distances of a film.
    pub(super) fn collect(film: &Film) -> Self {
        Self::from_histogram(&Histogram::count(film.values(|strip| &strip.distance)))
    }

    /// Returns the distances that a histogram counts; those without a hit are infinite.
    pub(super) fn from_histogram(distances: &Histogram) -> Self {
        let last = distances.n.saturating_sub(1);
        let quantiles = PERCENT.map(|percent| distances.at(last * percent / 100));
        let [Some(near), Some(median), Some(far), Some(farthest)] = quantiles else {
            return Self {
                median: None,
                max_shown: 1.0,
            };
        };
        let cut = f64::from(near) * 300.0;
        Self {
            median: Some(median),
            max_shown: cut.max(far.into()).min(2.0 * f64::from(farthest)),
        }
    }

    /// Returns true if a hit at this distance belongs to the horizon: it is more than four times as
    /// far as the median.
    pub(super) fn is_horizon(&self, distance: f32) -> bool {
        self.median
            .is_some_and(|median| distance > HORIZON * median)
    }
}
