//! Cameras: pixel coordinates → rays.
//!
//! Each kind of camera is one file that reads its YAML keys and places an
//! [`ImagePlane`]; all rays come of that. To add a camera, write its file, its
//! `mod` line and its arm in [`Camera`].

mod image_plane;
mod look_at;
mod orthographic;
mod window;

use serde::Deserialize;

pub use image_plane::{ImagePlane, Projection};
pub use look_at::LookAt;
pub use orthographic::Orthographic;
pub use window::{Window, WindowSamples};

/// The scene file's `camera`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    rename_all = "snake_case",
    expecting = "a camera such as { look_at: { … } }"
)]
pub enum Camera {
    /// A perspective camera by eye, target and field of view.
    LookAt(LookAt),
    /// Parallel rays.
    Orthographic(Orthographic),
    /// A perspective camera by eye and window, off-axis if need be.
    Window(Window),
}

impl Camera {
    /// The image plane of a picture of `width * height` pixels.
    pub fn image_plane(&self, width: u32, height: u32) -> ImagePlane {
        match self {
            Self::LookAt(camera) => camera.image_plane(width, height),
            Self::Orthographic(camera) => camera.image_plane(width, height),
            Self::Window(camera) => camera.image_plane(width, height),
        }
    }
}
