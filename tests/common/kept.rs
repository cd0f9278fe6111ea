//! Films with their cost attributions.

use render::attribution::CostAttribution;
use render::film::Film;
use render::tiles::{TilePlan, render};
use scene::build::Sensor;
use scene::config::{Config, OptionalOutput};
use tracer::accel::Accel;
use tracer::cost::Meter;
use tracer::trace::Tracer;
use world::scene::Scene;

use super::scene_of;

/// Renders the film of a config with its complete cost attribution.
pub fn kept(config: &Config, n_threads: usize) -> (Scene, Film, CostAttribution) {
    let mut config = config.clone();
    [
        OptionalOutput::Objects,
        OptionalOutput::Surface,
        OptionalOutput::Bvh,
        OptionalOutput::Tests,
    ]
    .into_iter()
    .for_each(|output| config.output.add(output));
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let meter = Meter::new(config.cost);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .unwrap();
    let (mut film, mut attribution) = pool.install(|| {
        let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
        let (film, _) = render(tracer, &plan, &meter, &|_| {});
        let sensor = &plan.sensor;
        let attribution =
            CostAttribution::measure(tracer, sensor, &film, &meter, &config.output, &|_| {});
        (film, attribution)
    });
    film.keep_step_counts(std::mem::take(&mut attribution.step_counts));
    (scene, film, attribution)
}
