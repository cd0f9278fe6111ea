//! Hits → surface points, in lanes.

use super::parameters::parameters;
use super::points::{PointGroup, PointLanes, Points};
use super::surface_point::{on_side_of, side};
use crate::accel::Hit;
use crate::geometry::RayStream;
use crate::scene::{AttributeKind, Scene, interpolated_normal};
use crate::simd::{
    InstructionSet, Lanes, N_LANES, SimdKernel, Vector, lane_of, lanes_mut, set_lane, to_arrays,
};

/// Computes the points of grouped hits.
pub(super) struct FindPoints<'a> {
    pub(super) scene: &'a Scene,
    pub(super) rays: &'a RayStream,
    pub(super) hits: &'a [Option<Hit>],
    pub(super) points: &'a mut Points,
}

/// Eight hits.
struct LaneHits {
    primitives: [u32; N_LANES],
    origins: [[f32; N_LANES]; 3],
    directions: [[f32; N_LANES]; 3],
    t: [f32; N_LANES],
}

impl SimdKernel for FindPoints<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        for i in 0..self.points.groups.len() {
            let group = self.points.groups[i];
            for at in group.lanes() {
                self.find(set, &group, at);
            }
        }
    }
}

impl FindPoints<'_> {
    /// Computes eight points.
    #[inline(always)]
    fn find<I: InstructionSet>(&mut self, set: I, group: &PointGroup, at: PointLanes) {
        let hits = self.hits(at);
        let direction = set.load_vector(&hits.directions);
        let near = set.load_vector(&hits.origins) + direction * set.load(&hits.t);
        let parameters = parameters(set, self.scene, &hits.primitives);
        let (position, outward) = match group.shape {
            Some(shape) => shape.project_onto(&parameters, near),
            None => self.project_placed(set, &hits.primitives, near),
        };
        let side = side(outward, direction);
        let geometric_normal = outward.flip_sign_by(side);
        let normal = match group.attributes {
            AttributeKind::Normals => {
                let normals = self.vertex_normals(set, &hits.primitives);
                let normal = interpolated_normal(&parameters, normals, position, geometric_normal);
                on_side_of(geometric_normal, normal)
            }
            AttributeKind::None | AttributeKind::Colors => geometric_normal,
        };
        let color = match group.attributes {
            AttributeKind::Colors => self.own_colors(set, &hits.primitives),
            AttributeKind::None | AttributeKind::Normals => {
                let material = self.scene.material(group.material);
                material.color.color_at(position)
            }
        };
        let points = &mut *self.points;
        *lanes_mut(&mut points.distance, at.first) = hits.t;
        *lanes_mut(&mut points.materials, at.first) = [group.material; N_LANES];
        *lanes_mut(&mut points.primitives, at.first) = hits.primitives;
        let objects = lanes_mut(&mut points.objects, at.first);
        for (object, &primitive) in objects.iter_mut().zip(&hits.primitives) {
            *object = self.scene.primitives[primitive as usize].object;
        }
        points.position.store(at.first, position);
        points.normal.store(at.first, normal);
        points.geometric_normal.store(at.first, geometric_normal);
        points.color.store(at.first, color);
        points.direction.store(at.first, direction);
        *lanes_mut(&mut points.side, at.first) = side.to_array();
    }

    /// Collects eight hits and their rays.
    #[inline(always)]
    fn hits(&self, at: PointLanes) -> LaneHits {
        let mut hits = LaneHits {
            primitives: [0; N_LANES],
            origins: [[0.0; N_LANES]; 3],
            directions: [[0.0; N_LANES]; 3],
            t: [0.0; N_LANES],
        };
        for (lane, &ray) in self.points.rays(at).iter().enumerate() {
            let (ray, hit) = (self.rays.get(ray as usize), self.hits[ray as usize]);
            let Some(hit) = hit else { continue };
            hits.primitives[lane] = hit.primitive;
            hits.t[lane] = hit.t;
            set_lane(&mut hits.origins, lane, ray.origin);
            set_lane(&mut hits.directions, lane, ray.direction);
        }
        hits
    }

    /// The nearest points and normals of primitives under a transform, one by one.
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

    /// The normals at the vertices of eight triangles.
    #[inline(always)]
    fn vertex_normals<I: InstructionSet>(
        &self,
        set: I,
        primitives: &[u32; N_LANES],
    ) -> [Vector<I::Lanes>; 3] {
        let mut columns = [[[0.0; N_LANES]; 3]; 3];
        for (lane, &primitive) in primitives.iter().enumerate() {
            let normals = self.scene.vertex_normals(primitive);
            for (column, normal) in columns.iter_mut().zip(normals.unwrap_or_default()) {
                set_lane(column, lane, normal);
            }
        }
        let [a, b, c] = &columns;
        [set.load_vector(a), set.load_vector(b), set.load_vector(c)]
    }

    /// The own colors of eight primitives.
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
