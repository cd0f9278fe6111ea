//! The surface points of a wave of rays, in groups that are computed in the same way.

use glam::Vec3;

use super::parameters::parameters;
use super::surface_point::ShadingPoint;
use math::simd::{InstructionSet, Lanes, N_LANES, Vector, VectorColumn, grow, lanes};
use world::geometry::{N_PARAMETERS, ShapeKind};
use world::material::{Material, PictureFactors};
use world::scene::{
    AttributeKind, InstanceId, MaterialId, ObjectId, PlacedPrimitive, Scene, SurfaceClass,
};

/// The surface points that rays have hit, as a structure of arrays.
///
/// Points of the same kind are neighbors, so that a loop over whole lanes has no branch that
/// depends on a single point. A group starts at a multiple of eight; after its last point, copies
/// of that point fill whole lanes.
#[derive(Debug, Default)]
pub struct Points {
    pub(super) groups: Vec<PointGroup>,
    /// The index of each point's ray.
    pub(super) rays: Vec<u32>,
    /// The index of each ray's point; [`NO_POINT`] without a hit.
    pub(super) by_ray: Vec<u32>,
    /// Indices of the rays that hit nothing.
    pub(super) missed: Vec<u32>,
    pub(super) position: VectorColumn,
    pub(super) normal: VectorColumn,
    pub(super) geometric_normal: VectorColumn,
    pub(super) color: VectorColumn,
    /// The factors of textures: for emission, and for roughness and metal; empty if no material of
    /// the scene has such textures.
    pub(super) factors: [VectorColumn; 2],
    pub(super) has_factors: bool,
    /// The direction of each point's ray.
    pub(super) direction: VectorColumn,
    pub(super) side: Vec<f32>,
    /// The opacity of each point in a scene that is split by it; else empty.
    opacity: Vec<f32>,
    pub(super) distance: Vec<f32>,
    /// A bound of the distance of each position from the surface.
    pub(super) error: Vec<f32>,
    pub(super) materials: Vec<MaterialId>,
    /// The primitive of each point.
    pub(super) primitives: Vec<u32>,
    /// The instance of each point, in a scene with instances.
    pub(super) instances: Vec<Option<InstanceId>>,
    /// The object of each point.
    pub(super) objects: Vec<ObjectId>,
    /// The group of each ray, while points are grouped.
    pub(super) group_of_ray: Vec<u32>,
    /// The index of the group of each class, if that group has this class.
    pub(super) group_of_class: Vec<u32>,
}

/// The index of the point of a ray that hit nothing.
pub(super) const NO_POINT: u32 = u32::MAX;

/// Points that are computed and shaded in the same way.
#[derive(Debug, Clone, Copy)]
pub struct PointGroup {
    /// The kind of the shapes; `None` for shapes under a transform.
    pub shape: Option<ShapeKind>,
    pub(super) attributes: AttributeKind,
    /// The material of all points.
    pub material: MaterialId,
    pub(super) class: SurfaceClass,
    /// Index of the first point, a multiple of eight.
    pub(super) first: usize,
    /// Number of points.
    pub(super) n: usize,
}

/// Up to eight points of a group.
#[derive(Debug, Clone, Copy)]
pub struct PointLanes {
    /// Index of the first point, a multiple of eight.
    pub first: usize,
    /// Number of points, from 1 to 8.
    pub n: usize,
}

impl PointGroup {
    /// Returns the points of the group, eight by eight.
    #[inline(always)]
    pub fn lanes(&self) -> impl Iterator<Item = PointLanes> + use<> {
        let (start, end) = (self.first, self.first + self.n);
        (start..end).step_by(N_LANES).map(move |first| PointLanes {
            first,
            n: N_LANES.min(end - first),
        })
    }
}

impl PointLanes {
    /// Returns the lanes that hold a point rather than a copy, as bits.
    #[inline(always)]
    pub fn bits(self) -> u8 {
        u8::MAX >> (N_LANES - self.n)
    }
}

impl Points {
    pub(super) fn grow(&mut self, n_points: usize) {
        grow(&mut self.rays, n_points);
        grow(&mut self.objects, n_points);
        grow(&mut self.primitives, n_points);
        grow(&mut self.materials, n_points);
        grow(&mut self.distance, n_points);
        grow(&mut self.error, n_points);
        grow(&mut self.side, n_points);
        self.position.grow(n_points);
        self.normal.grow(n_points);
        self.geometric_normal.grow(n_points);
        self.color.grow(n_points);
        if self.has_factors {
            self.factors
                .iter_mut()
                .for_each(|column| column.grow(n_points));
        }
        self.direction.grow(n_points);
    }

    /// Stores the factors of eight points, from this one on.
    #[inline(always)]
    pub(super) fn store_factors<L: Lanes>(&mut self, first: usize, factors: &PictureFactors<L>) {
        let PictureFactors {
            emission,
            roughness,
            metallic,
        } = *factors;
        let facets = Vector {
            x: roughness,
            y: metallic,
            z: roughness,
        };
        let [of_emission, of_facets] = &mut self.factors;
        of_emission.store(first, emission);
        of_facets.store(first, facets);
    }

    /// Returns the end of the points' indices.
    #[inline]
    pub fn end(&self) -> usize {
        let last = self.groups.last();
        last.map_or(0, |group| (group.first + group.n).next_multiple_of(N_LANES))
    }

    /// Returns the groups.
    #[inline]
    pub fn groups(&self) -> &[PointGroup] {
        &self.groups
    }

    /// Returns the rays that hit nothing.
    #[inline]
    pub fn missed(&self) -> &[u32] {
        &self.missed
    }

    /// Returns the indices of the object and of the material of a point.
    #[inline(always)]
    pub fn object_and_material(&self, point: usize) -> [u32; 2] {
        [self.objects[point].0, self.materials[point].0]
    }

    /// Returns the instance that a point is on, if any.
    #[inline]
    pub fn instance(&self, point: usize) -> Option<InstanceId> {
        *self.instances.get(point)?
    }

    /// Returns the distance of a point along its ray.
    #[inline(always)]
    pub fn distance(&self, point: usize) -> f32 {
        self.distance[point]
    }

    /// Returns the object of a point.
    #[inline(always)]
    pub fn object(&self, point: usize) -> ObjectId {
        self.objects[point]
    }

    /// Returns the point of a ray, if it hit something.
    #[inline(always)]
    pub fn by_ray(&self, ray: usize) -> Option<usize> {
        let point = self.by_ray[ray];
        (point != NO_POINT).then_some(point as usize)
    }

    /// Returns the part of eight points that shading reads.
    #[inline(always)]
    pub fn shading<I: InstructionSet>(&self, set: I, at: PointLanes) -> ShadingPoint<I::Lanes> {
        let side = set.load(lanes(&self.side, at.first));
        let mut factors = PictureFactors::ones(side);
        if self.has_factors {
            let [emission, facets] = &self.factors;
            let facets = facets.load(set, at.first);
            factors = PictureFactors {
                emission: emission.load(set, at.first),
                roughness: facets.x,
                metallic: facets.y,
            };
        }
        ShadingPoint {
            position: self.position.load(set, at.first),
            normal: self.normal.load(set, at.first),
            geometric_normal: self.geometric_normal.load(set, at.first),
            color: self.color.load(set, at.first),
            error: set.load(lanes(&self.error, at.first)),
            side,
            factors,
        }
    }

    /// Returns the colors of the surface at eight points.
    #[inline(always)]
    pub fn colors<I: InstructionSet>(&self, set: I, at: PointLanes) -> Vector<I::Lanes> {
        self.color.load(set, at.first)
    }

    /// Returns the color of the surface at a point.
    #[inline(always)]
    pub fn color(&self, point: usize) -> Vec3 {
        self.color.get(point)
    }

    /// Returns the lanes whose points are on a side of the surface that scatters light.
    #[inline(always)]
    pub(crate) fn scattering_sides<I: InstructionSet>(
        &self,
        set: I,
        at: PointLanes,
        material: &Material,
    ) -> u8 {
        if material.two_sided {
            return u8::MAX;
        }
        !set.load(lanes(&self.side, at.first)).signs()
    }

    /// Returns the parameters of the shapes at eight points, unless they have a transform.
    #[inline(always)]
    pub fn parameters<I: InstructionSet>(
        &self,
        set: I,
        scene: &Scene,
        at: PointLanes,
    ) -> [I::Lanes; N_PARAMETERS] {
        let instances = match scene.instances {
            None => &[None; N_LANES],
            Some(_) => lanes(&self.instances, at.first),
        };
        parameters(set, scene, lanes(&self.primitives, at.first), instances)
    }

    /// Computes the opacity of all points.
    pub(super) fn find_opacities(&mut self, scene: &Scene) {
        let mut opacity = std::mem::take(&mut self.opacity);
        opacity.clear();
        opacity.resize(self.end(), 1.0);
        for group in &self.groups {
            if scene.material(group.material).opacity.is_none() {
                continue;
            }
            for (i, opacity) in (group.first..).zip(&mut opacity[group.first..][..group.n]) {
                let placed = PlacedPrimitive {
                    primitive: self.primitives[i],
                    instance: self.instance(i),
                };
                let outward = self.side[i] * self.geometric_normal.get(i);
                *opacity = scene.opacity(placed, [self.position.get(i), outward]);
            }
        }
        self.opacity = opacity;
    }

    /// Returns the opacities of eight points.
    #[inline(always)]
    pub(crate) fn opacities<I: InstructionSet>(&self, set: I, at: PointLanes) -> I::Lanes {
        if self.opacity.is_empty() {
            return set.splat(1.0);
        }
        set.load(lanes(&self.opacity, at.first))
    }

    /// Returns the distances of eight points along their rays.
    #[inline(always)]
    pub fn distances(&self, at: PointLanes) -> &[f32; N_LANES] {
        lanes(&self.distance, at.first)
    }

    /// Returns the rays that hit eight points.
    #[inline(always)]
    pub fn rays(&self, at: PointLanes) -> &[u32; N_LANES] {
        lanes(&self.rays, at.first)
    }

    /// Returns the directions of the rays that hit eight points.
    #[inline(always)]
    pub fn directions<I: InstructionSet>(&self, set: I, at: PointLanes) -> Vector<I::Lanes> {
        self.direction.load(set, at.first)
    }

    /// Returns the position and the shading normal of a point.
    #[inline(always)]
    pub fn position_and_normal(&self, point: usize) -> [Vec3; 2] {
        [self.position.get(point), self.normal.get(point)]
    }
}
