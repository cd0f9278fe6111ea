//! Subtrees over at most four references: the cheapest of all possible ones.

use super::bounds::LaneBounds;
use super::forests::Forests;
use super::nodes::{BinaryNode, OpenNode};
use super::reference::Reference;
use crate::accel::layout::LeafKind;
use math::simd::{Arithmetic, InstructionSet};

/// Writes the whole subtree and sorts its references. Returns its forests, or `None` if there are
/// more than four references.
#[inline(always)]
pub(super) fn write<I: InstructionSet>(
    set: I,
    references: &mut [Reference],
    nodes: &mut [BinaryNode],
    bounds: LaneBounds,
) -> Option<Forests> {
    Some(match references {
        [one] => Forests::from_reference(one),
        [a, b] => write_two(set, [a, b], &mut nodes[0], bounds),
        [a, b, c] => write_three(set, [a, b, c], nodes.first_chunk_mut()?, bounds),
        [a, b, c, d] => write_four(set, [a, b, c, d], nodes.first_chunk_mut()?, bounds),
        _ => return None,
    })
}

/// Returns the kind of the references if a leaf tests them at once, else `None`.
#[inline(always)]
fn common_kind<const N: usize>(references: [&Reference; N]) -> Option<LeafKind> {
    let kind = references[0].kind();
    let is_common = references.iter().all(|reference| reference.kind() == kind);
    (is_common && kind.is_tested_at_once()).then_some(kind)
}

#[inline(always)]
fn write_two<I: InstructionSet>(
    set: I,
    [a, b]: [&Reference; 2],
    node: &mut BinaryNode,
    bounds: LaneBounds,
) -> Forests {
    let open = OpenNode {
        node,
        bounds,
        second: 1,
        is_leaf: [true; 2],
    };
    // One leaf, or two.
    if let Some(kind) = common_kind([a, b]) {
        let half_areas = [a.half_area(), b.half_area()];
        return open.write(Forests::from_pair(kind, half_areas, bounds.half_area()));
    }
    open.close(
        set,
        &Forests::from_reference(a),
        &Forests::from_reference(b),
    )
}

/// Writes a pair and a single reference, or one leaf.
#[inline(always)]
fn write_three<I: InstructionSet>(
    set: I,
    [a, b, c]: [&mut Reference; 3],
    [root, node]: &mut [BinaryNode; 2],
    bounds: LaneBounds,
) -> Forests {
    // Compute the areas of all single references and all pairs.
    let [x, y, z] = [a.lanes(set), b.lanes(set), c.lanes(set)];
    let [ab, ac, bc] = [
        LaneBounds::from_lanes(x.max(y)),
        LaneBounds::from_lanes(x.max(z)),
        LaneBounds::from_lanes(y.max(z)),
    ];
    let of_one = [a.half_area(), b.half_area(), c.half_area()];
    let of_pair = [ab.half_area(), ac.half_area(), bc.half_area()];
    let open = OpenNode {
        node: root,
        bounds,
        second: 2,
        is_leaf: [false, true],
    };
    // Make one leaf if its box costs no more than any division.
    if let Some(kind) = common_kind([a, b, c]) {
        let apart = of_one[0] + of_one[1] + of_one[2];
        let least = (of_pair[0] + of_one[2])
            .min(of_pair[1] + of_one[1])
            .min(of_pair[2] + of_one[0]);
        if bounds.half_area() <= least.min(apart) {
            return open.write(Forests::from_leaf(kind, 3, bounds.half_area()));
        }
    }
    // Choose the cheapest pair by the cost of its node; move it to the front.
    let costs = [
        2.0 * of_pair[0] + of_one[2],
        2.0 * of_pair[1] + of_one[1],
        2.0 * of_pair[2] + of_one[0],
    ];
    let pair = if costs[0] <= costs[1] && costs[0] <= costs[2] {
        ab
    } else if costs[1] <= costs[2] {
        (*b, *c) = (*c, *b);
        ac
    } else {
        (*a, *b, *c) = (*b, *c, *a);
        bc
    };
    let pair = write_two(set, [a, b], node, pair);
    open.close(set, &pair, &Forests::from_reference(c))
}

/// Writes two pairs, three references and a single one, or one leaf.
#[inline(always)]
fn write_four<I: InstructionSet>(
    set: I,
    [a, b, c, d]: [&mut Reference; 4],
    nodes: &mut [BinaryNode; 3],
    bounds: LaneBounds,
) -> Forests {
    // Compute the boxes of all divisions: 0 to 2 into pairs, 3 to 6 into three and one.
    let [x, y, z, w] = [a.lanes(set), b.lanes(set), c.lanes(set), d.lanes(set)];
    let of_pairs = [
        [
            LaneBounds::from_lanes(x.max(y)),
            LaneBounds::from_lanes(z.max(w)),
        ],
        [
            LaneBounds::from_lanes(x.max(z)),
            LaneBounds::from_lanes(y.max(w)),
        ],
        [
            LaneBounds::from_lanes(x.max(w)),
            LaneBounds::from_lanes(z.max(y)),
        ],
    ];
    let of_three = [
        LaneBounds::from_lanes(x.max(y).max(z)),
        LaneBounds::from_lanes(x.max(y).max(w)),
        LaneBounds::from_lanes(z.max(w).max(x)),
        LaneBounds::from_lanes(z.max(w).max(y)),
    ];
    let alone = [d.half_area(), c.half_area(), b.half_area(), a.half_area()];
    let apart = alone[0] + alone[1] + alone[2] + alone[3];
    // Find the cheapest division, and the smallest area of any.
    let (mut least, mut cheapest, mut smallest) = (f32::INFINITY, 0, apart);
    for (i, pairs) in of_pairs.iter().enumerate() {
        let sum = pairs[0].half_area() + pairs[1].half_area();
        smallest = smallest.min(sum);
        if 2.0 * sum < least {
            (least, cheapest) = (2.0 * sum, i);
        }
    }
    for (i, (three, alone)) in of_three.iter().zip(alone).enumerate() {
        let three = three.half_area();
        smallest = smallest.min(three + alone);
        if 3.0 * three + alone < least {
            (least, cheapest) = (3.0 * three + alone, 3 + i);
        }
    }
    let [root, below @ ..] = nodes;
    let mut open = OpenNode {
        node: root,
        bounds,
        second: 2,
        is_leaf: [false; 2],
    };
    // Make one leaf if its box costs no more than any division.
    if let Some(kind) = common_kind([a, b, c, d])
        && bounds.half_area() <= smallest
    {
        return open.write(Forests::from_leaf(kind, 4, bounds.half_area()));
    }
    // Sort the references: the first side of the division to the front.
    match cheapest {
        1 => (*b, *c) = (*c, *b),
        2 | 5 => (*b, *d) = (*d, *b),
        4 => (*c, *d) = (*d, *c),
        6 => (*a, *d) = (*d, *a),
        _ => {}
    }
    // Write both pairs, or the three and the single one.
    if cheapest < 3 {
        let [one, other] = below;
        let [first, second] = of_pairs[cheapest];
        let first = write_two(set, [a, b], one, first);
        let second = write_two(set, [c, d], other, second);
        return open.close(set, &first, &second);
    }
    (open.second, open.is_leaf) = (3, [false, true]);
    let three = write_three(set, [a, b, c], below, of_three[(cheapest - 3) % 4]);
    open.close(set, &three, &Forests::from_reference(d))
}
