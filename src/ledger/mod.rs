//! Pixels → what each object, material, primitive and node of the hierarchy
//! cost.
//!
//! After a picture is rendered, all of its rays are observed once more and
//! charged to the things that they had to do with. The counters are those of
//! the film, to the last one. So is the time: a ray's time is measured while it
//! is observed, and scaled so that the rays of a pixel take the `time_ns` that
//! the pixel took when nobody looked. A ray's time is shared out evenly to its
//! steps, visits of nodes and tests of primitives, whatever they were.

mod tally;
mod account;
mod keeper;

use rayon::prelude::*;

use crate::accel::{Accel, Bvh, BvhNode};
use crate::config::{Acceleration, Extra, Image, Outputs};
use crate::cost::Meter;
use crate::film::Film;
use crate::render::Progress;
use crate::scene::Scene;
use crate::stop;

pub use account::{Account, Charge, Hierarchy, Visits, Work};
use keeper::{Keeper, Tallies};

/// What was charged to whom.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    /// By [`ObjectId`](crate::scene::ObjectId); the last account is that of rays
    /// that met nothing.
    pub objects: Vec<Account>,
    /// By [`MaterialId`](crate::scene::MaterialId); the last account is that of
    /// rays that met nothing.
    pub materials: Vec<Account>,
    /// Of each primitive of the scene, if the surface is asked for.
    pub primitives: Option<Vec<Visits>>,
    /// Of each node, if the hierarchy is asked for.
    pub hierarchy: Option<Hierarchy>,
}

impl Ledger {
    /// Bytes of memory for each primitive, at most.
    pub fn bytes_per_primitive(outputs: &Outputs, acceleration: Acceleration) -> usize {
        let of_surface = if outputs.has(Extra::Surface) {
            size_of::<Visits>()
        } else {
            0
        };
        // Sums by the ids of nodes, which have gaps; then those of each node.
        let per_id = 2 * size_of::<Visits>() + size_of::<BvhNode>();
        let of_nodes = match acceleration {
            Acceleration::Bvh(quality) if outputs.has(Extra::Bvh) => {
                Bvh::ids_per_primitive(quality) * per_id
            }
            _ => 0,
        };
        of_surface + of_nodes
    }

    /// Whether something is asked for that is written of a ledger.
    pub fn is_wanted(outputs: &Outputs) -> bool {
        [Extra::Objects, Extra::Surface, Extra::Bvh]
            .into_iter()
            .any(|extra| outputs.has(extra))
    }

    /// Observes all rays of a film that was rendered of this scene, with
    /// counters, on the current rayon pool. `report` hears of each row, from any
    /// thread.
    pub fn keep(
        (scene, accel, image): (&Scene, &Accel, &Image),
        (film, meter): (&Film, &Meter),
        outputs: &Outputs,
        report: impl Fn(Progress) + Sync,
    ) -> Self {
        let nodes = outputs.has(Extra::Bvh).then(|| accel.nodes());
        let tallies = Tallies::new(scene, nodes.as_deref(), outputs);
        let times: Vec<&[f32]> = film.rows(|strip| &strip.time_ns).collect();
        let keeper = || Keeper::new(scene, accel, image, meter.clock(), &tallies);
        (0..film.grid.height)
            .into_par_iter()
            .for_each_init(keeper, |keeper, y| {
                let n_rays = (0..film.grid.width)
                    .take_while(|_| !stop::is_requested())
                    .map(|x| {
                        let time_ns = times.get(y as usize).map(|row| row[x as usize]);
                        keeper.pixel((x, y), time_ns)
                    })
                    .sum();
                report(Progress {
                    n_pixels: film.grid.width.into(),
                    n_rays,
                });
            });
        tallies.into_ledger(nodes)
    }
}
