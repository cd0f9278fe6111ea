//! The progress bars.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::render::Progress;
use crate::text::one_line;

/// How long a build goes on before it shows a bar.
const SHORT: Duration = Duration::from_secs(1);

/// A bar on standard error, on a terminal alone.
fn bar(length: u64, quiet: bool) -> ProgressBar {
    // indicatif hides the bar where standard error is no terminal.
    let target = match quiet {
        true => ProgressDrawTarget::hidden(),
        false => ProgressDrawTarget::stderr(),
    };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    let template = "{bar:40.cyan} {percent:>3} %  {msg}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// A bar for the building of the hierarchy, if it takes long.
pub(super) struct BuildBar {
    bar: ProgressBar,
    n_millionths: AtomicU64,
}

impl BuildBar {
    /// A bar that is never drawn if `quiet`.
    pub(super) fn new(quiet: bool) -> Self {
        Self {
            bar: bar(1_000_000, quiet).with_message("building"),
            n_millionths: AtomicU64::new(0),
        }
    }

    /// Moves the bar on by a part of the whole.
    pub(super) fn advance(&self, part: f64) {
        let n = (part * 1e6) as u64;
        let n_millionths = n + self.n_millionths.fetch_add(n, Ordering::Relaxed);
        if self.bar.elapsed() > SHORT {
            self.bar.set_position(n_millionths);
        }
    }

    /// Takes the bar off the terminal.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// A bar of pixels for the rendering.
pub(super) struct Bar {
    bar: ProgressBar,
    n_rays: AtomicU64,
}

impl Bar {
    /// A bar of this many pixels; never drawn if `quiet`.
    pub(super) fn new(n_pixels: u64, quiet: bool) -> Self {
        Self {
            bar: bar(n_pixels, quiet),
            n_rays: AtomicU64::new(0),
        }
    }

    /// Moves the bar on.
    pub(super) fn advance(&self, progress: Progress) {
        if self.bar.is_hidden() {
            return;
        }
        let n_rays = progress.n_rays + self.n_rays.fetch_add(progress.n_rays, Ordering::Relaxed);
        let seconds = self.bar.elapsed().as_secs_f64().max(1e-3);
        if n_rays > 0 {
            let mrays = n_rays as f64 / seconds / 1e6;
            self.bar.set_message(format!("{mrays:.1} Mrays/s"));
        }
        self.bar.inc(progress.n_pixels);
    }

    /// Takes the bar off the terminal.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// A bar of runs for a study.
pub(super) struct StudyBar {
    bar: ProgressBar,
}

impl StudyBar {
    /// A bar of this many runs; never drawn if `quiet`.
    pub(super) fn new(n_runs: u64, quiet: bool) -> Self {
        Self {
            bar: bar(n_runs, quiet),
        }
    }

    /// Tells which run is on.
    pub(super) fn begin(&self, label: &str) {
        self.bar.set_message(one_line(label).into_owned());
    }

    /// Moves the bar on by a run.
    pub(super) fn advance(&self) {
        self.bar.inc(1);
    }

    /// Takes the bar off the terminal.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}
