//! The list of shapes, and all kinds of shapes under their names.

use glam::Vec3;
use serde::Serialize;
use serde::de::MapAccess;

use super::{
    Aabb, Intersectable, Keyed, Located, N_PARAMETERS, Patch, Project, Ray, Sampled, Seen,
    SurfaceSample, Transform,
};
use math::simd::{Real, Vector};

/// Defines the enum, its YAML keys and its dispatch from one list. A row has the YAML
/// key and the type in the shape's file.
macro_rules! shapes {
    ($($(#[$doc:meta])* $key:literal => $file:ident::$shape:ident,)*) => {
        $(pub use super::$file::$shape;)*

        /// A shape of any kind, in object space.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $shape($shape),)*
        }

        impl Shape {
            /// The YAML keys of all kinds.
            pub const KEYS: &[&str] = &[$($key),*];

        }

        /// A shape of any kind in a scene file, with its keys.
        #[derive(Debug, Clone, PartialEq, Serialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        pub enum KeyedShape {
            $($(#[$doc])* #[serde(rename = $key)] $shape(Keyed<$shape>),)*
        }

        impl KeyedShape {
            /// Reads the value of `key` from `map`; `None` if the key is not one of
            /// [`Shape::KEYS`].
            pub fn next_value<'de, A: MapAccess<'de>>(
                key: &str,
                map: &mut A,
            ) -> Result<Option<Self>, A::Error> {
                match key {
                    $($key => map.next_value().map(|shape| Some(Self::$shape(shape))),)*
                    _ => Ok(None),
                }
            }

            /// Returns the shape.
            pub fn shape(&self) -> Located<Shape> {
                match self {
                    $(Self::$shape(keyed) => keyed.shape.map(Shape::$shape),)*
                }
            }

            /// Returns the YAML key.
            pub fn key(&self) -> &'static str {
                match self { $(Self::$shape(_) => $key,)* }
            }
        }

        /// The kinds of shapes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum ShapeKind {
            $($(#[$doc])* $shape,)*
        }

        impl ShapeKind {
            /// All kinds, in the order of declaration.
            pub const ALL: &[Self] = &[$(Self::$shape),*];

            /// [`Project::project_onto`] of shapes of this kind.
            #[inline(always)]
            pub fn project_onto<R: Real>(
                self,
                parameters: &[R; N_PARAMETERS],
                near: Vector<R>,
            ) -> (Vector<R>, Vector<R>) {
                match self { $(Self::$shape => $shape::project_onto(parameters, near),)* }
            }

            /// [`Project::rounding`] of shapes of this kind.
            #[inline(always)]
            pub fn rounding<R: Real>(
                self,
                parameters: &[R; N_PARAMETERS],
                point: Vector<R>,
            ) -> R {
                match self { $(Self::$shape => $shape::rounding(parameters, point),)* }
            }

            /// [`Project::rounding_along`] of shapes of this kind.
            #[inline(always)]
            pub fn rounding_along<R: Real>(
                self,
                parameters: &[R; N_PARAMETERS],
                at: [Vector<R>; 2],
            ) -> R {
                match self { $(Self::$shape => $shape::rounding_along(parameters, at),)* }
            }

            /// [`Sampled::area`] of a shape of this kind.
            #[inline(always)]
            pub fn area<R: Real>(self, parameters: &[R; N_PARAMETERS]) -> R {
                match self { $(Self::$shape => $shape::area(parameters),)* }
            }

            /// [`Sampled::sample`] of shapes of this kind.
            #[inline(always)]
            pub fn sample<R: Real>(
                self,
                parameters: &[R; N_PARAMETERS],
                from: Vector<R>,
                numbers: [R; 2],
            ) -> SurfaceSample<R> {
                match self { $(Self::$shape => $shape::sample(parameters, from, numbers),)* }
            }

            /// [`Sampled::density`] of shapes of this kind.
            #[inline(always)]
            pub fn density<R: Real>(
                self,
                parameters: &[R; N_PARAMETERS],
                from: Vector<R>,
                seen: &Seen<R>,
            ) -> R {
                match self { $(Self::$shape => $shape::density(parameters, from, seen),)* }
            }
        }

        impl Shape {
            /// Returns the kind.
            #[inline(always)]
            pub fn kind(&self) -> ShapeKind {
                match self { $(Self::$shape(_) => ShapeKind::$shape,)* }
            }

            /// Returns the parameters that define the shape, padded with zeros.
            #[inline(always)]
            pub fn parameters(&self) -> [f32; N_PARAMETERS] {
                match self { $(Self::$shape(shape) => shape.parameters(),)* }
            }

            /// Returns the point of the surface nearest to `near`, which lies on it up to rounding
            /// errors, and the outward unit normal there.
            pub fn project(&self, near: Vec3) -> (Vec3, Vec3) {
                match self { $(Self::$shape(shape) => shape.project(near),)* }
            }
        }

        impl Intersectable for Shape {
            #[inline]
            fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
                match self { $(Self::$shape(shape) => shape.intersect(ray, t_max),)* }
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
    };
}

shapes! {
    /// A sphere.
    "sphere" => sphere::Sphere,
    /// An infinite plane.
    "plane" => plane::Plane,
    /// A flat disk.
    "disk" => disk::Disk,
    /// A triangle.
    "triangle" => triangle::Triangle,
    /// An axis-aligned box.
    "box" => cuboid::Cuboid,
    /// A rectangle.
    "rectangle" => rectangle::Rectangle,
    /// A cylinder.
    "cylinder" => cylinder::Cylinder,
    /// A cone, possibly truncated.
    "cone" => cone::Cone,
    /// A capsule.
    "capsule" => capsule::Capsule,
}
