//! The section on the ranks of MPI.

use serde::{Deserialize, Serialize};
use sysinfo::System;

use render::ranks::{RankWork, Team};
use render::schedule::{Schedule, TileRun};

/// The ranks that rendered the picture, and how evenly they were busy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RanksSection {
    /// The number of ranks.
    pub n: u32,
    /// The longest busy time of a rank over the mean of all threads, minus 1; the busy time of a
    /// rank is the mean of its threads.
    pub load_imbalance: f64,
    /// Bytes of all messages with tiles.
    pub sent_bytes: u64,
    /// One entry per rank.
    pub of_rank: Vec<RankEntry>,
}

/// A rank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RankEntry {
    /// The name of its machine.
    pub host: String,
    /// Number of threads.
    pub threads: u32,
    /// The CPUs on which each thread may run, as Linux lists them, such as `0-3,8`; null where the
    /// system does not report them.
    #[serde(default)]
    pub affinity: Vec<Option<String>>,
    /// The number of tiles that the rank rendered, in the last of repeated renderings.
    pub n_tiles: u64,
    /// Time from the start to the end of each of these tiles, summed over all threads, in
    /// milliseconds.
    pub busy_ms: f64,
    /// Bytes of the rank's messages with tiles, or with their numbers, in all renderings.
    pub sent_bytes: u64,
    /// Time spent packing, sending, receiving and storing tiles, in milliseconds, summed over all
    /// threads.
    pub communication_ms: f64,
}

impl RanksSection {
    /// Describes the ranks of a team that rendered these tiles with this communication.
    pub fn new(team: &Team, schedule: &Schedule, work: &[RankWork]) -> Self {
        let entries = team.members.iter().zip(work).zip(0..);
        let of_rank = entries.map(|((member, work), rank)| {
            let host = member.host.clone();
            RankEntry::new(rank, host, member.affinity.clone(), schedule, *work)
        });
        Self::with(of_rank.collect())
    }

    /// Describes a single rank, which has sent nothing, with the CPUs of its threads.
    pub fn single(affinity: Vec<Option<String>>, schedule: &Schedule) -> Self {
        let host = System::host_name().unwrap_or_default();
        let nothing = RankWork::default();
        Self::with(vec![RankEntry::new(0, host, affinity, schedule, nothing)])
    }

    fn with(of_rank: Vec<RankEntry>) -> Self {
        Self {
            n: of_rank.len() as u32,
            load_imbalance: load_imbalance(&of_rank),
            sent_bytes: of_rank.iter().map(|rank| rank.sent_bytes).sum(),
            of_rank,
        }
    }
}

impl RankEntry {
    /// Describes a rank on this machine with this communication.
    fn new(
        rank: u32,
        host: String,
        affinity: Vec<Option<String>>,
        schedule: &Schedule,
        work: RankWork,
    ) -> Self {
        let here = || {
            let runs = schedule.rendered().map(|(_, run)| run);
            runs.filter(|run| run.rank == rank)
        };
        Self {
            host,
            threads: affinity.len() as u32,
            affinity,
            n_tiles: here().count() as u64,
            busy_ms: here().map(TileRun::duration_ns).sum::<u64>() as f64 / 1e6,
            sent_bytes: work.sent_bytes,
            communication_ms: work.communication_ns as f64 / 1e6,
        }
    }
}

/// Returns the longest mean busy time of a rank's threads over the mean of all threads, minus 1.
fn load_imbalance(ranks: &[RankEntry]) -> f64 {
    let per_thread = |rank: &RankEntry| rank.busy_ms / f64::from(rank.threads);
    let longest = ranks.iter().map(per_thread).fold(0.0, f64::max);
    let n_threads: u32 = ranks.iter().map(|rank| rank.threads).sum();
    let all: f64 = ranks.iter().map(|rank| rank.busy_ms).sum();
    if all > 0.0 {
        longest * f64::from(n_threads) / all - 1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_imbalance_is_that_of_the_mean_thread_of_each_rank() {
        let rank = |threads, busy_ms| RankEntry {
            host: "node".to_owned(),
            threads,
            affinity: Vec::new(),
            n_tiles: 1,
            busy_ms,
            sent_bytes: 0,
            communication_ms: 0.0,
        };
        // 30 ms and 60 ms per thread: 150 ms over three threads.
        let ranks = [rank(1, 30.0), rank(2, 120.0)];
        assert_eq!(load_imbalance(&ranks), 60.0 / 50.0 - 1.0);
        assert_eq!(load_imbalance(&[rank(1, 0.0), rank(2, 0.0)]), 0.0);
    }
}
