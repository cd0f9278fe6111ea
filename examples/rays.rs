//! Traces a million rays against a mesh made in code, without a scene file, and counts what they
//! cost: `cargo run --release --example rays`.

use glam::{Vec2, Vec3};
use raycost::accel::Accel;
use raycost::cost::Cost;
use raycost::geometry::{Ray, RenderSpace, Shape, Triangle};
use raycost::material::{Material, Texture};
use raycost::world::scene::{MaterialId, Scene};

/// Returns the height of the terrain at a point of the ground.
fn height(at: Vec2) -> f32 {
    0.1 * (9.0 * at.x).sin() * (7.0 * at.y).cos()
}

/// Returns a terrain of `2 n^2` triangles between -1 and 1.
pub fn terrain(n: u16) -> Option<Scene> {
    let corner = |x, y| {
        let at = 2.0 / f32::from(n) * Vec2::new(f32::from(x), f32::from(y)) - 1.0;
        Vec3::new(at.x, height(at), at.y)
    };
    let cells = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b] = [corner(x, y), corner(x + 1, y)];
        let [c, d] = [corner(x, y + 1), corner(x + 1, y + 1)];
        [[a, c, b], [b, c, d]].map(|vertices| Shape::Triangle(Triangle { vertices }))
    });
    let clay = Material::matte(Texture::Color(Vec3::splat(0.8)));
    let mut scene = Scene::new(
        RenderSpace::default(),
        Default::default(),
        vec![clay],
        Default::default(),
    );
    scene.add_shapes(triangles, MaterialId(0))?;
    Some(scene)
}

/// Traces `n^2` rays from above, straight down; returns their mean height and what they cost.
pub fn mean_height(scene: &Scene, n: u16) -> (f64, Cost) {
    let accel = Accel::new(scene, Default::default());
    let (mut sum, mut cost) = (0.0, Cost::default());
    for i in 0..u32::from(n).pow(2) {
        let [x, y] = [i % u32::from(n), i / u32::from(n)].map(|i| (i as f32 + 0.5) / f32::from(n));
        let ray = Ray {
            origin: Vec3::new(2.0 * x - 1.0, 1.0, 2.0 * y - 1.0),
            direction: -Vec3::Y,
        };
        let hit = accel.nearest(&ray, &mut cost);
        sum += hit.map_or(0.0, |hit| f64::from(1.0 - hit.t));
    }
    (sum / f64::from(n).powi(2), cost)
}

fn main() {
    let scene = terrain(300).expect("triangles with an area");
    let (mean, cost) = mean_height(&scene, 1000);
    println!(
        "{} triangles, mean height {mean:.5}",
        scene.primitives.len()
    );
    println!(
        "{} node visits, {} triangle tests",
        cost.node_visits, cost.primitive_tests
    );
}
