//! Describes a scene in code, a helix of spheres, shows the progress, and writes the
//! picture and its cost: `cargo run --release --example scene_in_code`.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;

use raycost::session::Event;
use raycost::{Options, Session};
use serde_json::{Value, json};

/// Returns a sphere on a helix of three turns.
fn sphere(i: u32, n: u32) -> Value {
    let share = f64::from(i) / f64::from(n);
    let (sin, cos) = (3.0 * TAU * share).sin_cos();
    json!({
        "sphere": { "center": [2.0 * cos, 4.0 * share - 2.0, 2.0 * sin], "radius": 0.25 },
        "material": if i.is_multiple_of(2) { "red" } else { "white" },
    })
}

/// Returns the scene, with the keys of a scene file.
fn scene(n_spheres: u32) -> Value {
    json!({
        "image": { "width": 320, "height": 320 },
        "camera": { "look_at": { "eye": [0, 2, 9], "target": [0, 0, 0], "fov_y_deg": 40 } },
        "materials": {
            "red": { "color": [0.8, 0.1, 0.1], "specular": 0.5 },
            "white": { "color": [0.9, 0.9, 0.9], "reflection": 0.2 },
        },
        "lights": [{ "point": { "position": [5, 8, 10] } }],
        "objects": (0..n_spheres).map(|i| sphere(i, n_spheres)).collect::<Vec<_>>(),
    })
}

/// Renders the scene into `folder`.
pub fn run(folder: &Path) -> Result<(), Box<dyn Error>> {
    let session = Session::from_value("helix", &scene(60))?;
    let options = Options {
        on_event: Some(&|event| {
            if let Event::Begin { stage, .. } = event {
                println!("{stage} …");
            }
        }),
        ..Options::default()
    };
    session.render(&options)?.write(folder)?;
    println!("wrote {}", folder.display());
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(Path::new("out/helix"))
}
