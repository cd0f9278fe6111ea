//! Classes of surfaces whose points are computed and shaded in the same way.

use super::attributes::AttributeKind;
use super::primitive::{MaterialId, Primitive};
use crate::geometry::ShapeKind;

/// The class by which a point of a primitive is computed and shaded: the kind of the shape, the
/// attributes and the material, in a single number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfaceClass(u32);

/// Number of kinds of shapes, plus one for shapes under a transform.
const N_SHAPES: u32 = ShapeKind::ALL.len() as u32 + 1;
const N_ATTRIBUTES: u32 = AttributeKind::COUNT;

impl SurfaceClass {
    /// Creates the class of a primitive with these attributes.
    #[inline]
    pub(super) fn new(primitive: &Primitive, attributes: AttributeKind) -> Self {
        let shape = primitive.kind().map_or(0, |kind| kind as u32 + 1);
        let material = primitive.material.0;
        Self((material * N_ATTRIBUTES + attributes.number()) * N_SHAPES + shape)
    }

    /// Creates the class of particles of a material, without shape and attributes.
    pub(super) fn particles(material: MaterialId) -> Self {
        Self(material.0 * N_ATTRIBUTES * N_SHAPES)
    }

    /// Returns the number: small for scenes with few materials.
    #[inline(always)]
    pub fn number(self) -> usize {
        self.0 as usize
    }

    /// Returns the kind of the shape; `None` for shapes under a transform.
    #[inline]
    pub fn shape(self) -> Option<ShapeKind> {
        let shape = (self.0 % N_SHAPES) as usize;
        shape.checked_sub(1).map(|kind| ShapeKind::ALL[kind])
    }

    /// Returns the kind of the attributes.
    #[inline]
    pub fn attributes(self) -> AttributeKind {
        AttributeKind::from_number(self.0 / N_SHAPES % N_ATTRIBUTES)
    }

    /// Returns the material.
    #[inline]
    pub fn material(self) -> MaterialId {
        MaterialId(self.0 / N_SHAPES / N_ATTRIBUTES)
    }
}
