//! The rays of a pixel for `raycost trace --json`.

use serde::Serialize;
use serde_json::{Value, json};

use output::writers::Traced;
use render::attribution::{ObservedPixel, TracedRay};
use scene::config::Config;

/// Returns a pixel, its color without limits, and its rays; the cells of `rays.vtp` are these, in
/// this order. Places and lengths are in world space.
pub(super) fn pixel(pixel: &ObservedPixel, traced: &Traced, config: &Config) -> impl Serialize {
    let rays = pixel.tree.rays.iter();
    PixelEntry {
        pixel: pixel.place.into(),
        color: pixel.tree.color().to_array(),
        rays: rays.map(|one| ray(one, traced, config)).collect(),
    }
}

#[derive(Serialize)]
struct PixelEntry {
    pixel: [u32; 2],
    color: [f32; 3],
    rays: Vec<RayEntry>,
}

#[derive(Serialize)]
struct RayEntry {
    kind: &'static str,
    parent: Option<u32>,
    sample: u32,
    bounce: u32,
    light: Option<u32>,
    origin: [f64; 3],
    direction: [f32; 3],
    distance: Option<f32>,
    in_fog: bool,
    hit: Option<Value>,
    node_visits: u32,
    primitive_tests: u32,
    time_ns: Option<f32>,
    contribution: [f32; 3],
}

fn ray(ray: &TracedRay, traced: &Traced, config: &Config) -> RayEntry {
    let space = &traced.scene.space;
    let hit = ray.surface().map(|hit| {
        let primitive = &traced.scene.primitives[hit.primitive as usize];
        let material = config.materials.get_index(primitive.material.0 as usize);
        json!({
            "object": primitive.object.0,
            "name": config.objects[primitive.object.0 as usize].name,
            "material": material.map(|(name, _)| name),
            "primitive": hit.primitive,
            "instance": hit.instance.map(|id| id.0),
        })
    });
    RayEntry {
        kind: ray.kind.name(),
        parent: ray.parent,
        sample: ray.sample,
        bounce: ray.bounce,
        light: ray.light,
        origin: space.legible(space.world_point(ray.ray.origin)),
        direction: ray.ray.direction.to_array(),
        distance: ray.end().map(|t| space.world_length(t)),
        in_fog: ray.particle.is_some(),
        hit,
        node_visits: ray.node_visits,
        primitive_tests: ray.primitive_tests,
        time_ns: traced.is_timed.then_some(ray.time_ns),
        contribution: ray.contribution.to_array(),
    }
}
