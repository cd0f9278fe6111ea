//! What a library of devices offers: OpenCL and CUDA stand behind the same traits.
//!
//! A [`LibraryDevice`] compiles a [`DeviceProgram`]; loaded with the arrays of a scene, as a
//! [`LoadedProgram`], it creates a [`LaunchQueue`] for each thread.

use std::fmt;
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use crate::program::Kernel;
use base::stop;
use host::start_detached;
use tracer::cost::KernelWork;

/// Rays or triples of a launch that share a group.
pub(crate) const GROUP: usize = 64;
/// Time after which a device that has not finished a launch counts as hung.
pub(crate) const MAX_LAUNCH: Duration = Duration::from_secs(30);
/// Time after which a compiler counts as hung: programs of many materials take it half a minute.
const MAX_COMPILATION: Duration = Duration::from_secs(600);

/// Why a device cannot go on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum DeviceFault {
    /// The system does not have this library.
    Missing(&'static str),
    /// A call failed with this name of an error.
    Call(String),
    /// The program cannot be built; the compiler's first lines.
    Build(String),
    /// A launch or a compilation has not finished in this time.
    Hang(Duration),
    /// The work was stopped.
    Stopped,
}

impl DeviceFault {
    /// Returns that the program cannot be built, with the first lines of the compiler's log.
    pub(crate) fn of_build(log: &str) -> Self {
        let lines = log.lines().filter(|line| !line.trim().is_empty());
        Self::Build(lines.take(3).collect::<Vec<_>>().join("; "))
    }
}

impl fmt::Display for DeviceFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(library) => write!(f, "it has no `{library}`"),
            Self::Call(name) => write!(f, "{name}"),
            Self::Build(log) => write!(f, "its compiler refuses the program: {log}"),
            Self::Hang(limit) => write!(f, "it has not finished in {} s", limit.as_secs()),
            Self::Stopped => write!(f, "stopped"),
        }
    }
}

/// A device of a library.
pub(crate) trait LibraryDevice: Send + Sync {
    /// Returns the device's name and its driver's.
    fn name(&self) -> String;

    /// Returns the bytes of its memory.
    fn n_bytes(&self) -> u64;

    /// Returns the most bytes of one array.
    fn max_array_bytes(&self) -> u64 {
        self.n_bytes()
    }

    /// Returns true if it computes in double precision.
    fn has_doubles(&self) -> bool {
        true
    }

    /// Compiles a program, given without the prelude of the device's language.
    fn compile(&self, text: &str) -> Result<Arc<dyn DeviceProgram>, DeviceFault>;
}

/// A compiled program.
pub(crate) trait DeviceProgram: Send + Sync {
    /// Copies the arrays of a scene to the device's memory; none is empty. A kernel has as many of
    /// them as first arguments as it reads: [`Kernel::n_arrays`].
    fn load(self: Arc<Self>, arrays: &[&[u32]]) -> Result<LoadedProgram, DeviceFault>;
}

/// Creates queues of a program with the arrays of a scene.
pub(crate) type LoadedProgram =
    Box<dyn Fn() -> Result<Box<dyn LaunchQueue>, DeviceFault> + Send + Sync>;

/// A queue with memory for the input and the output of launches, reused from launch to launch.
pub(crate) trait LaunchQueue: Send {
    /// Runs a kernel for `n` items, at least one: its arguments are its arrays, the input, the
    /// output and `n`. Returns the nanoseconds that it took on the device.
    ///
    /// After an error, the device may still read the input, and write to the queue's memory and to the
    /// output: none of them must be dropped.
    fn launch(
        &mut self,
        kernel: Kernel,
        input: &[u32],
        output: &mut [u32],
        n: usize,
    ) -> Result<f64, DeviceFault>;

    /// Returns the work of a kernel that was not launched, with what the library says about it.
    fn facts(&mut self, kernel: Kernel) -> Result<KernelWork, DeviceFault>;
}

/// Compiles a program, without trust in the compiler: one that hangs keeps its thread.
pub(crate) fn compile(
    machine: &Arc<dyn LibraryDevice>,
    text: String,
) -> Result<Arc<dyn DeviceProgram>, DeviceFault> {
    let (machine, (sender, receiver)) = (Arc::clone(machine), mpsc::channel());
    let started = start_detached(move || sender.send(machine.compile(&text)).unwrap_or_default());
    started.map_err(|error| DeviceFault::Call(error.to_string()))?;
    wait(MAX_COMPILATION, || match receiver.try_recv() {
        Err(mpsc::TryRecvError::Empty) => Ok(None),
        Err(error) => Err(DeviceFault::Call(error.to_string())),
        Ok(compiled) => compiled.map(Some),
    })
}

/// Waits until there is a result, without trust in the driver.
pub(crate) fn wait<T>(
    limit: Duration,
    result: impl Fn() -> Result<Option<T>, DeviceFault>,
) -> Result<T, DeviceFault> {
    let begin = Instant::now();
    loop {
        if let Some(found) = result()? {
            return Ok(found);
        }
        let waited = begin.elapsed();
        if waited > limit {
            return Err(DeviceFault::Hang(limit));
        }
        if stop::is_requested() && waited > Duration::from_secs(2) {
            return Err(DeviceFault::Stopped);
        }
        // As long again as the wait so far, so that short launches are noticed soon.
        thread::sleep((waited / 8).clamp(Duration::from_micros(5), Duration::from_millis(2)));
    }
}
