//! The lines of the run summary on the quality of the times.

use std::time::Duration;

use base::text::numbers;
use output::summary::ThreadTime;
use output::writers::{RenderingView, thread_time};
use render::tiles::Overhead;

/// Least time without a CPU, in percent of the time at work, that is reported.
const LEAST_WAITING_PERCENT: f64 = 0.1;

/// Returns the lines that apply, each with a line feed.
pub(super) fn lines(rendering: &RenderingView) -> String {
    let time = thread_time(rendering);
    let lines = [
        time.as_ref().map(threads),
        time.as_ref().and_then(waiting),
        time.and_then(|_| repeats(rendering)),
        rendering.overhead.as_ref().map(overhead),
    ];
    lines.into_iter().flatten().collect()
}

/// Returns the breakdown of the threads' time.
fn threads(time: &ThreadTime) -> String {
    let percent = |part_ns| time.percent(part_ns);
    format!(
        "threads {} at work: {:.1} % pixels, {:.1} % film, {:.1} % clock, {:.1} % warm-up, \
         {:.1} % unexplained\n",
        numbers::duration(Duration::from_nanos(time.busy_ns as u64)),
        percent(time.pixels_ns),
        percent(time.film_ns),
        percent(time.clock_ns),
        percent(time.warm_up_ns),
        percent(time.unexplained_ns),
    )
}

/// Returns the time without a CPU, unless it is short.
fn waiting(time: &ThreadTime) -> Option<String> {
    let is_short = time.percent(time.waiting_ns) < LEAST_WAITING_PERCENT;
    let waiting = || Duration::from_nanos(time.waiting_ns as u64);
    (!is_short).then(|| {
        format!(
            "waiting {} more, for a CPU that other work had; no pixel's time includes it\n",
            numbers::duration(waiting())
        )
    })
}

/// Returns the number of repeats, the spread of the times, and the rejected ones.
fn repeats(rendering: &RenderingView) -> Option<String> {
    let film = rendering.film;
    let n_rejected: u64 = rendering
        .repeats
        .iter()
        .map(|repeat| repeat.n_rejected)
        .sum();
    let rejected = numbers::counted(n_rejected, "interrupted time");
    let mad_percent = 100.0 * rendering.survey.time_mad_ns / rendering.survey.time_ns;
    match (film.n_repeats, n_rejected) {
        (0 | 1, 0) => None,
        (0 | 1, _) => Some(format!(
            "repeats none; {rejected}, less the wait for a CPU\n"
        )),
        (n, 0) => Some(format!("repeats {n}; MAD {mad_percent:.1} % of the time\n")),
        (n, _) => Some(format!(
            "repeats {n}; MAD {mad_percent:.1} % of the time; {rejected}, left out\n"
        )),
    }
}

/// Returns the overhead of measurement.
fn overhead(overhead: &Overhead) -> String {
    let [counters, clock, both, single_ray] = [
        overhead.counters_percent,
        overhead.clock_percent,
        overhead.time_percent,
        overhead.single_ray_percent,
    ]
    .map(Option::unwrap_or_default);
    format!(
        "measure counters {counters:+.1} %, a clock {clock:+.1} %, both {both:+.1} %; \
         rays one by one instead of in streams {single_ray:+.1} % ({} rounds)\n",
        overhead.rounds,
    )
}
