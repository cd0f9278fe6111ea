//! Adaptive sampling: noisy pixels get more samples, until they are not noisy.

use crate::common::{config, counts, film, lasting, parse, sum, with_cost};
use render::film::Film;
use scene::config::{Adaptive, Config, CostMode};
use tracer::cost::{Counter, RayKind};

/// The marbles behind a lens as a small picture.
fn marbles(samples: u32, adaptive: Option<Adaptive>) -> Config {
    let mut config = with_cost(config("marbles"), CostMode::Counters);
    (config.image.width, config.image.height) = (40, 26);
    (config.image.samples_per_pixel, config.image.adaptive) = (samples, adaptive);
    config
}

fn levels(film: &Film) -> Vec<[u8; 3]> {
    film.values(|strip| &strip.rgb).collect()
}

#[test]
fn the_error_is_below_the_threshold_wherever_samples_were_left() {
    let noise = 0.02;
    let adaptive = Adaptive::by_noise(noise);
    let found = film(&marbles(512, Some(adaptive)), 2);
    let n_samples = counts(&found, Counter::Samples);
    let exact = film(&marbles(2048, None), 2);
    let (mut n, mut n_far, mut squares) = (0, 0, 0.0);
    let pixels = levels(&found).into_iter().zip(levels(&exact));
    for (pixel, (found, exact)) in pixels.enumerate() {
        if n_samples[pixel] == 512 {
            continue;
        }
        for (found, exact) in found.into_iter().zip(exact) {
            let error = (f32::from(found) - f32::from(exact)) / 255.0;
            n_far += usize::from(error.abs() > 3.0 * noise);
            squares += error * error;
            n += 1;
        }
    }
    let error = (squares / n as f32).sqrt();
    assert!(error < noise, "{error}");
    // Few pixels have samples that are the same by chance.
    assert!(n_far * 100 < n, "{n_far} of {n}");
    let n_below = n_samples.iter().filter(|&&n| n < 512).count();
    assert_eq!(found.n_below_noise(), n_below as u64);
    // Flat pixels have the fewest samples, blurred edges many.
    let of_least = n_samples.iter().filter(|&&n| n == 16).count();
    let of_many = n_samples.iter().filter(|&&n| n >= 64).count();
    assert!(of_least > 100 && of_many > 100, "{of_least}, {of_many}");
    assert_eq!(
        sum(&found, Counter::Samples),
        found.totals.rays_of(RayKind::Camera)
    );
}

#[test]
fn a_threshold_that_is_never_met_gives_all_samples() {
    // A checker of 0 and 1 that is finer than a pixel.
    let text = |adaptive: &str| {
        format!(
            "
image: {{ width: 9, height: 7, samples_per_pixel: 50, sampler: sobol{adaptive} }}
camera: {{ orthographic: {{ eye: [0, 0, 5], target: [0, 0, 0], height: 4 }} }}
shading: {{ ambient: 1 }}
materials: {{ fine: {{ color: {{ checker: {{ even: 0, odd: 1, size: 0.0137, axes: xy }} }} }} }}
lights: []
objects: [{{ plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}, material: fine }}]
"
        )
    };
    let all = film(&parse(&text("")), 1);
    let noisy = film(
        &parse(&text(", adaptive: { noise: 0.0001, min_samples: 24 }")),
        1,
    );
    assert_eq!(counts(&noisy, Counter::Samples), [50; 63]);
    assert_eq!(levels(&all), levels(&noisy));
    assert_eq!(all.totals, noisy.totals);
    let calm = film(
        &parse(&text(", adaptive: { noise: 1, min_samples: 24 }")),
        1,
    );
    assert_eq!(counts(&calm, Counter::Samples), [24; 63]);
}

#[test]
fn threads_and_modes_change_no_byte() {
    let adaptive = Adaptive {
        min_samples: 8,
        ..Adaptive::by_noise(0.03)
    };
    let config = marbles(200, Some(adaptive));
    let expected = lasting(film(&config, 1));
    for mode in [CostMode::Counters, CostMode::SingleRayTime, CostMode::Time] {
        for n_threads in [2, 3] {
            let found = film(&with_cost(config.clone(), mode), n_threads);
            assert!(lasting(found) == expected, "{mode:?}, {n_threads} threads");
        }
    }
    let uncounted = film(&with_cost(config, CostMode::None), 2);
    assert!(lasting(uncounted).0 == expected.0);
}
