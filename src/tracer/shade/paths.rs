//! The paths of a wave.

use std::ops::Range;

use glam::Vec3;

use super::eye_media::EyeMedia;
use super::media::Media;
use crate::accel::Hit;
use crate::cost::RayKind;
use math::simd::{InstructionSet, N_LANES, Vector, VectorColumn, gather, grow, lanes_mut};
use world::fog::FogSphere;
use world::geometry::{Ray, RayStream};
use world::material::Material;

/// Rays of one kind and the paths that they continue, as a structure of arrays. All paths have the
/// same number of bounces.
#[derive(Debug, Default)]
pub struct PathWave {
    /// The rays.
    pub rays: RayStream,
    /// The pixel of each ray, padded to whole lanes.
    pixels: Vec<u32>,
    /// The index of each path's color, padded to whole lanes.
    slots: Vec<u32>,
    /// The share of the radiance met by each ray that reaches the camera.
    pub(super) weights: VectorColumn,
    /// Length of each path before its ray, in a scene with textures; else empty.
    lengths: Vec<f32>,
    /// Data of paths through media and of path tracing; else empty.
    pub(super) branches: Vec<Branch>,
    /// Light that the fog adds along each ray, weighted, in a scene whose fog does not scatter;
    /// else empty.
    gained: VectorColumn,
    /// Number of bounces so far.
    pub depth: u32,
}

/// A ray of a path that may be split, or scattered.
#[derive(Debug, Clone, Copy)]
pub(super) struct Branch {
    /// The media that the ray is in.
    pub(super) media: Media,
    pub(super) kind: RayKind,
    /// The density with which the ray's direction was chosen, per steradian; infinite if there was
    /// no choice.
    pub(super) density: f32,
    /// Place among the rays of the wave: twice the place of the ray that it continues, plus one if
    /// it is refracted.
    place: u32,
}

/// Eight rays that continue rays of a wave, in lanes.
pub(super) struct Continued<'a, L> {
    pub(super) origin: Vector<L>,
    pub(super) direction: Vector<L>,
    /// The share of the light met by each ray that reaches the camera.
    pub(super) weight: Vector<L>,
    /// The rays that they continue.
    pub(super) rays: &'a [u32; N_LANES],
    /// The distances of the points from which they start, along the rays before.
    pub(super) distances: &'a [f32; N_LANES],
    pub(super) kinds: [RayKind; N_LANES],
    /// The densities with which their directions were chosen.
    pub(super) densities: [f32; N_LANES],
    /// The media that refracted rays enter; all other rays stay in their media.
    pub(super) media: Option<&'a [Media; N_LANES]>,
}

impl PathWave {
    /// Removes all rays; the next paths have this number of bounces.
    pub fn restart(&mut self, depth: u32) {
        self.rays.clear();
        self.branches.clear();
        self.lengths.clear();
        self.depth = depth;
    }

    /// Starts adding up the lengths of all paths, which start at the camera.
    pub fn measure(&mut self) {
        self.lengths.clear();
        self.lengths.resize(self.rays.len(), 0.0);
    }

    /// Returns the length of each path before its ray, if they are [measured](Self::measure).
    #[inline]
    pub fn lengths(&self) -> &[f32] {
        &self.lengths
    }

    /// Starts all paths at the camera, in a scene where they have branches.
    pub fn start_branches(&mut self, eye_media: &EyeMedia) {
        let camera = |place| Branch {
            media: eye_media.at(self.rays.get(place as usize).origin),
            kind: RayKind::Camera,
            density: f32::INFINITY,
            place,
        };
        self.branches.clear();
        self.branches
            .extend((0..self.rays.len() as u32).map(camera));
    }

    /// Returns the kinds of the rays, which continue paths: each with the consecutive rays of this
    /// kind.
    pub fn kinds(&self) -> impl Iterator<Item = (RayKind, Range<usize>)> {
        let runs = self.branches.chunk_by(|a, b| a.kind == b.kind);
        let kinds = runs.scan(0, |end, run| {
            let first = *end;
            *end += run.len();
            Some((run[0].kind, first..*end))
        });
        let all = || (RayKind::Reflection, 0..self.rays.len());
        let all = self.branches.is_empty().then(all);
        all.into_iter().chain(kinds)
    }

    /// Weakens the light by the media on the way to the hits.
    pub(super) fn weaken(&mut self, hits: &[Option<Hit>], materials: &[Material]) {
        for (i, (branch, hit)) in self.branches.iter().zip(hits).enumerate() {
            if branch.media.is_none() {
                continue;
            }
            let distance = hit.map_or(f32::INFINITY, |hit| hit.t);
            let transmittance = branch.media.transmittance(distance, materials);
            self.weights.set(i, self.weights.get(i) * transmittance);
        }
    }

    /// Overwrites `media` with the media of each ray: the materials plus 1, and 0 for empty places;
    /// empty in a scene whose paths have no branches.
    pub fn write_media(&self, media: &mut Vec<[u32; 4]>) {
        media.clear();
        media.extend(self.branches.iter().map(|branch| branch.media.words()));
    }

    /// Returns the media of eight rays.
    pub(super) fn media(&self, rays: &[u32; N_LANES]) -> [Media; N_LANES] {
        rays.map(|ray| self.branches[ray as usize].media)
    }

    /// Fades the light in fog on the way to the hits.
    pub(super) fn fade(&mut self, hits: &[Option<Hit>], fog: &FogSphere) {
        self.gained.reset(self.rays.len().next_multiple_of(N_LANES));
        for (i, hit) in hits.iter().enumerate() {
            if self
                .branches
                .get(i)
                .is_some_and(|branch| !branch.media.is_none())
            {
                continue;
            }
            let distance = hit.map_or(f32::INFINITY, |hit| hit.t);
            let Ray { origin, direction } = self.rays.get(i);
            let ray = [origin, direction].map(Vector::from);
            let (transmittance, light) = fog.fade(ray, distance);
            let weight = self.weights.get(i);
            self.gained.set(i, weight * Vec3::from(light));
            self.weights.set(i, weight * transmittance);
        }
    }

    /// Returns the light that these rays bring, plus the light that they gain in fog.
    #[inline(always)]
    pub(super) fn with_gained<I: InstructionSet>(
        &self,
        set: I,
        rays: &[u32; N_LANES],
        light: Vector<I::Lanes>,
    ) -> Vector<I::Lanes> {
        if self.gained.is_empty() {
            return light;
        }
        light + self.gained.gather(set, rays)
    }

    /// Overwrites `sorted` with the rays in the order of the rays that they continue, of which
    /// there were `n_before`; of two, the reflected one comes first. So the order depends only on
    /// each path. `order` is a reused buffer.
    pub(super) fn sort_into(
        &self,
        sorted: &mut PathWave,
        n_before: usize,
        order: &mut Vec<Option<u32>>,
    ) {
        order.clear();
        order.resize(2 * n_before, None);
        for (i, branch) in (0..).zip(&self.branches) {
            order[branch.place as usize] = Some(i);
        }
        sorted.restart(self.depth);
        for &i in order.iter().flatten() {
            let (from, to) = (i as usize, sorted.rays.len());
            sorted.reserve();
            sorted.rays.push(self.rays.get(from));
            sorted.pixels[to] = self.pixels[from];
            sorted.slots[to] = self.slots[from];
            sorted.weights.set(to, self.weights.get(from));
            sorted.branches.push(self.branches[from]);
            sorted.lengths.extend(self.lengths.get(from));
        }
    }

    /// Returns the pixel of each ray.
    #[inline]
    pub fn pixels(&self) -> &[u32] {
        &self.pixels[..self.rays.len()]
    }

    /// Returns the index of each path's color.
    #[inline]
    pub fn slots(&self) -> &[u32] {
        &self.slots[..self.rays.len()]
    }

    /// Makes room for eight more rays.
    #[inline(always)]
    pub fn reserve(&mut self) {
        let n = self.rays.len();
        self.rays.reserve(N_LANES);
        grow(&mut self.pixels, n + N_LANES);
        grow(&mut self.slots, n + N_LANES);
        self.weights.grow(n + N_LANES);
    }

    /// Adds a path that starts with each ray of the first `n` lanes; slots ascend from
    /// `first_slot`.
    #[inline(always)]
    pub fn start<I: InstructionSet>(
        &mut self,
        set: I,
        [origin, direction]: [Vector<I::Lanes>; 2],
        pixels: &[u32; N_LANES],
        first_slot: u32,
        n: usize,
    ) {
        self.reserve();
        let first = self.rays.len();
        let mask = set.mask(u8::MAX >> (N_LANES - n));
        self.rays.push_lanes(origin, direction, mask);
        *lanes_mut(&mut self.pixels, first) = *pixels;
        self.weights.store(first, set.splat_vector(Vec3::ONE));
        for (slot, lane) in lanes_mut(&mut self.slots, first).iter_mut().zip(0..) {
            *slot = first_slot + lane;
        }
    }

    /// Adds these lanes of rays, which continue rays of `wave`.
    #[inline(always)]
    pub(super) fn bounce<I: InstructionSet>(
        &mut self,
        set: I,
        continued: &Continued<I::Lanes>,
        wave: &PathWave,
        mut lanes: u8,
    ) {
        self.reserve();
        let mut next = self.rays.len();
        let Continued {
            origin,
            direction,
            weight,
            rays,
            kinds,
            densities,
            distances,
            media,
        } = *continued;
        // Append rays and weights in lanes.
        let mask = set.mask(lanes);
        self.rays.push_lanes(origin, direction, mask);
        self.weights.store_lanes(next, weight, mask);
        // Append the other data ray by ray.
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % N_LANES;
            let ray = rays[lane] as usize;
            lanes &= lanes - 1;
            self.pixels[next] = wave.pixels[ray];
            self.slots[next] = wave.slots[ray];
            if let Some(before) = wave.lengths.get(ray) {
                self.lengths.push(before + distances[lane]);
            }
            if let Some(before) = wave.branches.get(ray) {
                self.branches.push(Branch {
                    media: match media {
                        Some(media) if kinds[lane] == RayKind::Refraction => media[lane],
                        _ => before.media,
                    },
                    kind: kinds[lane],
                    density: densities[lane],
                    place: 2 * ray as u32 + u32::from(kinds[lane] == RayKind::Refraction),
                });
            }
            next += 1;
        }
    }

    /// Returns the indices under which these rays add to colors, and their weights: indices of
    /// paths, or of rays if paths may be split.
    #[inline(always)]
    pub(super) fn slots_and_weights<I: InstructionSet>(
        &self,
        set: I,
        rays: &[u32; N_LANES],
        may_be_split: bool,
    ) -> ([u32; N_LANES], Vector<I::Lanes>) {
        let slots = if may_be_split {
            *rays
        } else {
            gather(&self.slots, rays)
        };
        (slots, self.weights.gather(set, rays))
    }
}
