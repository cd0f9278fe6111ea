//! Coherent rays through the hierarchy together.
//!
//! Wald, Slusallek, Benthin and Wagner, "Interactive Rendering with Coherent
//! Ray Tracing", Computer Graphics Forum 20(3), 2001. [`N_RAYS`] rays that
//! follow each other in a batch and go the same way (`columns`) share one stack
//! (`together`). At a node the eight boxes are tested, one a lane, against the
//! beam that holds all of the rays (`beam`). Those that it meets wait; when a
//! box's turn comes it is tested against the rays, one a lane (`rays`), and so
//! are a leaf's triangles or spheres, one after the other (`leaf`).
//!
//! # Why nothing changes for a ray
//!
//! Each ray visits what it would visit alone, in the same order and with the
//! same limit, so that its answer and its counters are those of
//! [`Traversal`](super::Traversal):
//!
//! - The order of a node's children depends on nothing but the signs of the
//!   ray's direction, which all rays of a packet share. So the packet's way,
//!   less the nodes where a ray is not active, is the way of that ray.
//! - Alone a ray goes into a child if `enter <= exit` and `enter <= then`, its
//!   limit when the parent was visited, and `enter <= now`, its limit when the
//!   child's turn comes. Limits never grow, so that the one test with `now`, of
//!   the rays that were active in the parent, leaves the same rays. Its
//!   arithmetic is that of [`Slabs`](super::slab::Slabs), to the bit.
//! - The beam rejects no child that a ray of the packet enters: see
//!   [`Beam`](beam::Beam).
//! - A leaf's tests are those of [`Blocks`](super::block::Blocks), to the bit,
//!   and what is found does not depend on their order.

mod columns;
mod rays;
mod beam;
mod leaf;
mod together;

use super::batch::Batch;
use crate::accel::search::Query;
use crate::accel::simd::{InstructionSet, N_LANES, Work};
use crate::cost::StreamProbe;
use columns::Columns;
use rays::Rays;
use together::{Stack, Together};

/// Registers of rays.
const N_HALVES: usize = 2;

/// Rays of a packet.
const N_RAYS: usize = N_HALVES * N_LANES;

/// Fewer rays are better off in the stream.
const MIN_RAYS: u32 = 8;

/// Finds the coherent rays of a batch and answers their queries.
pub(in crate::accel) struct Packets<'a, Q: Query, P>(pub(in crate::accel) Batch<'a, Q, P>);

impl<Q: Query, P: StreamProbe> Work for Packets<'_, Q, P> {
    /// The numbers of the queries that are left.
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Vec<u32> {
        let Self(mut batch) = self;
        let n_queries = batch.queries.len() as u32;
        let mut others = Vec::with_capacity(n_queries as usize);
        if batch.arena.is_empty() {
            others.extend(0..n_queries);
            return others;
        }
        let (mut columns, mut stack) = (Columns::EMPTY, Stack::new());
        // What the packets so far have saved. Where rays part soon the first one
        // tells, and the rest is left to the stream.
        let mut gain = 0;
        let mut first = 0;
        let (packets, _) = batch.queries.as_chunks::<N_RAYS>();
        for queries in packets {
            let next = first + N_RAYS as u32;
            if gain < 0 || !columns::may_be_alike(queries) {
                others.extend(first..next);
                first = next;
                continue;
            }
            columns.fill(queries);
            let mut alike = columns.like_first(set);
            if alike.count_ones() >= MIN_RAYS {
                columns.replace_by_first(!alike);
                let rays = Rays::new(set, &columns, batch.arena.largest());
                let mut together = Together::new(&rays, queries, batch.primitives);
                let active = together.test_always(batch.always) & alike;
                if active != 0 {
                    gain += together.descend::<P>(batch.arena, active, &mut stack);
                }
                together.answer(&mut batch, first as usize, alike);
            } else {
                alike = 0;
            }
            let mut left = !alike;
            while left != 0 {
                others.push(first + left.trailing_zeros());
                left &= left - 1;
            }
            first = next;
        }
        others.extend(first..n_queries);
        others
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::accel::bvh::Bvh;
    use crate::accel::simd::Simd;
    use crate::config::Quality;
    use crate::cost::NoProbe;
    use crate::geometry::{Ray, Shape, Sphere};
    use crate::scene::{MaterialId, ObjectId, Primitive};

    /// The rays that no packet takes.
    fn left(simd: Simd, rays: &[Ray]) -> Vec<u32> {
        let sphere = |x| Sphere {
            center: Vec3::new(x as f32, 0.0, -5.0),
            radius: 0.4,
        };
        let primitive =
            |x| Primitive::new(Shape::Sphere(sphere(x)), None, ObjectId(0), MaterialId(0));
        let primitives: Vec<_> = (-9..9).map(primitive).collect();
        let bvh = Bvh::new(&primitives, (0..18).collect(), Quality::Fast, |_| {}).unwrap();
        let mut answers = vec![None; rays.len()];
        simd.run(Packets(Batch {
            arena: bvh.arena(),
            primitives: &primitives,
            always: &[],
            queries: rays,
            answers: &mut answers,
            probe: &mut NoProbe,
        }))
    }

    #[test]
    fn packets_take_what_goes_the_same_way() {
        let ray = |i: u32| Ray {
            origin: Vec3::ZERO,
            direction: Vec3::new(0.1 + 0.001 * i as f32, -0.0, -1.0).normalize(),
        };
        let mut rays: Vec<Ray> = (0..40).map(ray).collect();
        rays[3].direction *= -1.0;
        // The same way, but into another octant.
        rays[20].direction.y = 0.0;
        for simd in Simd::available() {
            let expected = [3, 20, 32, 33, 34, 35, 36, 37, 38, 39];
            assert_eq!(left(simd, &rays), expected, "{simd}");
            let apart: Vec<Ray> = (0..40)
                .map(|i| Ray {
                    origin: Vec3::ZERO,
                    direction: Vec3::new(i as f32 - 20.0, 5.0, -4.0).normalize(),
                })
                .collect();
            assert_eq!(left(simd, &apart).len(), 40, "{simd}");
        }
    }
}
