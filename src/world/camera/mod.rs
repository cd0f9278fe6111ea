//! Cameras: pixel coordinates → rays.
//!
//! Each kind of camera has one file, which reads its YAML keys and places an
//! [`ImagePlane`]; the rays depend on nothing else. To add a camera, write its
//! file, its `mod` line and its row in the list of cameras.

mod basis;
mod lens;
mod sphere_axes;
mod image_plane;
mod cone;
mod look_at;
mod orthographic;
mod panorama;
mod window;

use glam::DVec3;
use serde::{Deserialize, Serialize};

pub use cone::RayCone;
pub use image_plane::{ImagePlane, Projection};
pub use lens::Lens;
pub use sphere_axes::SphereAxes;
pub use window::WindowSamples;

use crate::geometry::RenderSpace;

/// Defines [`Camera`] and its dispatch from one list. A row has the kind, whose YAML key
/// is its name in snake case, and the type in the kind's file.
macro_rules! cameras {
    ($($(#[$doc:meta])* $kind:ident($file:ident::$camera:ident),)*) => {
        $(pub use $file::$camera;)*

        /// The scene file's `camera`.
        #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = crate::values::expected::<Self>))]
        #[serde(
            rename_all = "snake_case",
            expecting = "a camera such as { look_at: { … } }"
        )]
        pub enum Camera {
            $($(#[$doc])* $kind($camera),)*
        }

        impl Camera {
            /// Returns the image plane, in render space, of an image of `size[0] * size[1]` pixels.
            pub fn image_plane(&self, size: [u32; 2], space: &RenderSpace) -> ImagePlane {
                match self {
                    $(Self::$kind(camera) => camera.image_plane(size, space),)*
                }
            }

            /// Returns the eye, and a point in the middle of the view, in world space.
            pub fn focus(&self) -> [DVec3; 2] {
                match self {
                    $(Self::$kind(camera) => camera.focus(),)*
                }
            }
        }
    };
}

cameras! {
    /// A perspective camera, given by eye, target and field of view.
    LookAt(look_at::LookAt),
    /// A camera with parallel rays.
    Orthographic(orthographic::Orthographic),
    /// A camera that sees all around.
    Panorama(panorama::Panorama),
    /// A perspective camera, given by eye and window, which may be off-axis.
    Window(window::Window),
}
