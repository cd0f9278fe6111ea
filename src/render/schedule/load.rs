//! The load balance of the threads.

use super::TileRun;

/// Balance of the work among threads. A thread is busy while it renders a tile. The rendering lasts
/// from the start of the first tile to the end of the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// The longest busy time of a thread over the mean of all threads, minus 1: how much longer the
    /// slowest thread was busy than in a balanced rendering.
    ///
    /// Pearce, Gamblin et al., "Quantifying the Effectiveness of Load Balance Algorithms", ICS
    /// 2012.
    pub load_imbalance: f64,
    /// The fraction of the threads' time without a tile: 1 minus the sum of the busy times over the
    /// number of threads times the duration of the rendering. 1 minus this is the parallel
    /// efficiency of the POP metrics (pop-coe.eu).
    pub idle_share: f64,
}

impl Load {
    /// Computes the load of `n_threads` threads that rendered these tiles; both numbers are 0 if
    /// the tiles took no time.
    pub fn measure(runs: &[TileRun], n_threads: u32) -> Self {
        let mut busy_ns = vec![0_u64; n_threads as usize];
        for run in runs {
            busy_ns[run.thread as usize] += run.duration_ns();
        }
        let longest = busy_ns.iter().copied().max().unwrap_or(0) as f64;
        let all = busy_ns.iter().sum::<u64>() as f64;
        let start = runs.iter().map(|run| run.start_ns).min().unwrap_or(0);
        let end = runs.iter().map(|run| run.end_ns).max().unwrap_or(0);
        let threads_time = f64::from(n_threads) * (end - start) as f64;
        if all == 0.0 {
            return Self {
                load_imbalance: 0.0,
                idle_share: 0.0,
            };
        }
        Self {
            load_imbalance: longest * f64::from(n_threads) / all - 1.0,
            idle_share: 1.0 - all / threads_time,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(thread: u32, start_ns: u64, end_ns: u64) -> TileRun {
        TileRun {
            thread,
            start_ns,
            end_ns,
            ..TileRun::default()
        }
    }

    #[test]
    fn the_load_of_a_small_schedule() {
        // Busy for 90, 60 and 30 ns of 100 ns, and one thread without a tile.
        let runs = [
            run(0, 0, 50),
            run(1, 10, 70),
            run(2, 20, 50),
            run(0, 60, 100),
        ];
        let load = Load::measure(&runs, 4);
        assert_eq!(load.load_imbalance, 90.0 / 45.0 - 1.0);
        assert_eq!(load.idle_share, 1.0 - 180.0 / 400.0);
    }

    #[test]
    fn equal_threads_are_balanced_and_so_is_a_single_one() {
        let even = [run(0, 0, 10), run(1, 0, 10)];
        let alone = [run(0, 5, 10), run(0, 10, 25)];
        for (runs, n_threads) in [(&even, 2), (&alone, 1)] {
            let load = Load::measure(runs, n_threads);
            assert_eq!((load.load_imbalance, load.idle_share), (0.0, 0.0));
        }
    }

    #[test]
    fn no_time_is_no_imbalance() {
        for runs in [&[][..], &[run(0, 0, 0)]] {
            let load = Load::measure(runs, 2);
            assert_eq!((load.load_imbalance, load.idle_share), (0.0, 0.0));
        }
    }
}
