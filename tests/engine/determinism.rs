//! Same scene and seed, same bytes, on any number of threads.

use base::Keyword;

use crate::common::{config, film, lasting};
use render::film::Film;
use scene::config::CostMode;

#[test]
fn the_number_of_threads_changes_no_byte() {
    for name in ["seed_extended", "textures", "sphere_cloud"] {
        let mut config = config(name);
        (config.image.width, config.image.height) = (101, 67);
        config.image.samples_per_pixel = 3;
        for &mode in CostMode::KEYWORDS {
            config.cost = mode;
            let one = lasting(film(&config, 1));
            for n_threads in [2, 5] {
                let many = lasting(film(&config, n_threads));
                assert!(one == many, "{name}, {mode:?}, {n_threads} threads");
            }
        }
    }
}

#[test]
fn the_seed_changes_the_samples_and_not_the_geometry() {
    let mut config = config("textures");
    (config.image.width, config.image.height) = (101, 67);
    let first = film(&config, 2);
    config.image.seed += 1;
    let second = film(&config, 2);
    assert!(
        !first
            .values(|strip| &strip.rgb)
            .eq(second.values(|strip| &strip.rgb))
    );
    assert!(
        first
            .values(|strip| &strip.object)
            .eq(second.values(|strip| &strip.object))
    );
}

#[test]
fn more_samples_keep_the_geometry_of_the_pixels_center() {
    let mut config = config("seed_extended");
    let one = film(&config, 2);
    config.image.samples_per_pixel = 4;
    let four = film(&config, 2);
    let bits = |film: &Film| -> Vec<u32> {
        film.values(|strip| &strip.distance)
            .map(f32::to_bits)
            .collect()
    };
    assert_eq!(bits(&one), bits(&four));
    assert_eq!(four.totals.rays[0], 4 * one.totals.rays[0]);
}
