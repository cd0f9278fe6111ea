//! Films with their ledgers.

use raycost::accel::Accel;
use raycost::config::{Config, Extra};
use raycost::cost::Meter;
use raycost::film::Film;
use raycost::ledger::Ledger;
use raycost::render::{Plan, render};
use raycost::scene::Scene;

use super::scene_of;

/// The film of a config and all of its ledger, on so many threads.
pub fn kept(config: &Config, n_threads: usize) -> (Scene, Film, Ledger) {
    let mut config = config.clone();
    [Extra::Objects, Extra::Surface, Extra::Bvh]
        .into_iter()
        .for_each(|extra| config.output.add(extra));
    let scene = scene_of(&config);
    let accel = Accel::new(&scene.primitives, config.acceleration);
    let meter = Meter::new(config.cost);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .unwrap();
    let (film, ledger) = pool.install(|| {
        let plan = Plan::new(&scene, &accel, &config.image, config.tiles);
        let (film, _) = render(&scene, &accel, &plan, &meter, |_| {});
        let world = (&scene, &accel, &config.image);
        let ledger = Ledger::keep(world, (&film, &meter), &config.output, |_| {});
        (film, ledger)
    });
    (scene, film, ledger)
}
