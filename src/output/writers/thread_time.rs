//! The breakdown of the threads' time.

use super::RenderingView;
use crate::summary::ThreadTime;
use tracer::cost::Meter;

/// Computes the breakdown for a rendering; `None` if there are no times.
pub fn thread_time(rendering: &RenderingView) -> Option<ThreadTime> {
    let clock = rendering.meter.clock()?;
    let repeats = rendering.repeats;
    let busy_ns = repeats.iter().map(|repeat| repeat.busy_ns).sum::<u64>();
    let film_ns = repeats.iter().map(|repeat| repeat.film_ns).sum::<u64>();
    let waiting_ns = repeats.iter().map(|repeat| repeat.waiting_ns).sum::<u64>();
    let warm_up_ns = repeats.iter().map(|repeat| repeat.warm_up_ns).sum::<u64>();
    let [clock_ns, film_ns] = match rendering.meter {
        Meter::SingleRayTime(_) => {
            let n_readings = repeats.len() * rendering.config.image.n_pixels();
            [n_readings as f64 * clock.overhead_ns(), film_ns as f64]
        }
        // The times of pixels include both.
        _ => [0.0; 2],
    };
    let time = ThreadTime::new(
        busy_ns as f64,
        repeats.iter().filter_map(|repeat| repeat.pixels_ns).sum(),
        clock_ns,
        film_ns,
        warm_up_ns as f64,
    );
    Some(ThreadTime {
        waiting_ns: waiting_ns as f64,
        ..time
    })
}
