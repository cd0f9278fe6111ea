//! The media that a ray is in.

use std::num::NonZeroU32;

use glam::Vec3;

use math::simd::{N_LANES, set_lane};
use world::material::{Dielectric, Material};
use world::scene::MaterialId;

/// Greatest number of media that may overlap at a point; a ray does not enter further ones.
const MAX_MEDIA: usize = 4;

/// The media that a ray is in, in the order in which it entered them, followed by empty places;
/// empty in a vacuum. Where media overlap, one of them is effective.
///
/// Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced Images", Journal of Graphics Tools
/// 7(2), 2002.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Media([Option<MediumId>; MAX_MEDIA]);

/// A medium by its material: the material's index plus one, so that an empty place takes no room.
#[derive(Debug, Clone, Copy, PartialEq)]
struct MediumId(NonZeroU32);

impl MediumId {
    fn new(material: MaterialId) -> Self {
        Self(NonZeroU32::MIN.saturating_add(material.0))
    }

    fn material(self) -> MaterialId {
        MaterialId(self.0.get() - 1)
    }
}

/// The surface of a medium, met by a ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interface {
    /// Ratio of the indices of refraction, before the surface over behind it.
    pub(super) eta: f32,
    /// True if the effective medium changes; otherwise the ray goes straight on.
    pub(super) is_visible: bool,
    /// The media behind the surface.
    pub(super) behind: Media,
}

impl Media {
    /// Returns true if the ray is in no medium.
    #[inline(always)]
    pub(super) fn is_none(self) -> bool {
        self.0[0].is_none()
    }

    /// Returns the materials of the media plus 1, and 0 for each empty place.
    pub(super) fn words(self) -> [u32; MAX_MEDIA] {
        self.0
            .map(|medium| medium.map_or(0, |medium| medium.0.get()))
    }

    /// Returns the number of media.
    pub(super) fn n(self) -> usize {
        self.0.iter().flatten().count()
    }

    /// Returns the surface of this material, which the ray enters or leaves. A ray that leaves a
    /// medium without having entered it started inside.
    pub(super) fn cross(self, material: MaterialId, enters: bool, all: &[Material]) -> Interface {
        // List the media on both sides.
        let [outside, inside] = if enters {
            [self, self.with(material)]
        } else if let Some(entered) = self.place_of(material) {
            [self.without(entered), self]
        } else {
            [self, self.with(material)]
        };
        // Order them along the ray.
        let [before, behind] = if enters {
            [outside, inside]
        } else {
            [inside, outside]
        };
        // Compare the effective media.
        let [from, to] = [before, behind].map(|media| media.counting(all));
        let index = |medium: Option<(MaterialId, &Dielectric)>| medium.map_or(1.0, |of| of.1.index);
        Interface {
            eta: index(from) / index(to),
            is_visible: from.map(|of| of.0) != to.map(|of| of.0),
            behind,
        }
    }

    /// Returns the fraction of the light of each channel that arrives from a distance, greater than
    /// 0, which may be infinite.
    #[inline]
    pub(super) fn transmittance(self, distance: f32, all: &[Material]) -> Vec3 {
        let Some((_, medium)) = self.counting(all) else {
            return Vec3::ONE;
        };
        let transmittance = |absorption: f32| match absorption {
            0.0 => 1.0,
            _ => libm::expf(-absorption * distance),
        };
        let [r, g, b] = medium.absorption.to_array().map(transmittance);
        Vec3::new(r, g, b)
    }

    /// Returns the index of refraction of the effective medium.
    #[inline]
    pub(super) fn index(self, all: &[Material]) -> f32 {
        self.counting(all).map_or(1.0, |(_, medium)| medium.index)
    }

    /// Returns the effective medium: the last one entered among the highest priority.
    #[inline(always)]
    fn counting(self, all: &[Material]) -> Option<(MaterialId, &Dielectric)> {
        let [first, second, ..] = self.0;
        // Most rays are in no medium, or in one.
        let mut counting = dielectric(first?, all);
        if second.is_some() {
            for other in self.0[1..].iter().map_while(|medium| *medium) {
                let other = dielectric(other, all);
                if other.1.priority >= counting.1.priority {
                    counting = other;
                }
            }
        }
        Some(counting)
    }

    fn with(mut self, material: MaterialId) -> Self {
        if let Some(free) = self.0.iter_mut().find(|medium| medium.is_none()) {
            *free = Some(MediumId::new(material));
        }
        self
    }

    /// Returns the place of the medium of this material that was entered last.
    fn place_of(self, material: MaterialId) -> Option<usize> {
        let medium = Some(MediumId::new(material));
        self.0.iter().rposition(|entered| *entered == medium)
    }

    /// Removes the medium at a place.
    fn without(mut self, place: usize) -> Self {
        self.0[place..].rotate_left(1);
        self.0[MAX_MEDIA - 1] = None;
        self
    }
}

/// Returns the material of a medium, and its dielectric.
#[inline(always)]
fn dielectric(medium: MediumId, all: &[Material]) -> (MaterialId, &Dielectric) {
    let material = medium.material();
    let dielectric = all[material.0 as usize].kind.medium();
    (material, dielectric.expect("media have dielectrics"))
}

/// Returns the fractions of light that media let pass over these distances: one column per channel.
pub(super) fn transmittances(
    media: &[Media; N_LANES],
    distances: &[f32; N_LANES],
    all: &[Material],
) -> [[f32; N_LANES]; 3] {
    let mut columns = [[1.0; N_LANES]; 3];
    for (lane, (media, &distance)) in media.iter().zip(distances).enumerate() {
        set_lane(&mut columns, lane, media.transmittance(distance, all));
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::yaml;

    const GLASS: MaterialId = MaterialId(0);
    const WATER: MaterialId = MaterialId(1);
    const ICE: MaterialId = MaterialId(2);

    /// Returns materials where glass is effective when it overlaps water.
    fn materials() -> Vec<Material> {
        let texts = [
            "{ dielectric: { index: 1.5, priority: 2 } }",
            "{ dielectric: { index: 1.25, absorption: [0, 0.5, 2] } }",
            "{ dielectric: { index: 2 } }",
        ];
        texts.map(|text| yaml::from_str(text).unwrap()).into()
    }

    /// Crosses surfaces, each entered or left. Returns the visible ones with their eta.
    fn crossed(surfaces: &[(MaterialId, bool)]) -> (Vec<(usize, f32)>, Media) {
        let materials = materials();
        let (mut media, mut visible) = (Media::default(), Vec::new());
        for (i, &(material, enters)) in surfaces.iter().enumerate() {
            let interface = media.cross(material, enters, &materials);
            media = interface.behind;
            if interface.is_visible {
                visible.push((i, interface.eta));
            }
        }
        (visible, media)
    }

    #[test]
    fn ice_in_water_is_met_between_them() {
        let (visible, media) = crossed(&[(WATER, true), (ICE, true), (ICE, false), (WATER, false)]);
        assert_eq!(visible, [(0, 0.8), (1, 0.625), (2, 1.6), (3, 1.25)]);
        assert_eq!(media, Media::default());
    }

    #[test]
    fn overlapping_media_meet_where_the_higher_priority_ends() {
        // Water that reaches into the wall of its glass.
        let path = [(GLASS, true), (WATER, true), (GLASS, false), (WATER, false)];
        let (visible, media) = crossed(&path);
        assert_eq!(visible, [(0, 1.0 / 1.5), (2, 1.2), (3, 1.25)]);
        assert_eq!(media, Media::default());
        let back = [(WATER, true), (GLASS, true), (WATER, false), (GLASS, false)];
        let (visible, _) = crossed(&back);
        assert_eq!(visible, [(0, 0.8), (1, 1.25 / 1.5), (3, 1.5)]);
    }

    #[test]
    fn a_ray_may_start_inside_and_enter_more_than_it_remembers() {
        assert_eq!(
            crossed(&[(GLASS, false)]),
            (vec![(0, 1.5)], Media::default())
        );
        let many = [(WATER, true); MAX_MEDIA + 2];
        let (visible, mut media) = crossed(&many);
        assert_eq!(visible, [(0, 0.8)]);
        for _ in 0..MAX_MEDIA {
            media = media.cross(WATER, false, &materials()).behind;
        }
        assert_eq!(media, Media::default());
    }

    #[test]
    fn light_fades_exponentially() {
        let (_, media) = crossed(&[(WATER, true)]);
        let found = media.transmittance(3.0, &materials());
        let expected = Vec3::new(1.0, (-1.5_f32).exp(), (-6.0_f32).exp());
        assert!((found - expected).abs().max_element() < 1e-7);
        let far = media.transmittance(f32::INFINITY, &materials());
        assert_eq!(far, Vec3::new(1.0, 0.0, 0.0));
        assert_eq!(Media::default().transmittance(3.0, &[]), Vec3::ONE);
    }
}
