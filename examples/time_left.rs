//! Prints how well the time left of a rendering is estimated, after the first tenth of it: `cargo
//! run --release --example time_left -- configs/*.yaml`.
//!
//! Each scene is rendered five times in each mode of cost, large enough to take some seconds.

use std::error::Error;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use raycost::config::{CostMode, Repeats};
use raycost::session::Event;
use raycost::{Options, Session};
use render::instruments::TimeLeft;

/// Renderings of a scene whose median error is printed.
const N_RENDERINGS: usize = 5;

/// The least time that a rendering should take.
const LEAST: Duration = Duration::from_secs(2);

/// Errors of the estimated time left of a rendering.
#[derive(Debug, Clone, Copy)]
pub struct Errors {
    /// The greatest error of the expected duration after the first tenth of the rendering, in
    /// percent of it.
    pub worst: f64,
    /// The error at that tenth: positive if the estimate is too long.
    pub at_tenth: f64,
    /// The duration of the rendering.
    pub wall: Duration,
    /// The time that the estimate took before the rendering.
    pub estimating: Duration,
}

/// Renders a scene in a mode of cost, its picture larger by a factor along both sides, and compares
/// the expected durations with the real one.
pub fn errors(scene: &Path, cost: CostMode, factor: f64) -> Result<Errors, Box<dyn Error>> {
    let session = Session::open_with(scene, |config| {
        (config.cost, config.repeats) = (cost, Repeats::ONCE);
        let larger = |side: u32| (f64::from(side) * factor).round() as u32;
        config.image.width = larger(config.image.width);
        config.image.height = larger(config.image.height);
    })?;
    let stage: Mutex<Option<(Instant, TimeLeft)>> = Mutex::new(None);
    let expected: Mutex<Vec<[Duration; 2]>> = Mutex::default();
    let ended: Mutex<Duration> = Mutex::default();
    let on_event = |event: Event| {
        let (Ok(mut stage), Ok(mut expected)) = (stage.lock(), expected.lock()) else {
            return;
        };
        match (event, &*stage) {
            (
                Event::Begin {
                    stage: "render",
                    n_pixels,
                },
                _,
            ) => {
                *stage = Some((Instant::now(), TimeLeft::begin(n_pixels as f64)));
            }
            (Event::Rendered(progress), Some((begin, left))) => {
                left.advance(progress.work, progress.is_restored);
                let elapsed = begin.elapsed();
                expected.extend(left.left().map(|left| [elapsed, elapsed + left]));
            }
            (Event::End, Some((begin, _))) => {
                if let Ok(mut ended) = ended.lock() {
                    *ended = begin.elapsed();
                }
                *stage = None;
            }
            _ => {}
        }
    };
    let options = Options {
        estimates_work: true,
        on_event: Some(&on_event),
        ..Options::default()
    };
    let rendering = session.render(&options)?;
    let wall = ended.into_inner()?;
    let after_tenth = expected.into_inner()?.into_iter();
    let errors: Vec<f64> = after_tenth
        .filter(|[elapsed, _]| *elapsed * 10 >= wall)
        .map(|[_, expected]| 100.0 * (expected.as_secs_f64() / wall.as_secs_f64() - 1.0))
        .collect();
    Ok(Errors {
        worst: errors
            .iter()
            .fold(0.0, |worst, error| error.abs().max(worst)),
        at_tenth: errors.first().copied().unwrap_or(0.0),
        wall,
        estimating: rendering.stages().wall("order"),
    })
}

/// Returns the rendering with the median of the worst errors, of pictures that take some seconds.
fn median(scene: &Path, cost: CostMode) -> Result<Errors, Box<dyn Error>> {
    let first = errors(scene, cost, 1.0)?;
    let longer = LEAST.as_secs_f64() / first.wall.as_secs_f64();
    let factor = longer.sqrt().clamp(1.0, 8.0);
    let rendered: Result<Vec<Errors>, _> = (0..N_RENDERINGS)
        .map(|_| errors(scene, cost, factor))
        .collect();
    let mut rendered = rendered?;
    rendered.sort_by(|a, b| a.worst.total_cmp(&b.worst));
    Ok(rendered[N_RENDERINGS / 2])
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("scene, cost: greatest error, error after a tenth, time, time of the estimate");
    for scene in std::env::args().skip(1) {
        for cost in [CostMode::Time, CostMode::Counters, CostMode::None] {
            let Errors {
                worst,
                at_tenth,
                wall,
                estimating,
            } = median(Path::new(&scene), cost)?;
            let [seconds, estimating] = [wall, estimating].map(|time| time.as_secs_f64());
            println!(
                "{scene}, {cost:?}: {worst:.0} %, {at_tenth:+.0} %, {seconds:.2} s, {:.1} %",
                100.0 * estimating / seconds
            );
        }
    }
    Ok(())
}
