//! Cylinders with flat ends.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::axis::EndKeys;
use super::located::{Described, Located};
use super::sampled::{Sampled, Seen, SurfaceSample};
use super::{Aabb, Cone, Intersectable, N_PARAMETERS, Patch, Project, Ray, Transform};
use crate::values;
use math::simd::{Real, Vector};

/// The closed surface of a cylinder between two ends, with a flat disk at each: a
/// [`Cone`] with one radius.
///
/// ```
/// # use raycost_world::geometry::{Located, Cylinder};
/// let pillar: Located<Cylinder> = scene::yaml::from_str("
/// { ends: [[0, 0, 2], [0, 3, 2]], radius: 0.2 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder(Cone);

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CylinderKeys {
    /// The centers of the two ends, which differ.
    ends: EndKeys,
    /// The radius.
    #[serde(with = "values::Positive")]
    radius: f32,
}

impl Described for Cylinder {
    type Keys = CylinderKeys;

    fn from_keys(
        CylinderKeys { ends, radius }: CylinderKeys,
    ) -> Result<Located<Self>, &'static str> {
        Ok(ends.ends.map(|ends| Self::new(ends.0, radius)))
    }
}

impl Cylinder {
    /// Creates the cylinder between two points, which must differ.
    pub fn new(ends: [Vec3; 2], radius: f32) -> Self {
        Self(Cone::new(ends, [radius; 2]))
    }
}

impl Intersectable for Cylinder {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.0.intersect(ray, t_max)
    }

    fn bounds(&self) -> Aabb {
        self.0.bounds()
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        self.0.transformed(transform).map(Self)
    }

    fn patch(&self) -> Option<Patch> {
        self.0.patch()
    }
}

impl Project for Cylinder {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        self.0.parameters()
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        Cone::project_onto(parameters, near)
    }
}

impl Sampled for Cylinder {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        Cone::area(parameters)
    }

    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        numbers: [R; 2],
    ) -> SurfaceSample<R> {
        Cone::sample(parameters, from, numbers)
    }

    #[inline(always)]
    fn density<R: Real>(parameters: &[R; N_PARAMETERS], from: Vector<R>, seen: &Seen<R>) -> R {
        Cone::density(parameters, from, seen)
    }
}
