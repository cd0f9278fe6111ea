//! The shading of a wave of surface points, in lanes.

use super::add_light::{AddAmbient, AddLight, Eyes};
use super::arriving_light::{ArrivingLight, SampleLights, SampledLight};
use super::bsdf::{Bsdf, by_kind};
use super::cast_shadows::{CastShadows, ShadowWave};
use super::emission::AddEmission;
use super::end_paths::{AddBackground, EndPoints};
use super::model::Model;
use super::models::by_model;
use super::numbers::{SampleIds, WaveNumbers};
use super::paths::PathWave;
use super::scatter::ScatterPaths;
use crate::accel::Hit;
use crate::trace::Points;
use math::sampling::Sampler;
use math::simd::{Simd, VectorColumn};
use world::scene::Scene;

/// The starts of the paths of a wave.
#[derive(Debug, Clone, Copy)]
pub struct PathStarts<'a> {
    /// The origins of the camera rays.
    pub eyes: Eyes<'a>,
    /// The samples; empty in a scene that needs no random numbers.
    pub ids: &'a SampleIds,
}

/// Shades waves of points. For each light in turn, [`cast`](Self::cast) collects the shadow rays of
/// all points, so that rays toward one light are neighbors, and [`add_light`](Self::add_light) adds
/// the light of the unoccluded rays. Finally [`end`](Self::end) adds the points' radiance to their
/// paths.
#[derive(Debug)]
pub struct WaveShader<'a> {
    pub(super) scene: &'a Scene,
    pub(super) sampler: Sampler,
    simd: Simd,
    /// The shadow rays toward the current light.
    pub shadows: ShadowWave,
    /// The light of the shadow rays, by point.
    arriving: ArrivingLight,
    /// The radiance of each point.
    radiance: VectorColumn,
    /// The share of the current light that reaches each point.
    reached: Vec<f32>,
    /// 1 for each point that some light reaches, else 0.
    lit: Vec<u8>,
    /// Used only in scenes that split paths.
    split: SplitPaths,
}

/// Buffers for paths that may be split.
#[derive(Debug, Default)]
struct SplitPaths {
    /// The light that each ray adds to its path.
    added: VectorColumn,
    /// The rays that continue the paths, in the order of the points.
    unsorted: PathWave,
    order: Vec<Option<u32>>,
}

impl<'a> WaveShader<'a> {
    /// Creates a shader for the points of a scene, with an instruction set.
    pub(super) fn new(scene: &'a Scene, sampler: Sampler, simd: Simd) -> Self {
        Self {
            scene,
            sampler,
            simd,
            shadows: ShadowWave::default(),
            arriving: ArrivingLight::default(),
            radiance: VectorColumn::default(),
            reached: Vec::new(),
            lit: Vec::new(),
            split: SplitPaths::default(),
        }
    }

    /// Returns true if rays need more than an origin and a direction.
    pub fn has_branches(&self) -> bool {
        self.scene.has_branches()
    }

    /// Returns true if textures need the lengths of paths.
    pub fn measures_paths(&self) -> bool {
        self.scene.has_images
    }

    /// Returns true if [`PathStarts::ids`] are needed.
    pub fn is_random(&self) -> bool {
        self.scene.is_random()
    }

    /// Returns true if shadow rays decide which lights reach a point.
    pub fn casts_shadows(&self) -> bool {
        self.scene.shading.shadows
    }

    /// Returns the number of light samples at the points of a wave after this number of bounces.
    pub fn n_light_samples(&self, depth: u32) -> usize {
        let max_depth = self.scene.shading.max_depth.into();
        let lights = &self.scene.lights;
        by_model!(self.scene, |model| model
            .n_light_samples(lights, depth, max_depth))
    }

    /// Starts a wave of these points.
    pub fn begin(&mut self, wave: &PathWave, points: &Points) {
        self.radiance.grow(points.end());
        self.lit.clear();
        self.lit.resize(points.end(), 0);
        // The light without shadow rays: ambient, then emitted.
        by_model!(self.scene, |model| self.simd.run(AddAmbient {
            model,
            scene: self.scene,
            points,
            radiance: &mut self.radiance,
        }));
        self.simd.run(AddEmission {
            scene: self.scene,
            wave,
            points,
            radiance: &mut self.radiance,
        });
    }

    /// Collects the shadow rays of all points for light sample `sample`.
    pub fn cast(&mut self, sample: usize, starts: PathStarts, wave: &PathWave, points: &Points) {
        self.shadows.clear();
        // Sample a light that is not plain, once for all points.
        if self.scene.lights.plain(sample).is_none() {
            self.arriving.grow(points.end());
            self.simd.run(SampleLights {
                scene: self.scene,
                sample,
                numbers: self.numbers(starts),
                wave,
                points,
                arriving: &mut self.arriving,
            });
        }
        // Cast a shadow ray from each point that it may reach.
        let light = SampledLight::new(&self.scene.lights, sample, &self.arriving);
        by_model!(self.scene, |model| self.simd.run(CastShadows {
            model,
            scene: self.scene,
            light,
            wave,
            points,
            shadows: &mut self.shadows,
        }));
    }

    fn numbers<'b>(&self, starts: PathStarts<'b>) -> WaveNumbers<'b> {
        WaveNumbers {
            sampler: self.sampler,
            ids: starts.ids,
        }
    }

    /// Adds the light of light sample `sample`, whose shadow rays were collected; of each, this share
    /// arrives.
    pub fn add_light(
        &mut self,
        sample: usize,
        starts: PathStarts,
        wave: &PathWave,
        points: &Points,
        shares: &[f32],
    ) {
        // Find the points that some light reaches.
        self.reached.clear();
        self.reached.resize(self.lit.len(), 0.0);
        for (&point, share) in self.shadows.points().iter().zip(shares) {
            self.reached[point as usize] = *share;
        }
        for (lit, reached) in self.lit.iter_mut().zip(&self.reached) {
            *lit |= u8::from(*reached > 0.0);
        }
        // Add the light that they reflect.
        let light = SampledLight::new(&self.scene.lights, sample, &self.arriving);
        by_model!(self.scene, |model| self.simd.run(AddLight {
            model,
            scene: self.scene,
            light,
            eyes: starts.eyes,
            wave,
            points,
            reached: &self.reached,
            radiance: &mut self.radiance,
        }));
    }

    /// Weakens the light of rays by the media and the fog on the way to their hits.
    pub fn weaken(&self, wave: &mut PathWave, hits: &[Option<Hit>]) {
        if self.scene.has_media() {
            wave.weaken(hits, &self.scene.materials);
        }
        if let Some(fog) = self.scene.fading_fog() {
            wave.fade(hits, fog);
        }
    }

    /// Adds the background seen by the rays without a point to `colors`, by slot; called before
    /// [`end`](Self::end).
    pub fn add_background(&mut self, wave: &PathWave, points: &Points, colors: &mut VectorColumn) {
        let colors = if self.scene.splits_paths() {
            self.split.added.reset(wave.rays.len());
            &mut self.split.added
        } else {
            colors
        };
        self.simd.run(AddBackground {
            scene: self.scene,
            missed: points.missed(),
            wave,
            colors,
        });
    }

    /// Adds the radiance of the points to `colors`, by slot. Overwrites `next` with the rays that
    /// continue the paths.
    pub fn end(
        &mut self,
        starts: PathStarts,
        wave: &PathWave,
        points: &Points,
        next: &mut PathWave,
        colors: &mut VectorColumn,
    ) {
        if !self.scene.splits_paths() {
            next.restart(wave.depth + 1);
            return self.end_paths(starts, wave, points, next, colors);
        }
        // Several rays of a path add to its color: in an order that depends only on the path, not
        // on the other paths of the wave.
        let mut split = std::mem::take(&mut self.split);
        split.unsorted.restart(wave.depth + 1);
        self.end_paths(starts, wave, points, &mut split.unsorted, &mut split.added);
        for (ray, &slot) in wave.slots().iter().enumerate() {
            colors.add(slot as usize, split.added.get(ray));
        }
        let n_before = wave.rays.len();
        split.unsorted.sort_into(next, n_before, &mut split.order);
        self.split = split;
    }

    fn end_paths(
        &self,
        starts: PathStarts,
        wave: &PathWave,
        points: &Points,
        next: &mut PathWave,
        colors: &mut VectorColumn,
    ) {
        by_model!(self.scene, |model| self.simd.run(EndPoints {
            model,
            scene: self.scene,
            points,
            radiance: &self.radiance,
            lit: &self.lit,
            wave,
            next,
            colors,
        }));
        if self.scene.scatters_paths() {
            self.scatter(starts, wave, points, next);
        }
    }

    /// Collects the scattered rays of points.
    fn scatter(&self, starts: PathStarts, wave: &PathWave, points: &Points, next: &mut PathWave) {
        if wave.depth >= u32::from(self.scene.shading.max_depth) {
            return;
        }
        for &group in points.groups() {
            let material = self.scene.material(group.material);
            if !material.scatters() {
                continue;
            }
            by_kind!(Bsdf::new(material), |scatter| self.simd.run(ScatterPaths {
                scene: self.scene,
                scatter,
                group,
                numbers: self.numbers(starts),
                points,
                wave,
                next,
            }));
        }
    }
}
