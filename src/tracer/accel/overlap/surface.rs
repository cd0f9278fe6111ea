//! The surface of a primitive, and its area in a box.

use std::f64::consts::{PI, TAU};
use std::mem::swap;
use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use world::geometry::{Aabb, Patch};
use world::scene::Primitive;

/// Number of points of a sphere.
const N_POINTS: usize = 256;

/// Points of the unit sphere, each of which stands for the same area (R. Swinbank, R. J. Purser,
/// Fibonacci grids, Quarterly Journal of the Royal Meteorological Society 132, 2006). In slices,
/// they are right within 2 % of the sphere.
static POINTS: LazyLock<[DVec3; N_POINTS]> = LazyLock::new(|| {
    let golden_ratio = 0.5 + 0.5 * 5_f64.sqrt();
    std::array::from_fn(|i| {
        let z = (2 * i + 1) as f64 / N_POINTS as f64 - 1.0;
        let (sin, cos) = (TAU * i as f64 / golden_ratio).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    })
});

/// The surface of a primitive: triangles as they are, curved surfaces as cells of a mesh.
pub(super) enum FacetedSurface {
    Sphere { center: DVec3, radius: f64 },
    Facets(Vec<[DVec3; 3]>),
}

impl FacetedSurface {
    pub(super) fn new(primitive: &Primitive) -> Self {
        match primitive.patch() {
            Some(Patch::Ball { center, radius }) => Self::Sphere {
                center: center.as_dvec3(),
                radius: radius.into(),
            },
            patch => {
                let facets = patch.iter().flat_map(Patch::triangles);
                let double = |facet: [Vec3; 3]| facet.map(|corner| corner.as_dvec3());
                Self::Facets(facets.map(double).collect())
            }
        }
    }

    /// Returns the whole area.
    pub(super) fn area(&self) -> f64 {
        match self {
            Self::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Self::Facets(facets) => facets.iter().map(|facet| area(facet)).sum(),
        }
    }

    /// Returns the area in a box, whose faces belong to it.
    pub(super) fn area_within(&self, bounds: &Aabb, clipper: &mut Clipper) -> f64 {
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.as_dvec3());
        match self {
            &Self::Sphere { center, radius } => {
                let [min, max] = [min, max].map(|corner| (corner - center) / radius);
                let is_within = |point: &&DVec3| point.cmpge(min).all() && point.cmple(max).all();
                let n = POINTS.iter().filter(is_within).count();
                self.area() * n as f64 / N_POINTS as f64
            }
            Self::Facets(facets) => {
                let facets = facets.iter();
                facets
                    .map(|facet| clipper.area_within(facet, min, max))
                    .sum()
            }
        }
    }
}

/// Memory to clip polygons (I. E. Sutherland, G. W. Hodgman, Reentrant Polygon Clipping,
/// Communications of the ACM 17, 1974).
#[derive(Default)]
pub(super) struct Clipper {
    polygon: Vec<DVec3>,
    clipped: Vec<DVec3>,
}

impl Clipper {
    /// Returns the area of the part of a triangle between two corners of a box.
    fn area_within(&mut self, triangle: &[DVec3; 3], min: DVec3, max: DVec3) -> f64 {
        self.polygon.clear();
        self.polygon.extend(triangle);
        for axis in 0..3 {
            self.clip(axis, min[axis], 1.0);
            self.clip(axis, max[axis], -1.0);
        }
        area(&self.polygon)
    }

    /// Keeps the part of the polygon above a coordinate, or below it with a negative sign.
    fn clip(&mut self, axis: usize, limit: f64, sign: f64) {
        let is_within = |point: &DVec3| sign * (point[axis] - limit) >= 0.0;
        if self.polygon.iter().all(is_within) {
            return;
        }
        self.clipped.clear();
        let mut from = self.polygon.last().copied().unwrap_or_default();
        for &to in &self.polygon {
            if is_within(&from) != is_within(&to) {
                let along = (limit - from[axis]) / (to[axis] - from[axis]);
                let mut crossing = from + along * (to - from);
                crossing[axis] = limit;
                self.clipped.push(crossing);
            }
            if is_within(&to) {
                self.clipped.push(to);
            }
            from = to;
        }
        swap(&mut self.polygon, &mut self.clipped);
    }
}

/// Returns the area of a flat polygon; 0 with fewer than three corners.
fn area(polygon: &[DVec3]) -> f64 {
    let Some((&first, others)) = polygon.split_first() else {
        return 0.0;
    };
    let double = |pair: &[DVec3]| (pair[0] - first).cross(pair[1] - first);
    others.windows(2).map(double).sum::<DVec3>().length() / 2.0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the area of the small triangles of a triangle whose centers are between two corners.
    fn slow_twin([a, b, c]: [DVec3; 3], min: DVec3, max: DVec3) -> f64 {
        const N: u32 = 100;
        let cells = (0..N).flat_map(|i| (0..N).map(move |j| [i, j].map(f64::from)));
        let centers = cells.flat_map(|[i, j]| [[i, j], [i + 1.0 / 3.0, j + 1.0 / 3.0]]);
        let shares = centers.map(|at| at.map(|k| (k + 1.0 / 3.0) / f64::from(N)));
        let within = shares.filter(|&[u, v]| {
            let point = a + u * (b - a) + v * (c - a);
            u + v < 1.0 && point.cmpge(min).all() && point.cmple(max).all()
        });
        within.count() as f64 * area(&[a, b, c]) / f64::from(N * N)
    }

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0_f64..1.0).prop_map(DVec3::from)
    }

    proptest! {
        #[test]
        fn an_area_in_a_box_is_the_sum_of_small_triangles(
            triangle in prop::array::uniform3(point()),
            corners in [point(), point()],
        ) {
            let [min, max] = [corners[0].min(corners[1]), corners[0].max(corners[1])];
            let found = Clipper::default().area_within(&triangle, min, max);
            let expected = slow_twin(triangle, min, max);
            let whole = area(&triangle);
            prop_assert!((found - expected).abs() < 0.03 * whole, "{found} {expected} {whole}");
        }

        #[test]
        fn the_areas_in_the_parts_of_a_box_add_up(
            triangle in prop::array::uniform3(point()),
            axis in 0_usize..3,
            position in -1.0_f64..1.0,
        ) {
            let mut clipper = Clipper::default();
            let mut within = |min, max| clipper.area_within(&triangle, min, max);
            let all = DVec3::ONE;
            let (mut low, mut high) = (all, -all);
            (low[axis], high[axis]) = (position, position);
            let sum = within(-all, low) + within(high, all);
            prop_assert!((sum - area(&triangle)).abs() < 1e-14);
        }

        #[test]
        fn a_slice_of_a_sphere_has_its_share_of_the_area(
            center in point(),
            radius in 0.1_f32..2.0,
            axis in 0_usize..3,
            share in -1.0_f32..1.0,
        ) {
            let sphere = FacetedSurface::Sphere { center, radius: radius.into() };
            let mut bounds = Aabb::ALL;
            bounds.max[axis] = center.as_vec3()[axis] + share * radius;
            let found = sphere.area_within(&bounds, &mut Clipper::default()) / sphere.area();
            let expected = f64::from(0.5 + 0.5 * share);
            prop_assert!((found - expected).abs() < 0.016, "{found} {expected}");
        }
    }
}
