//! A pixel's rays → sums.

use super::Ledger;
use super::account::{Account, Charge, Hierarchy, Visits, Work};
use super::tally::{Counter, Tally};
use crate::accel::{Accel, BvhNode, Hit, TraversalStep};
use crate::config::{Extra, Image, Outputs};
use crate::cost::{Clock, RayKind};
use crate::observe::{Observer, RayTree, TracedRay};
use crate::scene::{Primitive, Scene};

/// What all threads write to.
pub(super) struct Tallies {
    /// Four [`Work`] for each [`Charge`] of each object.
    objects: Tally<4>,
    materials: Tally<4>,
    primitives: Option<Tally<3>>,
    /// By the lines of the hierarchy's memory, as [`BvhNode::id`].
    lines: Option<Tally<3>>,
}

/// Rows of an account.
const N_ROWS: usize = 8;

impl Tallies {
    pub(super) fn new(scene: &Scene, nodes: Option<&[BvhNode]>, outputs: &Outputs) -> Self {
        let n_lines = |nodes: &[BvhNode]| nodes.last().map_or(0, |last| last.id as usize + 1);
        let primitives = outputs.has(Extra::Surface);
        Self {
            objects: Tally::new(N_ROWS * (scene.n_objects() + 1)),
            materials: Tally::new(N_ROWS * (scene.materials.len() + 1)),
            primitives: primitives.then(|| Tally::new(scene.primitives.len())),
            lines: nodes.map(|nodes| Tally::new(n_lines(nodes))),
        }
    }

    pub(super) fn into_ledger(self, nodes: Option<Vec<BvhNode>>) -> Ledger {
        let hierarchy = nodes.zip(self.lines).map(|(nodes, lines)| {
            let lines = lines.into_rows(visits);
            let visits = nodes.iter().map(|node| lines[node.id as usize]).collect();
            Hierarchy { nodes, visits }
        });
        Ledger {
            objects: accounts(self.objects),
            materials: accounts(self.materials),
            primitives: self.primitives.map(|tally| tally.into_rows(visits)),
            hierarchy,
        }
    }
}

fn visits([n, n_hits, time_ps]: [u64; 3]) -> Visits {
    Visits { n, n_hits, time_ps }
}

fn accounts(tally: Tally<4>) -> Vec<Account> {
    let work = |[rays, node_visits, primitive_tests, time_ps]: [u64; 4]| Work {
        rays,
        node_visits,
        primitive_tests,
        time_ps,
    };
    let rows = tally.into_rows(work);
    let account = |rows: &[Work]| Account {
        work: std::array::from_fn(|charge| std::array::from_fn(|kind| rows[4 * charge + kind])),
    };
    rows.chunks_exact(N_ROWS).map(account).collect()
}

/// A thread that observes pixels and writes down what their rays cost.
pub(super) struct Keeper<'a> {
    observer: Observer<'a>,
    tree: RayTree,
    things: Things<'a>,
    steps: Steps<'a>,
}

impl<'a> Keeper<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        accel: &'a Accel<'a>,
        image: &Image,
        clock: Option<&'a Clock>,
        tallies: &'a Tallies,
    ) -> Self {
        let observer = Observer::new(scene, accel, image, clock);
        let needs_steps = tallies.primitives.is_some() || tallies.lines.is_some();
        Self {
            observer: if needs_steps {
                observer
            } else {
                observer.without_steps()
            },
            tree: RayTree::default(),
            things: Things {
                primitives: &scene.primitives,
                nothing: [scene.n_objects() as u32, scene.materials.len() as u32],
                accounts: [
                    Counter::new(&tallies.objects),
                    Counter::new(&tallies.materials),
                ],
            },
            steps: Steps {
                primitives: tallies.primitives.as_ref().map(Counter::new),
                lines: tallies.lines.as_ref().map(Counter::new),
            },
        }
    }

    /// Writes down what the pixel's rays cost, which took `time_ns`, if that is
    /// known. Gives the number of rays.
    pub(super) fn pixel(&mut self, place: (u32, u32), time_ns: Option<f32>) -> u64 {
        self.observer.observe(place, &mut self.tree);
        let rays = &self.tree.rays;
        let observed_ns: f64 = rays.iter().map(|ray| f64::from(ray.time_ns)).sum();
        let ps = match time_ns {
            Some(time_ns) if observed_ns > 0.0 => 1e3 * f64::from(time_ns) / observed_ns,
            _ => 0.0,
        };
        let mut seen = self.things.nothing;
        for ray in rays {
            let met = self.things.met(ray.hit);
            // A sample's camera ray comes first.
            if ray.kind == RayKind::Camera {
                seen = met;
            }
            let time_ps = (f64::from(ray.time_ns) * ps).round() as u64;
            self.things.charge(Charge::Primary, seen, ray, time_ps);
            self.things.charge(Charge::Hit, met, ray, time_ps);
            self.steps.add(ray, self.tree.steps_of(ray), time_ps);
        }
        rays.len() as u64
    }
}

/// Objects and materials.
struct Things<'a> {
    primitives: &'a [Primitive],
    /// The object and the material that stand for nothing.
    nothing: [u32; 2],
    /// Of objects and of materials.
    accounts: [Counter<'a, 4>; 2],
}

impl Things<'_> {
    /// The object and the material that were met.
    fn met(&self, hit: Option<Hit>) -> [u32; 2] {
        hit.map_or(self.nothing, |hit| {
            let primitive = &self.primitives[hit.primitive as usize];
            [primitive.object.0, primitive.material.0]
        })
    }

    /// Charges a ray to an object and a material.
    fn charge(&mut self, charge: Charge, to: [u32; 2], ray: &TracedRay, time_ps: u64) {
        let work = [
            1,
            ray.node_visits.into(),
            ray.primitive_tests.into(),
            time_ps,
        ];
        for (counter, thing) in self.accounts.iter_mut().zip(to) {
            let row = N_ROWS as u32 * thing + 4 * charge as u32 + ray.kind as u32;
            counter.add(row, work);
        }
    }
}

/// Nodes and primitives, where they are asked for.
struct Steps<'a> {
    primitives: Option<Counter<'a, 3>>,
    lines: Option<Counter<'a, 3>>,
}

impl Steps<'_> {
    /// Shares a ray's time out to its steps.
    fn add(&mut self, ray: &TracedRay, steps: &[TraversalStep], time_ps: u64) {
        let n_steps = u64::from(ray.node_visits) + u64::from(ray.primitive_tests);
        // Whole picoseconds that add up to the ray's.
        let mut rest = time_ps.checked_rem(n_steps).unwrap_or(0);
        let mut share = || {
            let one_more = rest.min(1);
            rest -= one_more;
            time_ps / n_steps + one_more
        };
        let mut leaf = None;
        for step in steps {
            match *step {
                TraversalStep::Node { id, hit } => {
                    add(&mut self.lines, id, [1, hit.into(), share()])
                }
                TraversalStep::Leaf { id, hit } => {
                    leaf = Some(id);
                    add(&mut self.lines, id, [1, hit.into(), 0]);
                }
                TraversalStep::Test { primitive, hit } => {
                    let time_ps = share();
                    add(&mut self.primitives, primitive, [1, hit.into(), time_ps]);
                    // What is outside the hierarchy is tested before all leaves.
                    if let Some(leaf) = leaf {
                        add(&mut self.lines, leaf, [0, 0, time_ps]);
                    }
                }
            }
        }
    }
}

fn add(counter: &mut Option<Counter<3>>, row: u32, amounts: [u64; 3]) {
    if let Some(counter) = counter {
        counter.add(row, amounts);
    }
}
