//! Prints how well the time left of a rendering is estimated, after the first tenth of it:
//! `cargo run --release --example time_left -- configs/*.yaml`.

use std::error::Error;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use raycost::instruments::TimeLeft;
use raycost::session::{Event, Options, Session};

/// The greatest error of the expected duration after the first tenth of a rendering, in
/// percent of it, and the duration.
pub fn worst_error(scene: &Path) -> Result<(f64, Duration), Box<dyn Error>> {
    let session = Session::open_with(scene, |config| {
        config.repeats = raycost::config::Repeats::ONCE;
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
    session.render(&options)?;
    let wall = ended.into_inner()?;
    let after_tenth = expected.into_inner()?.into_iter();
    let errors = after_tenth
        .filter(|[elapsed, _]| *elapsed * 10 >= wall)
        .map(|[_, expected]| 100.0 * (expected.as_secs_f64() / wall.as_secs_f64() - 1.0).abs());
    Ok((errors.fold(0.0, f64::max), wall))
}

fn main() -> Result<(), Box<dyn Error>> {
    for scene in std::env::args().skip(1) {
        let (percent, wall) = worst_error(Path::new(&scene))?;
        let seconds = wall.as_secs_f64();
        println!("{scene}: at most {percent:.0} % of {seconds:.2} s");
    }
    Ok(())
}
