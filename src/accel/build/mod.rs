//! Primitives → the arena of a hierarchy.
//!
//! First a binary tree down to single references to primitives (`binary`), by
//! the surface area heuristic over `bins`, all of it on `reference`s; then the
//! best tree of eight-wide nodes and leaves that can be cut from it
//! (`collapse`); then its lines (`emit`). Where the quality asks for it,
//! triangles are cut (`clip`) into several references: the worst beforehand
//! (`presplit`), or on the way down wherever it pays (`cuts`). `way` chooses
//! between that and whole references, and `part` moves them.
//!
//! All of it runs in parallel on disjoint slices of memory, and no decision
//! depends on the threads.

mod clip;
mod reference;
mod bins;
mod cuts;
mod part;
mod way;
mod presplit;
mod binary;
mod collapse;
mod order;
mod emit;

use std::fmt;

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::arena::Arena;
use super::layout::{Line, Word};
use super::simd::Simd;
use crate::config::Quality;
use crate::scene::Primitive;
use binary::{BinaryNode, Growth, Subtree};
use part::Part;
use reference::Reference;

pub(super) use binary::MAX_DEPTH;

/// Most primitives: a word of 32 bits counts the lines of their arena, ten for
/// each where the worst comes together, before it is known whether they are few
/// enough for the arena's own words.
pub(super) const MAX_PRIMITIVES: usize = 1 << 28;

/// Lines of the arena for each reference. Less than one is common, and one and
/// a half for shapes that are tested one by one.
const LINES_PER_REFERENCE: f64 = 2.0;

/// References that cuts on the way down may add for each triangle.
const CUTS_PER_TRIANGLE: f64 = 0.5;

/// References for each primitive at most.
fn references_per_primitive(quality: Quality) -> f64 {
    match quality {
        Quality::Fast => 1.0,
        Quality::Balanced => 1.0 + presplit::CUTS_PER_TRIANGLE,
        Quality::High => 1.0 + CUTS_PER_TRIANGLE,
    }
}

/// Bytes for each primitive at most: its index, its part of the binary tree,
/// and the larger of what the two phases need beside. While the binary tree
/// grows that is two sets of references; then the arena.
pub(super) fn bytes_per_primitive(quality: Quality) -> usize {
    let tree = 2.0 * size_of::<BinaryNode>() as f64;
    let references = 2.0 * size_of::<Reference>() as f64;
    let arena = LINES_PER_REFERENCE * size_of::<Line>() as f64;
    let of_reference = tree + references.max(arena);
    size_of::<u32>() + (references_per_primitive(quality) * of_reference).ceil() as usize
}

/// Lines of the arena for each primitive at most.
pub(super) fn lines_per_primitive(quality: Quality) -> usize {
    (references_per_primitive(quality) * LINES_PER_REFERENCE).ceil() as usize
}

/// Builds the hierarchy over the primitives with these indices. No lines for no
/// primitives. `report` hears of the
/// parts that are done, which add up to 1, from any thread.
pub(super) fn arena(
    primitives: &[Primitive],
    indices: Vec<u32>,
    quality: Quality,
    report: impl Fn(f64) + Sync,
) -> Result<Arena, TooLarge> {
    if indices.is_empty() {
        return Ok(Arena::default());
    }
    let mut nodes = grow(primitives, indices, quality, report);
    let whole = collapse::choose(&mut nodes);
    let lines = emit::lines(&nodes, &whole, primitives)?;
    Ok(Arena::new(lines, nodes[0].bounds))
}

/// A hierarchy has more lines than words can tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLarge {
    /// What it would take.
    pub bytes: u64,
}

/// "the hierarchy would take 9.1 GiB, and 8 GiB is the most".
impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
        let most = (Word::MAX_LINES * size_of::<Line>()) as u64;
        let (bytes, most) = (gib(self.bytes), gib(most));
        write!(
            f,
            "the hierarchy would take {bytes:.1} GiB, and {most} GiB is the most"
        )
    }
}

impl std::error::Error for TooLarge {}

/// Grows the binary tree over these primitives.
fn grow(
    primitives: &[Primitive],
    indices: Vec<u32>,
    quality: Quality,
    report: impl Fn(f64) + Sync,
) -> Vec<BinaryNode> {
    let mut references: Vec<Reference> = indices
        .into_par_iter()
        .with_min_len(8192)
        .map(|index| Reference::new(&primitives[index as usize], index))
        .collect();
    let mut whole = Part::of(&references);
    match quality {
        Quality::Fast => {}
        Quality::Balanced => {
            references = presplit::presplit(references, primitives, &whole.bounds);
            whole = Part::of(&references);
        }
        Quality::High => {
            let n_triangles = references.iter().filter(|r| r.is_triangle()).count();
            let n_cuts = (CUTS_PER_TRIANGLE * n_triangles as f64) as usize;
            references.resize(references.len() + n_cuts, Reference::zeroed());
        }
    }
    let room = references.len();
    let mut nodes = bytemuck::zeroed_vec(2 * room - 1);
    let growth = Growth {
        primitives,
        simd: Simd::best(),
        half_area: whole.bounds.half_area(),
        report: |n_done: usize| report(n_done as f64 / room as f64),
    };
    let subtree = Subtree {
        part: whole,
        depth: 0,
        references: &mut references,
        spare: &mut bytemuck::zeroed_vec(room),
        nodes: &mut nodes,
    };
    subtree.grow(&growth);
    nodes
}
