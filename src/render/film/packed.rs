//! The counters of pixels, compressed.

use std::ops::Range;

use tracer::cost::{Counter, Counters};

/// The counters of some pixels. Counts saturate at 2^32 - 1.
///
/// Each counter is stored as byte planes: one plane for the lowest bytes of all pixels, one for the
/// next bytes and so on. Planes of zeros are omitted: counts up to 255, which are common, take one
/// byte, and counts of 0 none. Writing all bytes would take as long as counting.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PackedCounters {
    n_pixels: usize,
    /// The planes that are present, one bit each.
    present: u32,
    planes: Vec<u8>,
}

/// Planes per counter; the first one has the lowest bytes.
const N_PLANES: u32 = u32::BITS / u8::BITS;

const _: () = assert!(Counter::ALL.len() as u32 * N_PLANES <= u32::BITS);

/// One bit per plane of a counter.
const PLANES: u32 = (1 << N_PLANES) - 1;

/// The bits of the planes with the highest bytes.
const HIGHEST: u32 = 0x8888_8888;

impl PackedCounters {
    /// Packs the counters.
    pub fn new(counters: &Counters) -> Self {
        let bits = Counter::ALL.map(|counter| {
            let counts = counters.get(counter).iter();
            let bits = counts.fold(0, |bits, count| bits | count);
            u32::try_from(bits).unwrap_or(u32::MAX)
        });
        let is_used = |(counter, plane)| bits[counter as usize] >> (u8::BITS * plane) & 0xff != 0;
        let used = || all_planes().filter(|&plane| is_used(plane));
        let n_pixels = counters.n_pixels();
        let mut planes = vec![0; n_pixels * used().count()];
        for (bytes, (counter, plane)) in planes.chunks_exact_mut(n_pixels.max(1)).zip(used()) {
            let counts = counters.get(counter);
            match bits[counter as usize] {
                u32::MAX => write_plane(bytes, &saturated(counts), plane),
                _ => write_plane(bytes, counts, plane),
            }
        }
        Self {
            n_pixels,
            present: used().fold(0, |present, (counter, plane)| present | bit(counter, plane)),
            planes,
        }
    }

    /// Returns the number of pixels.
    pub fn n_pixels(&self) -> usize {
        self.n_pixels
    }

    /// Returns the packed counters as bytes, in parts: equal for equal counters of the same number
    /// of pixels.
    pub fn bytes(&self) -> [&[u8]; 2] {
        [bytemuck::bytes_of(&self.present), &self.planes]
    }

    /// Returns an upper bound of the bytes that `append_to` appends for `n_pixels` pixels in any
    /// number of parts.
    pub fn max_bytes(n_pixels: usize) -> usize {
        let per_pixel = Counter::ALL.len() * N_PLANES as usize;
        n_pixels * (per_pixel + 2 * size_of::<u32>())
    }

    /// Appends the counters as bytes: the number of pixels, the bits of the present planes, and the
    /// planes.
    pub(crate) fn append_to(&self, bytes: &mut Vec<u8>) {
        bytes.extend((self.n_pixels as u32).to_le_bytes());
        bytes.extend(self.present.to_le_bytes());
        bytes.extend(&self.planes);
    }

    /// Reads counters of at most `n_pixels` pixels, at least one, from the start of bytes that
    /// [`append_to`](Self::append_to) wrote. Returns them and the bytes after them.
    pub(crate) fn split_from(bytes: &[u8], n_pixels: usize) -> Option<(Self, &[u8])> {
        let (stored, bytes) = bytes.split_first_chunk()?;
        let (present, bytes) = bytes.split_first_chunk()?;
        let [stored, present] = [*stored, *present].map(u32::from_le_bytes);
        let stored = stored as usize;
        if stored == 0 || stored > n_pixels {
            return None;
        }
        let n_bytes = stored * present.count_ones() as usize;
        let (planes, rest) = bytes.split_at_checked(n_bytes)?;
        let packed = Self {
            n_pixels: stored,
            present,
            planes: planes.to_vec(),
        };
        Some((packed, rest))
    }

    /// Adds one counter of these pixels, which are rows of `width` pixels, to rows of `sums` that
    /// start `stride` apart. Sums saturate at 2^32 - 1.
    pub fn add_to(
        &self,
        counter: Counter,
        pixels: Range<usize>,
        [width, stride]: [usize; 2],
        sums: &mut [u32],
    ) {
        let mut present = self.present >> (N_PLANES * counter as u32) & PLANES;
        let before = self.present & (bit(counter, 0) - 1);
        let mut planes = self.planes[before.count_ones() as usize * self.n_pixels..]
            .chunks_exact(self.n_pixels.max(1));
        while present != 0
            && let Some(plane) = planes.next()
        {
            let shift = u8::BITS * present.trailing_zeros();
            let rows = sums
                .chunks_mut(stride)
                .zip(plane[pixels.clone()].chunks_exact(width));
            // Without highest bytes, no sum of a few counters overflows.
            if self.present & HIGHEST == 0 {
                rows.for_each(|(sums, bytes)| add_row(sums, bytes, shift));
            } else {
                rows.for_each(|(sums, bytes)| add_row_saturating(sums, bytes, shift));
            }
            present &= present - 1;
        }
    }
}

/// Adds a plane of a row to the first sums.
#[inline]
fn add_row(sums: &mut [u32], bytes: &[u8], shift: u32) {
    // Chunks of sixteen compile to vector instructions.
    let (many, rest) = bytes.as_chunks::<16>();
    let (many_sums, rest_sums) = sums[..bytes.len()].as_chunks_mut::<16>();
    for (sums, bytes) in many_sums.iter_mut().zip(many) {
        for (sum, &byte) in sums.iter_mut().zip(bytes) {
            *sum += u32::from(byte) << shift;
        }
    }
    for (sum, &byte) in rest_sums.iter_mut().zip(rest) {
        *sum += u32::from(byte) << shift;
    }
}

/// Adds a plane of a row to the first sums, which saturate.
fn add_row_saturating(sums: &mut [u32], bytes: &[u8], shift: u32) {
    for (sum, &byte) in sums.iter_mut().zip(bytes) {
        *sum = sum.saturating_add(u32::from(byte) << shift);
    }
}

/// Writes one byte of each count; all counts are below 2^32.
fn write_plane(bytes: &mut [u8], counts: &[u64], plane: u32) {
    let byte = |count: u64| (count as u32 >> (u8::BITS * plane)) as u8;
    // Chunks of sixteen compile to vector instructions.
    let (many, rest) = bytes.as_chunks_mut::<16>();
    let (many_counts, rest_counts) = counts.as_chunks::<16>();
    for (bytes, counts) in many.iter_mut().zip(many_counts) {
        *bytes = counts.map(byte);
    }
    for (to, &count) in rest.iter_mut().zip(rest_counts) {
        *to = byte(count);
    }
}

/// Returns the counts, saturated at 2^32 - 1.
#[cold]
fn saturated(counts: &[u64]) -> Vec<u64> {
    let saturated = counts.iter().map(|&count| count.min(u32::MAX.into()));
    saturated.collect()
}

/// Returns the planes of all counters, in the order in which they are stored.
fn all_planes() -> impl Iterator<Item = (Counter, u32)> {
    let planes = |counter| (0..N_PLANES).map(move |plane| (counter, plane));
    Counter::ALL.into_iter().flat_map(planes)
}

/// Returns the bit of a plane in `present`.
fn bit(counter: Counter, plane: u32) -> u32 {
    1 << (N_PLANES * counter as u32 + plane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracer::cost::Cost;

    /// Returns pixels with these numbers of visits, tests, shadow rays and bounces.
    fn counters(pixels: &[[u64; 4]]) -> Counters {
        let mut counters = Counters::default();
        counters.reset(pixels.len(), 1);
        for (i, &[node_visits, primitive_tests, shadow, depth]) in pixels.iter().enumerate() {
            let cost = Cost {
                node_visits,
                primitive_tests,
                rays: [1, shadow, 0, 0, 0],
                depth,
            };
            counters.add(i, &cost);
        }
        counters
    }

    #[test]
    fn packing_is_lossless_up_to_saturation() {
        let most = u64::from(u32::MAX);
        let few = [
            [1, 0, most, 0x1_0000],
            [255, 256, 0, 0],
            [0, most - 1, 7, 0xff_00ff],
            [3, 1 << 24, most + 1, 1],
            [0, 0, most << 9, 0],
        ];
        let pixels = few.repeat(7);
        let packed = PackedCounters::new(&counters(&pixels));
        let kept = [
            Counter::NodeVisits,
            Counter::PrimitiveTests,
            Counter::ShadowRays,
            Counter::Depth,
        ];
        for (i, counter) in kept.into_iter().enumerate() {
            for range in [0..35, 1..4, 13..34, 2..2] {
                for before in [0, 9] {
                    let mut sums = vec![before; range.len()];
                    let row = [range.len().max(1); 2];
                    packed.add_to(counter, range.clone(), row, &mut sums);
                    let counts = pixels[range.clone()].iter().map(|pixel| pixel[i].min(most));
                    let expected = counts.map(|count| before.saturating_add(count as u32));
                    assert!(sums.into_iter().eq(expected));
                }
            }
        }
        let mut none = [4, 5];
        packed.add_to(Counter::ReflectionRays, 1..3, [2, 2], &mut none);
        assert_eq!(none, [4, 5]);
    }

    #[test]
    fn zeros_take_no_memory_and_small_counts_one_byte() {
        let n_bytes = |pixels: &[[u64; 4]]| PackedCounters::new(&counters(pixels)).planes.len();
        assert_eq!(n_bytes(&[[0; 4]; 3]), 0);
        assert_eq!(n_bytes(&[[0, 255, 0, 0], [7, 0, 0, 0]]), 4);
        assert_eq!(n_bytes(&[[0x1_0001, 0, 0, 0], [0, 0, 0, 1]]), 6);
    }
}
