//! A fixed amount of tracing, whose instructions `benches/instructions/run`
//! counts: `instructions SCENE WAY COST N_ROUNDS`.
//!
//! In each round all rays ask for their nearest hit and whether there is any.

use std::hint::black_box;

use glam::Vec3;
use raycost::accel::{Accel, ShadowRay, Simd};
use raycost::config::Acceleration;
use raycost::cost::{ByPixel, Cost, Counters, NoProbe, PixelProbe, Probe};
use raycost::geometry::{Ray, Shape, Sphere, Triangle};
use raycost::sampling::uniform;
use raycost::scene::{MaterialId, ObjectId, Primitive};

const N_PRIMITIVES: u64 = 20_000;
const N_RAYS: u64 = 16_384;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let [scene, way, cost, n_rounds] = words[..] else {
        println!("this counts nothing by itself: use benches/instructions/run");
        return;
    };
    let shape = match scene {
        "triangles" => triangle,
        "spheres" => sphere,
        _ => panic!("no scene {scene}"),
    };
    let primitives: Vec<Primitive> = (0..N_PRIMITIVES)
        .map(|i| Primitive::new(shape(i), None, ObjectId(0), MaterialId(0)))
        .collect();
    // The widest one that valgrind knows.
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
    println!("{}", 2 * N_RAYS);
}

struct Rays {
    nearest: Vec<Ray>,
    shadow: Vec<ShadowRay>,
}

impl Rays {
    /// Rays through the cube from -1 to 1, from a face to its opposite.
    fn new() -> Self {
        let ray = |i| {
            let [x, y, u, v] = uniform([2, i, 0]).map(|random| 2.0 * random - 1.0);
            let (origin, target) = (Vec3::new(x, y, 2.0), Vec3::new(u, v, -1.0));
            let direction = (target - origin).normalize();
            Ray { origin, direction }
        };
        let nearest: Vec<Ray> = (0..N_RAYS).map(ray).collect();
        let shadow = |&ray| ShadowRay {
            ray,
            t_max: f32::INFINITY,
            ignored: None,
        };
        let shadow = nearest.iter().map(shadow).collect();
        Self { nearest, shadow }
    }

    #[inline(never)]
    fn one_by_one<P: Probe>(&self, accel: &Accel, mut probe: P) {
        for ray in &self.nearest {
            black_box(accel.nearest(ray, &mut probe));
        }
        for ShadowRay {
            ray,
            t_max,
            ignored,
        } in &self.shadow
        {
            black_box(accel.occluded(ray, *t_max, *ignored, &mut probe));
        }
        black_box(&probe);
    }

    /// Each ray is a pixel's.
    #[inline(never)]
    fn in_streams<P: PixelProbe>(&self, accel: &Accel, mut probe: P) {
        probe.reset(N_RAYS as usize);
        let pixels: Vec<u32> = (0..N_RAYS as u32).collect();
        let mut by_pixel = ByPixel::new(&mut probe, &pixels);
        let (mut hits, mut occluded) = (Vec::new(), Vec::new());
        accel.nearest_stream(&self.nearest, &mut hits, &mut by_pixel);
        accel.occluded_stream(&self.shadow, &mut occluded, &mut by_pixel);
        black_box((hits, occluded, &probe));
    }
}

/// A point in the cube from -1 to 1.
fn in_cube(key: [u64; 3]) -> Vec3 {
    let [x, y, z, _] = uniform(key);
    2.0 * Vec3::new(x, y, z) - 1.0
}

fn triangle(i: u64) -> Shape {
    let center = in_cube([1, i, 0]);
    let vertices = [1, 2, 3].map(|corner| center + 0.05 * in_cube([1, i, corner]));
    Shape::Triangle(Triangle { vertices })
}

fn sphere(i: u64) -> Shape {
    let (center, radius) = (in_cube([1, i, 0]), 0.03);
    Shape::Sphere(Sphere { center, radius })
}
