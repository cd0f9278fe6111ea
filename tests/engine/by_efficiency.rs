//! Adaptive sampling by efficiency: numbers of samples from variance and cost of the neighbors.

use glam::DVec3;

use crate::common::{config, counts, film, film_on, lasting, scene_of, sum, with_cost};
use math::simd::Simd;
use render::film::Film;
use render::tiles::TilePlan;
use scene::build::Sensor;
use scene::config::{Adaptive, Config, CostMode, OptionalOutput, PixelPattern, SampleRule};
use tracer::accel::Accel;
use tracer::cost::{Counter, RayKind};
use tracer::trace::Tracer;

/// A scene as a small picture.
fn small(name: &str, n_samples: u32, min_samples: u32) -> Config {
    let mut config = with_cost(config(name), CostMode::Counters);
    let image = &mut config.image;
    (image.width, image.height) = (45, 34);
    (image.samples_per_pixel, image.sampler) = (n_samples, PixelPattern::Sobol);
    image.adaptive = Some(Adaptive {
        by: SampleRule::Efficiency,
        noise: None,
        min_samples,
    });
    config.output.add(OptionalOutput::Radiance);
    config.output.add(OptionalOutput::Noise);
    config
}

#[test]
fn threads_modes_tiles_and_instructions_change_no_byte() {
    for name in ["cornell_box", "glass"] {
        let config = small(name, 24, 6);
        let expected = lasting(film(&config, 1));
        for mode in [CostMode::Counters, CostMode::SingleRayTime, CostMode::Time] {
            let found = film(&with_cost(config.clone(), mode), 3);
            assert!(lasting(found) == expected, "{name} {mode:?}");
        }
        let uncounted = film(&with_cost(config.clone(), CostMode::None), 2);
        assert!(lasting(uncounted).0 == expected.0);
        for size in [1, 5, 64] {
            let mut config = config.clone();
            config.tiles.size = size;
            assert!(lasting(film(&config, 2)) == expected, "{name} {size}");
        }
        for simd in Simd::available() {
            assert!(lasting(film_on(&config, 2, simd)) == expected, "{simd}");
        }
    }
}

#[test]
fn pictures_of_few_pixels_have_few_neighbors() {
    for size in [[1, 1], [1, 5], [4, 1], [2, 2]] {
        let mut config = small("cornell_box", 12, 4);
        [config.image.width, config.image.height] = size;
        let expected = lasting(film(&config, 1));
        for mode in [CostMode::SingleRayTime, CostMode::Time] {
            assert!(lasting(film(&with_cost(config.clone(), mode), 2)) == expected);
        }
    }
}

#[test]
fn the_mean_number_of_samples_is_the_wanted_one() {
    for name in ["cornell_box", "glass", "hero"] {
        let config = small(name, 48, 16);
        let found = film(&config, 2);
        let n_samples = counts(&found, Counter::Samples);
        assert_eq!(
            sum(&found, Counter::Samples),
            found.totals.rays_of(RayKind::Camera)
        );
        let mean = sum(&found, Counter::Samples) as f64 / n_samples.len() as f64;
        assert!(
            n_samples.iter().all(|n| (16..=8 * 48).contains(n)),
            "{name}"
        );
        assert!((mean / 48.0 - 1.0).abs() < 0.1, "{name}: {mean}");
    }
}

/// The light of all pixels.
fn light(film: &Film) -> Vec<DVec3> {
    let light = film.values(|strip| &strip.radiance);
    light.map(|light| light.as_dvec3()).collect()
}

#[test]
fn numbers_come_from_single_samples_of_the_neighbors() {
    const N_FIRST: u32 = 6;
    // Scenes without pictures, whose filter depends on the number of samples.
    for name in ["cornell_box", "nanotube"] {
        let mut config = small(name, 24, N_FIRST);
        (config.image.width, config.image.height) = (23, 17);
        let found = counts(&film(&config, 2), Counter::Samples);
        let [factor, gain] = factor_and_gain(&config);
        let samples = single_samples(&config, N_FIRST);
        let variances = samples.iter().map(|samples| variance(samples, gain));
        let variances: Vec<f64> = variances.collect();
        let costs = costs(&config, N_FIRST);
        for (pixel, found) in found.into_iter().enumerate() {
            let neighbors = neighbors(pixel, [23, 17]);
            let sum = |values: &[f64]| neighbors.iter().map(|&i| values[i]).sum::<f64>();
            let wanted = factor * (sum(&variances) / sum(&costs).max(1.0)).sqrt();
            let [low, high] = [0.999, 1.001].map(|share| nearest(share * wanted, N_FIRST, 24));
            assert!(
                found == low || found == high,
                "{name} {pixel}: {found}, {wanted}"
            );
        }
    }
}

/// The first `n` samples of each pixel, one by one: the sums of 1, 2, … samples differ by them.
fn single_samples(config: &Config, n: u32) -> Vec<Vec<DVec3>> {
    let mut sums = vec![DVec3::ZERO; config.image.n_pixels()];
    let mut samples = vec![Vec::new(); sums.len()];
    for n in 1..=n {
        let means = light(&film(&uniform(config, n), 2));
        for (pixel, mean) in means.into_iter().enumerate() {
            let sum = mean * f64::from(n);
            samples[pixel].push(sum - sums[pixel]);
            sums[pixel] = sum;
        }
    }
    samples
}

/// The node visits and primitive tests of the first `n` samples of each pixel.
fn costs(config: &Config, n: u32) -> Vec<f64> {
    let film = film(&uniform(config, n), 2);
    let [visits, tests] =
        [Counter::NodeVisits, Counter::PrimitiveTests].map(|it| counts(&film, it));
    visits
        .iter()
        .zip(tests)
        .map(|(a, b)| f64::from(a + b))
        .collect()
}

/// The same picture with the same number of samples for all pixels.
fn uniform(config: &Config, n: u32) -> Config {
    let mut config = config.clone();
    (config.image.samples_per_pixel, config.image.adaptive) = (n, None);
    config
}

/// The numbers of the pixels around a pixel.
fn neighbors(pixel: usize, [width, height]: [usize; 2]) -> Vec<usize> {
    let [x, y] = [pixel % width, pixel / width];
    let is_beside = |other: &usize| {
        x.abs_diff(other % width) <= 1 && y.abs_diff(other / width) <= 1 && *other != pixel
    };
    (0..width * height).filter(is_beside).collect()
}

/// The samples of a pixel per root of variance over cost, and the factor from radiance to the light of
/// the picture.
fn factor_and_gain(config: &Config) -> [f64; 2] {
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration);
    let sensor = Sensor::new(&scene, config);
    let plan = TilePlan::new(Tracer::new(&scene, &accel), &sensor, config.tiles);
    let gain = plan.sensor.development.gain();
    [plan.sensor.samples_per_root.unwrap(), gain.into()]
}

/// The sum of the channels' variances of light as a display shows it.
fn variance(samples: &[DVec3], gain: f64) -> f64 {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<DVec3>() / n;
    let squares = samples
        .iter()
        .map(|&sample| (sample - mean) * (sample - mean));
    let variance = gain * gain * squares.sum::<DVec3>() / (n - 1.0);
    (variance / (gain * mean).max(DVec3::splat(0.0015))).element_sum()
}

/// The nearest number of samples at which rounds end, with this mean of all pixels.
fn nearest(wanted: f64, first: u32, mean: u32) -> u32 {
    let powers = (0..16).flat_map(|i| [1 << i, 3 << i]);
    let inner = powers.filter(|n| (first..8 * mean).contains(n));
    let ends: Vec<u32> = inner.chain([first, 8 * mean]).collect();
    let distance = |n: &u32| (f64::from(*n) - wanted).abs();
    let nearest = ends
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap()
}

#[test]
fn pictures_are_unbiased() {
    const N_SEEDS: u64 = 96;
    let mut efficient = small("cornell_box", 16, 4);
    (efficient.image.width, efficient.image.height) = (24, 24);
    let moments =
        [(efficient.clone(), 0), (uniform(&efficient, 16), N_SEEDS)].map(|(config, first)| {
            let seeds = first..first + N_SEEDS;
            let films = seeds.map(|seed| light_of_blocks(&config, seed));
            moments(&films.collect::<Vec<_>>())
        });
    let [found, expected] = moments;
    let scores = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (a[0] - b[0]) / (a[1] + b[1]).sqrt());
    let scores: Vec<f64> = scores.collect();
    let n = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / n;
    let square = scores.iter().map(|z| z * z).sum::<f64>() / n;
    assert!(mean.abs() < 3.0 / n.sqrt(), "{mean}: {scores:?}");
    assert!(square < 1.8, "{square}: {scores:?}");
    assert!(scores.iter().all(|z| z.abs() < 4.0), "{scores:?}");
}

/// The light of blocks of 4 x 4 pixels of a picture of 24 x 24, with another seed.
fn light_of_blocks(config: &Config, seed: u64) -> Vec<f64> {
    let mut config = config.clone();
    config.image.seed = seed;
    let mut sums = vec![0.0; 36];
    for (pixel, light) in light(&film(&config, 2)).into_iter().enumerate() {
        sums[pixel / 24 / 4 * 6 + pixel % 24 / 4] += light.element_sum();
    }
    sums
}

/// The mean over films of each of their values, and its variance.
fn moments(films: &[Vec<f64>]) -> Vec<[f64; 2]> {
    let n = films.len() as f64;
    let moments = |i: usize| {
        let mean = films.iter().map(|film| film[i]).sum::<f64>() / n;
        let squares = films.iter().map(|film| (film[i] - mean).powi(2));
        [mean, squares.sum::<f64>() / (n - 1.0) / n]
    };
    (0..films[0].len()).map(moments).collect()
}
