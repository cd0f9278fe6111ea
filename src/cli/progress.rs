//! The progress bars.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{PoisonError, RwLock};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::session::Event;
use render::instruments::TimeLeft;
use render::tiles::{OnProgress, Progress};

/// A build that takes less than this does not show a bar.
const BUILD_DELAY: Duration = Duration::from_secs(1);
/// The length of bars of fractions.
const MILLION: u64 = 1_000_000;

/// Returns a bar on standard error, if that is a terminal.
pub(super) fn bar(length: u64, quiet: bool) -> ProgressBar {
    // indicatif hides the bar where standard error is not a terminal.
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    let template = "{bar:40.cyan} {percent:>3} %  {msg}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}

/// A bar for building or rendering, which shows the estimated work.
pub(super) struct StageBar {
    bar: ProgressBar,
    /// The bar is drawn after this time.
    delay: Duration,
    time_left: TimeLeft,
    n_rays: AtomicU64,
}

impl StageBar {
    /// Creates a bar of `n_pixels` rendered for a purpose; never drawn if `quiet`.
    pub(super) fn for_pixels(purpose: &'static str, n_pixels: u64, quiet: bool) -> Self {
        let bar = bar(MILLION, quiet).with_prefix(purpose);
        let template = "{bar:40.cyan} {percent:>3} %  {prefix}{msg}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self {
            bar,
            delay: Duration::ZERO,
            time_left: TimeLeft::begin(n_pixels as f64),
            n_rays: AtomicU64::new(0),
        }
    }

    /// Creates a bar for building the hierarchy, drawn only if that takes over a second; never if
    /// `quiet`.
    pub(super) fn for_build(quiet: bool) -> Self {
        Self {
            delay: BUILD_DELAY,
            ..Self::for_pixels("building  ", 1, quiet)
        }
    }

    /// Advances a build's bar by a fraction of the work.
    pub(super) fn advance_build(&self, fraction: f64) {
        self.advance(Progress {
            work: fraction,
            ..Progress::default()
        });
    }

    /// Advances the bar.
    pub(super) fn advance(&self, progress: Progress) {
        if self.bar.is_hidden() {
            return;
        }
        let part = (self.time_left).advance(progress.work, progress.is_restored);
        let here = rays_of_this_run(progress);
        let n_rays = here + self.n_rays.fetch_add(here, Ordering::Relaxed);
        let seconds = self.bar.elapsed().as_secs_f64().max(1e-3);
        let mut message = String::new();
        if n_rays > 0 {
            let mrays = n_rays as f64 / seconds / 1e6;
            message = format!("{mrays:.1} Mrays/s  ");
        }
        if let Some(left) = self.time_left.left() {
            message += &format!("{:#} left", HumanDuration(left));
        }
        if self.bar.elapsed() >= self.delay {
            self.bar.set_position((part * MILLION as f64) as u64);
            self.bar.set_message(message);
        }
    }

    /// Removes the bar from the terminal.
    pub(super) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Returns the purpose of another pass over the pixels after the picture's, before the speed.
fn purpose(stage: &str) -> &'static str {
    match stage {
        "observe" => "again for the costs of objects, ",
        "lanes" => "again for idle lanes, ",
        _ => "",
    }
}

/// Returns the rays that this run has traced: rays of an earlier run took it no time.
fn rays_of_this_run(progress: Progress) -> u64 {
    if progress.is_restored {
        0
    } else {
        progress.n_rays
    }
}

/// The bars of the stages of a session, one after the other.
pub(super) struct Bars {
    quiet: bool,
    current: RwLock<Option<StageBar>>,
}

impl Bars {
    /// Creates bars that are never drawn if `quiet`.
    pub(super) fn new(quiet: bool) -> Self {
        Self {
            quiet,
            current: RwLock::new(None),
        }
    }

    /// Returns true if bars are drawn, if not `quiet`.
    pub(super) fn are_shown(quiet: bool) -> bool {
        !quiet && !ProgressDrawTarget::stderr().is_hidden()
    }

    /// Shows an event of a session.
    pub(super) fn show(&self, event: Event) {
        match event {
            Event::Begin { stage: "build", .. } => {
                self.replace(Some(StageBar::for_build(self.quiet)));
            }
            Event::Begin { stage, n_pixels } => {
                let bar = StageBar::for_pixels(purpose(stage), n_pixels, self.quiet);
                self.replace(Some(bar));
            }
            Event::Built { fraction } => self.with(|bar| bar.advance_build(fraction)),
            Event::Rendered(progress) => self.with(|bar| bar.advance(progress)),
            Event::End => {
                self.with(StageBar::clear);
                self.replace(None);
            }
        }
    }

    fn replace(&self, bar: Option<StageBar>) {
        *self.current.write().unwrap_or_else(PoisonError::into_inner) = bar;
    }

    fn with(&self, show: impl FnOnce(&StageBar)) {
        let current = self.current.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(bar) = &*current {
            show(bar);
        }
    }
}

/// Does `work` on `n_pixels` pixels, which reports its progress, with a bar.
pub(super) fn with_bar<T>(n_pixels: u64, quiet: bool, work: impl FnOnce(OnProgress) -> T) -> T {
    let bar = StageBar::for_pixels("", n_pixels, quiet);
    let done = work(&|progress| bar.advance(progress));
    bar.clear();
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_this_run() {
        let here = Progress::from_pixels(4, 12);
        let before = Progress {
            is_restored: true,
            ..here
        };
        assert_eq!([here, before].map(rays_of_this_run), [12, 0]);
    }

    #[test]
    fn a_pass_after_the_picture_says_what_it_is_for() {
        let bars = Bars::new(true);
        let prefix = |stage| {
            bars.show(Event::Begin { stage, n_pixels: 9 });
            let current = bars.current.read().unwrap();
            current.as_ref().map(|bar| bar.bar.prefix())
        };
        assert_eq!(prefix("render").as_deref(), Some(""));
        let again = "again for the costs of objects, ";
        assert_eq!(prefix("observe").as_deref(), Some(again));
    }
}
