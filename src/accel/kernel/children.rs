//! Pushes the children that a ray enters.

use super::stack::Stack;
use crate::accel::layout::WideNode;
use crate::accel::search::Search;
use crate::simd::{InstructionSet, Lanes, Mask, N_LANES, Real};

/// Pushes the children that the ray enters before it leaves them, the first one
/// to visit on top. Has no branch that depends on the ray.
#[inline(always)]
pub(super) fn push_entered<I: InstructionSet, S: Search>(
    set: I,
    node: &WideNode,
    enter: I::Lanes,
    exit: I::Lanes,
    order_shift: I::Lanes,
    stack: &mut Stack,
) {
    let children = set.load_bits(&node.children);
    if S::NEAREST_FIRST {
        let children = children.permute(&node.order, order_shift);
        let enter = enter.permute(&node.order, order_shift);
        let exit = exit.permute(&node.order, order_shift);
        let entered = enter.le(exit);
        stack.push_all(
            children.compress(entered).to_bits(),
            enter.compress(entered).to_array(),
            entered.bits().count_ones() as usize,
        );
    } else {
        let entered = enter.le(exit);
        stack.push_all(
            children.compress(entered).to_bits(),
            [0.0; N_LANES],
            entered.bits().count_ones() as usize,
        );
    }
}
