//! ParaView state files: templates and the values that fill them.
//!
//! The states in the repository's `paraview/` folder are the templates. Each value that depends on
//! the output has a key there:
//!
//! ```xml
//! <Element index="0" value="$RAYCOST_OUT/frame.vti" fill="frame.vti"/>
//! ```
//!
//! `fill` replaces the values and removes the keys.

mod template;
mod panels;
mod color_points;
mod axis;
mod camera;

pub use axis::{Axis, ColorScale};
pub(crate) use camera::ViewCamera;
pub use panels::{Panels, value_of_panels};
pub(crate) use template::StateValue;
pub use template::{fill, relocated};
