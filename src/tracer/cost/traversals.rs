//! The counters of the traversals of several rays.

/// The counters of the traversals of `N` consecutive rays.
#[derive(Debug, Clone, Copy)]
pub struct Traversals<'a, const N: usize> {
    /// Node visits of each ray.
    pub node_visits: &'a [u32; N],
    /// Primitive tests of each ray.
    pub primitive_tests: &'a [u32; N],
    /// The active mask: bit `i` is set if the counters of ray `i` are valid.
    pub active: u32,
}

impl<const N: usize> Traversals<'_, N> {
    /// Calls `visit` with the index, the node visits and the primitive tests of each active ray.
    #[inline(always)]
    pub fn for_each(&self, mut visit: impl FnMut(usize, u32, u32)) {
        let mut visit = |i: usize| visit(i, self.node_visits[i], self.primitive_tests[i]);
        if self.active.count_ones() as usize == N {
            // The common case: no branch per ray.
            for i in 0..N {
                visit(i);
            }
        } else {
            let mut active = self.active;
            while active != 0 {
                visit(active.trailing_zeros() as usize % N);
                active &= active - 1;
            }
        }
    }
}
