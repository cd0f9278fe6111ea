//! The processor's own counters, through the kernel's perf events.

use std::io::{self, ErrorKind};

use indexmap::IndexMap;

/// Counters of all threads that are started from now on, and of this one; or
/// why there are none.
#[derive(Debug)]
pub struct HardwareCounters {
    counters: Result<Vec<Open>, String>,
}

/// Counts by the counters' names.
pub type Counts = IndexMap<&'static str, u64>;

#[cfg(target_os = "linux")]
mod open {
    use std::io;

    use perf_event::events::{Event, Hardware};
    use perf_event::{Builder, Counter};

    /// A counter that runs.
    #[derive(Debug)]
    pub(super) struct Open {
        pub(super) name: &'static str,
        counter: Counter,
    }

    impl Open {
        /// A counter of this process's threads, the kernel's work left out.
        pub(super) fn new(name: &'static str, event: impl Event) -> io::Result<Self> {
            let mut builder = Builder::new(event);
            let counter = builder.inherit(true).enabled(true).build()?;
            Ok(Self { name, counter })
        }

        /// Events so far. Where the processor has fewer counters than are asked
        /// for they take turns: then a part of the time stands for all of it.
        pub(super) fn read(&mut self) -> Option<u64> {
            self.counter.read().ok()
        }
    }

    /// All that are read.
    pub(super) fn all() -> io::Result<Vec<Open>> {
        [
            ("cycles", Hardware::CPU_CYCLES),
            ("instructions", Hardware::INSTRUCTIONS),
            ("cache_references", Hardware::CACHE_REFERENCES),
            ("cache_misses", Hardware::CACHE_MISSES),
            ("branches", Hardware::BRANCH_INSTRUCTIONS),
            ("branch_misses", Hardware::BRANCH_MISSES),
        ]
        .into_iter()
        .map(|(name, event)| Open::new(name, event))
        .collect()
    }
}

#[cfg(not(target_os = "linux"))]
mod open {
    /// There is none.
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
        Err(std::io::Error::other("they are read on Linux alone"))
    }
}

use open::Open;

impl HardwareCounters {
    /// Counters that run from now on.
    pub fn start() -> Self {
        Self {
            counters: open::all().map_err(|error| reason(&error)),
        }
    }

    /// None, since nobody asked.
    pub fn none() -> Self {
        Self {
            counters: Err("not asked for: render with --hardware-counters".to_owned()),
        }
    }

    /// Why there are none, if so.
    pub fn why_not(&self) -> Option<&str> {
        self.counters.as_ref().err().map(String::as_str)
    }

    /// Counts so far.
    pub fn read(&mut self) -> Counts {
        let counters = self.counters.iter_mut().flatten();
        let read = counters.filter_map(|open| Some((open.name, open.read()?)));
        read.collect()
    }
}

/// Why counters cannot be had, in words.
fn reason(error: &io::Error) -> String {
    let why = match error.kind() {
        ErrorKind::NotFound => "the processor, or the virtual machine, has none to offer",
        ErrorKind::PermissionDenied => {
            "the kernel keeps them for itself: set /proc/sys/kernel/perf_event_paranoid to 2 or less"
        }
        _ => return format!("not available here: {error}"),
    };
    format!("not available here: {why}")
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use perf_event::events::Software;

    use super::*;

    /// Events that any machine counts: those of threads that are started later
    /// are among them.
    #[test]
    fn other_threads_count_too() {
        let Ok(faults) = Open::new("page_faults", Software::PAGE_FAULTS) else {
            // A machine that keeps perf events from its users: `why_not` says so.
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
