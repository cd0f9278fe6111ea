//! The one list of shapes, and what each of them can do.

use std::fmt;

use glam::Vec3;
use serde::de::MapAccess;

use super::{Aabb, Cuboid, Disk, Patch, Plane, Ray, Sphere, Transform, Triangle};

/// What a shape has to know.
pub trait Surface: Sized {
    /// The least `t` in (0, `t_max`) at which the ray meets the surface, from
    /// either side. The ray's direction may have any length.
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32>;

    /// The point of the surface nearest to `near`, which lies on it but for
    /// rounding, and the outward unit normal there.
    fn project(&self, near: Vec3) -> (Vec3, Vec3);

    /// The smallest box around it; [`Aabb::ALL`] if it has no bounds.
    fn bounds(&self) -> Aabb;

    /// Its image under the transform, if that is a shape of the same kind.
    fn transformed(&self, transform: &Transform) -> Option<Self>;

    /// How a viewer of meshes draws it; `None` if it has no bounds.
    fn patch(&self) -> Option<Patch>;
}

/// Makes the enum, its YAML keys and its dispatch of one list.
macro_rules! shapes {
    ($($(#[$doc:meta])* $key:literal => $shape:ident,)*) => {
        /// A shape of any kind, in object space.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $shape($shape),)*
        }

        impl Shape {
            /// The YAML keys of all kinds.
            pub const KEYS: &[&str] = &[$($key),*];

            /// Reads the value behind `key`, one of [`Self::KEYS`], from `map`;
            /// `None` for another key.
            pub fn next_value<'de, A: MapAccess<'de>>(
                key: &str,
                map: &mut A,
            ) -> Result<Option<Self>, A::Error> {
                match key {
                    $($key => map.next_value().map(|shape| Some(Self::$shape(shape))),)*
                    _ => Ok(None),
                }
            }
        }

        impl Surface for Shape {
            #[inline]
            fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
                match self { $(Self::$shape(shape) => shape.intersect(ray, t_max),)* }
            }

            fn project(&self, near: Vec3) -> (Vec3, Vec3) {
                match self { $(Self::$shape(shape) => shape.project(near),)* }
            }

            fn bounds(&self) -> Aabb {
                match self { $(Self::$shape(shape) => shape.bounds(),)* }
            }

            fn transformed(&self, transform: &Transform) -> Option<Self> {
                match self {
                    $(Self::$shape(shape) => shape.transformed(transform).map(Self::$shape),)*
                }
            }

            fn patch(&self) -> Option<Patch> {
                match self { $(Self::$shape(shape) => shape.patch(),)* }
            }
        }

        /// The YAML key.
        impl fmt::Display for Shape {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$shape(_) => $key,)* })
            }
        }
    };
}

shapes! {
    /// A sphere.
    "sphere" => Sphere,
    /// An infinite plane.
    "plane" => Plane,
    /// A flat disk.
    "disk" => Disk,
    /// A triangle.
    "triangle" => Triangle,
    /// An axis-aligned box.
    "box" => Cuboid,
}
