//! Timing on a simulated machine with other work.

use std::cell::Cell;
use std::time::Duration;

use super::*;

/// A machine with other work, in simulated nanoseconds.
struct BusyMachine {
    now_ns: Cell<u64>,
    /// CPU time of the thread.
    cpu_ns: Cell<u64>,
    /// The time without a CPU before and after the last query for an interruption.
    waited_ns: [Cell<u64>; 2],
    /// CPU time between two interruptions, which are reported, and how long they last.
    slices: [u64; 2],
    /// CPU time between two pauses, which are not reported, and how long they last.
    pauses: [u64; 2],
}

/// Cost of the cold caches after an interruption.
const COLD_NS: u64 = 2000;

impl BusyMachine {
    fn new(slices: [u64; 2], pauses: [u64; 2]) -> Self {
        Self {
            now_ns: 0.into(),
            cpu_ns: 0.into(),
            waited_ns: [0.into(), 0.into()],
            slices,
            pauses,
        }
    }

    /// Works for `ns` nanoseconds.
    fn work(&self, ns: u64) {
        let add = |sum: &Cell<u64>, ns| sum.set(sum.get() + ns);
        let (begin, end) = (self.cpu_ns.get(), self.cpu_ns.get() + ns);
        let n = |[every, _]: [u64; 2]| end / every - begin / every;
        let (n_interruptions, n_pauses) = (n(self.slices), n(self.pauses));
        let waited_ns = n_interruptions * self.slices[1];
        add(&self.waited_ns[1], waited_ns);
        add(&self.now_ns, ns + waited_ns + n_interruptions * COLD_NS);
        add(&self.now_ns, n_pauses * self.pauses[1]);
        add(&self.cpu_ns, ns);
    }
}

impl Timer for &BusyMachine {
    fn now(&mut self) -> Instant {
        Instant::from_ticks(self.now_ns.get())
    }

    fn elapsed_ns(&self, from: Instant, to: Instant) -> f32 {
        (to.ticks() - from.ticks()).max(1) as f32
    }

    fn is_interrupted(&mut self) -> bool {
        let [before, after] = &self.waited_ns;
        let new_ns = after.take();
        before.set(before.get() + new_ns);
        new_ns > 0
    }

    fn waited_ns(&self) -> u64 {
        self.waited_ns[0].get()
    }
}

/// Times pixels that take `ns`, then the disturbed ones again.
fn timed(machine: &BusyMachine, n: usize, ns: impl Fn(usize) -> u64) -> [Vec<PixelTime>; 2] {
    let mut stopwatch = Stopwatch::new(machine);
    let mut times = vec![PixelTime::default(); n];
    let render = |i: usize| machine.work(ns(i));
    assert_eq!(stopwatch.time_each(&mut times, render), n);
    let first = times.clone();
    stopwatch.time_again(&mut times, 1e6, is_spike, render);
    [first, times]
}

/// Returns times of pixels that are far apart.
fn varied_ns(i: usize) -> u64 {
    300 + i as u64 * 7919 % 1009 * 5
}

#[test]
fn on_a_machine_with_other_work_every_time_is_that_of_the_pixel() {
    // The thread has the CPU for one 61st of the time.
    let machine = BusyMachine::new([50_000, 3_000_000], [333_000, 120_000]);
    let [first, times] = timed(&machine, 256, varied_ns);
    let is_wrong = |(i, time): &(usize, &PixelTime)| time.ns != varied_ns(*i) as f32;
    assert!(first.iter().enumerate().filter(is_wrong).count() > 14);
    assert_eq!(
        times.iter().enumerate().find(is_wrong).map(|(i, _)| i),
        None
    );
    assert!(first.iter().any(|time| time.is_rejected));
    assert!(times.iter().all(|time| !time.is_rejected));
}

#[test]
fn a_pixel_that_is_always_interrupted_has_its_cpu_time() {
    let machine = BusyMachine::new([3_000_000, 5_000_000], [u64::MAX, 0]);
    let [_, times] = timed(&machine, 4, |_| 10_000_000);
    for time in times {
        assert!(time.is_rejected);
        let cold_ns = time.ns - 1e7;
        assert!((0.0..=4.0 * COLD_NS as f32).contains(&cold_ns), "{cold_ns}");
    }
}

#[test]
fn a_hot_pixel_stays_hot() {
    let ns = |i| if i == 7 { 90_000 } else { 500 };
    let machine = BusyMachine::new([u64::MAX, 0], [u64::MAX, 0]);
    let [_, times] = timed(&machine, 16, ns);
    assert!(
        times
            .iter()
            .enumerate()
            .all(|(i, time)| time.ns == ns(i) as f32)
    );
}

#[test]
fn a_long_disturbed_pixel_is_rendered_again_by_itself() {
    let machine = BusyMachine::new([250_000, 3_000_000], [u64::MAX, 0]);
    let mut stopwatch = Stopwatch::new(&machine);
    let mut times = [PixelTime::default(); 4];
    stopwatch.time_each(&mut times, |_| machine.work(100_000));
    assert_eq!(
        times.map(|time| time.is_rejected),
        [false, false, true, false]
    );
    let mut again = Vec::new();
    stopwatch.time_again(
        &mut times,
        2e5,
        |_, _| false,
        |i| {
            again.push(i);
            machine.work(50_000);
        },
    );
    assert_eq!(again, [2]);
    assert_eq!(times[2].ns, 50_000.0);
}

#[test]
fn waiting_is_no_work() {
    let machine = BusyMachine::new([50_000, 3_000_000], [u64::MAX, 0]);
    let mut stopwatch = Stopwatch::new(&machine);
    let ns = stopwatch.time(|_| machine.work(1_000_000));
    assert_eq!(ns, 1_000_000.0 + 20.0 * COLD_NS as f64);
}

#[test]
fn an_interrupted_pixel_of_a_thread_and_the_one_after_a_short_one_are_rejected() {
    let clock = Clock::calibrated();
    let mut wait = CpuWait::of_this_thread();
    let mut times = [PixelTime::default(); 2];
    let mut stopwatch = Stopwatch::new(ThreadTimer {
        clock: &clock,
        wait: &mut wait,
    });
    stopwatch.time_each(&mut times, |i| {
        if i == 0 {
            std::thread::sleep(Duration::from_micros(50));
        }
    });
    if wait.waited_ns() > 0 {
        let [interrupted, next] = times;
        assert!(interrupted.is_rejected);
        assert!(next.is_rejected || interrupted.ns >= WARM_NS);
    }
}
