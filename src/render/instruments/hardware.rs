//! Hardware performance counters, through Linux perf events.

use std::io::{self, ErrorKind};
use std::path::Path;

use indexmap::IndexMap;

use super::energy::EnergyMeters;

/// The counters of this thread and of all threads that start later, and the meters of the machine's
/// energy, or the reasons why there are none.
#[derive(Debug)]
pub struct HardwareCounters {
    counters: Result<Vec<Open>, String>,
    energy: EnergyMeters,
}

/// The names of all counters.
pub const EVENTS: [&str; 6] = [
    "cycles",
    "instructions",
    "cache_references",
    "cache_misses",
    "branches",
    "branch_misses",
];

/// Counts by the counters' names.
pub type Counts = IndexMap<&'static str, u64>;

#[cfg(target_os = "linux")]
mod open {
    use std::io;

    use perf_event::events::{Event, Hardware};
    use perf_event::{Builder, Counter};

    /// A running counter.
    #[derive(Debug)]
    pub(super) struct Open {
        pub(super) name: &'static str,
        counter: Counter,
    }

    impl Open {
        /// Opens a counter of this process's threads, without kernel mode.
        pub(super) fn new(name: &'static str, event: impl Event) -> io::Result<Self> {
            let mut builder = Builder::new(event);
            let counter = builder.inherit(true).enabled(true).build()?;
            Ok(Self { name, counter })
        }

        /// Returns the number of events so far. If the processor has fewer counters than requested,
        /// the kernel multiplexes them and the number covers only the time in which the counter
        /// ran.
        pub(super) fn read(&mut self) -> Option<u64> {
            self.counter.read().ok()
        }
    }

    /// Opens all counters.
    pub(super) fn all() -> io::Result<Vec<Open>> {
        let events = [
            Hardware::CPU_CYCLES,
            Hardware::INSTRUCTIONS,
            Hardware::CACHE_REFERENCES,
            Hardware::CACHE_MISSES,
            Hardware::BRANCH_INSTRUCTIONS,
            Hardware::BRANCH_MISSES,
        ];
        let named = super::EVENTS.into_iter().zip(events);
        named.map(|(name, event)| Open::new(name, event)).collect()
    }
}

#[cfg(not(target_os = "linux"))]
mod open {
    /// A counter; this system has none.
    #[derive(Debug)]
    pub(super) struct Open {
        pub(super) name: &'static str,
    }

    impl Open {
        pub(super) fn read(&mut self) -> Option<u64> {
            None
        }
    }

    pub(super) fn all() -> std::io::Result<Vec<Open>> {
        Err(std::io::Error::other("they are supported on Linux only"))
    }
}

use open::Open;

impl HardwareCounters {
    /// Starts all counters and meters.
    pub fn start() -> Self {
        Self {
            counters: open::all().map_err(|error| reason(&error)),
            energy: EnergyMeters::start(Path::new("/sys")),
        }
    }

    /// Starts no counters, as none were requested.
    pub fn none() -> Self {
        let why_not = "not requested: render with --hardware-counters";
        Self {
            counters: Err(why_not.to_owned()),
            energy: EnergyMeters::none(why_not),
        }
    }

    /// Returns the reason why there are no counters, if there are none.
    pub fn why_not(&self) -> Option<&str> {
        self.counters.as_ref().err().map(String::as_str)
    }

    /// Returns the reason why no energy is measured, if it is not.
    pub fn why_no_energy(&self) -> Option<&str> {
        self.energy.why_not()
    }

    /// Returns the energy of all processor packages of the machine since the last call, or since
    /// the start, in joules.
    pub fn energy_since(&mut self) -> Option<f64> {
        self.energy.lap()
    }

    /// Returns all counts so far.
    pub fn read(&mut self) -> Counts {
        let counters = self.counters.iter_mut().flatten();
        let read = counters.filter_map(|open| Some((open.name, open.read()?)));
        read.collect()
    }
}

/// Describes why counters are not available.
fn reason(error: &io::Error) -> String {
    let why = match error.kind() {
        ErrorKind::NotFound => "the processor or the virtual machine provides none",
        ErrorKind::PermissionDenied => {
            "the kernel denies access: set /proc/sys/kernel/perf_event_paranoid to 2 or less"
        }
        _ => return format!("not available here: {error}"),
    };
    format!("not available here: {why}")
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::hint::spin_loop;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use cpu_time::ThreadTime;
    use perf_event::events::Software;

    use super::*;

    /// Counts the CPU time of a thread that starts later, which all machines can count, and which
    /// does not depend on the memory that the process has used before. The thread lives until its
    /// count is read: if it ended first, the kernel may add its last microseconds after it is
    /// joined.
    #[test]
    fn other_threads_count_too() {
        let Ok(clock) = Open::new("cpu_ns", Software::TASK_CLOCK) else {
            // Without permission to use perf events `why_not` gives the reason.
            assert!(HardwareCounters::start().why_not().is_some());
            return;
        };
        let mut counters = HardwareCounters {
            counters: Ok(vec![clock]),
            energy: EnergyMeters::none(""),
        };
        let before = counters.read()["cpu_ns"];
        let (worked, has_worked) = channel();
        let (end, may_end) = channel::<()>();
        let thread = std::thread::spawn(move || {
            let start = ThreadTime::now();
            while start.elapsed() < Duration::from_millis(20) {
                spin_loop();
            }
            worked.send(()).unwrap();
            may_end.recv().unwrap_err();
        });
        has_worked.recv().unwrap();
        let after = counters.read()["cpu_ns"];
        drop(end);
        thread.join().unwrap();
        // This thread has waited: its own time is far less.
        assert!(after >= before + 10_000_000, "{before} to {after}");
    }
}
