//! Running kernels in turn, and their times.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use cpu_time::ThreadTime;
use math::statistics::upper_median;

use crate::kernel::Kernel;
use crate::rays::Rays;

/// The parameters of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct Course {
    pub n_threads: usize,
    /// Rays per batch.
    pub batch: usize,
    /// Number of runs of each kernel.
    pub n_rounds: usize,
}

impl Course {
    /// Measures the times of each kernel for all rays, in seconds.
    pub fn times(&self, kernels: &[&dyn Kernel], rays: &Rays) -> Vec<Vec<f64>> {
        let batches = rays.batches(self.batch);
        in_turn(self.n_rounds, kernels, |kernel| {
            self.seconds(*kernel, &batches)
        })
    }

    /// Measures the time of the kernel for all batches in seconds: the mean CPU time of the
    /// threads, so that other load on the machine disturbs little.
    fn seconds(&self, kernel: &dyn Kernel, batches: &[Rays]) -> f64 {
        let next = AtomicUsize::new(0);
        let work = || {
            let start = ThreadTime::now();
            let (mut hits, mut occluded) = (Vec::new(), Vec::new());
            loop {
                match batches.get(next.fetch_add(1, Ordering::Relaxed)) {
                    Some(Rays::Nearest(rays)) => kernel.nearest(rays, &mut hits),
                    Some(Rays::Any(rays)) => kernel.any(rays, &mut occluded),
                    None => break start.elapsed(),
                }
            }
        };
        let all: Duration = thread::scope(|scope| {
            let threads: Vec<_> = (0..self.n_threads).map(|_| scope.spawn(work)).collect();
            let join =
                |thread: thread::ScopedJoinHandle<_>| thread.join().expect("kernels do not panic");
            threads.into_iter().map(join).sum()
        });
        all.as_secs_f64() / self.n_threads as f64
    }
}

/// Measures the times of each runner, in seconds; they run A B C, A B C, … so that drifts of the
/// machine's speed affect all of them equally.
pub fn in_turn<T>(
    n_rounds: usize,
    runners: &[T],
    mut seconds: impl FnMut(&T) -> f64,
) -> Vec<Vec<f64>> {
    let mut times = vec![Vec::with_capacity(n_rounds); runners.len()];
    for _ in 0..n_rounds {
        for (times, runner) in times.iter_mut().zip(runners) {
            times.push(seconds(runner));
        }
    }
    times
}

/// Returns the upper median of at least one time.
pub fn median(times: &[f64]) -> f64 {
    upper_median(&mut times.to_vec(), f64::total_cmp).unwrap_or_default()
}
