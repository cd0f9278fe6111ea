//! What the machine gives at most: measured, and kept beside a study's runs.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::results::differing;
use crate::text::Diagnostic;

/// The format's number: files of others are refused.
const FORMAT: u32 = 1;
/// Blocks of which a mean is taken.
const N_STEPS: i32 = 256;

/// What memory gives a thread at most, over the size of what is read, and how
/// many instructions a thread executes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Data caches that the machine tells of, the nearest one first; none where
    /// it tells nothing.
    pub caches: Vec<Cache>,
    /// Threads that read where all do.
    pub n_threads: usize,
    /// By ascending size, each twice the one before; at least one.
    pub blocks: Vec<Block>,
    /// Instructions that a simple loop executes in a second on one thread; none
    /// where they cannot be counted.
    pub instructions_per_second: Option<f64>,
}

/// A data cache.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cache {
    /// "L1".
    pub name: String,
    /// What it holds, in bytes.
    pub bytes: u64,
}

/// A block of memory that is read again and again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Size of the block.
    pub bytes: f64,
    /// From asking for a line, anywhere in it, until it is there.
    pub latency_ns: f64,
    /// Bytes a nanosecond, so GB/s, that one thread reads alone, in order.
    pub bandwidth_alone: f64,
    /// The same for each of the threads where all read this block.
    pub bandwidth_shared: f64,
}

/// A cache, or what lies behind all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryLevel {
    /// "L1", "DRAM"; "64 KiB" where the machine does not tell its caches.
    pub name: String,
    /// A block that it holds.
    pub block: Block,
}

impl Limits {
    /// Reading a block of so many bytes: between two that were measured, as the
    /// logarithms of both lie on a straight line; beyond them, the last one.
    pub fn block(&self, bytes: f64) -> Block {
        let after = self.blocks.partition_point(|block| block.bytes < bytes);
        let last = self.blocks.len() - 1;
        let [a, b] = [after.saturating_sub(1), after.min(last)].map(|i| self.blocks[i]);
        if a.bytes >= b.bytes {
            return Block { bytes, ..b };
        }
        let share = (bytes / a.bytes).ln() / (b.bytes / a.bytes).ln();
        let between = |a: f64, b: f64| a * (b / a).powf(share);
        Block {
            bytes,
            latency_ns: between(a.latency_ns, b.latency_ns),
            bandwidth_alone: between(a.bandwidth_alone, b.bandwidth_alone),
            bandwidth_shared: between(a.bandwidth_shared, b.bandwidth_shared),
        }
    }

    /// What rays find that come down a tree of so many bytes, whose nodes have
    /// `node_bytes`: each level is some times as large as the one above, and of
    /// each a ray fetches as much. So the time of a fetch, and of a byte, is the
    /// mean over the blocks from a node to the tree, by the logarithm of their
    /// size.
    pub fn tree(&self, bytes: f64, node_bytes: f64) -> Block {
        let ratio = (bytes / node_bytes).max(1.0);
        let middle = |step: i32| (f64::from(step) + 0.5) / f64::from(N_STEPS);
        let size = |step| node_bytes * ratio.powf(middle(step));
        let mean = |of: fn(Block) -> f64| {
            let sum: f64 = (0..N_STEPS).map(|step| of(self.block(size(step)))).sum();
            sum / f64::from(N_STEPS)
        };
        Block {
            bytes,
            latency_ns: mean(|block| block.latency_ns),
            bandwidth_alone: 1.0 / mean(|block| 1.0 / block.bandwidth_alone),
            bandwidth_shared: 1.0 / mean(|block| 1.0 / block.bandwidth_shared),
        }
    }

    /// The levels of memory, the nearest one first, each by a block that is as
    /// many times larger than the cache before as it is smaller than its own:
    /// part of a shared cache may belong to others. Where the caches are not
    /// known, every fourth block.
    pub fn levels(&self) -> Vec<MemoryLevel> {
        let level = |name: String, block: &Block| MemoryLevel {
            name,
            block: *block,
        };
        let Some(last) = self.caches.last() else {
            let every_fourth = self.blocks.iter().rev().step_by(4).rev();
            let named = every_fourth.map(|block| level(size_name(block.bytes), block));
            return named.collect();
        };
        // The nearest cache has none before it: a block of half its size.
        let nearest = self.caches[0].bytes as f64 / 4.0;
        let before = self.caches.iter().map(|cache| cache.bytes as f64);
        let before = std::iter::once(nearest).chain(before);
        let of_cache = |(cache, before): (&Cache, f64)| {
            let most = (cache.bytes as f64 * before).sqrt();
            let mut fitting = self.blocks.iter().rev().filter(|block| block.bytes <= most);
            Some(level(cache.name.clone(), fitting.next()?))
        };
        // What the last cache holds half of or more is not yet memory's.
        let behind = self.blocks.last();
        let behind = behind.filter(|block| block.bytes >= 2.0 * last.bytes as f64);
        let caches = self.caches.iter().zip(before).filter_map(of_cache);
        let memory = behind.map(|block| level("DRAM".to_owned(), block));
        caches.chain(memory).collect()
    }

    /// Reads the file of limits that stands beside runs of which `made_by` tells;
    /// `None` if there is no such file.
    ///
    /// # Errors
    /// A file that cannot be read, that holds no limits, or those of another
    /// program or machine. It is left as it is.
    pub fn read_from(path: &Path, made_by: &Value) -> Result<Option<Self>, Diagnostic> {
        let remedy = "move the file away to measure anew, or give another folder by `--out`";
        let name = path.display();
        let refused = |message: String| Err(Diagnostic::new(message).with_help(remedy));
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return refused(format!("cannot read `{name}`: {error}")),
        };
        let Ok(file) = serde_json::from_str::<LimitsFile>(&text) else {
            return refused(format!("`{name}` holds no limits of a machine"));
        };
        if file.raycost_limits != FORMAT {
            let found = file.raycost_limits;
            return refused(format!(
                "`{name}` has format {found} of limits, this raycost has {FORMAT}"
            ));
        }
        if let Some(key) = differing(&file.made_by, made_by) {
            return refused(format!(
                "the limits in `{name}` were measured with another {key}"
            ));
        }
        match file.limits.blocks.is_empty() {
            true => refused(format!("`{name}` holds no limits of a machine")),
            false => Ok(Some(file.limits)),
        }
    }

    /// What the file holds that [`read_from`](Self::read_from) reads.
    pub fn to_file(&self, made_by: &Value) -> impl Serialize {
        LimitsFile {
            raycost_limits: FORMAT,
            made_by: made_by.clone(),
            limits: self.clone(),
        }
    }
}

/// The whole file.
#[derive(Serialize, Deserialize)]
struct LimitsFile {
    raycost_limits: u32,
    made_by: Value,
    limits: Limits,
}

/// "64 KiB".
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

    fn limits(caches: &[(&str, u64)]) -> Limits {
        let cache = |(name, bytes): &(&str, u64)| Cache {
            name: (*name).to_owned(),
            bytes: *bytes,
        };
        let block = |power: i32| Block {
            bytes: 2_f64.powi(14 + power),
            latency_ns: 2_f64.powi(power),
            bandwidth_alone: 2_f64.powi(10 - power),
            bandwidth_shared: 2_f64.powi(9 - power),
        };
        Limits {
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
        // Up to the first block all blocks are alike; then latency doubles with
        // the size: the mean of 2^x over x from 0 to 4, half of the levels.
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
        let names_and_bytes = |limits: &Limits| -> Vec<(String, f64)> {
            let levels = limits.levels().into_iter();
            let pair = |level: MemoryLevel| (level.name, level.block.bytes / 1024.0);
            levels.map(pair).collect()
        };
        let known = limits(&[("L1", 48 * kib), ("L2", 1024 * kib)]);
        let expected = [("L1", 16.0), ("L2", 128.0), ("DRAM", 4096.0)];
        let expected = expected.map(|(name, kib)| (name.to_owned(), kib));
        assert_eq!(names_and_bytes(&known), expected);
        // A cache that holds half of the largest block: nothing is known of DRAM.
        let large = limits(&[("L1", 48 * kib), ("L3", 4096 * kib)]);
        assert_eq!(names_and_bytes(&large).last().unwrap().0, "L3");
        let unknown = names_and_bytes(&limits(&[]));
        let names: Vec<&str> = unknown.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["16 KiB", "256 KiB", "4 MiB"]);
    }
}
