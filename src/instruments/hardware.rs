//! Hardware performance counters, through Linux perf events.

use std::io::{self, ErrorKind};

use indexmap::IndexMap;

/// The counters of this thread and of all threads that start later, or the reason
/// why there are none.
#[derive(Debug)]
pub struct HardwareCounters {
    counters: Result<Vec<Open>, String>,
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

        /// Returns the number of events so far. If the processor has fewer
        /// counters than requested, the kernel multiplexes them and the number is
        /// that of the time in which the counter ran.
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
    /// A counter, of which this system has none.
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
    /// Starts all counters.
    pub fn start() -> Self {
        Self {
            counters: open::all().map_err(|error| reason(&error)),
        }
    }

    /// Starts no counters, as none were requested.
    pub fn none() -> Self {
        Self {
            counters: Err("not requested: render with --hardware-counters".to_owned()),
        }
    }

    /// Returns the reason why there are no counters, if there are none.
    pub fn why_not(&self) -> Option<&str> {
        self.counters.as_ref().err().map(String::as_str)
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
    use perf_event::events::Software;

    use super::*;

    /// Counts a software event, which all machines support, in a thread that
    /// starts later.
    #[test]
    fn other_threads_count_too() {
        let Ok(faults) = Open::new("page_faults", Software::PAGE_FAULTS) else {
            // Without permission to use perf events `why_not` gives the reason.
            assert!(HardwareCounters::start().why_not().is_some());
            return;
        };
        let mut counters = HardwareCounters {
            counters: Ok(vec![faults]),
        };
        let before = counters.read()["page_faults"];
        let touch = || std::hint::black_box(vec![1_u8; 16 << 20]).len();
        std::thread::spawn(touch).join().unwrap();
        let after = counters.read()["page_faults"];
        assert!(after >= before + 1000, "{before} to {after}");
    }
}
