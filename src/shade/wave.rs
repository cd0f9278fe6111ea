//! The shading of a wave of surface points, in lanes.

use super::add_light::{AddAmbient, AddLight, Eyes};
use super::cast_shadows::{CastShadows, ShadowWave};
use super::end_paths::{AddBackground, EndPoints};
use super::model::Model;
use super::paths::PathWave;
use super::seed::Seed;
use super::standard::Standard;
use crate::accel::Hit;
use crate::config::ShadingModel;
use crate::scene::Scene;
use crate::simd::{N_LANES, Simd, VectorColumn};
use crate::trace::Points;

/// Shades waves of points. For each light in turn, [`cast`](Self::cast) collects the
/// shadow rays of all points, so that rays toward one light are neighbors, and
/// [`add_light`](Self::add_light) adds the light of those that are not occluded. At
/// last `end` adds the points' radiance to their paths.
#[derive(Debug)]
pub struct WaveShader<'a> {
    scene: &'a Scene,
    simd: Simd,
    /// The shadow rays toward the current light.
    pub shadows: ShadowWave,
    /// The radiance of each point.
    radiance: VectorColumn,
    /// The points that the current light reaches: a bit each, a byte for eight.
    reached: Vec<u8>,
    /// The points that some light reaches.
    lit: Vec<u8>,
    /// Only in scenes with media.
    split: SplitPaths,
}

/// Buffers for paths that may be split.
#[derive(Debug, Default)]
struct SplitPaths {
    /// What each ray adds to its path.
    added: VectorColumn,
    /// The rays that continue the paths, in the order of the points.
    unsorted: PathWave,
    order: Vec<Option<u32>>,
}

impl<'a> WaveShader<'a> {
    /// Shades the points of a scene with an instruction set.
    pub fn new(scene: &'a Scene, simd: Simd) -> Self {
        Self {
            scene,
            simd,
            shadows: ShadowWave::default(),
            radiance: VectorColumn::default(),
            reached: Vec::new(),
            lit: Vec::new(),
            split: SplitPaths::default(),
        }
    }

    /// Whether media may split paths.
    pub fn splits_paths(&self) -> bool {
        self.scene.has_media()
    }

    /// Number of lights.
    pub fn n_lights(&self) -> usize {
        self.scene.lights.len()
    }

    /// Begins a wave of these points.
    pub fn begin(&mut self, points: &Points) {
        self.radiance.grow(points.end());
        self.lit.clear();
        self.lit.resize(points.end() / N_LANES, 0);
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => self.add_ambient(Standard, points),
            ShadingModel::Seed => self.add_ambient(Seed, points),
        }
    }

    fn add_ambient(&mut self, model: impl Model, points: &Points) {
        self.simd.run(AddAmbient {
            model,
            scene: self.scene,
            points,
            radiance: &mut self.radiance,
        });
    }

    /// Collects the shadow rays of all points toward light number `light`.
    pub fn cast(&mut self, light: usize, wave: &PathWave, points: &Points) {
        self.shadows.clear();
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => self.cast_by(Standard, light, wave, points),
            ShadingModel::Seed => self.cast_by(Seed, light, wave, points),
        }
    }

    fn cast_by(&mut self, model: impl Model, light: usize, wave: &PathWave, points: &Points) {
        self.simd.run(CastShadows {
            model,
            scene: self.scene,
            light: &self.scene.lights[light],
            wave,
            points,
            shadows: &mut self.shadows,
        });
    }

    /// Adds the light whose shadow rays were collected, as far as it is not occluded.
    pub fn add_light(
        &mut self,
        light: usize,
        eyes: Eyes,
        wave: &PathWave,
        points: &Points,
        occluded: &[bool],
    ) {
        self.reached.clear();
        self.reached.resize(self.lit.len(), 0);
        for (&point, is_occluded) in self.shadows.points().iter().zip(occluded) {
            let point = point as usize;
            self.reached[point / N_LANES] |= u8::from(!is_occluded) << (point % N_LANES);
        }
        for (lit, reached) in self.lit.iter_mut().zip(&self.reached) {
            *lit |= reached;
        }
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => self.add_light_by(Standard, light, eyes, wave, points),
            ShadingModel::Seed => self.add_light_by(Seed, light, eyes, wave, points),
        }
    }

    fn add_light_by(
        &mut self,
        model: impl Model,
        light: usize,
        eyes: Eyes,
        wave: &PathWave,
        points: &Points,
    ) {
        self.simd.run(AddLight {
            model,
            scene: self.scene,
            light: &self.scene.lights[light],
            eyes,
            wave,
            points,
            reached: &self.reached,
            radiance: &mut self.radiance,
        });
    }

    /// Weakens the light of rays by the media on the way to their hits.
    pub fn weaken(&self, wave: &mut PathWave, hits: &[Option<Hit>]) {
        wave.weaken(hits, &self.scene.materials);
    }

    /// Adds the radiance of the points, and the background that the other rays see,
    /// to `colors`, by slot. Overwrites `next` with the rays that continue the paths.
    pub(crate) fn end(
        &mut self,
        wave: &PathWave,
        points: &Points,
        next: &mut PathWave,
        colors: &mut VectorColumn,
    ) {
        if !self.scene.has_media() {
            next.restart(wave.depth + 1);
            return self.end_paths(wave, points, next, colors);
        }
        // Several rays of a path add to its color: in an order that depends on the path
        // alone, not on the other paths of the wave.
        let mut split = std::mem::take(&mut self.split);
        split.added.reset(wave.rays.len());
        split.unsorted.restart(wave.depth + 1);
        self.end_paths(wave, points, &mut split.unsorted, &mut split.added);
        for (ray, &slot) in wave.slots().iter().enumerate() {
            colors.add(slot as usize, split.added.get(ray));
        }
        let n_before = wave.rays.len();
        split.unsorted.sort_into(next, n_before, &mut split.order);
        self.split = split;
    }

    fn end_paths(
        &self,
        wave: &PathWave,
        points: &Points,
        next: &mut PathWave,
        colors: &mut VectorColumn,
    ) {
        self.simd.run(AddBackground {
            scene: self.scene,
            missed: points.missed(),
            wave,
            colors,
        });
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => self.end_by(Standard, wave, points, next, colors),
            ShadingModel::Seed => self.end_by(Seed, wave, points, next, colors),
        }
    }

    fn end_by(
        &self,
        model: impl Model,
        wave: &PathWave,
        points: &Points,
        next: &mut PathWave,
        colors: &mut VectorColumn,
    ) {
        self.simd.run(EndPoints {
            model,
            scene: self.scene,
            points,
            radiance: &self.radiance,
            lit: &self.lit,
            wave,
            next,
            colors,
        });
    }
}
