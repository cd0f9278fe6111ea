//! Options of a rendering.

use std::sync::Arc;
use std::{fmt, io};

use super::RenderError;
use base::stop::Cancellation;
use device::Device;
use host::text::Diagnostic;
use host::{advice, affinity, start_threads};
use render::ranks::local_rank;
use render::tiles::{OnProgress, Progress};
use scene::config::{Pinning, SimdSet, Traversal};

/// The way in which a scene is rendered, besides the settings of its config.
///
/// ```
/// # use raycost::session::{Event, Options};
/// # let show = |_: Event| {};
/// let options = Options {
///     threads: Some(2),
///     on_event: Some(&show),
///     ..Options::default()
/// };
/// ```
#[derive(Clone, Default)]
pub struct Options<'a> {
    /// Number of threads, at least 1; `None` for one per processor.
    pub threads: Option<u16>,
    /// The places of the threads.
    pub pin: Pinning,
    /// The instruction set; `None` for the fastest one of the processor.
    pub simd: Option<SimdSet>,
    /// The way in which the rays of a wave are traced.
    pub traversal: Traversal,
    /// A device that follows the paths in place of the processor, or traces their rays: same
    /// picture, same counters.
    pub device: Option<Arc<Device>>,
    /// If true, a few rays estimate the work of each tile before the rendering, for
    /// [`Progress::work`]; otherwise all pixels count the same.
    pub estimates_work: bool,
    /// If true, [`Rendering::write`](super::Rendering::write) also writes cloud and frame as
    /// VTKHDF; needs the cargo feature `hdf5`.
    pub vtkhdf: bool,
    /// Cancels the rendering.
    pub cancellation: Cancellation,
    /// Called with each event, from any thread.
    pub on_event: Option<&'a (dyn Fn(Event) + Sync)>,
}

/// The progress of a rendering.
#[derive(Debug, Clone, Copy)]
pub enum Event {
    /// A stage starts: `build`, `render`, `observe`, `lanes`, `survey` or `write`.
    Begin {
        /// Name of the stage.
        stage: &'static str,
        /// Number of pixels that it will process; 0 for `build`.
        n_pixels: u64,
    },
    /// Another part of the acceleration structure was built.
    Built {
        /// The part, from 0 to 1; all parts add up to 1.
        fraction: f64,
    },
    /// More pixels were rendered.
    Rendered(Progress),
    /// The stage has ended.
    End,
}

impl Options<'_> {
    /// Reports an event.
    pub(super) fn report(&self, event: Event) {
        if let Some(on_event) = self.on_event {
            on_event(event);
        }
    }

    /// Does the work of a stage and reports its events.
    pub(super) fn reported<T>(
        &self,
        stage: &'static str,
        n_pixels: u64,
        work: impl FnOnce(OnProgress) -> T,
    ) -> T {
        self.report(Event::Begin { stage, n_pixels });
        let result = work(&|progress| self.report(Event::Rendered(progress)));
        self.report(Event::End);
        result
    }

    /// Starts the threads.
    pub(crate) fn thread_pool(&self) -> Result<rayon::ThreadPool, RenderError> {
        let is_pinned = self.pin == Pinning::Cores;
        if is_pinned {
            // Before they start: a thousand threads take a second.
            cpus_for(self.threads.map_or(1, usize::from))?;
        }
        let pool = thread_pool(self.threads, &self.cancellation).map_err(RenderError::Machine)?;
        if is_pinned {
            pin(&pool)?;
        }
        Ok(pool)
    }
}

/// Returns the CPUs of the machine for this many pinned threads.
///
/// # Errors
/// There are fewer, or the system does not report them.
fn cpus_for(n: usize) -> Result<Vec<usize>, RenderError> {
    let cpus = affinity::cpus_by_core().map_err(not_pinned)?;
    if n <= cpus.len() {
        return Ok(cpus);
    }
    let message = format!(
        "cannot pin the threads: there are {n}, but only {} CPUs",
        cpus.len()
    );
    let help = format!("use `--threads {}`", cpus.len());
    Err(RenderError::Scene(Diagnostic::new(message).with_help(help)))
}

fn not_pinned(error: io::Error) -> RenderError {
    let message = Diagnostic::new(format!("cannot pin the threads: {error}"));
    RenderError::Machine(message.with_help("leave out `--pin`, which only Linux has"))
}

/// Restricts each thread of a pool to one CPU. Processes that were launched together on this machine
/// take CPUs in turn, unless the launcher has given each its own.
fn pin(pool: &rayon::ThreadPool) -> Result<(), RenderError> {
    let n = pool.current_num_threads();
    let cpus = cpus_for(n)?;
    let first = n * local_rank();
    let pinned =
        pool.broadcast(|thread| affinity::pin_to_cpu(cpus[(first + thread.index()) % cpus.len()]));
    let pinned: io::Result<()> = pinned.into_iter().collect();
    pinned.map_err(not_pinned)
}

/// Starts threads whose work the cancellation stops; `None` for one per processor.
///
/// # Errors
/// If the system refuses them.
pub(crate) fn thread_pool(
    n_threads: Option<u16>,
    cancellation: &Cancellation,
) -> Result<rayon::ThreadPool, Diagnostic> {
    let cancellation = cancellation.clone();
    start_threads(n_threads, move || cancellation.watch_on_this_thread()).map_err(|error| {
        Diagnostic::new(format!("cannot start the threads: {error}"))
            .with_help("ask for fewer with `--threads N`")
    })
}

/// Returns the message that the system refused a thread besides the pool's.
pub(crate) fn without_thread(error: &io::Error) -> Diagnostic {
    let help = advice(error).unwrap_or("ask for fewer threads with `--threads N`");
    Diagnostic::new(error.to_string()).with_help(help)
}

impl fmt::Debug for Options<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Options")
            .field("threads", &self.threads)
            .field("pin", &self.pin)
            .field("simd", &self.simd)
            .field("traversal", &self.traversal)
            .field("device", &self.device)
            .field("estimates_work", &self.estimates_work)
            .field("vtkhdf", &self.vtkhdf)
            .field("cancellation", &self.cancellation)
            .finish_non_exhaustive()
    }
}
