//! Attributes the cost of observed rays.

use super::CostAttribution;
use super::attributed_cost::{AttributedCost, AttributionRule, Hierarchy, Visits, Work};
use super::tally::{Tally, TallyCache};
use crate::attribution::{PathObserver, RayTree, TracedRay};
use scene::build::Sensor;
use scene::config::{OptionalOutput, Outputs};
use tracer::accel::{BvhNode, Hit, TraversalStep};
use tracer::cost::{Clock, RayKind, StepCounter, StepCounts};
use tracer::trace::Tracer;
use world::scene::{Instances, Primitive, Scene};

/// Sums that all threads add to.
pub(super) struct Tallies {
    /// Four [`Work`] for each [`AttributionRule`] of each object.
    objects: Tally<5>,
    materials: Tally<5>,
    primitives: Option<Tally<3>>,
    /// Indexed by [`BvhNode::id`], the node's cache line.
    lines: Option<Tally<3>>,
    /// The ID of the first node of instanced meshes; greater than all IDs if the scene has no
    /// instanced meshes.
    first_lower_id: u32,
    /// True if the steps of each pixel are counted.
    pub(super) keeps_counts: bool,
}

/// Rows per object or material.
const N_ROWS: usize = AttributionRule::ALL.len() * N_KINDS;
const N_KINDS: usize = RayKind::ALL.len();

impl Tallies {
    pub(super) fn new(scene: &Scene, nodes: Option<&[BvhNode]>, outputs: &Outputs) -> Self {
        let n_lines = |nodes: &[BvhNode]| nodes.last().map_or(0, |last| last.id as usize + 1);
        let primitives = outputs.has(OptionalOutput::Surface);
        Self {
            objects: Tally::new(N_ROWS * (scene.n_objects() + 1)),
            materials: Tally::new(N_ROWS * (scene.n_materials() + 1)),
            primitives: primitives.then(|| Tally::new(scene.primitives.len())),
            lines: nodes.map(|nodes| Tally::new(n_lines(nodes))),
            first_lower_id: nodes
                .and_then(|nodes| nodes.iter().find(|node| node.mesh.is_some()))
                .map_or(u32::MAX, |first| first.id),
            keeps_counts: outputs.has(OptionalOutput::Tests),
        }
    }

    pub(super) fn into_attribution(
        self,
        nodes: Option<Vec<BvhNode>>,
        step_counts: Vec<StepCounts>,
    ) -> CostAttribution {
        let hierarchy = nodes.zip(self.lines).map(|(nodes, lines)| {
            let lines = lines.into_rows(visits);
            let visits = nodes.iter().map(|node| lines[node.id as usize]).collect();
            Hierarchy { nodes, visits }
        });
        CostAttribution {
            objects: accounts(self.objects),
            materials: accounts(self.materials),
            primitives: self.primitives.map(|tally| tally.into_rows(visits)),
            hierarchy,
            step_counts,
        }
    }
}

fn visits([n, n_hits, time_ps]: [u64; 3]) -> Visits {
    Visits { n, n_hits, time_ps }
}

fn accounts(tally: Tally<5>) -> Vec<AttributedCost> {
    let work = |[rays, node_visits, primitive_tests, time_ps, pixel_units]: [u64; 5]| Work {
        rays,
        node_visits,
        primitive_tests,
        time_ps,
        pixel_units,
    };
    let rows = tally.into_rows(work);
    let account = |rows: &[Work]| AttributedCost {
        work: std::array::from_fn(|charge| {
            std::array::from_fn(|kind| rows[N_KINDS * charge + kind])
        }),
    };
    rows.chunks_exact(N_ROWS).map(account).collect()
}

/// Observes pixels on one thread and attributes the cost of their rays.
pub(super) struct Attributor<'a> {
    observer: PathObserver<'a>,
    tree: RayTree,
    groups: ObjectTallies<'a>,
    steps: Steps<'a>,
}

impl<'a> Attributor<'a> {
    pub(super) fn new(
        tracer: Tracer<'a>,
        sensor: &Sensor,
        clock: Option<&'a Clock>,
        tallies: &'a Tallies,
    ) -> Self {
        let scene = tracer.scene;
        let observer = PathObserver::new(tracer, sensor, clock);
        let needs_steps =
            tallies.keeps_counts || tallies.primitives.is_some() || tallies.lines.is_some();
        Self {
            observer: if needs_steps {
                observer
            } else {
                observer.without_steps()
            },
            tree: RayTree::default(),
            groups: ObjectTallies {
                primitives: &scene.primitives,
                background: [scene.n_objects() as u32, scene.n_materials() as u32],
                accounts: [
                    TallyCache::new(&tallies.objects),
                    TallyCache::new(&tallies.materials),
                ],
            },
            steps: Steps {
                instances: scene.instances.as_ref(),
                first_lower: scene
                    .instances
                    .as_ref()
                    .map_or(u32::MAX, Instances::first_triangle),
                first_lower_id: tallies.first_lower_id,
                primitives: tallies.primitives.as_ref().map(TallyCache::new),
                lines: tallies.lines.as_ref().map(TallyCache::new),
            },
        }
    }

    /// Attributes the cost of a pixel's rays, which have this number of samples, if given; whose
    /// times are scaled to a sum of `time_ns`, if given; and adds their steps to `counts`, if given.
    /// Returns the number of rays.
    pub(super) fn pixel(
        &mut self,
        place: (u32, u32),
        n_samples: Option<u32>,
        time_ns: Option<f32>,
        mut counts: Option<&mut StepCounts>,
    ) -> u64 {
        // Observe the rays of the pixel.
        match n_samples {
            Some(n) => self.observer.observe_samples(place, n, &mut self.tree),
            None => self.observer.observe(place, &mut self.tree),
        }
        let rays = &self.tree.rays;
        // Scale their times to the time of the pixel.
        let observed_ns: f64 = rays.iter().map(|ray| f64::from(ray.time_ns)).sum();
        let ps = match time_ns {
            Some(time_ns) if observed_ns > 0.0 => 1e3 * f64::from(time_ns) / observed_ns,
            _ => 0.0,
        };
        let n_samples = rays.last().map_or(1, |ray| u64::from(ray.sample) + 1);
        let share = (Work::PIXEL_UNIT + n_samples / 2) / n_samples;
        let mut primary = self.groups.background;
        // Attribute each ray to objects, by both rules, and its steps to nodes and primitives.
        for ray in rays {
            let hit = self.groups.object_and_material(ray.hit);
            // The camera ray is the first ray of a sample.
            if ray.kind == RayKind::Camera {
                primary = hit;
            }
            let time_ps = (f64::from(ray.time_ns) * ps).round() as u64;
            self.groups
                .attribute(AttributionRule::Primary, primary, ray, [time_ps, share]);
            self.groups
                .attribute(AttributionRule::Hit, hit, ray, [time_ps, share]);
            let steps = self.tree.steps_of(ray);
            self.steps.add(ray, steps, time_ps);
            if let Some(counts) = &mut counts {
                self.steps.count(steps, counts);
            }
        }
        rays.len() as u64
    }
}

/// The tallies of objects and materials.
struct ObjectTallies<'a> {
    primitives: &'a [Primitive],
    /// The object and the material that represent the background.
    background: [u32; 2],
    /// The tallies of objects and of materials.
    accounts: [TallyCache<'a, 5>; 2],
}

impl ObjectTallies<'_> {
    /// Returns the object and the material of a hit.
    fn object_and_material(&self, hit: Option<Hit>) -> [u32; 2] {
        hit.map_or(self.background, |hit| {
            let primitive = &self.primitives[hit.primitive as usize];
            [primitive.object.0, primitive.material.0]
        })
    }

    /// Attributes a ray, with its time and its share of the pixel, to an object and a material.
    fn attribute(
        &mut self,
        charge: AttributionRule,
        to: [u32; 2],
        ray: &TracedRay,
        [time_ps, share]: [u64; 2],
    ) {
        let work = [
            1,
            ray.node_visits.into(),
            ray.primitive_tests.into(),
            time_ps,
            if ray.kind == RayKind::Camera {
                share
            } else {
                0
            },
        ];
        for (counter, id) in self.accounts.iter_mut().zip(to) {
            let row = N_ROWS as u32 * id + N_KINDS as u32 * charge as u32 + ray.kind as u32;
            counter.add(row, work);
        }
    }
}

/// The tallies of nodes and primitives, if requested.
struct Steps<'a> {
    instances: Option<&'a Instances>,
    /// The index of the first primitive, and the ID of the first node, of instanced meshes; greater
    /// than all others if the scene has no instanced meshes.
    first_lower: u32,
    first_lower_id: u32,
    primitives: Option<TallyCache<'a, 3>>,
    lines: Option<TallyCache<'a, 3>>,
}

impl Steps<'_> {
    /// Divides a ray's time evenly among its steps.
    fn add(&mut self, ray: &TracedRay, steps: &[TraversalStep], time_ps: u64) {
        let n_steps = u64::from(ray.node_visits) + u64::from(ray.primitive_tests);
        // Whole picoseconds whose sum is the ray's time.
        let mut rest = time_ps.checked_rem(n_steps).unwrap_or(0);
        let mut share = || {
            let one_more = rest.min(1);
            rest -= one_more;
            time_ps / n_steps + one_more
        };
        // The last leaf, and the last leaf of the upper level.
        let (mut leaf, mut upper_leaf) = (None, None);
        for step in steps {
            match *step {
                TraversalStep::Node { id, boxes } => {
                    let is_hit = (boxes.n_hits > 0).into();
                    add(&mut self.lines, id, [1, is_hit, share()])
                }
                TraversalStep::Leaf { id, hit } => {
                    leaf = Some(id);
                    if id < self.first_lower_id {
                        upper_leaf = leaf;
                    }
                    add(&mut self.lines, id, [1, hit.into(), 0]);
                }
                TraversalStep::Test { primitive, hit } => {
                    let time_ps = share();
                    add(&mut self.primitives, primitive, [1, hit.into(), time_ps]);
                    // The tests in an instance may come between the tests of a leaf of the upper
                    // level.
                    if primitive < self.first_lower {
                        leaf = upper_leaf;
                    }
                    // Primitives outside of the hierarchy are tested before all leaves.
                    if let Some(leaf) = leaf {
                        add(&mut self.lines, leaf, [0, 0, time_ps]);
                    }
                }
            }
        }
    }
}

impl Steps<'_> {
    /// Adds the steps of a ray to the counts of its pixel.
    fn count(&self, steps: &[TraversalStep], counts: &mut StepCounts) {
        let mut add = |counter: StepCounter, n: u32| {
            let count = &mut counts[counter as usize];
            *count = count.saturating_add(n);
        };
        // Primitives of the upper level come first, with the instances at their end.
        let is_instance = |primitive| {
            let is_box = |instances: &Instances| instances.by_box(primitive).is_some();
            primitive < self.first_lower && self.instances.is_some_and(is_box)
        };
        // A shadow ray that has found a hit skips the other instances of its leaf, and ends.
        let is_inside = |step: &TraversalStep| match *step {
            TraversalStep::Test { primitive, .. } => primitive >= self.first_lower,
            TraversalStep::Node { .. } | TraversalStep::Leaf { .. } => true,
        };
        for (i, step) in steps.iter().enumerate() {
            match *step {
                TraversalStep::Node { boxes, .. } => {
                    add(StepCounter::BoxTests, boxes.n.into());
                    add(StepCounter::BoxHits, boxes.n_hits.into());
                }
                TraversalStep::Test { primitive, .. } if is_instance(primitive) => {
                    let is_visited = steps.get(i + 1).is_some_and(is_inside);
                    add(StepCounter::InstanceVisits, is_visited.into());
                }
                TraversalStep::Test { hit, .. } => add(StepCounter::PrimitiveHits, hit.into()),
                TraversalStep::Leaf { .. } => {}
            }
        }
    }
}

fn add(counter: &mut Option<TallyCache<3>>, row: u32, amounts: [u64; 3]) {
    if let Some(counter) = counter {
        counter.add(row, amounts);
    }
}
