//! The surfaces of media that the rays of a wave meet.

use super::bsdf::Boundary;
use super::media::Media;
use super::paths::PathWave;
use math::simd::{InstructionSet, N_LANES};
use world::scene::{MaterialId, Scene};

/// The surfaces of a medium that eight rays met.
pub(super) struct Interfaces {
    /// Ratios of the indices of refraction, before the surface over behind it.
    pub(super) eta: [f32; N_LANES],
    /// The lanes where the effective medium changes.
    pub(super) visible: u8,
    /// The media behind the surfaces.
    pub(super) behind: [Media; N_LANES],
}

impl Interfaces {
    /// Returns the surfaces of a material that rays of a wave met; `flipped` marks surfaces met
    /// from inside.
    #[inline(always)]
    pub(super) fn met(
        scene: &Scene,
        wave: &PathWave,
        material: MaterialId,
        rays: &[u32; N_LANES],
        flipped: u8,
    ) -> Self {
        let mut interfaces = Self {
            eta: [1.0; N_LANES],
            visible: 0,
            behind: [Media::default(); N_LANES],
        };
        for (lane, &ray) in rays.iter().enumerate() {
            let media = wave.branches[ray as usize].media;
            let enters = flipped >> lane & 1 == 0;
            let interface = media.cross(material, enters, &scene.materials);
            interfaces.eta[lane] = interface.eta;
            interfaces.visible |= u8::from(interface.is_visible) << lane;
            interfaces.behind[lane] = interface.behind;
        }
        interfaces
    }

    /// Returns the boundaries that scattering needs.
    #[inline(always)]
    pub(super) fn boundary<I: InstructionSet>(&self, set: I) -> Boundary<I::Lanes> {
        Boundary {
            eta: set.load(&self.eta),
            is_visible: set.mask(self.visible),
        }
    }
}
