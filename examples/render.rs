//! Renders a scene file and writes all files: `cargo run --release --example render`.

use std::error::Error;
use std::path::Path;

use raycost::{Options, Session};

/// Renders `scene` into `folder`.
pub fn run(scene: &Path, folder: &Path) -> Result<(), Box<dyn Error>> {
    let session = Session::open(scene)?;
    let mut rendering = session.render(&Options::default())?;
    println!("{} pixels see something", rendering.film().n_hits());
    for file in rendering.write(folder)? {
        println!("{}: {} bytes", file.file, file.bytes);
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(
        Path::new("configs/seed_extended.yaml"),
        Path::new("out/example"),
    )
}
