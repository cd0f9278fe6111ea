//! References → a binary tree with one reference per leaf.

use arrayvec::ArrayVec;

use super::few;
use super::forests::Forests;
use super::nodes::{BinaryNode, OpenNode};
use super::partition::{Subset, by_spatial_split, in_halves, subsets};
use super::reference::Reference;
use super::split_candidate::{MIN_SPATIAL_SPLIT, SplitCandidate, SplitContext};
use super::workers::{OneThread, Workers};
use crate::accel::layout::MAX_DEPTH;
use base::stop;
use math::simd::{InstructionSet, SimdKernel};

/// Number of references from which both subtrees are built in parallel.
const PARALLEL: usize = 4096;

/// Data shared by the builds of all subtrees.
pub(super) struct BuildContext<'a, R> {
    pub(super) split: SplitContext<'a>,
    /// Called with the capacity of each finished subtree, from any thread.
    pub(super) report: R,
}

/// A subtree to be built: its references and its memory.
pub(super) struct Subtree<'a> {
    pub(super) subset: Subset,
    pub(super) depth: usize,
    /// The references, followed by spare memory. The length is the capacity: the number of
    /// references that spatial splits may make of them.
    pub(super) references: &'a mut [Reference],
    /// Memory for the partition, as long as `references`.
    pub(super) scratch: &'a mut [Reference],
    /// True if the references of the built tree stay in `references`; otherwise they move to
    /// `scratch`.
    pub(super) stays: bool,
    /// One entry fewer than `references`.
    pub(super) nodes: &'a mut [BinaryNode],
}

impl<'a> Subtree<'a> {
    /// Builds the subtree, in parallel. Returns `None` if the build was stopped.
    pub(super) fn build<R: Fn(usize) + Sync>(self, context: &BuildContext<R>) -> Option<Forests> {
        let capacity = self.references.len();
        let simd = context.split.simd;
        if stop::is_requested() {
            return None;
        }
        // Few references: build on this thread.
        if self.subset.n < PARALLEL {
            let forests = simd.run(BuildSerially(self, &context.split));
            (context.report)(capacity);
            return Some(forests);
        }
        // Many: split them with all threads, then build both sides in parallel.
        let (open, [first, second]) = self.split(&context.split, simd);
        let (first, second) = rayon::join(|| first.build(context), || second.build(context));
        Some(simd.run(Close(open, [first?, second?])))
    }

    /// Splits the references, four or more.
    #[inline(always)]
    fn split(mut self, context: &SplitContext, workers: impl Workers) -> (OpenNode<'a>, [Self; 2]) {
        let n = self.subset.n;
        if n < MIN_SPATIAL_SPLIT {
            // Only that many are used, so the references of a leaf are neighbors.
            self.references = &mut self.references[..n];
        }
        let capacity = self.references.len();
        let from = &self.references[..n];
        // Find the cheapest split: by centers, by a plane, or in halves where the depth runs out.
        let split = if needs_halves(n, self.depth) {
            SplitCandidate::Halves
        } else {
            let object = workers.object_split(from, &self.subset.centers);
            SplitCandidate::cheapest(context, object, from, &self.subset, capacity - n)
        };
        // Divide the memory between the sides.
        let left_capacity = split.left_capacity(from, capacity);
        let (to_left, to_right) = self.scratch[..capacity].split_at_mut(left_capacity);
        let to = [&mut *to_left, &mut *to_right];
        // Move the references to their sides.
        let [left, right] = match split {
            SplitCandidate::Object(split) => subsets(n, &split, workers.scatter(from, to, &split)),
            SplitCandidate::Spatial(split) => {
                by_spatial_split(context.simd, from, to, &split, context.primitives)
            }
            SplitCandidate::Halves => in_halves(context.simd, from, to),
        };
        // Open the node: it is written once both subtrees are known.
        let (node, below) = self
            .nodes
            .split_first_mut()
            .expect("a root for its references");
        let (nodes_left, nodes_right) = below[..capacity - 2].split_at_mut(left_capacity - 1);
        let open = OpenNode {
            node,
            bounds: self.subset.bounds,
            second: left_capacity,
            is_leaf: [left.n == 1, right.n == 1],
        };
        // The partition and the scratch memory trade roles.
        let (scratch_left, scratch_right) = self.references.split_at_mut(left_capacity);
        let subtree = |subset, references, scratch, nodes| Self {
            subset,
            depth: self.depth + 1,
            references,
            scratch,
            stays: !self.stays,
            nodes,
        };
        let left = subtree(left, to_left, scratch_left, nodes_left);
        let right = subtree(right, to_right, scratch_right, nodes_right);
        (open, [left, right])
    }

    /// Writes the whole subtree if it has few references. Returns its forests.
    #[inline(always)]
    fn write_few<I: InstructionSet>(&mut self, set: I) -> Option<Forests> {
        let n = self.subset.n;
        if n == 4 && needs_halves(8, self.depth) {
            // The subtree may take three levels.
            return None;
        }
        let references = &mut self.references[..n];
        let forests = few::write(set, references, self.nodes, self.subset.bounds)?;
        if !self.stays {
            self.scratch[..n].copy_from_slice(references);
        }
        Some(forests)
    }
}

/// Builds a subtree on one thread.
struct BuildSerially<'a, 'c>(Subtree<'a>, &'c SplitContext<'c>);

impl SimdKernel for BuildSerially<'_, '_> {
    type Output = Forests;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Forests {
        // No recursion: only code inlined here uses the instructions of the set.
        let Self(mut subtree, context) = self;
        let mut waiting = ArrayVec::<Subtree, MAX_DEPTH>::new();
        let mut open_nodes = ArrayVec::<(OpenNode, Option<Forests>), MAX_DEPTH>::new();
        loop {
            // Split until few references are left: the first side next, the second side later.
            let Some(mut forests) = subtree.write_few(set) else {
                let (open, [first, second]) = subtree.split(context, OneThread(set));
                open_nodes.push((open, None));
                waiting.push(second);
                subtree = first;
                continue;
            };
            // Close every node whose second subtree is finished.
            loop {
                match open_nodes.pop() {
                    None => return forests,
                    Some((open, None)) => {
                        open_nodes.push((open, Some(forests)));
                        break;
                    }
                    Some((open, Some(first))) => forests = open.close(set, &first, &forests),
                }
            }
            subtree = waiting.pop().expect("each open node has two subtrees");
        }
    }
}

/// Closes a node.
struct Close<'a>(OpenNode<'a>, [Forests; 2]);

impl SimdKernel for Close<'_> {
    type Output = Forests;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Forests {
        let Self(open, [first, second]) = self;
        open.close(set, &first, &second)
    }
}

/// Returns true if `n` references at this depth have to be halved from here on to stay within
/// [`MAX_DEPTH`]: halving takes log2(n) levels.
#[inline(always)]
fn needs_halves(n: usize, depth: usize) -> bool {
    let n_levels = n.next_power_of_two().trailing_zeros() as usize;
    depth + n_levels >= MAX_DEPTH
}
