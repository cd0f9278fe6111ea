//! The light of one light sample at the points of a wave, in lanes.

use super::interfaces::Interfaces;
use super::media::{Media, transmittances};
use super::models::lit_groups;
use super::numbers::WaveNumbers;
use super::paths::PathWave;
use crate::trace::{PointLanes, Points};
use math::simd::{
    InstructionSet, Lanes, Mask, N_LANES, SimdKernel, Vector, VectorColumn, grow, lanes, lanes_mut,
};
use world::light::{Illumination, Light};
use world::scene::{Lights, MaterialId, Scene};

/// The light that arrives at points unless it is occluded.
#[derive(Debug, Default)]
pub(super) struct ArrivingLight {
    direction: VectorColumn,
    distance: Vec<f32>,
    radiance: VectorColumn,
    density: Vec<f32>,
}

impl ArrivingLight {
    /// Makes room for this number of points.
    pub(super) fn grow(&mut self, n_points: usize) {
        self.direction.grow(n_points);
        self.radiance.grow(n_points);
        grow(&mut self.distance, n_points);
        grow(&mut self.density, n_points);
    }

    #[inline(always)]
    fn store<L: Lanes>(&mut self, first: usize, light: &Illumination<L>) {
        self.direction.store(first, light.direction);
        *lanes_mut(&mut self.distance, first) = light.distance.to_array();
        self.radiance.store(first, light.radiance);
        *lanes_mut(&mut self.density, first) = light.density.to_array();
    }

    /// Returns the light at eight points.
    #[inline(always)]
    fn load<I: InstructionSet>(&self, set: I, first: usize) -> Illumination<I::Lanes> {
        Illumination {
            direction: self.direction.load(set, first),
            distance: set.load(lanes(&self.distance, first)),
            radiance: self.radiance.load(set, first),
            density: set.load(lanes(&self.density, first)),
        }
    }
}

/// The light of one light sample.
#[derive(Clone, Copy)]
pub(super) enum SampledLight<'a> {
    /// The light of a [plain](world::scene::Lights::plain) light, computed where it is needed.
    Plain(&'a Light),
    /// The light that was stored for each point.
    Stored(&'a ArrivingLight),
}

impl<'a> SampledLight<'a> {
    /// Returns the light of sample `sample`; `arriving` holds it for a light that is not plain.
    pub(super) fn new(lights: &'a Lights, sample: usize, arriving: &'a ArrivingLight) -> Self {
        match lights.plain(sample) {
            Some(light) => Self::Plain(light),
            None => Self::Stored(arriving),
        }
    }

    /// Returns the light at eight points with these positions.
    #[inline(always)]
    pub(super) fn at<I: InstructionSet>(
        self,
        set: I,
        first: usize,
        position: Vector<I::Lanes>,
    ) -> Illumination<I::Lanes> {
        match self {
            Self::Plain(light) => light.illuminate(position),
            Self::Stored(arriving) => arriving.load(set, first),
        }
    }
}

/// Computes the light of a sample at all points that it may light.
pub(super) struct SampleLights<'a> {
    pub(super) scene: &'a Scene,
    /// Number of the light sample.
    pub(super) sample: usize,
    pub(super) numbers: WaveNumbers<'a>,
    pub(super) wave: &'a PathWave,
    pub(super) points: &'a Points,
    pub(super) arriving: &'a mut ArrivingLight,
}

impl SimdKernel for SampleLights<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let lights = &self.scene.lights;
        let lit = lit_groups(self.scene, self.points);
        for (group, at) in lit.flat_map(|group| group.lanes().map(move |at| (group, at))) {
            // Sample a light by the random numbers of each point.
            let point = self.points.shading(set, at);
            let numbers = self
                .numbers
                .point_numbers(set, self.wave, self.points.rays(at));
            let numbers = numbers.light(lights, self.sample);
            let (mut light, _) = lights.illuminate(self.sample, &point.lit(), &numbers);
            // Weaken it by the media on the way.
            if self.scene.weakens_lights() {
                let is_behind = point.is_backed_by(light.direction).bits();
                let media = self.media_of_lights(group.material, at, point.side.signs(), is_behind);
                let distances = light.distance.to_array();
                let left = transmittances(&media, &distances, &self.scene.materials);
                light.radiance = light.radiance.times(set.load_vector(&left));
            }
            self.arriving.store(at.first, &light);
        }
    }
}

impl SampleLights<'_> {
    /// Returns the media between eight points of a material and their lights; `flipped` marks
    /// points that rays met from inside, `behind` marks points whose light is behind the surface.
    #[inline(always)]
    fn media_of_lights(
        &self,
        material: MaterialId,
        at: PointLanes,
        flipped: u8,
        behind: u8,
    ) -> [Media; N_LANES] {
        let rays = self.points.rays(at);
        let mut media = self.wave.media(rays);
        if behind != 0 && self.scene.material(material).kind.medium().is_some() {
            let met = Interfaces::met(self.scene, self.wave, material, rays, flipped);
            for (lane, (media, of_other_side)) in media.iter_mut().zip(met.behind).enumerate() {
                if behind >> lane & 1 != 0 {
                    *media = of_other_side;
                }
            }
        }
        media
    }
}
