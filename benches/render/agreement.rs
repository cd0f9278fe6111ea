//! How well attributed times agree with those of a clock.

use raycost::accel::Accel;
use raycost::config::{Config, CostMode};
use raycost::cost::Meter;
use raycost::film::Film;
use raycost::render::{TilePlan, repeat};
use raycost::scene::Scene;

/// Mean absolute differences of two times per pixel, as parts of the mean time.
pub struct Agreement {
    /// Of the times over their sums: rays in streams speed up some pixels more than
    /// others, so that this is not an error alone.
    pub of_picture: f64,
    /// Of the times over the sums of their tiles.
    pub within_tiles: f64,
}

/// Renders the picture with both times, each the median of several renderings.
pub fn agreement(config: &Config, scene: &Scene, accel: &Accel, plan: &TilePlan) -> Agreement {
    let repeats = "5".parse().expect("a number of renderings");
    let [clock, attributed] = [CostMode::Time, CostMode::AttributedTime].map(|mode| {
        let meter = Meter::new(mode);
        repeat(repeats, scene, accel, plan, &meter, |_| {}).0
    });
    let n_pixels = config.image.n_pixels();
    let tiles = tiles(&clock, n_pixels);
    let one_tile = vec![0; n_pixels];
    let [clock, attributed] = [clock, attributed].map(|film| times(&film));
    Agreement {
        of_picture: difference(&attributed, &clock, &one_tile),
        within_tiles: difference(&attributed, &clock, &tiles),
    }
}

fn times(film: &Film) -> Vec<f64> {
    film.values(|strip| &strip.time_ns).map(f64::from).collect()
}

/// The tile of each pixel.
fn tiles(film: &Film, n_pixels: usize) -> Vec<u32> {
    let (mut all, mut of_strip) = (Vec::with_capacity(n_pixels), Vec::new());
    for strip in &film.strips {
        film.tile_numbers(strip, &mut of_strip);
        all.extend_from_slice(&of_strip);
    }
    all
}

/// The mean absolute difference of two times per pixel over the mean of the second,
/// after scaling the first to the second's sum in each group of pixels.
fn difference(times: &[f64], reference: &[f64], groups: &[u32]) -> f64 {
    let n_groups = groups.iter().max().map_or(0, |&group| group as usize + 1);
    let sums = |times: &[f64]| {
        let mut sums = vec![0.0; n_groups];
        for (&time, &group) in times.iter().zip(groups) {
            sums[group as usize] += time;
        }
        sums
    };
    let (sums, reference_sums) = (sums(times), sums(reference));
    let pixels = times.iter().zip(reference).zip(groups);
    let differences = pixels.map(|((&time, &reference), &group)| {
        let scale = reference_sums[group as usize] / sums[group as usize];
        (time * scale - reference).abs()
    });
    differences.sum::<f64>() / reference.iter().sum::<f64>()
}
