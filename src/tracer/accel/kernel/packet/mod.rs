//! Packet traversal: coherent rays traverse the hierarchy as one.
//!
//! Wald, Slusallek, Benthin and Wagner, "Interactive Rendering with Coherent Ray Tracing", Computer
//! Graphics Forum 20(3), 2001. [`N_RAYS`] coherent rays that are consecutive in a batch (`soa`)
//! share one stack (`traversal`). A visit to a node tests its eight boxes, one per lane, against a
//! beam that contains all rays (`beam`), and pushes the boxes that the beam hits. A popped box is
//! tested against the rays, one per lane (`boxes`); so are the primitives of a leaf, one after the
//! other (`triangles`, `spheres`), and, before the hierarchy, planes (`planes`). Hits change the
//! states of the searches, which are stored one per lane, too (`searches`).
//!
//! # Why results equal those of single traversals
//!
//! Each ray visits the nodes that it would visit in a single traversal, in the same order and with
//! the same limit, so it gives the same answer and the same counters as
//! [`SingleTraversal`](super::SingleTraversal):
//!
//! - The order of a node's children depends only on the signs of the ray's direction, which all
//!   rays of a packet share. So a ray visits the nodes that the packet visits, except where it is
//!   inactive, in the packet's order.
//! - A single ray visits a child if `enter < exit`, and `enter` is below its limit at the visit
//!   to the parent and below its limit when the child is popped. Limits never grow, so one test
//!   against the latter limit, of the rays that were active in the parent, selects the same rays.
//!   Both take the same [`span`](super::slab::SlabSetup::span).
//! - The beam rejects no child that a ray of the packet enters: see [`Beam`](beam::Beam).
//! - The tests of a leaf are the formulas of [`LeafIntersector`](super::leaf::LeafIntersector), and
//!   the result does not depend on their order.

mod soa;
mod rays;
mod beam;
mod boxes;
mod searches;
mod planes;
mod triangles;
mod spheres;
mod traversal;

use super::batch::Batch;
use crate::accel::search::Queries;
use crate::cost::StreamProbe;
use math::simd::{InstructionSet, SimdKernel};
use rays::PacketRays;
use soa::{N_RAYS, RaySoa};
use traversal::{Packet, PacketStack};

/// With fewer coherent rays, the stream is faster.
const MIN_RAYS: u32 = 8;

/// Finds the coherent rays of a batch and answers their queries.
pub(in crate::accel) struct PacketTraversal<'a, Q: Queries, P> {
    pub(in crate::accel) batch: Batch<'a, Q, P>,
    /// Is overwritten with the indices of the remaining queries.
    pub(in crate::accel) incoherent: &'a mut Vec<u32>,
}

impl<Q: Queries, P: StreamProbe> SimdKernel for PacketTraversal<'_, Q, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let Self {
            mut batch,
            incoherent,
        } = self;
        let n_queries = batch.queries.rays().len() as u32;
        incoherent.clear();
        incoherent.reserve(n_queries as usize);
        if batch.arena.is_empty() {
            incoherent.extend(0..n_queries);
            return;
        }
        let (mut soa, mut stack) = (RaySoa::EMPTY, PacketStack::new());
        // The work that packets have saved so far. Where rays diverge early, this is negative after
        // the first packet, and the stream gets the remaining rays.
        let mut gain = 0;
        let mut first = 0;
        while first + N_RAYS as u32 <= n_queries {
            let next = first + N_RAYS as u32;
            let (queries, rays) = (batch.queries, batch.queries.rays());
            // Skip sixteen rays that are hardly coherent.
            if gain < 0 || !soa::may_be_coherent(rays, first as usize) {
                incoherent.extend(first..next);
                first = next;
                continue;
            }
            // Select the rays that are coherent with the first; copies of it fill the other lanes.
            soa.fill(rays, first as usize);
            let mut coherent = soa.coherent_with_first(set);
            if coherent.count_ones() >= MIN_RAYS {
                soa.replace_by_first(!coherent);
                // Prepare the rays, test the unbounded primitives, traverse the hierarchy.
                let rays = PacketRays::new(set, &soa, batch.arena.largest());
                let mut packet = Packet::new(&rays, queries, first as usize, batch.primitives);
                let active = packet.test_unbounded(batch.unbounded) & coherent;
                if active != 0 {
                    gain += packet.traverse::<P>(batch.arena, active, &mut stack);
                }
                packet.answer(&mut batch, first as usize, coherent);
            } else {
                coherent = 0;
            }
            // Leave the incoherent rays to the stream.
            let mut rest = !coherent;
            while rest != 0 {
                incoherent.push(first + rest.trailing_zeros());
                rest &= rest - 1;
            }
            first = next;
        }
        incoherent.extend(first..n_queries);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::accel::Quality;
    use crate::accel::bvh::Bvh;
    use crate::accel::unbounded::Unbounded;
    use crate::cost::NoProbe;
    use math::simd::Simd;
    use world::geometry::{Ray, RayStream, Shape, Sphere};
    use world::scene::{MaterialId, ObjectId, Primitive};

    /// Returns the indices of the rays that no packet takes.
    fn incoherent(simd: Simd, rays: &[Ray]) -> Vec<u32> {
        let sphere = |x| Sphere {
            center: Vec3::new(x as f32, 0.0, -5.0),
            radius: 0.4,
        };
        let primitive =
            |x| Primitive::new(Shape::Sphere(sphere(x)), None, ObjectId(0), MaterialId(0));
        let primitives: Vec<_> = (-9..9).map(primitive).collect();
        let bvh = Bvh::new(&primitives, &[], Quality::Fast, |_| {}).unwrap();
        let mut answers = vec![None; rays.len()];
        let mut incoherent = vec![7];
        simd.run(PacketTraversal {
            batch: Batch {
                arena: bvh.arena(),
                primitives: &primitives,
                unbounded: &Unbounded::default(),
                queries: &rays.iter().copied().collect::<RayStream>(),
                answers: &mut answers,
                probe: &mut NoProbe,
            },
            incoherent: &mut incoherent,
        });
        incoherent
    }

    #[test]
    fn packets_take_the_coherent_rays() {
        let ray = |i: u32| Ray {
            origin: Vec3::ZERO,
            direction: Vec3::new(0.1 + 0.001 * i as f32, -0.0, -1.0).normalize(),
        };
        let mut rays: Vec<Ray> = (0..40).map(ray).collect();
        rays[3].direction *= -1.0;
        // Almost the same direction, but in another octant.
        rays[20].direction.y = 0.0;
        for simd in Simd::available() {
            let expected = [3, 20, 32, 33, 34, 35, 36, 37, 38, 39];
            assert_eq!(incoherent(simd, &rays), expected, "{simd}");
            let diverging: Vec<Ray> = (0..40)
                .map(|i| Ray {
                    origin: Vec3::ZERO,
                    direction: Vec3::new(i as f32 - 20.0, 5.0, -4.0).normalize(),
                })
                .collect();
            assert_eq!(incoherent(simd, &diverging).len(), 40, "{simd}");
        }
    }
}
