//! Traced pixels → `rays.vtp`, the cloud around them, and a ParaView state.

use std::io::{self, Seek, Write};

use super::rays::{CLOUD, FILE as RAYS, Rays, Traced};
use super::{fields, hits, states};
use host::folder::{OutputFolder, Own, WriteError, Written};
use host::provenance::{Hasher, RunId, stamped};
use vtk::{Codec, Encoding};

/// The name of the ParaView state.
pub const STATE: &str = "rays.pvsm";

/// Writes the rays of traced pixels as PolyData with one line per ray.
///
/// # Errors
/// An error of `out`.
pub fn write_rays(traced: &Traced, codec: Codec, out: &mut (impl Write + Seek)) -> io::Result<()> {
    Rays::new(traced).write(codec.into(), out)
}

/// Writes all files of traced pixels and returns them in order.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
pub fn write_traced(
    traced: &Traced,
    codec: Codec,
    folder: &OutputFolder,
) -> Result<Vec<Written>, WriteError> {
    let rays = Rays::new(traced);
    let run = run_id(traced);
    let mut fields = fields::run(&[traced.name], run);
    fields.extend(fields::camera(traced.plane));
    fields.extend(traced.time.map(fields::time));
    let encoding = Encoding {
        codec,
        run: Some(run),
        fields,
    };
    let staging = folder.stage_files()?;
    let files = [
        staging.stage(RAYS, |out| rays.write(encoding.clone(), out))?,
        staging.stage(CLOUD, |out| {
            hits::write(traced.cloud, encoding.clone(), out)
        })?,
        staging.stage(STATE, |out| {
            let state = stamped(&states::ray_state(&rays, folder), run);
            out.write_all(state.as_bytes())
        })?,
    ];
    staging.commit(&files, &own())?;
    Ok(files.into())
}

/// Checks that [`write_traced`] would not overwrite a file of another program.
///
/// # Errors
/// The first file of another program.
pub fn refuse_foreign_traced(folder: &OutputFolder) -> Result<(), WriteError> {
    folder.refuse_foreign(&own())
}

fn own() -> Own {
    Own::Marked(vec![RAYS, CLOUD, STATE])
}

/// Returns a hash of the scene's name, the frame's time, the rays, their times and the cloud.
fn run_id(traced: &Traced) -> RunId {
    let mut hasher = Hasher::default();
    hasher.add(format!("{:?}", (traced.name, traced.time)).as_bytes());
    for pixel in traced.pixels {
        for ray in &pixel.tree.rays {
            let counts = [ray.node_visits, ray.primitive_tests];
            hasher.add(bytemuck::cast_slice(&counts));
            let numbers = [ray.ray.origin, ray.ray.direction, ray.contribution];
            hasher.add(bytemuck::cast_slice(&numbers));
            hasher.add(&ray.time_ns.to_ne_bytes());
        }
    }
    for strip in &traced.cloud.strips {
        hasher.add(bytemuck::cast_slice(&strip.position));
    }
    hasher.checksum().into()
}
