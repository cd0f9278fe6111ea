//! The lines of the run summary on the quality of the times.

use std::time::Duration;

use base::numbers;
use output::summary::ThreadTime;
use output::writers::{RenderingView, thread_time, time_notes};

/// Least time without a CPU, in percent of the time at work, that is reported.
const LEAST_WAITING_PERCENT: f64 = 0.1;

/// Returns the lines that apply, each with a line feed.
pub(super) fn lines(rendering: &RenderingView) -> String {
    let time = thread_time(rendering);
    let notes = time_notes(rendering);
    let notes = notes.iter().map(|note| format!("note    {note}\n"));
    let lines = [
        time.as_ref().map(threads),
        time.as_ref().and_then(|time| waiting(time, rendering)),
        time.and_then(|_| repeats(rendering)),
        Some(notes.collect()),
    ];
    lines.into_iter().flatten().collect()
}

/// Returns the breakdown of the threads' time.
fn threads(time: &ThreadTime) -> String {
    let percent = |permille| f64::from(permille) / 10.0;
    let [pixels, clock, film, warm_up, unexplained] = time.permille().map(percent);
    format!(
        "threads {} at work: {pixels:.1} % pixels, {film:.1} % film, {clock:.1} % clock, \
         {warm_up:.1} % warm-up, {unexplained:.1} % unexplained\n",
        numbers::duration(Duration::from_nanos(time.busy_ns as u64)),
    )
}

/// Returns the time without a CPU and without a device at work, unless it is short.
fn waiting(time: &ThreadTime, rendering: &RenderingView) -> Option<String> {
    let is_short = time.percent(time.waiting_ns) < LEAST_WAITING_PERCENT;
    let waiting = || Duration::from_nanos(time.waiting_ns as u64);
    let launches = rendering.device.map_or("", |_| "launches to begin and ");
    (!is_short).then(|| {
        format!(
            "waiting {} more, for {launches}a CPU that other work had\n",
            numbers::duration(waiting())
        )
    })
}

/// Returns the number of repeats and the spread of the times.
fn repeats(rendering: &RenderingView) -> Option<String> {
    let n = rendering.film.n_repeats;
    let mad_percent = 100.0 * rendering.survey.time_mad_ns / rendering.survey.time_ns;
    (n > 1).then(|| format!("repeats {n}; MAD {mad_percent:.1} % of the time\n"))
}
