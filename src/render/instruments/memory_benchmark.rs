//! Benchmark of memory bandwidth and latency over the size of a block, and of the peak rate of
//! instructions.
//!
//! For the bandwidth one thread, then all threads together, read the block sequentially with the
//! SIMD instructions of the kernels. For the latency one thread follows a chain of cache lines
//! through the block in pseudo-random order. The best of several tries counts, since other
//! processes can only slow down a try.

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::sync::Barrier;
use std::time::{Duration, Instant};

use bytemuck::{Pod, Zeroable};

use super::{DataCache, HardwareCounters, MachineLimits, MemoryBlock};
use math::simd::Simd;

/// Size of the smallest block in words of four bytes: 16 KiB.
const MIN_WORDS: usize = 1 << 12;
/// Maximum size of a block in bytes: it exceeds all but the largest caches.
const MAX_BYTES: u64 = 1 << 30;
/// Size of the largest block in bytes if the caches are unknown.
const DEFAULT_MAX_BYTES: u64 = 1 << 28;
/// Number of words in a cache line.
const N_LINE_WORDS: usize = size_of::<Line>() / 4;
/// Minimum and maximum number of words that a try reads: 16 MiB and 64 MiB. Only the first try,
/// which is not timed, reads more.
const N_TRY_WORDS: [usize; 2] = [1 << 22, 1 << 24];
/// Number of tries; the best one counts.
const N_TRIES: usize = 4;
/// Number of cache lines that a try fetches one after the other.
const N_LINKS: usize = 20_000;

/// An aligned cache line: no SIMD load crosses its end.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 16]);

impl MachineLimits {
    /// Measures this machine on the current rayon pool, which takes about two seconds.
    pub fn measure() -> Self {
        let caches = read_caches(Path::new("/sys/devices/system/cpu/cpu0/cache"));
        let n_threads = rayon::current_num_threads();
        // All words are 1.0, so no sum is subnormal.
        let line = Line([1_f32.to_bits(); N_LINE_WORDS]);
        let mut lines =
            vec![line; max_block_bytes(&caches, host::available_memory()) / size_of::<Line>()];
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut lines);
        let sizes = || {
            (0..)
                .map(|power| MIN_WORDS << power)
                .take_while(|&n| n <= words.len())
        };
        let bandwidths: Vec<[f64; 2]> = sizes()
            .map(|n| [1, n_threads].map(|n_threads| bandwidth(&words[..n], n_threads)))
            .collect();
        let sizes: Vec<usize> = sizes().collect();
        let blocks = sizes.into_iter().zip(bandwidths);
        let blocks = blocks.map(|(n, [bandwidth_alone, bandwidth_shared])| MemoryBlock {
            bytes: 4.0 * n as f64,
            latency_ns: latency_ns(&mut words[..n]),
            bandwidth_alone,
            bandwidth_shared,
        });
        Self {
            caches,
            n_threads,
            blocks: blocks.collect(),
            instructions_per_second: instructions_per_second(),
        }
    }
}

/// Returns the size of the largest block in bytes, a power of two: four times the largest cache, at
/// most a fourth of the available memory.
fn max_block_bytes(caches: &[DataCache], available_bytes: u64) -> usize {
    let four_times = caches.iter().map(|cache| 4 * cache.bytes).max();
    let wanted = four_times.unwrap_or(DEFAULT_MAX_BYTES).next_power_of_two();
    let most = MAX_BYTES.min(available_bytes / 4).max(4 * MIN_WORDS as u64);
    wanted.min(1 << most.ilog2()) as usize
}

/// Returns the data caches of the first CPU as Linux reports them in `folder`, by ascending size.
fn read_caches(folder: &Path) -> Vec<DataCache> {
    let cache = |index: usize| {
        let read = |name: &str| fs::read_to_string(folder.join(format!("index{index}/{name}")));
        let kib = read("size").ok()?;
        let kib: u64 = kib.trim().strip_suffix('K')?.parse().ok()?;
        let is_for_data = read("type").is_ok_and(|kind| kind.trim() != "Instruction");
        is_for_data.then_some(DataCache {
            name: format!("L{}", read("level").ok()?.trim()),
            bytes: kib << 10,
        })
    };
    let mut caches: Vec<DataCache> = (0..8).filter_map(cache).collect();
    caches.sort_by_key(|cache| cache.bytes);
    caches
}

/// Returns the bandwidth in GB/s of each of `n_threads` threads, one or the whole pool, that read
/// the same block from different offsets: the bandwidth of the slowest thread in the best try.
fn bandwidth(words: &[u32], n_threads: usize) -> f64 {
    let barrier = Barrier::new(n_threads);
    let (numbers, barrier) = (bytemuck::cast_slice::<u32, f32>(words), &barrier);
    let of_thread = |thread: usize| {
        let begin = thread * numbers.len() / n_threads / 64 * 64;
        let simd = Simd::best();
        let tries = 0..=N_TRIES;
        let seconds = tries.map(move |number| {
            barrier.wait();
            let start = Instant::now();
            // The first try loads the block into the caches that can hold it.
            let n_words = match number {
                0 => numbers.len(),
                _ => n_words_per_try(numbers.len()),
            };
            // In a large block a later try reads another part than the last one did.
            let mut at = (begin + number.saturating_sub(1) * n_words) % numbers.len();
            let mut left = n_words;
            while left > 0 {
                let part = &numbers[at..numbers.len().min(at + left)];
                black_box(simd.sum(black_box(part)));
                (at, left) = (0, left - part.len());
            }
            start.elapsed()
        });
        seconds.skip(1).collect::<Vec<Duration>>()
    };
    let times = match n_threads {
        1 => vec![of_thread(0)],
        _ => rayon::broadcast(|thread| of_thread(thread.index())),
    };
    let of_try = |number: usize| times.iter().filter_map(|times| times.get(number)).max();
    let best = (0..N_TRIES).filter_map(of_try).min();
    let ns = best.map_or(f64::INFINITY, |best| best.as_nanos().max(1) as f64);
    4.0 * n_words_per_try(numbers.len()) as f64 / ns
}

/// Returns the number of words that a try reads: a small block many times, a large one in part.
fn n_words_per_try(n_words: usize) -> usize {
    let [least, most] = N_TRY_WORDS;
    n_words.max(least).min(most)
}

/// Returns the latency in nanoseconds of following one link, in the best try. Overwrites the words.
fn latency_ns(words: &mut [u32]) -> f64 {
    link(words);
    let mut at = 0;
    let mut times = [Duration::ZERO; N_TRIES];
    for time in &mut times {
        let start = Instant::now();
        for _ in 0..N_LINKS {
            at = words[at as usize];
        }
        *time = start.elapsed();
    }
    black_box(at);
    let best = times.into_iter().min().unwrap_or_default();
    best.as_nanos().max(1) as f64 / N_LINKS as f64
}

/// Stores in the first word of each cache line the index of the next one, such that the links form
/// one cycle through all lines. The number of lines must be a power of two: the order comes from a
/// linear congruential generator of full period (Hull and Dobell, "Random Number Generators", SIAM
/// Review, 1962).
fn link(words: &mut [u32]) {
    let n_lines = words.len() / N_LINE_WORDS;
    for line in 0..n_lines {
        let next = (line * 1_664_525 + 1_013_904_223) % n_lines;
        words[line * N_LINE_WORDS] = (next * N_LINE_WORDS) as u32;
    }
}

/// Returns the instructions per second in a loop of independent additions, or `None` if the system
/// cannot count instructions.
fn instructions_per_second() -> Option<f64> {
    let mut counters = HardwareCounters::start();
    let mut tries = (0..N_TRIES).map(|_| {
        let before = *counters.read().get("instructions")?;
        let start = Instant::now();
        let mut sums = [0_u64; 6];
        for i in 0..black_box(2_000_000) {
            for (number, sum) in sums.iter_mut().enumerate() {
                *sum = sum.wrapping_add(i) ^ number as u64;
            }
        }
        black_box(sums);
        let seconds = start.elapsed().as_secs_f64();
        let after = *counters.read().get("instructions")?;
        Some((after - before) as f64 / seconds)
    });
    let rates: Option<Vec<f64>> = tries.by_ref().collect();
    rates?.into_iter().reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_go_once_through_all_lines() {
        for n_lines in [256, 1 << 14] {
            let mut words = vec![0; n_lines * N_LINE_WORDS];
            link(&mut words);
            let mut seen = vec![false; n_lines];
            let mut at = 0;
            for _ in 0..n_lines {
                assert!(!std::mem::replace(&mut seen[at / N_LINE_WORDS], true));
                at = words[at] as usize;
            }
            assert_eq!(at, 0);
        }
    }

    #[test]
    fn the_largest_block_leaves_the_caches_and_memory_free() {
        let cache = |bytes| {
            let name = "L3".to_owned();
            [DataCache { name, bytes }]
        };
        let (mib, gib) = (1_u64 << 20, 1_u64 << 30);
        assert_eq!(max_block_bytes(&cache(12 * mib), 64 * gib), 64 << 20);
        assert_eq!(max_block_bytes(&cache(512 * mib), 64 * gib), 1 << 30);
        assert_eq!(max_block_bytes(&cache(12 * mib), 100 * mib), 16 << 20);
        assert_eq!(max_block_bytes(&[], 64 * gib), 1 << 28);
        assert_eq!(max_block_bytes(&[], 0), 16 << 10);
    }

    #[test]
    fn caches_are_those_that_linux_reports() {
        let folder = tempfile::tempdir().unwrap();
        let reported = [
            ("1", "Data", "48K"),
            ("1", "Instruction", "32K"),
            ("2", "Unified", "2048K"),
        ];
        for (index, (level, kind, size)) in reported.into_iter().enumerate() {
            let of_index = folder.path().join(format!("index{index}"));
            fs::create_dir(&of_index).unwrap();
            for (name, text) in [("level", level), ("type", kind), ("size", size)] {
                fs::write(of_index.join(name), format!("{text}\n")).unwrap();
            }
        }
        let found = read_caches(folder.path()).into_iter();
        let found: Vec<(String, u64)> = found.map(|cache| (cache.name, cache.bytes)).collect();
        assert_eq!(
            found,
            [("L1".to_owned(), 48 << 10), ("L2".to_owned(), 2 << 20)]
        );
        assert!(read_caches(Path::new("/nowhere")).is_empty());
    }

    #[test]
    fn every_number_is_positive() {
        let mut words = vec![1_f32.to_bits(); MIN_WORDS];
        for n_threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
            let pool = pool.build().unwrap();
            let bandwidth = pool.install(|| bandwidth(&words, n_threads));
            assert!(bandwidth > 0.0 && bandwidth.is_finite());
        }
        assert!(latency_ns(&mut words) > 0.0);
    }
}
