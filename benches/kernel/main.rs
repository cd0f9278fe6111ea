//! Rays per second of every ray kernel that this machine can run: `cargo bench --bench kernel [--
//! [--only SCENE] [--mesh FILE] [--builds]]`.
//!
//! There are three scenes, and a fourth one with `--mesh`. For each quality of the hierarchy: the
//! build time, the size, and the node visits and primitive tests per ray; with `--builds` only
//! these. For each kernel three kinds of rays: the primary rays of an image and, from each of their
//! hits, a diffuse ray (cosine-distributed) and a shadow ray to a point light. On one thread; the
//! kernels take turns in one process, so that drifts of the machine's speed affect all of them
//! equally. Reports medians.

mod scenes;

use std::hint::black_box;
use std::time::Instant;

use base::Keyword;
use glam::Vec3;
use math::sampling::uniform;
use math::simd::Simd;
use math::statistics::upper_median;
use scene::config::{Acceleration, Quality};
use scenes::View;
use tracer::accel::Accel;
use tracer::cost::{Cost, NoProbe, Probe};
use world::geometry::Ray;
use world::scene::Primitive;

const N_ROUNDS: usize = 9;
const N_BUILDS: usize = 3;
/// Rows and columns of the image.
const SIDE: usize = 512;

fn main() {
    println!("Mrays/s, one thread, medians of {N_ROUNDS} rounds; in brackets with counters");
    let wanted = argument("--only");
    let is_wanted = |scene: &str| wanted.as_ref().is_none_or(|wanted| wanted == scene);
    if is_wanted("spheres") {
        compare("spheres", &scenes::sphere_cloud(), &scenes::CUBE);
    }
    if is_wanted("soup") {
        compare("soup", &scenes::triangle_soup(), &scenes::CUBE);
    }
    if is_wanted("architecture") {
        compare("architecture", &scenes::architecture(), &scenes::NAVE);
    }
    if let Some(path) = argument("--mesh") {
        let (mesh, view) = scenes::mesh(path.as_ref());
        compare("mesh", &mesh, &view);
    }
}

/// Returns the argument after `name` on the command line.
fn argument(name: &str) -> Option<String> {
    let mut arguments = std::env::args().skip_while(|argument| argument != name);
    arguments.nth(1)
}

/// Returns a kernel per instruction set of the CPU, by name.
fn kernels(primitives: &[Primitive]) -> Vec<(String, Accel<'_>)> {
    let built = Accel::new(primitives, Acceleration::default());
    let on = |simd: Simd| (simd.to_string(), built.clone().with_simd(simd));
    Simd::available().into_iter().map(on).collect()
}

fn compare(scene: &str, primitives: &[Primitive], view: &View) {
    println!("\n{scene}: {} primitives", primitives.len());
    let kernels = kernels(primitives);
    let rays = Rays::new(&kernels[0].1, primitives, view);
    for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
        compare_build(primitives, quality, &rays);
    }
    if std::env::args().any(|argument| argument == "--builds") {
        return;
    }
    for (name, rays, t_max) in rays.sets() {
        let mut times = vec![[[0.0; N_ROUNDS]; 2]; kernels.len()];
        let mut cost = Cost::default();
        for round in 0..N_ROUNDS {
            for (times, (_, accel)) in times.iter_mut().zip(&kernels) {
                cost = Cost::default();
                times[0][round] = seconds(accel, rays, t_max, &mut NoProbe);
                times[1][round] = seconds(accel, rays, t_max, &mut cost);
            }
        }
        let n = rays.len() as f64;
        let (nodes, tests) = (cost.node_visits as f64 / n, cost.primitive_tests as f64 / n);
        print!("  {name:8} {nodes:5.1} nodes {tests:5.1} tests a ray");
        for (times, (kernel, _)) in times.iter_mut().zip(&kernels) {
            let [bare, counting] = times.each_mut().map(|times| n / median(times) / 1e6);
            print!("   {kernel} {bare:.2} ({counting:.2})");
        }
        println!();
    }
}

/// Builds a hierarchy; prints its build time, its size and the cost of rays.
fn compare_build(primitives: &[Primitive], quality: Quality, rays: &Rays) {
    let build = || Accel::new(primitives, Acceleration::Bvh(quality));
    let mut times = [0.0; N_BUILDS];
    for time in &mut times {
        let start = Instant::now();
        black_box(build());
        *time = start.elapsed().as_secs_f64() * 1e3;
    }
    let accel = build();
    let name = quality.name();
    print!("  {name:8} {:6.0} ms", median(&mut times));
    for (set, rays, t_max) in rays.sets() {
        let mut cost = Cost::default();
        seconds(&accel, rays, t_max, &mut cost);
        let per_ray = |count: u64| count as f64 / rays.len() as f64;
        let (nodes, tests) = (per_ray(cost.node_visits), per_ray(cost.primitive_tests));
        print!("   {set} {nodes:.2} nodes {tests:.2} tests");
    }
    println!("\n           {:?}", accel.statistics().unwrap());
}

/// Measures the time for all rays in seconds; they are nearest-hit queries if `t_max` is 0.
fn seconds(accel: &Accel, rays: &[Ray], t_max: f32, probe: &mut impl Probe) -> f64 {
    let start = Instant::now();
    let mut n_hits = 0;
    for ray in rays {
        n_hits += usize::from(if t_max > 0.0 {
            accel.occluded(ray, t_max, None, probe)
        } else {
            black_box(accel.nearest(ray, probe)).is_some()
        });
    }
    black_box(n_hits);
    start.elapsed().as_secs_f64()
}

/// Returns the upper median of at least one time.
fn median(times: &mut [f64]) -> f64 {
    upper_median(times, f64::total_cmp).unwrap_or_default()
}

struct Rays {
    primary: Vec<Ray>,
    diffuse: Vec<Ray>,
    shadow: Vec<Ray>,
}

impl Rays {
    /// Returns the sets of rays by name, with the `t_max` of shadow rays and 0 for others.
    fn sets(&self) -> [(&str, &[Ray], f32); 3] {
        [
            ("primary", &self.primary, 0.0),
            ("diffuse", &self.diffuse, 0.0),
            ("shadow", &self.shadow, f32::INFINITY),
        ]
    }

    fn new(accel: &Accel, primitives: &[Primitive], view: &View) -> Self {
        let primary: Vec<Ray> = (0..SIDE * SIDE).map(|i| view.ray(i, SIDE)).collect();
        let (mut diffuse, mut shadow) = (Vec::new(), Vec::new());
        for (i, ray) in primary.iter().enumerate() {
            let Some(hit) = accel.nearest(ray, &mut NoProbe) else {
                continue;
            };
            let primitive = &primitives[hit.primitive as usize];
            let (position, outward) = primitive.project(ray.at(hit.t));
            let normal = outward * -outward.dot(ray.direction).signum();
            let leaving = |direction| {
                Ray::leaving(
                    [position, normal],
                    primitive.rounding([position, normal]),
                    direction,
                )
            };
            let [u, v, w, _] = uniform([7, i as u64, 0]);
            let z = 1.0 - 2.0 * v;
            let (sin, cos) = (std::f32::consts::TAU * u).sin_cos();
            let on_sphere = Vec3::new(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + Vec3::Z * z;
            let up = (normal + 0.999 * on_sphere).normalize();
            diffuse.push(leaving(up));
            let light = view.light + 0.1 * Vec3::new(u, v, w);
            let to_light = (light - position).normalize();
            shadow.push(leaving(to_light));
        }
        Self {
            primary,
            diffuse,
            shadow,
        }
    }
}
