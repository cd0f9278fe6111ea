//! A check that two kernels give the same answers.

use std::fmt;

use crate::kernel::Kernel;
use crate::rays::Rays;
use tracer::accel::Hit;

/// Tolerance of distances, relative to the distance: the kernels round differently.
const TOLERANCE: f32 = 1e-4;

/// One in this number of rays may differ: rounding decides if rays that graze an edge hit.
const ONE_IN: usize = 1000;

/// Number of rays for which the answers of two kernels differ.
#[derive(Debug, Clone, Copy)]
pub struct Agreement {
    n_rays: usize,
    /// Rays that hit for only one kernel.
    n_one_misses: usize,
    /// Rays that hit different primitives at different distances.
    n_elsewhere: usize,
}

impl Agreement {
    /// Traces all rays with both kernels.
    pub fn of(ours: &dyn Kernel, theirs: &dyn Kernel, rays: &Rays) -> Self {
        let mut agreement = Self {
            n_rays: rays.len(),
            n_one_misses: 0,
            n_elsewhere: 0,
        };
        match rays {
            Rays::Nearest(rays) => {
                let hits = [ours, theirs].map(|kernel| {
                    let mut hits = Vec::new();
                    kernel.nearest(rays, &mut hits);
                    hits
                });
                for pair in hits[0].iter().zip(&hits[1]) {
                    match pair {
                        (Some(a), Some(b)) if !is_same(a, b) => agreement.n_elsewhere += 1,
                        (a, b) => agreement.n_one_misses += usize::from(a.is_some() != b.is_some()),
                    }
                }
            }
            Rays::Any(rays) => {
                let [a, b] = [ours, theirs].map(|kernel| {
                    let mut occluded = Vec::new();
                    kernel.any(rays, &mut occluded);
                    occluded
                });
                agreement.n_one_misses = a.iter().zip(&b).filter(|(a, b)| a != b).count();
            }
        }
        agreement
    }

    /// Returns true if rounding explains the differences.
    pub fn is_good(&self) -> bool {
        self.n_different() * ONE_IN <= self.n_rays
    }

    /// Returns the number of rays that differ.
    pub fn n_different(&self) -> usize {
        self.n_one_misses + self.n_elsewhere
    }
}

fn is_same(a: &Hit, b: &Hit) -> bool {
    a.primitive == b.primitive || (a.t - b.t).abs() <= TOLERANCE * a.t.max(b.t)
}

impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            n_rays,
            n_one_misses,
            n_elsewhere,
        } = self;
        write!(
            f,
            "of {n_rays} rays {n_one_misses} hit for one kernel only, {n_elsewhere} hit elsewhere"
        )
    }
}
