//! The most expensive pixels, for the run summary and for `raycost trace`.

use super::progress::with_bar;
use super::scene::SceneArguments;
use super::{Failure, shell_word};
use host::text::Diagnostic;
use render::film::{Film, HotPixel};
use render::tiles::{TilePlan, least_repeats, repeat};
use scene::build::Sensor;
use scene::config::{Config, CostMode, Repeats};
use tracer::cost::{Meter, Metric, MetricUnit};
use tracer::trace::Tracer;

/// The most expensive pixel by a metric.
type Hottest = (Metric, HotPixel);

/// Returns lines with the most expensive pixel of a picture by its time, if the times are
/// reliable, and by its counters; empty if nothing was measured.
pub(super) fn lines(found: [Option<Hottest>; 2]) -> String {
    let texts: Vec<String> = match found {
        [Some(time), Some(count)] if time.1.place == count.1.place => {
            let by = format!("time and {}", count.0.label);
            let values = [time, count].map(|(metric, pixel)| shown(metric, pixel.value));
            vec![line(time.1, &by, &values)]
        }
        found => found.into_iter().flatten().map(alone).collect(),
    };
    let begins = ["hottest ", "        "].into_iter();
    let numbered = begins.zip(texts);
    numbered
        .map(|(begin, text)| format!("{begin}{text}\n"))
        .collect()
}

/// Returns the command that traces the most expensive pixel; `None` if nothing was measured, or if
/// the scene was read from standard input.
pub(super) fn trace_command(scene: &SceneArguments, found: [Option<Hottest>; 2]) -> Option<String> {
    let (_, pixel) = found.into_iter().flatten().next()?;
    if scene.is_standard_input() {
        return None;
    }
    let (x, y) = pixel.place;
    let scene_word = shell_word(&scene.scene);
    let flags = scene.flags_of_the_picture().concat();
    Some(format!("raycost trace {scene_word} --pixel {x},{y}{flags}"))
}

/// Returns a line with the pixels that a trace has found by a metric.
pub(super) fn found(pixels: &[HotPixel], metric: Metric) -> String {
    let named = |pixel: &HotPixel| {
        let ((x, y), value) = (pixel.place, shown(metric, pixel.value));
        format!("{x},{y} ({value})")
    };
    let pixels: Vec<String> = pixels.iter().map(named).collect();
    format!("hottest by {}: {}\n", metric.name, pixels.join(", "))
}

/// Returns the config of the rendering that finds the most expensive pixels: it measures only the
/// metric.
pub(super) fn searched(config: &Config, metric: Metric) -> Config {
    let (cost, repeats) = match metric {
        Metric::TIME if config.cost.has_time() => (config.cost, config.repeats),
        Metric::TIME => (CostMode::Time, config.repeats),
        _ => (CostMode::Counters, Repeats::ONCE),
    };
    Config {
        cost,
        repeats,
        ..config.clone()
    }
}

/// Renders the picture on the current rayon pool.
pub(super) fn search(config: &Config, tracer: Tracer, quiet: bool) -> Film {
    let n_rendered = u64::from(least_repeats(config)) * config.image.n_pixels() as u64;
    let meter = Meter::new(config.cost);
    with_bar(n_rendered, quiet, |report| {
        let plan = TilePlan::new(tracer, &Sensor::new(tracer.scene, config), config.tiles);
        repeat(config.repeats, tracer, &plan, &meter, report).0
    })
}

/// Returns the `n` most expensive pixels, or fewer if fewer have a cost.
///
/// # Errors
/// If no pixel has a cost, or no time is reliable.
pub(super) fn pixels(film: &Film, metric: Metric, n: usize) -> Result<Vec<HotPixel>, Failure> {
    let pixels = film.hottest(metric, n);
    match (pixels.is_empty(), metric) {
        (false, _) => Ok(pixels),
        (true, metric) if metric.is_timed() => {
            let message = "no pixel has a reliable time: the machine is too busy";
            let help = "ask for `--repeats 10`, or for counters, such as `--by node_visits`";
            Err(Failure::Machine(Diagnostic::new(message).with_help(help)))
        }
        (true, _) => Err(
            Diagnostic::new(format!("no pixel has any {}", metric.label))
                .with_help("choose another metric, such as `--by primitive_tests`")
                .into(),
        ),
    }
}

fn alone(hottest: Hottest) -> String {
    let (metric, pixel) = hottest;
    line(pixel, metric.label, &[shown(metric, pixel.value)])
}

fn line(pixel: HotPixel, by: &str, values: &[String]) -> String {
    let (x, y) = pixel.place;
    format!("pixel {x},{y} by {by}: {}", values.join(", "))
}

/// Formats a value of a metric with its unit.
fn shown(metric: Metric, value: f64) -> String {
    match metric.unit {
        MetricUnit::Nanoseconds | MetricUnit::Ratio => metric.format(value),
        MetricUnit::Count => format!("{} {}", metric.format(value), metric.label),
    }
}
