//! The progress bar.

use std::sync::atomic::{AtomicU64, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::render::Progress;

/// A bar on standard error, on a terminal alone.
pub(super) struct Bar {
    bar: ProgressBar,
    n_rays: AtomicU64,
}

impl Bar {
    /// A bar of this many pixels; never drawn if `quiet`.
    pub(super) fn new(n_pixels: u64, quiet: bool) -> Self {
        // indicatif hides the bar where standard error is no terminal.
        let target = match quiet {
            true => ProgressDrawTarget::hidden(),
            false => ProgressDrawTarget::stderr(),
        };
        let bar = ProgressBar::with_draw_target(Some(n_pixels), target);
        let template = "{bar:40.cyan} {percent:>3} %  {msg}  {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self {
            bar,
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
