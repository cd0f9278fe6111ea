//! The limits of the machine for the roofline model: latency and bandwidth of memory, and the peak
//! rate of instructions.

use serde::{Deserialize, Serialize};

/// Number of block sizes over which [`MachineLimits::tree`] averages.
const N_STEPS: i32 = 256;

/// The limits per thread: latency and bandwidth of memory over the size of the block that is read,
/// and the peak rate of instructions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MachineLimits {
    /// The data caches that the system reports, the nearest one first; may be empty.
    pub caches: Vec<DataCache>,
    /// Number of threads that share the bandwidth in [`MemoryBlock::bandwidth_shared`].
    pub n_threads: usize,
    /// The measured blocks: at least one, by ascending size, each twice the size of the one before.
    pub blocks: Vec<MemoryBlock>,
    /// Instructions per second that one thread executes in a simple loop; `None` if the system
    /// cannot count them.
    pub instructions_per_second: Option<f64>,
}

/// A data cache.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DataCache {
    /// Name, such as "L1".
    pub name: String,
    /// Capacity in bytes.
    pub bytes: u64,
}

/// A block of memory that is read repeatedly.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MemoryBlock {
    /// Size in bytes.
    pub bytes: f64,
    /// Latency of a random access to a cache line in nanoseconds.
    pub latency_ns: f64,
    /// Sequential bandwidth of a single thread in GB/s.
    pub bandwidth_alone: f64,
    /// Sequential bandwidth of each thread in GB/s if all read the block.
    pub bandwidth_shared: f64,
}

/// A level of the memory hierarchy: a cache or main memory.
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryLevel {
    /// Name, such as "L1" or "DRAM"; a block size, such as "64 KiB", if the system does not report
    /// its caches.
    pub name: String,
    /// A block that fits in it.
    pub block: MemoryBlock,
}

impl MemoryBlock {
    /// Returns the sequential bandwidth per thread in GB/s with this number of threads at work.
    pub fn bandwidth(&self, n_threads: f64) -> f64 {
        if n_threads > 1.0 {
            self.bandwidth_shared
        } else {
            self.bandwidth_alone
        }
    }
}

impl MachineLimits {
    /// Returns the limits for a block of this size: interpolated on logarithmic scales between two
    /// measured blocks; beyond them, the limits of the nearest one.
    pub fn block(&self, bytes: f64) -> MemoryBlock {
        let after = self.blocks.partition_point(|block| block.bytes < bytes);
        let last = self.blocks.len() - 1;
        let [a, b] = [after.saturating_sub(1), after.min(last)].map(|i| self.blocks[i]);
        if a.bytes >= b.bytes {
            return MemoryBlock { bytes, ..b };
        }
        let share = (bytes / a.bytes).ln() / (b.bytes / a.bytes).ln();
        let between = |a: f64, b: f64| a * (b / a).powf(share);
        MemoryBlock {
            bytes,
            latency_ns: between(a.latency_ns, b.latency_ns),
            bandwidth_alone: between(a.bandwidth_alone, b.bandwidth_alone),
            bandwidth_shared: between(a.bandwidth_shared, b.bandwidth_shared),
        }
    }

    /// Returns the mean limits for rays that descend a tree of this size with nodes of
    /// `node_bytes`. Each level of the tree is larger than the one above by a constant factor, and
    /// a ray fetches the same amount from each, so the time per fetch, and per byte, is the mean
    /// over block sizes from a node to the tree that are equidistant on a logarithmic scale.
    pub fn tree(&self, bytes: f64, node_bytes: f64) -> MemoryBlock {
        let ratio = (bytes / node_bytes).max(1.0);
        let middle = |step: i32| (f64::from(step) + 0.5) / f64::from(N_STEPS);
        let size = |step| node_bytes * ratio.powf(middle(step));
        let mean = |of: fn(MemoryBlock) -> f64| {
            let sum: f64 = (0..N_STEPS).map(|step| of(self.block(size(step)))).sum();
            sum / f64::from(N_STEPS)
        };
        MemoryBlock {
            bytes,
            latency_ns: mean(|block| block.latency_ns),
            bandwidth_alone: 1.0 / mean(|block| 1.0 / block.bandwidth_alone),
            bandwidth_shared: 1.0 / mean(|block| 1.0 / block.bandwidth_shared),
        }
    }

    /// Returns the levels of the memory hierarchy, the nearest one first. Each is represented by a
    /// block whose size is the geometric mean of this cache and the previous one, since other
    /// processes may use part of a shared cache. If the caches are unknown, every fourth block.
    pub fn levels(&self) -> Vec<MemoryLevel> {
        let level = |name: String, block: &MemoryBlock| MemoryLevel {
            name,
            block: *block,
        };
        let Some(last) = self.caches.last() else {
            let every_fourth = self.blocks.iter().rev().step_by(4).rev();
            let named = every_fourth.map(|block| level(size_name(block.bytes), block));
            return named.collect();
        };
        // There is no cache before the nearest one: take a block of half its size.
        let nearest = self.caches[0].bytes as f64 / 4.0;
        let before = self.caches.iter().map(|cache| cache.bytes as f64);
        let before = std::iter::once(nearest).chain(before);
        let of_cache = |(cache, before): (&DataCache, f64)| {
            let most = (cache.bytes as f64 * before).sqrt();
            let mut fitting = self.blocks.iter().rev().filter(|block| block.bytes <= most);
            Some(level(cache.name.clone(), fitting.next()?))
        };
        // A block half of which fits in the last cache does not measure main memory.
        let behind = self.blocks.last();
        let behind = behind.filter(|block| block.bytes >= 2.0 * last.bytes as f64);
        let caches = self.caches.iter().zip(before).filter_map(of_cache);
        let memory = behind.map(|block| level("DRAM".to_owned(), block));
        caches.chain(memory).collect()
    }
}

/// Returns a size with its unit, such as "64 KiB".
fn size_name(bytes: f64) -> String {
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB"), (0, "bytes")];
    let unit = |power: i32| 2_f64.powi(power);
    let fits = |(power, _): &(i32, &str)| bytes >= unit(*power);
    let (power, name) = units.into_iter().find(fits).unwrap_or((0, "bytes"));
    format!("{:.0} {name}", bytes / unit(power))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(caches: &[(&str, u64)]) -> MachineLimits {
        let cache = |(name, bytes): &(&str, u64)| DataCache {
            name: (*name).to_owned(),
            bytes: *bytes,
        };
        let block = |power: i32| MemoryBlock {
            bytes: 2_f64.powi(14 + power),
            latency_ns: 2_f64.powi(power),
            bandwidth_alone: 2_f64.powi(10 - power),
            bandwidth_shared: 2_f64.powi(9 - power),
        };
        MachineLimits {
            caches: caches.iter().map(cache).collect(),
            n_threads: 2,
            blocks: (0..9).map(block).collect(),
            instructions_per_second: None,
        }
    }

    #[test]
    fn between_two_blocks_logarithms_lie_on_a_line() {
        let limits = limits(&[]);
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        let between = limits.block(2_f64.powf(16.5));
        assert!(close(between.latency_ns, 2_f64.powf(2.5)), "{between:?}");
        assert!(close(between.bandwidth_alone, 2_f64.powf(7.5)));
        assert_eq!(limits.block(2_f64.powi(17)).latency_ns, 8.0);
        assert_eq!(limits.block(10.0).latency_ns, 1.0);
        assert_eq!(limits.block(1e12).bandwidth_shared, 2.0);
    }

    #[test]
    fn a_tree_is_the_mean_of_its_levels() {
        // Up to the first block all latencies are equal; then they double with the size: the mean
        // of 2^x over x from 0 to 4, half of the levels.
        let tree = limits(&[]).tree(2_f64.powi(18), 2_f64.powi(10));
        let of_rest = (2_f64.powi(4) - 1.0) / 4.0 / 2_f64.ln();
        let expected = 0.5 * (1.0 + of_rest);
        assert!((tree.latency_ns / expected - 1.0).abs() < 1e-3, "{tree:?}");
        assert!((tree.bandwidth_alone * expected / 1024.0 - 1.0).abs() < 1e-3);
        assert_eq!(limits(&[]).tree(64.0, 256.0).latency_ns, 1.0);
    }

    #[test]
    fn a_level_is_a_block_between_two_caches() {
        let kib = 1024;
        let names_and_bytes = |limits: &MachineLimits| -> Vec<(String, f64)> {
            let levels = limits.levels().into_iter();
            let pair = |level: MemoryLevel| (level.name, level.block.bytes / 1024.0);
            levels.map(pair).collect()
        };
        let known = limits(&[("L1", 48 * kib), ("L2", 1024 * kib)]);
        let expected = [("L1", 16.0), ("L2", 128.0), ("DRAM", 4096.0)];
        let expected = expected.map(|(name, kib)| (name.to_owned(), kib));
        assert_eq!(names_and_bytes(&known), expected);
        // A cache that holds half of the largest block: DRAM was not measured.
        let large = limits(&[("L1", 48 * kib), ("L3", 4096 * kib)]);
        assert_eq!(names_and_bytes(&large).last().unwrap().0, "L3");
        let unknown = names_and_bytes(&limits(&[]));
        let names: Vec<&str> = unknown.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["16 KiB", "256 KiB", "4 MiB"]);
    }
}
