//! Traced pixels → `rays.vtp`, the cloud around them, and a ParaView state.

use std::io::{self, Seek, Write};

use super::folder::StagedFile;
use super::state;
use super::vtk::{self, Rays};
use super::{OutputFolder, WriteError, Written};
use crate::camera::ImagePlane;
use crate::config::Codec;
use crate::film::Film;
use crate::observe::ObservedPixel;
use crate::scene::Scene;

/// The cloud's file.
pub(super) const CLOUD: &str = "rays_cloud.vtu";
const STATE: &str = "rays.pvsm";

/// Some pixels of a picture with all of their rays, and what is around them.
#[derive(Debug, Clone, Copy)]
pub struct Traced<'a> {
    /// The scene that the rays went through.
    pub scene: &'a Scene,
    /// Where the picture's pixels lie.
    pub plane: &'a ImagePlane,
    /// The pixels, of `i32::MAX` rays at most.
    pub pixels: &'a [ObservedPixel],
    /// Whether the rays have a time.
    pub is_timed: bool,
    /// A small picture of the scene, whose hits are shown as a cloud.
    pub cloud: &'a Film,
}

/// Writes the rays of traced pixels as PolyData: one line a ray.
///
/// # Errors
/// What the system says.
pub fn write_rays(traced: &Traced, codec: Codec, out: &mut (impl Write + Seek)) -> io::Result<()> {
    Rays::of(traced).write(codec, out)
}

/// Writes all files of traced pixels; gives them in their order.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
pub fn write_traced(
    traced: &Traced,
    codec: Codec,
    folder: &OutputFolder,
) -> Result<Vec<Written>, WriteError> {
    let rays = Rays::of(traced);
    let files = vec![
        folder.stage(vtk::RAYS, |out| rays.write(codec, out))?,
        folder.stage(CLOUD, |out| vtk::write_hits(traced.cloud, codec, out))?,
        folder.stage(STATE, |out| {
            out.write_all(state::of_rays(&rays, folder).as_bytes())
        })?,
    ];
    let written = files.iter().map(StagedFile::written).collect();
    folder.commit(files, [].into_iter())?;
    Ok(written)
}
