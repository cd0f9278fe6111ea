//! Hits → surface points, in lanes.

use glam::Vec3;

use super::hit_attributes::{HitAttributes, HitPlace, shading_point};
use super::parameters::parameters;
use super::points::{PointGroup, PointLanes, Points};
use crate::accel::Hit;
use math::simd::{
    InstructionSet, Lanes, N_LANES, SimdKernel, Vector, lane_of, lanes, lanes_mut, set_lane,
    to_arrays,
};
use world::camera::RayCone;
use world::geometry::{InstanceTransform, N_PARAMETERS, RayStream};
use world::material::{MaterialKind, PictureFactors};
use world::scene::{
    AttributeKind, InstanceId, ObjectId, PlacedPrimitive, Scene, interpolated_scalar, scalar_along,
};

/// Computes the points of grouped hits.
pub(super) struct FindPoints<'a> {
    pub(super) scene: &'a Scene,
    pub(super) cone: Option<RayCone>,
    /// Lengths of the paths before the rays, with a cone.
    pub(super) lengths: &'a [f32],
    pub(super) rays: &'a RayStream,
    pub(super) hits: &'a [Option<Hit>],
    pub(super) points: &'a mut Points,
}

/// Eight hits.
struct LaneHits {
    primitives: [u32; N_LANES],
    /// The instance of each hit; `None` for all in a scene without instances.
    instances: [Option<InstanceId>; N_LANES],
    t: [f32; N_LANES],
}

impl LaneHits {
    /// Returns the primitive that was hit in a lane.
    #[inline(always)]
    fn placed(&self, lane: usize) -> PlacedPrimitive {
        PlacedPrimitive {
            primitive: self.primitives[lane],
            instance: self.instances[lane],
        }
    }
}

impl SimdKernel for FindPoints<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        self.collect_hits();
        for i in 0..self.points.groups.len() {
            let group = self.points.groups[i];
            let is_fog = matches!(
                self.scene.material(group.material).kind,
                MaterialKind::Particles(_)
            );
            for at in group.lanes() {
                if is_fog {
                    self.find_particles(set, &group, at);
                } else {
                    self.find(set, &group, at);
                }
            }
        }
    }
}

impl FindPoints<'_> {
    /// Writes the hits of all points to their columns. Writing eight at a time would load them
    /// right after they were stored one by one, which stalls the CPU.
    #[inline(always)]
    fn collect_hits(&mut self) {
        let end = self.points.end();
        let Points {
            rays,
            distance,
            primitives,
            instances,
            ..
        } = &mut *self.points;
        let hits = rays[..end].iter().map(|&ray| self.hits[ray as usize]);
        let columns = distance[..end].iter_mut().zip(&mut primitives[..end]);
        for ((distance, primitive), hit) in columns.zip(hits.clone()) {
            // Each point has a hit: a branch is faster than selects.
            if let Some(hit) = hit {
                (*distance, *primitive) = (hit.t, hit.primitive);
            }
        }
        if self.scene.instances.is_some() {
            for (instance, hit) in instances[..end].iter_mut().zip(hits) {
                *instance = hit.and_then(|hit| hit.instance);
            }
        }
    }

    /// Computes eight points.
    #[inline(always)]
    fn find<I: InstructionSet>(&mut self, set: I, group: &PointGroup, at: PointLanes) {
        // Project the hits onto the surfaces, which removes the rounding error.
        let hits = self.hits(at);
        let [origin, direction] = self.rays.gather(set, self.points.rays(at));
        let near = origin + direction * set.load(&hits.t);
        let parameters = parameters(set, self.scene, &hits.primitives, &hits.instances);
        let (position, outward) = match group.shape {
            Some(shape) => shape.project_onto(&parameters, near),
            None => self.project_placed(set, &hits.primitives, near),
        };
        let error = match group.shape {
            Some(shape) => shape.rounding_along(&parameters, [position, outward]),
            None => self.placed_rounding(set, &hits.primitives),
        };
        let outward = match &self.scene.instances {
            None => outward,
            Some(_) => outward.flip_sign_by(self.mirror_signs(set, &hits)),
        };
        let place = HitPlace {
            position,
            outward,
            error,
            direction,
        };
        // Gather the attributes that the group has.
        let kind = group.attributes;
        let normals = |lane| self.scene.vertex_normals(hits.placed(lane));
        let colors = |lane| self.scene.vertex_colors(hits.primitives[lane]);
        let attributes = HitAttributes {
            parameters,
            normals: if kind.has_normals() {
                Some(vertex_lanes(set, normals))
            } else {
                None
            },
            uvs: if kind.has_uvs() {
                Some(self.vertex_uvs(set, &hits.primitives))
            } else {
                None
            },
            colors: if kind.has_corner_colors() {
                Some(vertex_lanes(set, colors))
            } else {
                None
            },
            scalar: self.scalars(set, group, &hits, &parameters, position),
            color: match kind {
                AttributeKind::Colors => Some(self.own_colors(set, &hits.primitives)),
                _ => None,
            },
        };
        let material = self.scene.material(group.material);
        let point = shading_point(material, &place, &attributes, self.cones(set, &hits, at));
        // Store the points.
        let points = &mut *self.points;
        *lanes_mut(&mut points.materials, at.first) = [group.material; N_LANES];
        let objects = lanes_mut(&mut points.objects, at.first);
        for (object, &primitive) in objects.iter_mut().zip(&hits.primitives) {
            *object = self.scene.primitives[primitive as usize].object;
        }
        points.position.store(at.first, point.position);
        points.normal.store(at.first, point.normal);
        points
            .geometric_normal
            .store(at.first, point.geometric_normal);
        points.color.store(at.first, point.color);
        if points.has_factors {
            points.store_factors(at.first, &point.factors);
        }
        points.direction.store(at.first, direction);
        *lanes_mut(&mut points.error, at.first) = error.to_array();
        *lanes_mut(&mut points.side, at.first) = point.side.to_array();
    }

    /// Returns the scalars at eight points that textures read; `None` if the group has none.
    #[inline(always)]
    fn scalars<I: InstructionSet>(
        &self,
        set: I,
        group: &PointGroup,
        hits: &LaneHits,
        parameters: &[I::Lanes; N_PARAMETERS],
        position: Vector<I::Lanes>,
    ) -> Option<I::Lanes> {
        if group.attributes.has_corner_scalars() {
            let scalars = self.vertex_scalars(set, hits);
            return Some(interpolated_scalar(parameters, scalars, position));
        }
        match (group.attributes, group.shape) {
            (AttributeKind::Scalars, _) => Some(self.own_scalars(set, &hits.primitives)),
            (AttributeKind::Ends, Some(_)) => {
                let scalars = self.end_scalars(set, &hits.primitives);
                Some(scalar_along(parameters, scalars, position))
            }
            (AttributeKind::Ends, None) => Some(self.placed_scalars(set, hits, position)),
            _ => None,
        }
    }

    /// Computes eight particles of fog, as [`SurfacePoint::fog_particle`](super::SurfacePoint) does.
    #[inline(always)]
    fn find_particles<I: InstructionSet>(&mut self, set: I, group: &PointGroup, at: PointLanes) {
        let [origin, direction] = self.rays.gather(set, self.points.rays(at));
        let color = self.scene.fog.map_or(Vec3::ZERO, |fog| fog.color);
        let (none, first) = (set.splat_vector(Vec3::ZERO), at.first);
        let distances = set.load(self.points.distances(at));
        let points = &mut *self.points;
        *lanes_mut(&mut points.materials, first) = [group.material; N_LANES];
        *lanes_mut(&mut points.objects, first) = [ObjectId(0); N_LANES];
        let position = origin + direction * distances;
        points.position.store(first, position);
        points.normal.store(first, none);
        points.geometric_normal.store(first, none);
        points.color.store(first, set.splat_vector(color));
        if points.has_factors {
            points.store_factors(first, &PictureFactors::ones(set.splat(1.0)));
        }
        points.direction.store(first, direction);
        *lanes_mut(&mut points.error, first) = [0.0; N_LANES];
        *lanes_mut(&mut points.side, first) = [1.0; N_LANES];
    }

    /// Returns the hits of eight points.
    #[inline(always)]
    fn hits(&self, at: PointLanes) -> LaneHits {
        LaneHits {
            primitives: *lanes(&self.points.primitives, at.first),
            instances: match self.scene.instances {
                Some(_) => *lanes(&self.points.instances, at.first),
                None => [None; N_LANES],
            },
            t: *self.points.distances(at),
        }
    }

    /// Returns the cone of the camera's rays with the lengths of eight paths; `None` without one.
    #[inline(always)]
    fn cones<I: InstructionSet>(
        &self,
        set: I,
        hits: &LaneHits,
        at: PointLanes,
    ) -> Option<(RayCone, I::Lanes)> {
        let cone = self.cone?;
        let mut lengths = hits.t;
        for (length, &ray) in lengths.iter_mut().zip(self.points.rays(at)) {
            *length += self.lengths[ray as usize];
        }
        Some((cone, set.load(&lengths)))
    }

    /// Returns the nearest points and normals of primitives under a transform, one by one.
    #[inline(always)]
    fn project_placed<I: InstructionSet>(
        &self,
        set: I,
        primitives: &[u32; N_LANES],
        near: Vector<I::Lanes>,
    ) -> (Vector<I::Lanes>, Vector<I::Lanes>) {
        let near = to_arrays(near);
        let (mut positions, mut normals) = ([[0.0; N_LANES]; 3], [[0.0; N_LANES]; 3]);
        for (lane, &primitive) in primitives.iter().enumerate() {
            let primitive = &self.scene.primitives[primitive as usize];
            let (position, normal) = primitive.project(lane_of(&near, lane));
            set_lane(&mut positions, lane, position);
            set_lane(&mut normals, lane, normal);
        }
        (set.load_vector(&positions), set.load_vector(&normals))
    }

    /// Returns the bounds of rounding errors of primitives under a transform, one by one.
    #[inline(always)]
    fn placed_rounding<I: InstructionSet>(&self, set: I, primitives: &[u32; N_LANES]) -> I::Lanes {
        let rounding = |&primitive: &u32| {
            let primitive = &self.scene.primitives[primitive as usize];
            primitive.rounding([Vec3::ZERO; 2])
        };
        set.load(&primitives.each_ref().map(rounding))
    }

    /// Returns numbers by whose signs the normals of triangles have to be flipped: negative on
    /// mirrored instances.
    #[inline(always)]
    fn mirror_signs<I: InstructionSet>(&self, set: I, hits: &LaneHits) -> I::Lanes {
        let mut signs = [1.0; N_LANES];
        for (lane, sign) in signs.iter_mut().enumerate() {
            let transform = self.scene.transform(hits.placed(lane));
            if transform.is_some_and(InstanceTransform::is_mirrored) {
                *sign = -1.0;
            }
        }
        set.load(&signs)
    }

    /// Returns the texture coordinates at the vertices of eight triangles.
    #[inline(always)]
    fn vertex_uvs<I: InstructionSet>(
        &self,
        set: I,
        primitives: &[u32; N_LANES],
    ) -> [[I::Lanes; 2]; 3] {
        let mut columns = [[[0.0; N_LANES]; 2]; 3];
        for (lane, &primitive) in primitives.iter().enumerate() {
            let uvs = self.scene.vertex_uvs(primitive).unwrap_or_default();
            for (column, [u, v]) in columns.iter_mut().zip(uvs) {
                (column[0][lane], column[1][lane]) = (u, v);
            }
        }
        let mut uvs = [[set.splat(0.0); 2]; 3];
        for (uv, [u, v]) in uvs.iter_mut().zip(&columns) {
            *uv = [set.load(u), set.load(v)];
        }
        uvs
    }

    /// Returns the numbers of an array at the vertices of eight triangles.
    #[inline(always)]
    fn vertex_scalars<I: InstructionSet>(&self, set: I, hits: &LaneHits) -> [I::Lanes; 3] {
        let mut columns = [[0.0; N_LANES]; 3];
        for lane in 0..N_LANES {
            let scalars = self.scene.vertex_scalars(hits.placed(lane));
            for (column, scalar) in columns.iter_mut().zip(scalars.unwrap_or_default()) {
                column[lane] = scalar;
            }
        }
        let [a, b, c] = &columns;
        [set.load(a), set.load(b), set.load(c)]
    }

    /// Returns the scalars given per primitive for eight primitives.
    #[inline(always)]
    fn own_scalars<I: InstructionSet>(&self, set: I, primitives: &[u32; N_LANES]) -> I::Lanes {
        let mut column = [f32::NAN; N_LANES];
        for (scalar, &primitive) in column.iter_mut().zip(primitives) {
            *scalar = self.scene.own_scalar(primitive).unwrap_or(f32::NAN);
        }
        set.load(&column)
    }

    /// Returns the numbers of an array at the ends of eight capsules.
    #[inline(always)]
    fn end_scalars<I: InstructionSet>(&self, set: I, primitives: &[u32; N_LANES]) -> [I::Lanes; 2] {
        let mut columns = [[f32::NAN; N_LANES]; 2];
        for (lane, &primitive) in primitives.iter().enumerate() {
            let scalars = self.scene.end_scalars(primitive);
            let [from, to] = scalars.unwrap_or([f32::NAN; 2]);
            (columns[0][lane], columns[1][lane]) = (from, to);
        }
        [set.load(&columns[0]), set.load(&columns[1])]
    }

    /// Returns the numbers of an array at points of primitives under a transform, one by one.
    #[inline(always)]
    fn placed_scalars<I: InstructionSet>(
        &self,
        set: I,
        hits: &LaneHits,
        points: Vector<I::Lanes>,
    ) -> I::Lanes {
        let points = to_arrays(points);
        let mut column = [f32::NAN; N_LANES];
        for (lane, scalar) in column.iter_mut().enumerate() {
            *scalar = self.scene.scalar(hits.placed(lane), lane_of(&points, lane));
        }
        set.load(&column)
    }

    /// Returns the colors given per primitive for eight primitives.
    #[inline(always)]
    fn own_colors<I: InstructionSet>(
        &self,
        set: I,
        primitives: &[u32; N_LANES],
    ) -> Vector<I::Lanes> {
        let mut columns = [[0.0; N_LANES]; 3];
        for (lane, &primitive) in primitives.iter().enumerate() {
            let color = self.scene.own_color(primitive).unwrap_or_default();
            set_lane(&mut columns, lane, color);
        }
        set.load_vector(&columns)
    }
}

/// Returns the normals or the colors at the vertices of eight triangles, by lane.
#[inline(always)]
fn vertex_lanes<I: InstructionSet>(
    set: I,
    vectors_of: impl Fn(usize) -> Option<[Vec3; 3]>,
) -> [Vector<I::Lanes>; 3] {
    let mut columns = [[[0.0; N_LANES]; 3]; 3];
    for lane in 0..N_LANES {
        let vectors = vectors_of(lane).unwrap_or_default();
        for (column, vector) in columns.iter_mut().zip(vectors) {
            set_lane(column, lane, vector);
        }
    }
    let [a, b, c] = &columns;
    [set.load_vector(a), set.load_vector(b), set.load_vector(c)]
}
