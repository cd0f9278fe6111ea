//! Cameras: pixel coordinates → rays.
//!
//! Each kind of camera has one file, which reads its YAML keys and places an
//! [`ImagePlane`]; the rays depend on nothing else. To add a camera, write its
//! file, its `mod` line and its arms in [`Camera`].

mod image_plane;
mod basis;
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
    /// A perspective camera, given by eye, target and field of view.
    LookAt(LookAt),
    /// A camera with parallel rays.
    Orthographic(Orthographic),
    /// A perspective camera, given by eye and window, which may be off-axis.
    Window(Window),
}

impl Camera {
    /// The image plane of an image of `width * height` pixels.
    pub fn image_plane(&self, width: u32, height: u32) -> ImagePlane {
        match self {
            Self::LookAt(camera) => camera.image_plane(width, height),
            Self::Orthographic(camera) => camera.image_plane(width, height),
            Self::Window(camera) => camera.image_plane(width, height),
        }
    }
}
