//! The order in which rays visit the children of a node.

use std::array::from_fn;

use crate::accel::layout::Node;
use crate::accel::simd::N_LANES;

/// The children from far to near for rays into each of the eight octants, as
/// [`Node::order`] holds them: by how far the middle of the box lies along the
/// octant's diagonal.
///
/// An octant has bit 0 for rays down the x axis, bit 1 for y, bit 2 for z.
pub(super) fn by_octant(node: &Node) -> [u32; N_LANES] {
    let mut orders = [0; N_LANES];
    for octant in 0..8 {
        let depth = |lane: usize| {
            let along = |axis: usize| {
                let center = node.min[axis][lane] + node.max[axis][lane];
                if octant >> axis & 1 != 0 {
                    -center
                } else {
                    center
                }
            };
            along(0) + along(1) + along(2)
        };
        let mut lanes: [usize; N_LANES] = from_fn(|lane| lane);
        lanes[..node.n_children()].sort_by(|&a, &b| depth(b).total_cmp(&depth(a)));
        for (order, lane) in orders.iter_mut().zip(lanes) {
            *order |= (lane as u32) << (3 * octant);
        }
    }
    orders
}
