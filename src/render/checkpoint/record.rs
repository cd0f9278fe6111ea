//! A finished tile ↔ bytes.

use std::borrow::Cow;

use super::RecordLayout;
use crate::film::PackedCounters;
use crate::schedule::{Tile, TileRun};
use tracer::cost::Cost;

/// A tile of one rendering of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct TileRecord<'a> {
    /// Number of the rendering, from 0, among several that repeat the picture.
    pub rendering: u8,
    /// Number of the tile in the grid.
    pub tile: u32,
    /// The thread, the times and the counters of the tile; its position in the order of tiles is
    /// not kept.
    pub run: TileRun,
    /// The counters of its pixels, in parts of whole rows; empty if nothing was counted.
    pub counters: Vec<PackedCounters>,
    /// The pixels in the film's arrays, bit for bit.
    pub pixels: Cow<'a, [u8]>,
}

/// Bytes of a record besides its counters and its pixels.
const FIXED_BYTES: usize = 1 + 4 + 4 + 4 + 5 * 8 + N_COUNTS * 8 + 4;
/// Numbers of a [`Cost`].
const N_COUNTS: usize = 8;
/// Latest time in nanoseconds: sums of many stay below 2^64.
const MAX_NS: u64 = 1 << 53;
/// Greatest number of threads.
pub(super) const MAX_THREADS: u32 = 1 << 16;

impl<'a> TileRecord<'a> {
    /// Returns an upper bound of the bytes of a record with this layout.
    pub(super) fn max_bytes(layout: &RecordLayout) -> usize {
        let n_pixels = layout.tile_size.pow(2) as usize;
        let counters = PackedCounters::max_bytes(n_pixels);
        FIXED_BYTES + n_pixels * layout.bytes_per_pixel as usize + counters
    }

    /// Appends the record as bytes: numbers with the lowest byte first, pixels as in memory.
    pub fn append_to(&self, bytes: &mut Vec<u8>) {
        let run = &self.run;
        bytes.push(self.rendering);
        bytes.extend(self.tile.to_le_bytes());
        bytes.extend(run.rank.to_le_bytes());
        bytes.extend(run.thread.to_le_bytes());
        let parts = [run.film_ns, run.warm_up_ns, run.waiting_ns];
        let times = [run.start_ns, run.end_ns].into_iter().chain(parts);
        for number in times.chain(counts(&run.counted)) {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend((self.counters.len() as u32).to_le_bytes());
        for part in &self.counters {
            part.append_to(bytes);
        }
        bytes.extend(&*self.pixels);
    }

    /// Reads a record of a rendering with this layout from all of `bytes`. Returns `None` if they
    /// are not a record.
    pub fn parse(bytes: &'a [u8], layout: &RecordLayout) -> Option<Self> {
        let mut bytes = Bytes(bytes);
        let record = bytes.head(layout)?;
        let place = layout.grid(record.rendering).tile(record.tile);
        let counters = bytes.counters(&place)?;
        let n_bytes = place.n_pixels() * layout.bytes_per_pixel as usize;
        (bytes.0.len() == n_bytes).then(|| Self {
            counters,
            pixels: bytes.0.into(),
            ..record
        })
    }

    /// Reads the start of a record's bytes: all but the counters and the pixels. Returns `None` if
    /// they are not a record.
    pub(crate) fn parse_head(bytes: &[u8], layout: &RecordLayout) -> Option<TileRecord<'static>> {
        Bytes(bytes).head(layout)
    }

    /// Returns the record with owned pixels.
    pub fn into_owned(self) -> TileRecord<'static> {
        TileRecord {
            pixels: self.pixels.into_owned().into(),
            ..self
        }
    }
}

/// Returns the numbers of a cost.
fn counts(cost: &Cost) -> [u64; N_COUNTS] {
    let [camera, shadow, reflection, refraction, diffuse] = cost.rays;
    let [visits, tests] = [cost.node_visits, cost.primitive_tests];
    [
        visits, tests, camera, shadow, reflection, refraction, diffuse, cost.depth,
    ]
}

/// Bytes that are read from the start.
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl Bytes<'_> {
    pub(super) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.array()?))
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.array()?))
    }

    /// Reads a time in nanoseconds.
    pub(super) fn time(&mut self) -> Option<u64> {
        self.u64().filter(|&ns| ns < MAX_NS)
    }

    fn cost(&mut self) -> Option<Cost> {
        let mut numbers = [0; N_COUNTS];
        for number in &mut numbers {
            *number = self.u64()?;
        }
        let [node_visits, primitive_tests, rays @ .., depth] = numbers;
        Some(Cost {
            node_visits,
            primitive_tests,
            rays,
            depth,
        })
    }

    /// Reads a record without its counters and its pixels.
    fn head(&mut self, layout: &RecordLayout) -> Option<TileRecord<'static>> {
        let [rendering] = self.array()?;
        let [tile, rank, thread] = [self.u32()?, self.u32()?, self.u32()?];
        let is_there = rendering < layout.n_renderings
            && tile < layout.grid(rendering).n_tiles()
            && rank.max(thread) < MAX_THREADS;
        if !is_there {
            return None;
        }
        let run = TileRun {
            is_missing: false,
            rank,
            thread,
            position: 0,
            start_ns: self.time()?,
            end_ns: self.time()?,
            film_ns: self.time()?,
            warm_up_ns: self.time()?,
            waiting_ns: self.time()?,
            counted: self.cost()?,
        };
        (run.start_ns <= run.end_ns).then_some(TileRecord {
            rendering,
            tile,
            run,
            counters: Vec::new(),
            pixels: Cow::Borrowed(&[]),
        })
    }

    /// Reads the counters of a tile: parts of whole rows that cover it, or none.
    fn counters(&mut self, tile: &Tile) -> Option<Vec<PackedCounters>> {
        let mut n_left = tile.n_pixels();
        let mut counters = Vec::new();
        for _ in 0..self.u32()? {
            let (part, rest) = PackedCounters::split_from(self.0, n_left)?;
            if part.n_pixels() % tile.width() != 0 {
                return None;
            }
            n_left -= part.n_pixels();
            self.0 = rest;
            counters.push(part);
        }
        (counters.is_empty() || n_left == 0).then_some(counters)
    }
}
