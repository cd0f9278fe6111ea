//! Same scene and seed, same bytes, on any number of threads.

mod common;

use common::{config, film};
use raycost::film::{Film, Strip};

/// The film without what may differ: time and thread.
fn lasting(mut film: Film) -> Vec<Strip> {
    for strip in &mut film.strips {
        strip.time_ns.clear();
        strip.thread.clear();
        // NaN is equal to nothing, itself included: compare its bits.
        let misses = strip
            .object
            .iter()
            .enumerate()
            .filter(|(_, object)| **object < 0);
        for i in misses.map(|(i, _)| i).collect::<Vec<_>>() {
            assert!(strip.position[i].is_nan() && strip.normal[i].is_nan());
            assert!(strip.distance[i].is_nan() && strip.footprint[i].is_nan());
            (strip.position[i], strip.normal[i]) = Default::default();
            (strip.distance[i], strip.footprint[i]) = Default::default();
        }
    }
    film.strips
}

#[test]
fn threads_change_no_byte() {
    for name in ["seed_extended", "textures", "sphere_cloud"] {
        let mut config = config(name);
        (config.image.width, config.image.height) = (101, 67);
        config.image.samples_per_pixel = 3;
        let one = lasting(film(&config, 1));
        for n_threads in [2, 5] {
            assert!(
                one == lasting(film(&config, n_threads)),
                "{name}, {n_threads} threads"
            );
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
fn samples_leave_the_geometry_of_the_pixels_middle() {
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
