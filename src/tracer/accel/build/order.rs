//! The order in which ordered traversals visit the children of a node.

use crate::accel::layout::WideNode;
use math::simd::{Arithmetic, InstructionSet, Lanes, N_LANES};

/// The signs of the diagonals into the eight octants, one row per axis: negative where rays point
/// down the axis. Bit 0 of an octant stands for the x axis, bit 1 for y, bit 2 for z.
static DIAGONALS: [[f32; N_LANES]; 3] = [
    [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0],
    [1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0],
];

/// From here on, floats are integers, held in the low bits.
const ZERO: f32 = 8_388_608.0;

/// Returns the children from far to near for rays into each of the eight octants, in the encoding
/// of [`WideNode::order`]: sorted by the centers of the boxes along the octant's diagonal.
#[inline(always)]
pub(super) fn by_octant<I: InstructionSet>(set: I, node: &WideNode) -> [u32; N_LANES] {
    let mut orders = [0; N_LANES];
    let depths = depths(set, node);
    for child in 0..N_LANES {
        // Rank the child in all octants at once: counting its predecessors is the fastest way to
        // sort eight numbers.
        let mut rank = set.splat(ZERO);
        for other in 0..N_LANES {
            let is_before = if other < child {
                depths[child].le(depths[other])
            } else {
                depths[child].lt(depths[other])
            };
            let next = rank + set.splat(1.0);
            rank = I::Lanes::select(is_before, next, rank);
        }
        // Write the child at its rank in each octant.
        for (octant, rank) in rank.to_bits().into_iter().enumerate() {
            orders[rank as usize % N_LANES] |= (child as u32) << (3 * octant);
        }
    }
    orders
}

/// Returns the depths of each child's center along the diagonals. Missing children come last and
/// are never entered.
#[inline(always)]
fn depths<I: InstructionSet>(set: I, node: &WideNode) -> [I::Lanes; N_LANES] {
    let [x, y, z] = &DIAGONALS;
    let [x, y, z] = [set.load(x), set.load(y), set.load(z)];
    let mut depths = [set.splat(f32::NEG_INFINITY); N_LANES];
    for (child, depth) in depths.iter_mut().enumerate().take(node.n_children()) {
        let mut center = [0.0; 3];
        for (axis, center) in center.iter_mut().enumerate() {
            *center = node.min[axis][child] + node.max[axis][child];
        }
        let [cx, cy, cz] = center;
        *depth = x * set.splat(cx) + y * set.splat(cy) + z * set.splat(cz);
    }
    depths
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use math::simd::{Simd, SimdKernel};

    struct ByOctant<'a>(&'a WideNode);

    impl SimdKernel for ByOctant<'_> {
        type Output = [u32; N_LANES];

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> [u32; N_LANES] {
            by_octant(set, self.0)
        }
    }

    proptest! {
        #[test]
        fn children_are_sorted_by_their_centers(
            // Few different numbers, so that some are equal.
            centers in prop::collection::vec(prop::array::uniform3(-3_i8..3), 1..=N_LANES),
        ) {
            let mut node = WideNode::EMPTY;
            for (lane, center) in centers.iter().enumerate() {
                for (axis, &x) in center.iter().enumerate() {
                    node.min[axis][lane] = f32::from(x) - 0.25;
                    node.max[axis][lane] = f32::from(x) + 0.25;
                }
            }
            for simd in Simd::available() {
                let orders = simd.run(ByOctant(&node));
                for octant in 0..8 {
                    let depth = |child: usize| {
                        let signed = |(axis, &x): (usize, &i8)| {
                            if octant >> axis & 1 == 0 { x } else { -x }
                        };
                        centers[child].iter().enumerate().map(signed).sum::<i8>()
                    };
                    let mut sorted: Vec<usize> = (0..centers.len()).collect();
                    sorted.sort_by_key(|&child| -depth(child));
                    let n = centers.len();
                    let order = orders[..n].iter().map(|order| (order >> (3 * octant) & 7) as usize);
                    prop_assert_eq!(order.collect::<Vec<_>>(), sorted);
                }
            }
        }
    }
}
