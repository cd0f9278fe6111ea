//! Traversal stacks: the children still to be visited.
#![expect(
    unsafe_code,
    reason = "initializing the stacks would cost as much as tracing some rays"
)]

use std::mem::MaybeUninit;

use crate::accel::arena::Arena;
use crate::accel::layout::{MAX_DEPTH, NodeRef};
use math::simd::{Arithmetic, InstructionSet, Lanes, Mask, N_LANES};

/// Entries of a stack for a hierarchy of `n_levels`. Each node on a path leaves at most seven
/// children on the stack, above the sentinel, and a push writes eight lanes.
const fn capacity(n_levels: usize) -> usize {
    (N_LANES - 1) * n_levels + 1 + N_LANES
}

/// A value for each entry of `N` stacks.
type PerEntry<T, const N: usize> = [[MaybeUninit<T>; capacity(MAX_DEPTH + 1)]; N];

/// `N` stacks of children, each with the parameter at which the ray enters it. A sentinel lies at
/// the bottom.
///
/// Accesses are unchecked: a check at each push would keep the compiler from folding the loads
/// before it into operations.
pub(super) struct Stacks<const N: usize> {
    node_refs: PerEntry<u32, N>,
    enter: PerEntry<f32, N>,
    /// Entries from one stack to the next: as few as the hierarchy needs, so that all tops lie in
    /// few pages.
    stride: usize,
}

/// Number of entries below the top of a stack, including the entries of the stacks before it.
#[derive(Clone, Copy)]
pub(super) struct Top(usize);

impl<const N: usize> Stacks<N> {
    /// Returns memory for traversals of this arena.
    #[inline(always)]
    pub(super) fn new(arena: &Arena) -> Self {
        Self {
            node_refs: [const { [const { MaybeUninit::uninit() }; _] }; N],
            enter: [const { [const { MaybeUninit::uninit() }; _] }; N],
            stride: capacity(arena.n_levels()),
        }
    }

    /// Empties stack `i % N`, except for the sentinel.
    #[inline(always)]
    pub(super) fn restart(&mut self, i: usize) -> Top {
        let bottom = i % N * self.stride;
        // SAFETY: a stack has room for the sentinel.
        unsafe {
            *ref_at(&mut self.node_refs, bottom) = NodeRef::END.0;
            *ref_at(&mut self.enter, bottom) = f32::NEG_INFINITY;
        }
        Top(bottom + 1)
    }

    /// Pushes the first `n` children, at most eight, in order, with the parameters at which the ray
    /// enters them.
    ///
    /// # Safety
    /// They are the children of a node of the arena, which is the root or was popped off this
    /// stack.
    #[inline(always)]
    pub(super) unsafe fn push_sorted(
        &mut self,
        top: &mut Top,
        node_refs: [u32; N_LANES],
        enter: [f32; N_LANES],
        n: usize,
    ) {
        // SAFETY: the caller's promise. A path has at most as many nodes as the arena has levels,
        // each of which leaves at most seven children: there is room for eight.
        unsafe {
            *ref_at(&mut self.enter, top.0) = enter;
            self.push_all(top, node_refs, n);
        }
    }

    /// Pushes the first `n` children, at most eight, in order, for a search that reads no
    /// parameters.
    ///
    /// # Safety
    /// As for [`push_sorted`](Self::push_sorted).
    #[inline(always)]
    pub(super) unsafe fn push_all(&mut self, top: &mut Top, node_refs: [u32; N_LANES], n: usize) {
        // SAFETY: as in `push_sorted`.
        unsafe { *ref_at(&mut self.node_refs, top.0) = node_refs };
        top.0 += n;
    }

    /// Pops a child, or the sentinel.
    ///
    /// # Safety
    /// The sentinel has not been popped.
    #[inline(always)]
    pub(super) unsafe fn pop(&mut self, top: &mut Top) -> NodeRef {
        top.0 -= 1;
        // SAFETY: entries below the top are initialized, and this was one.
        NodeRef(unsafe { *ref_at(&mut self.node_refs, top.0) })
    }

    /// Returns the parameter at which the ray enters the child that was popped last.
    ///
    /// # Safety
    /// A child was popped that had been pushed with a parameter.
    #[inline(always)]
    pub(super) unsafe fn popped_enter(&mut self, top: &Top) -> f32 {
        // SAFETY: the caller's promise.
        unsafe { *ref_at(&mut self.enter, top.0) }
    }

    /// Removes from stack `i % N` the children that the ray does not enter before `limit`, which is
    /// finite, without a branch per child.
    ///
    /// # Safety
    /// `top` is the top of this stack.
    #[inline(always)]
    pub(super) unsafe fn keep_before<I: InstructionSet>(
        &mut self,
        set: I,
        i: usize,
        top: &mut Top,
        limit: f32,
    ) {
        let limit = set.splat(limit);
        let bottom = i % N * self.stride;
        // SAFETY: there is always room for eight entries. Every entry read is initialized: it lies
        // below the top, or is one of the eight above it.
        unsafe {
            // Pad the last eight entries with children that are dropped.
            *ref_at(&mut self.enter, top.0) = [f32::INFINITY; N_LANES];
            *ref_at(&mut self.node_refs, top.0) = [0_u32; N_LANES];
            // Compress eight entries at a time towards the bottom.
            let (mut n_kept, mut next) = (bottom, bottom);
            while next < top.0 {
                let node_refs = set.load_bits(ref_at(&mut self.node_refs, next));
                let enter = set.load(ref_at(&mut self.enter, next));
                let kept = enter.lt(limit);
                // Never past what was read.
                *ref_at(&mut self.node_refs, n_kept) = node_refs.compress(kept).to_bits();
                *ref_at(&mut self.enter, n_kept) = enter.compress(kept).to_array();
                n_kept += kept.bits().count_ones() as usize;
                next += N_LANES;
            }
            top.0 = n_kept;
        }
    }
}

/// Returns entries from entry `i` on.
///
/// # Safety
/// The stacks have them. They are initialized, or not read.
#[inline(always)]
unsafe fn ref_at<T, E, const N: usize>(entries: &mut PerEntry<T, N>, i: usize) -> &mut E {
    debug_assert!(size_of::<T>() * i + size_of::<E>() <= size_of_val(entries));
    // SAFETY: the caller's promise.
    unsafe { &mut *entries.as_mut_ptr().cast::<T>().add(i).cast() }
}
