//! Pushing the children that a ray enters.
#![expect(unsafe_code, reason = "the arena bounds the depth of the stack")]

use super::stack::{Stacks, Top};
use crate::accel::layout::WideNode;
use crate::accel::search::Search;
use math::simd::{Arithmetic, InstructionSet, Lanes, Mask};

/// Pushes the children that the ray enters before leaving, the first to visit on top. No branch
/// depends on the ray.
///
/// # Safety
/// `node` belongs to the arena of the stacks; it is the root or was popped off this stack.
#[inline(always)]
pub(super) unsafe fn push_entered<I: InstructionSet, S: Search, const N: usize>(
    set: I,
    node: &WideNode,
    enter: I::Lanes,
    exit: I::Lanes,
    order_shift: u32,
    stacks: &mut Stacks<N>,
    top: &mut Top,
) {
    let children = set.load_bits(&node.children);
    if S::NEAREST_FIRST {
        // Put the children into the order of visits by the octant of the ray, the nearest last.
        let shift = set.splat_bits(order_shift);
        let children = children.permute(&node.order, shift);
        let enter = enter.permute(&node.order, shift);
        let exit = exit.permute(&node.order, shift);
        // Keep those with a non-empty span, and push them all at once.
        let entered = enter.lt(exit);
        let n = entered.bits().count_ones() as usize;
        let enter = enter.compress(entered).to_array();
        // SAFETY: the caller's promise.
        unsafe { stacks.push_sorted(top, children.compress(entered).to_bits(), enter, n) };
    } else {
        // Any order will do: push the children that are entered.
        let entered = enter.lt(exit);
        let n = entered.bits().count_ones() as usize;
        // SAFETY: the caller's promise.
        unsafe { stacks.push_all(top, children.compress(entered).to_bits(), n) };
    }
}
