//! The kinds of materials.

use super::{Conductor, Dielectric, Principled};
use crate::fog::HenyeyGreenstein;

/// The way in which a material scatters light, besides its diffuse light and its highlight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaterialKind {
    /// An opaque surface.
    Opaque {
        /// Fraction of the mirrored ray's light, 0 to 1.
        reflection: f32,
    },
    /// The surface of a clear medium: it reflects and refracts light by Fresnel's equations.
    Dielectric {
        /// The medium inside.
        medium: Dielectric,
        /// The roughness, 0 to 1.
        roughness: f32,
    },
    /// A metal: it reflects light by Fresnel's equations.
    Conductor {
        /// The metal.
        metal: Conductor,
        /// The roughness, 0 to 1.
        roughness: f32,
    },
    /// A principled surface.
    Principled {
        /// Its settings.
        surface: Principled,
        /// The medium inside, if the surface transmits light.
        medium: Option<Dielectric>,
    },
    /// The particles of fog, with their phase function.
    Particles(HenyeyGreenstein),
}

impl MaterialKind {
    /// An opaque surface that does not mirror.
    pub const MATTE: Self = Self::Opaque { reflection: 0.0 };

    /// Returns the medium behind the surface, if light enters it.
    #[inline(always)]
    pub fn medium(&self) -> Option<&Dielectric> {
        match self {
            Self::Dielectric { medium, .. } => Some(medium),
            Self::Principled { medium, .. } => medium.as_ref(),
            Self::Opaque { .. } | Self::Conductor { .. } | Self::Particles(_) => None,
        }
    }

    /// Returns the medium behind the surface for writing.
    pub(super) fn medium_mut(&mut self) -> Option<&mut Dielectric> {
        match self {
            Self::Dielectric { medium, .. } => Some(medium),
            Self::Principled { medium, .. } => medium.as_mut(),
            Self::Opaque { .. } | Self::Conductor { .. } | Self::Particles(_) => None,
        }
    }

    /// Returns true if it mirrors.
    #[inline]
    pub fn mirrors(&self) -> bool {
        match *self {
            Self::Opaque { reflection } => reflection > 0.0,
            Self::Conductor { .. } => true,
            Self::Dielectric { .. } | Self::Principled { .. } | Self::Particles(_) => false,
        }
    }

    /// Returns the roughness of a medium or a metal; 0 for other kinds.
    pub fn roughness(&self) -> f32 {
        match *self {
            Self::Dielectric { roughness, .. } | Self::Conductor { roughness, .. } => roughness,
            Self::Opaque { .. } | Self::Principled { .. } | Self::Particles(_) => 0.0,
        }
    }
}

impl From<Principled> for MaterialKind {
    fn from(surface: Principled) -> Self {
        Self::Principled {
            medium: surface.medium(),
            surface,
        }
    }
}
