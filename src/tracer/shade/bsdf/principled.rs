//! The principled material: a mixture of a metal, a coated diffuse surface and a clear medium.
//!
//! After Burley, "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering",
//! SIGGRAPH 2015, with fewer parameters. The reflectance of facets is Schlick's approximation. The
//! coat passes all light that it does not reflect to the diffuse surface, so no light is lost or
//! gained.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::medium::Medium;
use super::{Boundary, Leaving, Scattered, Scattering, Scatters, gain};
use math::optics::{Ggx, schlick};
use math::sampling::hemisphere;
use math::simd::{Real, Vector};
use world::material::{Principled, RoughSurface};

/// The principled BSDF; see the module's documentation.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct PrincipledBsdf<'a> {
    rough: &'a RoughSurface,
    /// The coat's reflectance along the normal.
    coat_reflectance: f32,
    /// The share of metal and the roughness, before the factors of textures.
    metallic: f32,
    roughness: f32,
    /// The share of the rest that lets light through.
    transmission: f32,
    /// The share of the clear medium at a surface without textures.
    clear: f32,
    medium: Medium<'a>,
}

/// The light that a viewer sees of the metal and of the coat.
struct Reflectances<R> {
    /// The factors of the light that comes from the first facet, for the metal and for the coat.
    gains: [Vector<R>; 2],
    /// The share of the light that the coat reflects.
    of_coat: R,
}

impl<'a> PrincipledBsdf<'a> {
    pub(super) fn new(keys: &Principled, rough: &'a RoughSurface) -> Self {
        let Principled {
            metallic,
            roughness,
            transmission,
            index,
        } = *keys;
        Self {
            rough,
            coat_reflectance: ((index - 1.0) / (index + 1.0)).powi(2),
            metallic,
            roughness,
            transmission,
            clear: (1.0 - metallic) * transmission,
            medium: Medium::new(Some(rough)),
        }
    }

    /// Returns the roughness at a point.
    #[inline(always)]
    fn roughness<R: Real>(&self, at: &Leaving<R>) -> R {
        let factor = at.point.factors.roughness;
        factor * factor.splat(self.roughness)
    }

    /// Returns the facets at a point.
    #[inline(always)]
    fn facets<R: Real>(&self, at: &Leaving<R>) -> Ggx<R> {
        let roughness = self.roughness(at);
        Ggx::never_smooth(roughness, self.rough.facets(roughness).masking)
    }

    /// Returns the shares of the metal and of the coated surface at a point; the rest belongs to
    /// the medium.
    #[inline(always)]
    fn shares<R: Real>(&self, at: &Leaving<R>) -> [R; 2] {
        let factor = at.point.factors.metallic;
        let one = factor.splat(1.0);
        let metal = factor * one.splat(self.metallic);
        [metal, (one - metal) * one.splat(1.0 - self.transmission)]
    }

    #[inline(always)]
    fn reflectances<R: Real>(&self, at: &Leaving<R>) -> Reflectances<R> {
        let one = at.point.side.splat(1.0);
        // The coat's reflectance along the normal, and the albedo of white facets.
        let of_normal = one.splat(self.coat_reflectance);
        let cos = at.cos_of_viewer();
        let [all, fifth_power] = match (&self.rough.of_mirror, self.rough.by_roughness) {
            (_, Some(table)) => R::look_up(table, [cos, self.roughness(at)]),
            (Some(albedo), None) => albedo.at(cos),
            (None, None) => [one, one.splat(0.0)],
        };
        // The light from facet to facet, and the share that the coat reflects.
        let of_coat = gain(all, Vector::splat(one, Vec3::splat(self.coat_reflectance)));
        let once = of_normal * (all - fifth_power) + fifth_power;
        Reflectances {
            gains: [gain(all, at.point.color), of_coat],
            of_coat: (once * of_coat.x).min(one),
        }
    }

    /// Returns the probabilities of facets and of the diffuse surface; the rest belongs to the
    /// medium.
    #[inline(always)]
    fn choice<R: Real>(&self, at: &Leaving<R>, of_coat: R) -> [R; 2] {
        let [metal, coated] = self.shares(at);
        let one = of_coat.splat(1.0);
        [metal + coated * of_coat, coated * (one - of_coat)]
    }
}

impl Scatters for PrincipledBsdf<'_> {
    fn is_lit(&self) -> bool {
        true
    }

    fn is_lit_from_all_sides(&self) -> bool {
        self.clear > 0.0
    }

    #[inline(always)]
    fn evaluate<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        to_light: Vector<R>,
    ) -> Scattering<R> {
        let (zero, one) = (to_light.x.splat(0.0), to_light.x.splat(1.0));
        // Find the shares of the parts.
        let Reflectances { gains, of_coat } = self.reflectances(at);
        let [of_facets, of_diffuse] = self.choice(at, of_coat);
        // The facets of the metal and of the coat, with Schlick's approximation.
        let to_viewer = at.in_surface(at.to_viewer);
        let facets = self.facets(at);
        let facets = facets.reflection(to_viewer, at.in_surface(to_light));
        let grazing = schlick(facets.cos);
        let white = Vector::splat(one, Vec3::ONE);
        let color = at.point.color;
        let coat = one.splat(self.coat_reflectance);
        let [metal, coated] = self.shares(at);
        let of_metal = (color + (white - color) * grazing).times(gains[0]) * metal;
        let reflected_by_coat = gains[1] * ((coat + (one - coat) * grazing) * coated);
        // The diffuse surface below the coat.
        let cos = to_light.dot(at.point.normal).max(zero);
        let below = color * (coated * (one - of_coat) * cos);
        let opaque = Scattering {
            value: (of_metal + reflected_by_coat) * facets.value + below,
            density: of_facets * facets.density + of_diffuse * cos * one.splat(FRAC_1_PI),
        };
        if self.clear == 0.0 {
            return opaque;
        }
        // The clear medium, tinted where light passes through it.
        let clear = one.splat(self.clear);
        let of_medium = self.medium.evaluate(at, boundary, to_light);
        let is_behind = to_light.dot(at.point.normal).lt(zero);
        let opaque = Scattering::select(is_behind, Scattering::none(one), opaque);
        let tint = Vector::select(is_behind, refracted_share(color), white);
        opaque.with(Scattering {
            value: of_medium.value.times(tint) * clear,
            density: of_medium.density * clear,
        })
    }

    #[inline(always)]
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        lobe: R,
    ) -> Scattered<R> {
        let zero = lobe.splat(0.0);
        // Choose a part by its share.
        let Reflectances { of_coat, .. } = self.reflectances(at);
        let [of_facets, _] = self.choice(at, of_coat);
        let clear = zero.splat(self.clear);
        let is_glossy = lobe.lt(clear + of_facets);
        // Sample a direction of the diffuse surface or of the facets.
        let [x, y, z] = hemisphere(numbers);
        let diffuse = at.in_world(Vector { x, y, z });
        let glossy = at.mirrored_by(self.facets(at), numbers);
        let mut direction = Vector::select(is_glossy, glossy, diffuse);
        if self.clear == 0.0 {
            return self.reflected(at, boundary, direction, !is_glossy);
        }
        // Replace the direction in lanes that chose the medium.
        let is_clear = lobe.lt(clear);
        let of_medium = self.medium.sample(at, boundary, numbers, lobe / clear);
        direction = Vector::select(is_clear, of_medium.direction, direction);
        let reflected = self.reflected(at, boundary, direction, !is_glossy);
        let refracted = Scattered {
            factor: of_medium.factor.times(refracted_share(at.point.color)),
            density: of_medium.density * clear,
            ..of_medium
        };
        Scattered::select(is_clear & of_medium.is_refracted, refracted, reflected)
    }
}

impl PrincipledBsdf<'_> {
    /// Returns light from a direction that was chosen by any part.
    #[inline(always)]
    fn reflected<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        direction: Vector<R>,
        is_diffuse: R::Mask,
    ) -> Scattered<R> {
        Scattered {
            is_diffuse,
            ..at.reflected(direction, self.evaluate(at, boundary, direction))
        }
    }
}

/// Returns the share that a surface of this color lets pass of each channel, so that a ray that
/// passes two of them has the color.
#[inline(always)]
fn refracted_share<R: Real>(color: Vector<R>) -> Vector<R> {
    Vector {
        x: color.x.sqrt(),
        y: color.y.sqrt(),
        z: color.z.sqrt(),
    }
}
