//! Measuring what memory gives, over the size of what is read.
//!
//! A block of memory is read by one thread, then by all at once, in order and
//! with the kernels' own instructions, for the bandwidth; then line after line
//! in an order of which each line tells the next, for the latency. The best of
//! some tries counts: others on the machine can only slow it down.

use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::sync::Barrier;
use std::time::{Duration, Instant};

use bytemuck::{Pod, Zeroable};

use super::limits::{Block, Cache, Limits};
use crate::accel::Simd;
use crate::instruments::HardwareCounters;
use crate::memory;

/// Size of the least block, in words of four bytes: 16 KiB.
const LEAST: usize = 1 << 12;
/// Most bytes of a block: enough to leave any cache but the largest.
const MOST_BYTES: u64 = 1 << 30;
/// Largest block where the caches are not known, in bytes.
const USUAL_BYTES: u64 = 1 << 28;
/// Words of a cache line.
const LINE: usize = size_of::<Line>() / 4;
/// Words that are read at least before a try has a time, and at most, but for
/// the first one: 16 MiB and 64 MiB.
const TRY: [usize; 2] = [1 << 22, 1 << 24];
/// Tries of which the best one counts.
const N_TRIES: usize = 4;
/// Lines that are asked for, one after the other, in a try.
const N_LINKS: usize = 20_000;

/// A cache line, where one begins: no read goes over its end.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u32; 16]);

impl Limits {
    /// Measures this machine, in some two seconds.
    pub fn measure() -> Self {
        let caches = caches(Path::new("/sys/devices/system/cpu/cpu0/cache"));
        let n_threads = std::thread::available_parallelism().map_or(1, usize::from);
        // A number that is read as 1: sums of it are never subnormal.
        let line = Line([1_f32.to_bits(); LINE]);
        let mut lines = vec![line; largest(&caches, memory::available()) / size_of::<Line>()];
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut lines);
        let sizes = || {
            (0..)
                .map(|power| LEAST << power)
                .take_while(|&n| n <= words.len())
        };
        let bandwidths: Vec<[f64; 2]> = sizes()
            .map(|n| [1, n_threads].map(|n_threads| bandwidth(&words[..n], n_threads)))
            .collect();
        let sizes: Vec<usize> = sizes().collect();
        let blocks = sizes.into_iter().zip(bandwidths);
        let blocks = blocks.map(|(n, [bandwidth_alone, bandwidth_shared])| Block {
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

/// Bytes of the largest block, a power of two: four times the largest cache,
/// and a fourth of the free memory at most.
fn largest(caches: &[Cache], available_bytes: u64) -> usize {
    let four_times = caches.iter().map(|cache| 4 * cache.bytes).max();
    let wanted = four_times.unwrap_or(USUAL_BYTES).next_power_of_two();
    let most = MOST_BYTES.min(available_bytes / 4).max(4 * LEAST as u64);
    wanted.min(1 << most.ilog2()) as usize
}

/// The data caches that Linux tells of, as seen from the first CPU.
fn caches(folder: &Path) -> Vec<Cache> {
    let cache = |index: usize| {
        let read = |name: &str| fs::read_to_string(folder.join(format!("index{index}/{name}")));
        let kib = read("size").ok()?;
        let kib: u64 = kib.trim().strip_suffix('K')?.parse().ok()?;
        let is_for_data = read("type").is_ok_and(|kind| kind.trim() != "Instruction");
        is_for_data.then_some(Cache {
            name: format!("L{}", read("level").ok()?.trim()),
            bytes: kib << 10,
        })
    };
    let mut caches: Vec<Cache> = (0..8).filter_map(cache).collect();
    caches.sort_by_key(|cache| cache.bytes);
    caches
}

/// Bytes a nanosecond that each of so many threads reads of the same block,
/// each from another place on; of the slowest thread in the best try.
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
            // The first try brings the block into the caches that can hold it.
            let n_words = match number {
                0 => numbers.len(),
                _ => read_in_a_try(numbers.len()),
            };
            // The later ones of a large block do not read what the last one did.
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
    let times: Vec<Vec<Duration>> = std::thread::scope(|scope| {
        let start = |thread| scope.spawn(move || of_thread(thread));
        let threads: Vec<_> = (0..n_threads).map(start).collect();
        let ended = threads.into_iter().map(|thread| thread.join());
        ended.map(Result::unwrap_or_default).collect()
    });
    let of_try = |number: usize| times.iter().filter_map(|times| times.get(number)).max();
    let best = (0..N_TRIES).filter_map(of_try).min();
    let ns = best.map_or(f64::INFINITY, |best| best.as_nanos().max(1) as f64);
    4.0 * read_in_a_try(numbers.len()) as f64 / ns
}

/// Words that a try reads: of a small block some, all of it many times.
fn read_in_a_try(n_words: usize) -> usize {
    let [least, most] = TRY;
    n_words.max(least).min(most)
}

/// Nanoseconds from one line to the next that it tells, in the best try.
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

/// Makes each line tell the next one, in one round through all of them, a power
/// of two: a linear congruential generator of full period (Hull and Dobell,
/// "Random Number Generators", SIAM Review, 1962).
fn link(words: &mut [u32]) {
    let n_lines = words.len() / LINE;
    for line in 0..n_lines {
        let next = (line * 1_664_525 + 1_013_904_223) % n_lines;
        words[line * LINE] = (next * LINE) as u32;
    }
}

/// What a loop of additions reaches that do not wait for each other; none where
/// instructions cannot be counted.
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
            let mut words = vec![0; n_lines * LINE];
            link(&mut words);
            let mut seen = vec![false; n_lines];
            let mut at = 0;
            for _ in 0..n_lines {
                assert!(!std::mem::replace(&mut seen[at / LINE], true));
                at = words[at] as usize;
            }
            assert_eq!(at, 0);
        }
    }

    #[test]
    fn the_largest_block_leaves_the_caches_and_memory_free() {
        let cache = |bytes| {
            let name = "L3".to_owned();
            [Cache { name, bytes }]
        };
        let (mib, gib) = (1_u64 << 20, 1_u64 << 30);
        assert_eq!(largest(&cache(12 * mib), 64 * gib), 64 << 20);
        assert_eq!(largest(&cache(512 * mib), 64 * gib), 1 << 30);
        assert_eq!(largest(&cache(12 * mib), 100 * mib), 16 << 20);
        assert_eq!(largest(&[], 64 * gib), 1 << 28);
        assert_eq!(largest(&[], 0), 16 << 10);
    }

    #[test]
    fn caches_are_read_as_linux_tells_them() {
        let folder = tempfile::tempdir().unwrap();
        let told = [
            ("1", "Data", "48K"),
            ("1", "Instruction", "32K"),
            ("2", "Unified", "2048K"),
        ];
        for (index, (level, kind, size)) in told.into_iter().enumerate() {
            let of_index = folder.path().join(format!("index{index}"));
            fs::create_dir(&of_index).unwrap();
            for (name, text) in [("level", level), ("type", kind), ("size", size)] {
                fs::write(of_index.join(name), format!("{text}\n")).unwrap();
            }
        }
        let told = caches(folder.path()).into_iter();
        let told: Vec<(String, u64)> = told.map(|cache| (cache.name, cache.bytes)).collect();
        assert_eq!(
            told,
            [("L1".to_owned(), 48 << 10), ("L2".to_owned(), 2 << 20)]
        );
        assert!(caches(Path::new("/nowhere")).is_empty());
    }

    #[test]
    fn every_number_is_positive() {
        let mut words = vec![1_f32.to_bits(); LEAST];
        for n_threads in [1, 3] {
            let bandwidth = bandwidth(&words, n_threads);
            assert!(bandwidth > 0.0 && bandwidth.is_finite());
        }
        assert!(latency_ns(&mut words) > 0.0);
    }
}
