//! Brute force, the reference for every other way to find hits.

use std::fmt::Debug;

use math::simd::Simd;
use proptest::prelude::*;
use scene::config::{Acceleration, Quality};
use tracer::accel::{Accel, Hit, ShadowRay, ShadowStream};
use tracer::cost::{Cost, StreamProbe, Traversals};
use world::geometry::{Ray, RayStream};
use world::scene::{ObjectId, World};

/// A query's answer and its cost.
type Answer<A> = (A, Cost);

/// The qualities of hierarchies.
pub const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Balanced, Quality::High];

/// The hierarchy of this quality with every instruction set of the CPU.
pub fn kernels<'a>(world: impl Into<World<'a>>, quality: Quality) -> Vec<Accel<'a>> {
    on_all_sets(&Accel::new(world, Acceleration::Bvh(quality)))
}

/// A structure with every instruction set of the CPU.
fn on_all_sets<'a>(accel: &Accel<'a>) -> Vec<Accel<'a>> {
    let on = |simd| accel.clone().with_simd(simd);
    Simd::available().into_iter().map(on).collect()
}

/// Checks that all kernels find the hits of brute force in hierarchies of each
/// quality, for single rays and for streams, and that they count the same for
/// each ray.
pub fn compare<'a>(world: impl Into<World<'a>>, rays: &[Ray]) -> Result<(), TestCaseError> {
    let world = world.into();
    compare_built(world, rays, |quality| {
        Accel::new(world, Acceleration::Bvh(quality))
    })
}

/// Does what [`compare`] does, with hierarchies that `build` gives.
pub fn compare_built<'a>(
    world: impl Into<World<'a>>,
    rays: &[Ray],
    build: impl Fn(Quality) -> Accel<'a>,
) -> Result<(), TestCaseError> {
    let world = world.into();
    let built = QUALITIES.map(|quality| (quality, on_all_sets(&build(quality))));
    let hits = agree(world, &built, |accel| {
        [nearest(accel, rays), nearest_stream(accel, rays)]
    })?;
    let rays = shadow_rays(rays, &hits);
    agree(world, &built, |accel| {
        [occluded(accel, &rays), occluded_stream(accel, &rays)]
    })?;
    Ok(())
}

/// Checks that both results of `answer` agree with each other and with brute force;
/// returns the answers of brute force.
fn agree<A: PartialEq + Debug>(
    world: World,
    built: &[(Quality, Vec<Accel>)],
    answer: impl Fn(&Accel) -> [Vec<Answer<A>>; 2],
) -> Result<Vec<Answer<A>>, TestCaseError> {
    let [expected, in_stream] = answer(&Accel::new(world, Acceleration::BruteForce));
    prop_assert_eq!(&in_stream, &expected);
    for (quality, kernels) in built {
        let all: Vec<_> = kernels.iter().flat_map(&answer).collect();
        for answers in &all {
            prop_assert_eq!(answers.len(), expected.len());
            for (i, (found, cost)) in answers.iter().enumerate() {
                prop_assert_eq!(found, &expected[i].0, "{:?} ray {}", quality, i);
                prop_assert_eq!(cost, &all[0][i].1, "{:?} ray {}", quality, i);
            }
        }
    }
    Ok(expected)
}

/// Rays that end at a hit, before it, just behind it or at infinity, and that
/// ignore no object or one.
fn shadow_rays(rays: &[Ray], hits: &[Answer<Option<Hit>>]) -> Vec<ShadowRay> {
    let ends = |hit: Option<Hit>| {
        let t = hit.map_or(2.0, |hit| hit.t);
        [t, 0.5 * t, t.next_up(), f32::INFINITY]
    };
    let mut shadow_rays = Vec::new();
    for (ray, (hit, _)) in rays.iter().zip(hits) {
        for t_max in ends(*hit) {
            for ignored in [None, Some(ObjectId(0))] {
                shadow_rays.push(ShadowRay {
                    ray: *ray,
                    t_max,
                    ignored,
                });
            }
        }
    }
    shadow_rays
}

fn nearest(accel: &Accel, rays: &[Ray]) -> Vec<Answer<Option<Hit>>> {
    let answer = |ray| {
        let mut cost = Cost::default();
        (accel.nearest(ray, &mut cost), cost)
    };
    rays.iter().map(answer).collect()
}

fn occluded(accel: &Accel, rays: &[ShadowRay]) -> Vec<Answer<bool>> {
    let answer = |ShadowRay {
                      ray,
                      t_max,
                      ignored,
                  }: &ShadowRay| {
        let mut cost = Cost::default();
        (accel.occluded(ray, *t_max, *ignored, &mut cost), cost)
    };
    rays.iter().map(answer).collect()
}

fn nearest_stream(accel: &Accel, rays: &[Ray]) -> Vec<Answer<Option<Hit>>> {
    let (mut hits, mut costs) = (Vec::new(), RayCosts::new(rays.len()));
    let rays: RayStream = rays.iter().copied().collect();
    accel.nearest_stream(&rays, &mut hits, &mut costs);
    costs.zip(hits)
}

fn occluded_stream(accel: &Accel, rays: &[ShadowRay]) -> Vec<Answer<bool>> {
    let (mut occluded, mut costs) = (Vec::new(), RayCosts::new(rays.len()));
    let rays: ShadowStream = rays.iter().copied().collect();
    accel.occluded_stream(&rays, &mut occluded, &mut costs);
    costs.zip(occluded)
}

/// The cost of each ray of a stream; `None` before it is reported.
struct RayCosts(Vec<Option<Cost>>);

impl RayCosts {
    fn new(n_rays: usize) -> Self {
        Self(vec![None; n_rays])
    }

    fn zip<A>(self, answers: Vec<A>) -> Vec<Answer<A>> {
        assert_eq!(answers.len(), self.0.len());
        let costs = self
            .0
            .into_iter()
            .map(|cost| cost.expect("each ray reports its cost"));
        answers.into_iter().zip(costs).collect()
    }
}

impl StreamProbe for RayCosts {
    const COUNTS: bool = true;

    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>) {
        traversals.for_each(|i, node_visits, primitive_tests| {
            let cost = Cost {
                node_visits: node_visits.into(),
                primitive_tests: primitive_tests.into(),
                ..Cost::default()
            };
            let before = self.0[first + i].replace(cost);
            assert_eq!(before, None, "each ray reports its cost once");
        });
    }
}
