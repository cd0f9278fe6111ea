//! Lights: a point → the light that arrives there.
//!
//! Each kind of light has one file. To add a light, write its file, its `mod` line and
//! its row in the list of lights.

mod directional;
mod falloff;
mod illumination;
mod point;
mod spot;

use glam::{DAffine3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

pub use falloff::Falloff;
pub use illumination::{Illumination, LitPoint};

use crate::geometry::RenderSpace;
use math::simd::{Real, Vector};

/// Defines [`Light`] and its dispatch from one list. A row has the kind, whose YAML key
/// is its name in snake case, and the type in the kind's file.
macro_rules! lights {
    ($($(#[$doc:meta])* $kind:ident($file:ident::$light:ident),)*) => {
        $(pub use $file::$light;)*

        /// One of the scene file's `lights`.
        #[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = crate::values::expected::<Self>))]
        #[serde(
            rename_all = "snake_case",
            expecting = "a light such as { point: { … } }"
        )]
        pub enum Light {
            $($(#[$doc])* $kind($light),)*
        }

        impl Light {
            /// Returns the radiance of a white surface that faces the light, averaged over a sphere of
            /// this radius around it, or around any point if it is infinitely far away.
            pub fn mean_radiance(&self, radius: f32) -> Vec3 {
                match self {
                    $(Self::$kind(light) => light.mean_radiance(radius),)*
                }
            }

            /// Returns the position, if there is one.
            pub fn position(&self) -> Option<DVec3> {
                match self {
                    $(Self::$kind(light) => light.position(),)*
                }
            }

            /// Converts the light from world space to render space.
            pub fn in_space(&self, space: &RenderSpace) -> Self {
                match self {
                    $(Self::$kind(light) => Self::$kind(light.in_space(space)),)*
                }
            }

            /// Places the light as an object's transform does, with all lengths: where its falloff
            /// is the natural one, it lights a scaled object as before. Multiplies its intensity by
            /// `factor`. Returns `None` if the transform leaves it without a direction.
            pub fn placed(&self, world_from_object: &DAffine3, factor: f32) -> Option<Self> {
                match self {
                    $(Self::$kind(light) => {
                        light.placed(world_from_object, factor).map(Self::$kind)
                    })*
                }
            }

            /// Returns the light that arrives at `point` unless it is occluded.
            #[inline(always)]
            pub fn illuminate<R: Real>(&self, point: Vector<R>) -> Illumination<R> {
                match self {
                    $(Self::$kind(light) => light.illuminate(point),)*
                }
            }
        }
    };
}

lights! {
    /// A light at a point.
    Point(point::PointLight),
    /// A light infinitely far away.
    Directional(directional::DirectionalLight),
    /// A light at a point that shines into a cone.
    Spot(spot::SpotLight),
}
