//! Points of surfaces, sampled as seen from other points: the light that reaches a point from a
//! shape.

use super::N_PARAMETERS;
use math::simd::{Real, Vector, cos_sin};

/// A shape whose surface can be sampled, with a formula for one shape and point or for
/// lanes of them.
pub trait Sampled {
    /// Returns the area of the surface; infinite if it cannot be sampled.
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R;

    /// Samples a direction from a point to the surface with two numbers in [0, 1).
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        numbers: [R; 2],
    ) -> SurfaceSample<R>;

    /// Returns the probability density with which [`sample`](Self::sample) chooses the direction to
    /// this point of the surface: unless overridden, uniform over the area.
    #[inline(always)]
    fn density<R: Real>(parameters: &[R; N_PARAMETERS], _from: Vector<R>, seen: &Seen<R>) -> R {
        seen.density_by_area(Self::area(parameters))
    }
}

/// A sampled direction to a surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceSample<R> {
    /// The surface point that is seen.
    pub seen: Seen<R>,
    /// The probability density of the direction, per steradian.
    pub density: R,
}

/// A point of a surface, as seen from another point.
#[derive(Debug, Clone, Copy)]
pub struct Seen<R> {
    /// The direction to the point, a unit vector.
    pub direction: Vector<R>,
    /// The distance to the point.
    pub distance: R,
    /// The cosine of the angle between the surface's own normal and the direction back: negative if
    /// the surface is seen from behind.
    pub cos: R,
}

impl<R: Real> Seen<R> {
    /// Returns `this` where `mask` is true, else `other`.
    #[inline(always)]
    pub(super) fn select(mask: R::Mask, this: Self, other: Self) -> Self {
        Self {
            direction: Vector::select(mask, this.direction, other.direction),
            distance: R::select(mask, this.distance, other.distance),
            cos: R::select(mask, this.cos, other.cos),
        }
    }

    /// Creates a point of a surface with this normal, seen from another point.
    #[inline(always)]
    pub(super) fn new(point: Vector<R>, normal: Vector<R>, from: Vector<R>) -> Self {
        Self::along(point - from, normal)
    }

    /// Creates a point of a surface with this normal, seen along `way`, the vector to it.
    #[inline(always)]
    pub(super) fn along(way: Vector<R>, normal: Vector<R>) -> Self {
        let distance = way.length();
        let direction = way / distance.max(distance.splat(f32::MIN_POSITIVE));
        Self {
            direction,
            distance,
            cos: -normal.dot(direction),
        }
    }

    /// Returns the density of directions to uniform points on a surface of this area.
    #[inline(always)]
    pub(super) fn density_by_area(&self, area: R) -> R {
        let least = area.splat(f32::MIN_POSITIVE);
        self.distance * self.distance / (area * self.cos.abs()).max(least)
    }

    /// Returns the sample for a uniform point on a surface of this area.
    #[inline(always)]
    pub(super) fn by_area(self, area: R) -> SurfaceSample<R> {
        SurfaceSample {
            density: self.density_by_area(area),
            seen: self,
        }
    }
}

/// Returns a point on the circle of this radius at a height.
#[inline(always)]
pub(super) fn on_circle<R: Real>(number: R, radius: R, height: R) -> [R; 3] {
    let [cos, sin] = cos_sin(number);
    [radius * cos, radius * sin, height]
}

/// Samples a point on the unit sphere uniformly.
#[inline(always)]
pub(super) fn on_unit_sphere<R: Real>([u, v]: [R; 2]) -> Vector<R> {
    let one = u.splat(1.0);
    let z = one - u.splat(2.0) * u;
    let radius = (one - z * z).max(u.splat(0.0)).sqrt();
    let [x, y, z] = on_circle(v, radius, z);
    Vector { x, y, z }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{
        Aabb, Capsule, Cone, Cuboid, Cylinder, Disk, Intersectable, Ray, Rectangle, Shape, Sphere,
        Triangle,
    };

    const N: u32 = 400;

    /// The samples of a grid in the unit square.
    fn samples(shape: &Shape, from: Vec3) -> impl Iterator<Item = SurfaceSample<f32>> {
        let parameters = shape.parameters();
        let kind = shape.kind();
        (0..N * N).map(move |i| {
            let numbers = [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32);
            kind.sample(&parameters, from.into(), numbers)
        })
    }

    /// The solid angle of a shape, by rays in all directions.
    fn solid_angle(shape: &Shape, origin: Vec3) -> f32 {
        let n = 1500;
        let hits = (0..n * n).filter(|i| {
            let numbers = [i / n, i % n].map(|k| (k as f32 + 0.5) / n as f32);
            let direction = on_unit_sphere(numbers).into();
            shape
                .intersect(&Ray { origin, direction }, f32::INFINITY)
                .is_some()
        });
        hits.count() as f32 * 4.0 * std::f32::consts::PI / (n * n) as f32
    }

    const ENDS: [Vec3; 2] = [Vec3::new(-0.5, 2.5, 0.0), Vec3::new(0.7, 3.0, 0.9)];

    fn shapes() -> Vec<Shape> {
        vec![
            Shape::Sphere(Sphere {
                center: Vec3::new(0.5, 2.0, 0.0),
                radius: 0.7,
            }),
            Shape::Disk(Disk {
                center: Vec3::new(0.0, 2.0, 1.0),
                normal: Vec3::new(0.6, 0.8, 0.0),
                radius: 0.8,
            }),
            Shape::Triangle(Triangle {
                vertices: [
                    Vec3::new(-1.0, 1.0, 0.0),
                    Vec3::new(1.0, 2.0, 0.3),
                    Vec3::new(0.0, 1.5, 2.0),
                ],
            }),
            Shape::Rectangle(Rectangle::new(
                Vec3::new(-0.5, 2.0, -1.0),
                Vec3::X,
                Vec3::new(0.0, 0.5, 1.5),
            )),
            // A parallelogram.
            Shape::Rectangle(Rectangle::new(
                Vec3::new(-0.5, 2.0, -1.0),
                Vec3::X,
                Vec3::new(0.5, 0.5, 1.5),
            )),
            Shape::Cuboid(Cuboid::new(Aabb {
                min: Vec3::new(-0.5, 1.0, 0.0),
                max: Vec3::new(0.5, 1.5, 1.2),
            })),
            Shape::Cylinder(Cylinder::new(ENDS, 0.6)),
            Shape::Cone(Cone::new(ENDS, [0.9, 0.0])),
            Shape::Cone(Cone::new(ENDS, [0.3, 0.8])),
            Shape::Capsule(Capsule::new(ENDS, [0.8, 0.3])),
            Shape::Capsule(Capsule::new(ENDS, [0.5, 0.5])),
            // One sphere within the other.
            Shape::Capsule(Capsule::new(ENDS, [0.1, 2.0])),
        ]
    }

    #[test]
    fn the_mean_of_reciprocal_densities_is_the_solid_angle() {
        for shape in shapes() {
            let from = Vec3::new(0.1, -0.2, 0.3);
            let n_hits = |sample: &SurfaceSample<f32>| {
                // A box is seen twice: only the near side counts as its solid angle.
                let ray = Ray {
                    origin: from,
                    direction: sample.seen.direction.into(),
                };
                let t = shape.intersect(&ray, f32::INFINITY);
                t.is_some_and(|t| (t - sample.seen.distance).abs() < 1e-3 * t)
            };
            let sum: f64 = samples(&shape, from)
                .filter(n_hits)
                .map(|sample| 1.0 / f64::from(sample.density))
                .sum();
            let mean = sum / f64::from(N * N);
            let expected = f64::from(solid_angle(&shape, from));
            assert!(
                (mean / expected - 1.0).abs() < 0.01,
                "{shape:?}: {mean} {expected}"
            );
        }
    }

    #[test]
    fn directions_to_a_rectangle_are_uniform() {
        let size = Vec3::new(3.0, 0.0, 2.0);
        for from in [
            [0.0, 0.4, 0.0],
            [1.4, -0.05, 0.3],
            [-4.0, 1.0, 2.5],
            [2.0, 0.3, -1.0],
        ] {
            let from = Vec3::from(from);
            let (u, v) = (size.x * Vec3::X, size.z * Vec3::Z);
            let shape = Shape::Rectangle(Rectangle::new(-0.5 * size, u, v));
            // The mean of the distance from the center has the same weights in both sums.
            let (mut by_directions, mut by_area, mut density) = (0.0, 0.0, 0.0);
            for sample in samples(&shape, from) {
                let at = from + sample.seen.distance * Vec3::from(sample.seen.direction);
                by_directions += f64::from(at.length()) / f64::from(sample.density);
                density = sample.density;
            }
            for i in 0..N * N {
                let [a, b] = [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32);
                let at = -0.5 * size + a * u + b * v;
                let seen = Seen::new(at.into(), Vec3::NEG_Y.into(), from.into());
                by_area +=
                    f64::from(at.length()) / f64::from(seen.density_by_area(size.x * size.z));
            }
            assert!(
                (by_directions / by_area - 1.0).abs() < 2e-3,
                "{from}: {by_directions} {by_area}"
            );
            let found = kind_density(&shape, from);
            assert!((found / density - 1.0).abs() < 1e-6, "{found} {density}");
        }
    }

    /// Returns the density of a sampled direction to a shape.
    fn kind_density(shape: &Shape, from: Vec3) -> f32 {
        let nowhere = Seen::new(Vec3::ZERO.into(), Vec3::Y.into(), from.into());
        let parameters = shape.parameters();
        shape.kind().density(&parameters, from.into(), &nowhere)
    }

    #[test]
    fn points_inside_see_the_whole_sphere_and_box() {
        let inside = [
            Shape::Sphere(Sphere {
                center: Vec3::ZERO,
                radius: 1.0,
            }),
            Shape::Cuboid(Cuboid::new(Aabb {
                min: Vec3::splat(-1.0),
                max: Vec3::new(1.0, 2.0, 1.0),
            })),
        ];
        for shape in inside {
            let from = Vec3::new(0.2, 0.3, -0.1);
            let sum: f64 = samples(&shape, from)
                .map(|sample| 1.0 / f64::from(sample.density))
                .sum();
            let mean = sum / f64::from(N * N);
            assert!(
                (mean / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.005,
                "{shape:?}: {mean}"
            );
        }
    }

    proptest! {
        #[test]
        fn densities_of_samples_are_those_of_their_directions(
            u in 0.0_f32..1.0, v in 0.0_f32..1.0, from in prop::array::uniform3(-3.0_f32..3.0),
        ) {
            let from = Vec3::from(from);
            let edges = [0.8 * Vec3::X, -0.8 * Vec3::Z];
            let far = Shape::Rectangle(Rectangle::new(Vec3::new(1.0, 12.0, 2.0), edges[0], edges[1]));
            for shape in shapes().into_iter().chain([far]) {
                let (kind, parameters) = (shape.kind(), shape.parameters());
                let sample = kind.sample(&parameters, from.into(), [u, v]);
                let found = kind.density(&parameters, from.into(), &sample.seen);
                prop_assert!((found / sample.density - 1.0).abs() < 1e-3, "{:?}: {} {}", shape, found, sample.density);
                let point = from + Vec3::from(sample.seen.direction) * sample.seen.distance;
                let (on_surface, normal) = shape.project(point);
                prop_assert!((on_surface - point).length() < 2e-3, "{:?}", shape);
                let cos = -normal.dot(sample.seen.direction.into());
                prop_assert!((cos - sample.seen.cos).abs() < 2e-2, "{:?}: {} {}", shape, cos, sample.seen.cos);
            }
        }
    }
}
