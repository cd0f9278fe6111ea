//! A fixed amount of tracing: `benches/instructions/run` counts its instructions,
//! `benches/instructions/cache` its cache misses: `instructions SCENE WAY COST N_ROUNDS`.
//!
//! Each round makes a nearest-hit query and an occlusion query for all rays. Prints the number of
//! queries, the number of primitives and the provenance of the program as JSON.

use std::hint::black_box;
use std::path::Path;

use glam::Vec3;
use import::read_mesh;
use math::sampling::uniform;
use math::simd::Simd;
use scene::config::Acceleration;
use serde_json::json;
use tracer::accel::{Accel, ShadowRay, ShadowStream};
use tracer::cost::{ByPixel, Cost, Counters, NoProbe, PixelProbe, Probe};
use world::geometry::{Ray, RayStream, Shape, Sphere, Triangle};
use world::scene::{MaterialId, ObjectId, Primitive};

/// The file of the scene `mesh`.
const MESH: &str = "configs/meshes/spot.obj";
const N_RAYS: u64 = 16_384;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let [scene, way, cost, n_rounds] = words[..] else {
        println!("this counts nothing by itself: use benches/instructions/run");
        return;
    };
    let primitives = primitives(scene);
    // The widest instruction set that valgrind supports.
    let avx2 = Simd::available()
        .into_iter()
        .find(|simd| simd.to_string() == "avx2");
    let avx2 = avx2.expect("this bench needs AVX2");
    let accel = Accel::new(&primitives, Acceleration::default()).with_simd(avx2);
    let rays = Rays::new();
    for _ in 0..n_rounds.parse().expect("a number of rounds") {
        match (way, cost) {
            ("single", "none") => rays.one_by_one(&accel, NoProbe),
            ("single", "counters") => rays.one_by_one(&accel, Cost::default()),
            ("stream", "none") => rays.in_streams(&accel, NoProbe),
            ("stream", "counters") => rays.in_streams(&accel, Counters::default()),
            _ => panic!("no way {way} with cost {cost}"),
        }
    }
    let n_primitives = primitives.len();
    let made_by = raycost::session::this_build();
    println!(
        "{}",
        json!({ "n_rays": 2 * N_RAYS, "n_primitives": n_primitives, "made_by": made_by })
    );
}

fn primitives(scene: &str) -> Vec<Primitive> {
    let shapes: Vec<Shape> = match scene {
        "mesh" => mesh(),
        "triangles" => (0..20_000).map(triangle).collect(),
        "spheres" => (0..20_000).map(|i| sphere(i, 0.03)).collect(),
        // Equally dense: the first fits into the first cache, the last into none.
        "few_spheres" => (0..100).map(|i| sphere(i, 0.175)).collect(),
        "many_spheres" => (0..400_000).map(|i| sphere(i, 0.011)).collect(),
        _ => panic!("no scene {scene}"),
    };
    let primitive = |shape| Primitive::new(shape, None, ObjectId(0), MaterialId(0));
    shapes.into_iter().map(primitive).collect()
}

struct Rays {
    nearest: RayStream,
    shadow: ShadowStream,
}

impl Rays {
    /// Returns rays through the cube from -1 to 1, from a face to its opposite.
    fn new() -> Self {
        let ray = |i| {
            let [x, y, u, v] = uniform([2, i, 0]).map(|random| 2.0 * random - 1.0);
            let (origin, target) = (Vec3::new(x, y, 2.0), Vec3::new(u, v, -1.0));
            let direction = (target - origin).normalize();
            Ray { origin, direction }
        };
        let nearest: RayStream = (0..N_RAYS).map(ray).collect();
        let shadow = |ray| ShadowRay {
            ray,
            t_max: f32::INFINITY,
            ignored: None,
        };
        let shadow = nearest.iter().map(shadow).collect();
        Self { nearest, shadow }
    }

    #[inline(never)]
    fn one_by_one<P: Probe>(&self, accel: &Accel, mut probe: P) {
        for ray in self.nearest.iter() {
            black_box(accel.nearest(&ray, &mut probe));
        }
        for ShadowRay {
            ray,
            t_max,
            ignored,
        } in self.shadow.iter()
        {
            black_box(accel.occluded(&ray, t_max, ignored, &mut probe));
        }
        black_box(&probe);
    }

    /// Traces rays in streams, where each ray belongs to a different pixel.
    #[inline(never)]
    fn in_streams<P: PixelProbe>(&self, accel: &Accel, mut probe: P) {
        probe.reset(N_RAYS as usize, 1);
        let pixels: Vec<u32> = (0..N_RAYS as u32).collect();
        let mut by_pixel = ByPixel::new(&mut probe, &pixels);
        let (mut hits, mut occluded) = (Vec::new(), Vec::new());
        accel.nearest_stream(&self.nearest, &mut hits, &mut by_pixel);
        accel.occluded_stream(&self.shadow, &mut occluded, &mut by_pixel);
        black_box((hits, occluded, &probe));
    }
}

/// Returns a point in the cube from -1 to 1.
fn in_cube(key: [u64; 3]) -> Vec3 {
    let [x, y, z, _] = uniform(key);
    2.0 * Vec3::new(x, y, z) - 1.0
}

fn triangle(i: u64) -> Shape {
    let center = in_cube([1, i, 0]);
    let vertices = [1, 2, 3].map(|corner| center + 0.05 * in_cube([1, i, corner]));
    Shape::Triangle(Triangle { vertices })
}

fn sphere(i: u64, radius: f32) -> Shape {
    let center = in_cube([1, i, 0]);
    Shape::Sphere(Sphere { center, radius })
}

fn mesh() -> Vec<Shape> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(MESH);
    let mesh = read_mesh(&path).unwrap_or_else(|fault| panic!("{fault}"));
    let triangles = mesh.triangles.iter();
    triangles
        .map(|&indices| Shape::Triangle(mesh.triangle(indices)))
        .collect()
}
