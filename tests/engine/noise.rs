//! The standard error of pixels, and the efficiency of their samples.

use crate::common::{config, film, lasting, parse, with_cost};
use math::statistics::median;
use render::film::Film;
use scene::config::{Config, CostMode, OptionalOutput, PixelArray};
use tracer::cost::Metric;

fn with_noise(mut config: Config) -> Config {
    config.output.add(OptionalOutput::Noise);
    config.output.add(OptionalOutput::Radiance);
    config
}

/// A checker of 0 and 1 that is finer than a pixel: samples of pixels are one or the other.
fn fine_checker(n_samples: u32) -> Config {
    with_noise(parse(&format!(
        "
image: {{ width: 9, height: 7, samples_per_pixel: {n_samples}, sampler: sobol }}
camera: {{ orthographic: {{ eye: [0, 0, 5], target: [0, 0, 0], height: 4 }} }}
shading: {{ ambient: 1 }}
materials: {{ fine: {{ color: {{ checker: {{ even: 0, odd: 1, size: 0.0137, axes: xy }} }} }} }}
lights: []
objects: [{{ plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}, material: fine }}]
"
    )))
}

fn cornell_box() -> Config {
    let mut config = with_cost(config("cornell_box"), CostMode::Counters);
    (config.image.width, config.image.height) = (32, 24);
    config.image.samples_per_pixel = 16;
    with_noise(config)
}

#[test]
fn the_noise_of_zeros_and_ones_is_known() {
    for n in [2, 3, 16, 50] {
        let film = film(&fine_checker(n), 2);
        let shares = film.values(|strip| &strip.radiance).map(|light| light.x);
        for (share, noise) in shares.zip(film.values(|strip| &strip.noise)) {
            let expected = (share * (1.0 - share) / (n - 1) as f32).sqrt();
            assert!((noise - expected).abs() < 1e-4, "{n}: {noise}, {expected}");
        }
    }
}

#[test]
fn pixels_without_a_difference_have_no_noise_and_no_efficiency() {
    let mut config = cornell_box();
    for material in config.materials.values_mut() {
        *material = parse(
            "image: { width: 1, height: 1 }
camera: { look_at: { eye: [0, 0, 1], target: [0, 0, 0], fov_y_deg: 20 } }
materials: { plain: { color: 0 } }
lights: []
objects: [{ sphere: { center: [0, 0, 0], radius: 1 }, material: plain }]
",
        )
        .materials[0]
            .clone();
    }
    config.lights.clear();
    let film = film(&config, 2);
    assert!(film.values(|strip| &strip.noise).all(|noise| noise == 0.0));
    let efficiency = film.metric(Metric::EFFICIENCY);
    assert!(efficiency.iter().all(|value| value.is_nan()));
}

#[test]
fn noise_is_at_least_the_spread_over_seeds() {
    // Strata make the true spread smaller than independent samples would.
    const N_SEEDS: u64 = 32;
    let mut config = cornell_box();
    let mut films = Vec::new();
    for seed in 0..N_SEEDS {
        config.image.seed = seed;
        films.push(film(&config, 2));
    }
    let light = |film: &Film| -> Vec<f64> {
        let light = film.values(|strip| &strip.radiance);
        light
            .flat_map(|light| light.as_dvec3().to_array())
            .collect()
    };
    let lights: Vec<Vec<f64>> = films.iter().map(light).collect();
    let noise: Vec<Vec<f32>> = films
        .iter()
        .map(|film| film.metric(Metric::NOISE))
        .collect();
    let n = N_SEEDS as f64;
    let mut ratios = Vec::new();
    for pixel in 0..noise[0].len() {
        let channel = |i: usize| {
            let mean = lights.iter().map(|light| light[i]).sum::<f64>() / n;
            let squares = lights.iter().map(|light| (light[i] - mean).powi(2));
            squares.sum::<f64>() / (n - 1.0)
        };
        let spread: f64 = (3 * pixel..3 * pixel + 3).map(channel).sum();
        let variances = noise
            .iter()
            .map(|noise| 3.0 * f64::from(noise[pixel]).powi(2));
        if spread > 0.0 {
            ratios.push(variances.sum::<f64>() / n / spread);
        }
    }
    assert!(ratios.len() > 500, "{}", ratios.len());
    let ratio = median(&mut ratios).unwrap();
    assert!((0.95..2.0).contains(&ratio), "{ratio}");
}

#[test]
fn efficiency_divides_by_variance_and_cost() {
    let mut config = cornell_box();
    for cost in [None, Some(PixelArray::ShadowRays)] {
        config.output.noise.cost = cost;
        let film = film(&config, 2);
        let [noise, efficiency] =
            [Metric::NOISE, Metric::EFFICIENCY].map(|metric| film.metric(metric));
        let chosen = match cost {
            None => vec![Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS],
            Some(array) => Metric::ALL
                .into_iter()
                .filter(|metric| metric.name == base::Keyword::name(array))
                .collect(),
        };
        let costs: Vec<Vec<f32>> = chosen.into_iter().map(|cost| film.metric(cost)).collect();
        for (i, found) in efficiency.into_iter().enumerate() {
            let cost: f32 = costs.iter().map(|costs| costs[i]).sum();
            // Of one sample: variance is 16 times that of the mean, cost a sixteenth.
            let expected = 1.0 / (16.0 * noise[i].powi(2) * cost / 16.0);
            let is_equal = (found / expected - 1.0).abs() < 1e-5;
            assert!(is_equal || !expected.is_finite(), "{found}, {expected}");
        }
    }
}

#[test]
fn threads_and_modes_change_no_byte_and_noise_no_picture() {
    let config = cornell_box();
    let expected = lasting(film(&config, 1));
    for mode in [CostMode::Counters, CostMode::SingleRayTime, CostMode::Time] {
        let found = film(&with_cost(config.clone(), mode), 3);
        assert!(lasting(found) == expected, "{mode:?}");
    }
    let noisy = film(&config, 2);
    let mut config = config;
    config.output = Default::default();
    config.output.add(OptionalOutput::Radiance);
    let plain = film(&config, 2);
    let light = |film: &Film| film.values(|strip| &strip.radiance).collect::<Vec<_>>();
    assert_eq!(light(&noisy), light(&plain));
    assert_eq!(noisy.totals, plain.totals);
}
