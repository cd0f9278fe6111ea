//! Cost attribution: the cost of each object, material, primitive and node.
//!
//! After a picture is rendered, all of its rays are traced once more with an observer, and their
//! cost is attributed to the objects, materials, primitives and nodes involved. The counters sum
//! exactly to the counters of the film. So do the times: the time of each observed ray is scaled so
//! that the rays of a pixel sum to its `time_ns`, which was measured without an observer. The time
//! of a ray is divided evenly among its steps, the node visits and primitive tests.
//!
//! The [`PathObserver`] follows paths in the loop of single rays, with the same rays, hits and counters.
//! It is slow and records everything: the hit of each ray, the nodes and primitives it was tested
//! against, its time, and its contribution to the pixel.

mod tree;
mod observer;
mod many;
mod tally;
mod attributed_cost;
mod attributor;

use rayon::prelude::*;

use crate::film::Film;
use crate::tiles::{OnProgress, Progress};
use base::stop;
use scene::build::Sensor;
use scene::config::{Acceleration, OptionalOutput, Outputs};
use tracer::accel::{Bvh, BvhNode};
use tracer::cost::{Meter, StepCounts};
use tracer::trace::Tracer;

pub use attributed_cost::{AttributedCost, AttributionRule, Hierarchy, Visits, Work};
use attributor::{Attributor, Tallies};
pub use many::{ObservedPixel, TooManyRays};
pub use observer::PathObserver;
pub use tree::{RayTree, TracedRay};

/// The cost of a picture, attributed to the parts of its scene.
#[derive(Debug, Clone, PartialEq)]
pub struct CostAttribution {
    /// Indexed by [`ObjectId`](world::scene::ObjectId); the last entry is for rays without a hit.
    pub objects: Vec<AttributedCost>,
    /// Indexed by [`MaterialId`](world::scene::MaterialId); the last entry is for rays without a
    /// hit.
    pub materials: Vec<AttributedCost>,
    /// For each primitive of the scene, if [`OptionalOutput::Surface`] is requested.
    pub primitives: Option<Vec<Visits>>,
    /// For each node, if [`OptionalOutput::Bvh`] is requested.
    pub hierarchy: Option<Hierarchy>,
    /// The steps of each pixel, row-major, row 0 on top, if [`OptionalOutput::Tests`] is
    /// requested; otherwise empty.
    pub step_counts: Vec<StepCounts>,
}

impl CostAttribution {
    /// Returns the expected bytes of memory per primitive.
    pub fn bytes_per_primitive(outputs: &Outputs, acceleration: Acceleration) -> usize {
        let of_surface = if outputs.has(OptionalOutput::Surface) {
            size_of::<Visits>()
        } else {
            0
        };
        // Sums by node ID, with gaps: about a third are of nodes, which are listed with their sums.
        let per_id = size_of::<Visits>() + (size_of::<Visits>() + size_of::<BvhNode>()) / 3;
        let of_nodes = match acceleration {
            Acceleration::Bvh(quality) if outputs.has(OptionalOutput::Bvh) => {
                (Bvh::ids_per_primitive(quality) * per_id as f64) as usize
            }
            _ => 0,
        };
        of_surface + of_nodes
    }

    /// Returns true if the requested outputs need a cost attribution.
    pub fn is_requested(outputs: &Outputs) -> bool {
        outputs.iter().any(OptionalOutput::needs_attribution)
    }

    /// Observes all rays of a film of this scene, which was rendered with counters, on the current
    /// rayon pool. Any thread calls `report` after each row.
    pub fn measure(
        tracer: Tracer,
        sensor: &Sensor,
        film: &Film,
        meter: &Meter,
        outputs: &Outputs,
        report: OnProgress,
    ) -> Self {
        let nodes = outputs.has(OptionalOutput::Bvh).then(|| {
            let mut nodes = tracer.accel.nodes();
            tracer.accel.measure_overlap(&mut nodes);
            nodes
        });
        let tallies = Tallies::new(tracer.scene, nodes.as_deref(), outputs);
        let times: Vec<&[f32]> = film.rows(|strip| &strip.time_ns).collect();
        let samples = if film.counts_samples() {
            film.samples()
        } else {
            Vec::new()
        };
        let attributor = || Attributor::new(tracer, sensor, meter.clock(), &tallies);
        let width = film.grid.width;
        let n_counts = if tallies.keeps_counts { width } else { 0 };
        let rows = (0..film.grid.height).into_par_iter();
        let step_counts: Vec<Vec<StepCounts>> = rows
            .map_init(attributor, |attributor, y| {
                let mut counts = vec![StepCounts::default(); n_counts as usize];
                let n_rays = (0..width)
                    .take_while(|_| !stop::is_requested())
                    .filter(|&x| film.is_rendered(x, y))
                    .map(|x| {
                        let time_ns = times.get(y as usize).map(|row| row[x as usize]);
                        let pixel = y as usize * width as usize + x as usize;
                        let n_samples = samples.get(pixel).copied();
                        let counts = counts.get_mut(x as usize);
                        attributor.pixel((x, y), n_samples, time_ns, counts)
                    })
                    .sum();
                report(Progress::from_pixels(width.into(), n_rays));
                counts
            })
            .collect();
        tallies.into_attribution(nodes, step_counts.concat())
    }
}
