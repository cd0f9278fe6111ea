//! Renders two spheres and a lamp made of Rust types, without a scene file, and follows one ray:
//! `cargo run --release --example two_spheres`.

use glam::{DVec3, Vec3};
use raycost::accel::Accel;
use raycost::camera::{Camera, LookAt};
use raycost::config::{CostMode, Image, Tiling};
use raycost::cost::{Cost, Meter};
use raycost::film::Film;
use raycost::geometry::{Ray, RenderSpace, Shape, Sphere};
use raycost::light::{Falloff, Light, PointLight};
use raycost::material::{Material, Texture};
use raycost::world::scene::{MaterialId, Scene};
use raycost::{Sensor, TilePlan, Tracer, render};

/// Returns the picture, with the cost of each pixel, and the cost of a ray through its middle.
pub fn picture(width: u32, height: u32) -> Result<(Film, Cost), &'static str> {
    let clay = Material::matte(Texture::Color(Vec3::new(0.8, 0.4, 0.3)));
    let (shading, background) = Default::default();
    let mut scene = Scene::new(RenderSpace::default(), shading, vec![clay], background);
    let sphere = |x, radius| {
        Shape::Sphere(Sphere {
            center: Vec3::new(x, 0.0, 0.0),
            radius,
        })
    };
    scene.add_shapes([sphere(-0.5, 1.0), sphere(1.0, 0.5)], MaterialId(0));
    scene.add_lights(&[Light::Point(PointLight {
        position: DVec3::new(3.0, 5.0, 4.0),
        color: Vec3::ONE,
        intensity: 1.0,
        falloff: Falloff::None,
    })]);
    let accel = Accel::new(&scene, Default::default());
    let tracer = Tracer::new(&scene, &accel);

    let camera = Camera::LookAt(LookAt::new(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 30.0)?);
    let sensor = Sensor::from_camera(&scene, &camera, Image::new(width, height));
    let plan = TilePlan::new(tracer, &sensor, Tiling::default());
    let (film, _) = render(tracer, &plan, &Meter::new(CostMode::Counters), &|_| {});

    let mut cost = Cost::default();
    let ray = Ray {
        origin: Vec3::new(0.0, 0.0, 6.0),
        direction: -Vec3::Z,
    };
    accel.nearest(&ray, &mut cost);
    Ok((film, cost))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (film, cost) = picture(400, 300)?;
    let pixels: Vec<u8> = film.values(|strip| &strip.rgb).flatten().collect();
    std::fs::create_dir_all("out")?;
    image::save_buffer(
        "out/two_spheres.png",
        &pixels,
        400,
        300,
        image::ColorType::Rgb8,
    )?;
    println!(
        "out/two_spheres.png shows {} pixels of spheres",
        film.n_hits()
    );
    println!(
        "one ray: {} node visits, {} primitive tests",
        cost.node_visits, cost.primitive_tests
    );
    Ok(())
}
