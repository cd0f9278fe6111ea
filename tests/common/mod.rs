//! What several test files need.
#![allow(dead_code, reason = "each test file uses its part")]

use std::path::PathBuf;

use raycost::accel::Accel;
use raycost::config::Config;
use raycost::cost::Clock;
use raycost::film::{Film, Strip};
use raycost::render::render;
use raycost::scene::Scene;
use raycost::yaml::Source;

/// A path below the repository's root.
pub fn in_repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The config of a file in `configs/`.
pub fn config(name: &str) -> Config {
    let source = Source::read(&in_repository(&format!("configs/{name}.yaml"))).unwrap();
    source.parse().unwrap_or_else(|error| panic!("{error}"))
}

/// The config that `text` holds.
pub fn parse(text: &str) -> Config {
    let source = Source::new("test.yaml", text);
    source.parse().unwrap_or_else(|error| panic!("{error}"))
}

/// The film of a config, with cost, on `n_threads` threads.
pub fn film(config: &Config, n_threads: usize) -> Film {
    let scene = Scene::new(config).unwrap();
    let accel = Accel::new(&scene.primitives, config.acceleration);
    let clock = Clock::calibrated();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .unwrap();
    pool.install(|| render(&scene, &accel, &config.image, Some(&clock), |_| {}))
}

/// The sum of one counter over all pixels.
pub fn sum(film: &Film, counter: fn(&Strip) -> &Vec<u32>) -> u64 {
    film.values(counter).map(u64::from).sum()
}
