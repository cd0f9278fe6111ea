//! The breakdown of the threads' time.

use super::RenderingView;
use crate::summary::ThreadTime;
use tracer::cost::Meter;

/// Computes the breakdown of a rendering; `None` if there are no times.
pub fn thread_time(rendering: &RenderingView) -> Option<ThreadTime> {
    let clock = rendering.meter.clock()?;
    let repeats = rendering.repeats;
    let is_by_ray = matches!(rendering.meter, Meter::SingleRayTime(_));
    let outside_of_pixels = if is_by_ray { 1.0 } else { 0.0 };
    let n_readings = repeats.len() * rendering.config.image.n_pixels();
    let busy_ns = repeats.iter().map(|repeat| repeat.busy_ns).sum::<u64>();
    let film_ns = repeats.iter().map(|repeat| repeat.film_ns).sum::<u64>();
    let waiting_ns = repeats.iter().map(|repeat| repeat.waiting_ns).sum::<u64>();
    let warm_up_ns = repeats.iter().map(|repeat| repeat.warm_up_ns).sum::<u64>();
    let time = ThreadTime::new(
        busy_ns as f64,
        repeats.iter().filter_map(|repeat| repeat.pixels_ns).sum(),
        outside_of_pixels * n_readings as f64 * clock.overhead_ns(),
        outside_of_pixels * film_ns as f64,
        warm_up_ns as f64,
    );
    Some(ThreadTime {
        waiting_ns: waiting_ns as f64,
        ..time
    })
}
