//! The sampling profiler behind `profile.svg`, a flame graph (Gregg, "The Flame Graph", CACM 59(6),
//! 2016).

use std::io::{self, Write};

use sampler::Sampler;

use host::provenance::RunId;

/// Samples the stacks of running threads at a fixed rate of CPU time.
#[derive(Debug)]
pub struct Profiler {
    sampler: Sampler,
}

/// Reasons why there is no profiler.
#[derive(Debug)]
pub enum NoProfiler {
    /// The program was built without a profiler.
    NotBuilt,
    /// The operating system is not supported.
    Unknown,
    /// The system refused the profiler.
    Refused(String),
}

impl Profiler {
    /// Starts sampling.
    ///
    /// # Errors
    /// The reason why sampling cannot start.
    pub fn start() -> Result<Self, NoProfiler> {
        Sampler::start().map(|sampler| Self { sampler })
    }

    /// Writes the samples so far as an SVG, followed by the run's ID.
    pub fn write(&self, scene: &str, run: RunId, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.sampler.flame_graph(scene)?)?;
        out.write_all(run.comment().as_bytes())
    }
}

#[cfg(all(feature = "profile", any(target_os = "linux", target_os = "macos")))]
mod sampler {
    use std::io;

    use pprof::flamegraph::{Options, TextTruncateDirection};
    use pprof::{Frames, ProfilerGuard, ProfilerGuardBuilder, Symbol};

    use super::NoProfiler;
    use base::numbers::counted;

    /// Samples per second of CPU time: a prime, to avoid synchrony with the tiles. Systems with a
    /// slower clock take fewer.
    const FREQUENCY_HZ: i32 = 997;

    /// Samples until it is dropped.
    pub(super) struct Sampler(ProfilerGuard<'static>);

    impl std::fmt::Debug for Sampler {
        fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("Sampler")
        }
    }

    impl Sampler {
        pub(super) fn start() -> Result<Self, NoProfiler> {
            let builder = ProfilerGuardBuilder::default().frequency(FREQUENCY_HZ);
            // A stack must not be unwound within the unwinder itself.
            let guard = builder.blocklist(&["libgcc", "libunwind"]).build();
            guard
                .map(Self)
                .map_err(|error| NoProfiler::Refused(error.to_string()))
        }

        /// Returns the stacks so far as an SVG.
        pub(super) fn flame_graph(&self, scene: &str) -> io::Result<Vec<u8>> {
            let mut report = self.0.report();
            let report = report.frames_post_processor(tidy).build();
            let report = report.map_err(io::Error::other)?;
            let n_samples: isize = report.data.values().sum();
            let mut svg = Vec::new();
            if n_samples == 0 {
                // A flame graph needs at least one sample.
                svg.extend(NO_SAMPLE.as_bytes());
                return Ok(svg);
            }
            let mut options = Options::default();
            options.title = format!("raycost render: {scene}");
            options.subtitle = Some(format!(
                "{} of processor time; functions that were inlined are part of their callers",
                counted(n_samples as u64, "sample"),
            ));
            options.hash = true;
            options.text_truncate_direction = TextTruncateDirection::Right;
            report
                .flamegraph_with_options(&mut svg, &mut options)
                .map_err(io::Error::other)?;
            Ok(svg)
        }
    }

    /// The program's crates, as the names of their functions begin.
    const CRATES: [&str; 2] = ["raycost::", "raycost_"];

    const NO_SAMPLE: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="480" height="40">
<text x="10" y="25" font-family="sans-serif">The run was too short: no sample was taken.</text>
</svg>
"#;

    /// Removes all functions except the program's and the functions they call, and the scheduler's
    /// among the latter, and shortens the program's names.
    fn tidy(frames: &mut Frames) {
        // All threads of a pool do the same work.
        "raycost".clone_into(&mut frames.thread_name);
        let stack = &mut frames.frames;
        for symbols in stack.iter_mut() {
            // Samples of a stack are merged under the address of the first one, so inlined calls
            // are known only for that address.
            symbols.drain(..symbols.len().saturating_sub(1));
        }
        // The signal handler that takes the sample.
        let is = |krate, symbols: &Vec<Symbol>| symbols.last().is_some_and(|s| is_of(krate, s));
        let is_own = |symbols: &Vec<Symbol>| CRATES.iter().any(|krate| is(krate, symbols));
        stack.retain(|symbols| !is("pprof::", symbols));
        // A waiting thread steals work on top of its stack: functions below a task of rayon are not
        // its callers.
        let is_task = |symbols: &Vec<Symbol>| is("rayon", symbols);
        let Some(own) = (stack.iter().position(is_own)).or_else(|| stack.iter().position(is_task))
        else {
            return;
        };
        let task = stack[own..].iter().position(is_task);
        stack.truncate(task.map_or(stack.len(), |task| own + task));
        let mut callers = stack.split_off(own);
        callers.retain(is_own);
        stack.retain(|symbols| !is_task(symbols));
        stack.append(&mut callers);
        for symbol in stack.iter_mut().filter(|it| is_own(it)).flatten() {
            symbol.name = Some(short_name(&symbol.name()).into_bytes());
        }
    }

    /// Returns the last two parts of a function's path, without generic arguments and closures:
    /// `TileQueue::render` of `<render::queue::TileQueue<T> as render::Queue>::render::{{closure}}`.
    fn short_name(path: &str) -> String {
        let path = path.strip_prefix('<').unwrap_or(path);
        let mut depth = 0_u32;
        let mut plain = String::new();
        for letter in path.replace("->", "").chars() {
            match letter {
                '<' => depth += 1,
                '>' => depth = depth.saturating_sub(1),
                _ if depth == 0 => plain.push(letter),
                _ => {}
            }
        }
        let parts = |path: &str| -> Vec<String> {
            let parts = path.split("::").map(str::to_owned);
            parts
                .filter(|part| !part.is_empty() && !part.starts_with('{'))
                .collect()
        };
        let (mut of, method) = match plain.split_once(" as ") {
            Some((of, method)) => (parts(of), parts(method).pop()),
            None => (parts(&plain), None),
        };
        of.extend(method);
        of[of.len().saturating_sub(2)..].join("::")
    }

    /// Returns true if a function belongs to a crate, perhaps as a method of a trait.
    fn is_of(krate: &str, symbol: &Symbol) -> bool {
        symbol.name().trim_start_matches('<').starts_with(krate)
    }
}

#[cfg(not(all(feature = "profile", any(target_os = "linux", target_os = "macos"))))]
mod sampler {
    use std::io;

    use super::NoProfiler;

    /// No sampler exists on this system.
    #[derive(Debug)]
    pub(super) enum Sampler {}

    impl Sampler {
        pub(super) fn start() -> Result<Self, NoProfiler> {
            Err(if cfg!(feature = "profile") {
                NoProfiler::Unknown
            } else {
                NoProfiler::NotBuilt
            })
        }

        pub(super) fn flame_graph(&self, _: &str) -> io::Result<Vec<u8>> {
            match *self {}
        }
    }
}
