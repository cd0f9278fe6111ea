//! Shapes as cells of a mesh, for viewers.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::{InstanceTransform, Transform};

/// Number of corners of the polygon that approximates a circle.
const N_CORNERS: usize = 32;
/// Number of bands, from pole to pole, of the strip that approximates an ellipsoid.
const N_BANDS: usize = 12;

/// The cell that a viewer draws for a shape, in terms of its corners.
#[derive(Debug, Clone, PartialEq)]
pub enum Patch {
    /// A sphere, given only by its center and radius: viewers draw many of them as points.
    Ball {
        /// The center.
        center: Vec3,
        /// The radius.
        radius: f32,
    },
    /// A triangle.
    Triangle([Vec3; 3]),
    /// A flat polygon, its corners in order.
    Polygon(Vec<Vec3>),
    /// A box: the four corners of one face in order, then the adjacent corners of the opposite
    /// face.
    Box([Vec3; 8]),
    /// A triangle strip: one triangle for each three consecutive corners.
    Strip(Vec<Vec3>),
}

impl Patch {
    /// Returns the polygon that approximates a disk around `center` with this unit normal.
    pub(super) fn disk(center: Vec3, normal: Vec3, radius: f32) -> Self {
        let (u, v) = normal.any_orthonormal_pair();
        let corner = |i: usize| {
            let (sin, cos) = (TAU * i as f32 / N_CORNERS as f32).sin_cos();
            center + radius * (cos * u + sin * v)
        };
        Self::Polygon((0..N_CORNERS).map(corner).collect())
    }

    /// Returns the strip that approximates a surface of revolution, given the distances of circles
    /// from the center along the axis between two ends, and their radii.
    pub(super) fn turned(
        [from, to]: [Vec3; 2],
        circles: impl IntoIterator<Item = [f32; 2]>,
    ) -> Self {
        let axis = (to - from).normalize_or(Vec3::Y);
        let center = 0.5 * from + 0.5 * to;
        let (u, v) = axis.any_orthonormal_pair();
        let corner = |[along, radius]: [f32; 2], i: usize| {
            let (sin, cos) = (TAU * (i % N_TURNED) as f32 / N_TURNED as f32).sin_cos();
            center + along * axis + radius * (cos * v + sin * u)
        };
        let circles: Vec<[f32; 2]> = circles.into_iter().collect();
        let bands = circles.windows(2);
        let corners = bands.flat_map(|band| {
            (0..=N_TURNED).flat_map(move |i| [corner(band[0], i), corner(band[1], i)])
        });
        Self::Strip(corners.collect())
    }

    /// Returns the corners.
    pub fn corners(&self) -> &[Vec3] {
        match self {
            Self::Ball { center, .. } => std::slice::from_ref(center),
            Self::Triangle(corners) => corners,
            Self::Box(corners) => corners,
            Self::Polygon(corners) | Self::Strip(corners) => corners,
        }
    }

    /// Returns the triangles of the cell, in any orientation; none for a ball.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        match self {
            Self::Ball { .. } => Vec::new(),
            Self::Triangle(corners) => vec![*corners],
            Self::Polygon(corners) => fan(corners).collect(),
            Self::Box([a, b, c, d, e, f, g, h]) => [
                [a, b, c, d],
                [e, f, g, h],
                [a, b, f, e],
                [b, c, g, f],
                [c, d, h, g],
                [d, a, e, h],
            ]
            .iter()
            .flat_map(|face| fan(&face.map(|corner| *corner)).collect::<Vec<_>>())
            .collect(),
            Self::Strip(corners) => corners.windows(3).map(|at| [at[0], at[1], at[2]]).collect(),
        }
    }

    /// Transforms a triangle to the placement of an instance.
    pub fn placed(self, place: &InstanceTransform) -> Self {
        let Self::Triangle(corners) = self else {
            return self;
        };
        let placed = Self::Triangle(corners.map(|corner| place.world_point(corner)));
        if place.is_mirrored() {
            placed.reversed()
        } else {
            placed
        }
    }

    /// Returns the image under the transform.
    pub fn transformed(self, transform: &Transform) -> Self {
        let place = |corner| transform.world_point(corner);
        let place_all = |corners: Vec<Vec3>| corners.into_iter().map(place).collect();
        let placed = match self {
            Self::Ball { center, radius } => Self::Strip(place_all(strip(center, radius))),
            Self::Triangle(corners) => Self::Triangle(corners.map(place)),
            Self::Box(corners) => Self::Box(corners.map(place)),
            Self::Polygon(corners) => Self::Polygon(place_all(corners)),
            Self::Strip(corners) => Self::Strip(place_all(corners)),
        };
        if transform.is_mirrored() {
            placed.reversed()
        } else {
            placed
        }
    }

    /// Returns the same cell with the opposite orientation.
    fn reversed(self) -> Self {
        match self {
            Self::Ball { .. } => self,
            Self::Triangle([a, b, c]) => Self::Triangle([a, c, b]),
            Self::Box([a, b, c, d, e, f, g, h]) => Self::Box([e, f, g, h, a, b, c, d]),
            Self::Polygon(corners) => Self::Polygon(corners.into_iter().rev().collect()),
            Self::Strip(mut corners) => {
                // A triangle without area changes the turn of all others.
                corners.insert(0, corners[0]);
                Self::Strip(corners)
            }
        }
    }
}

/// Number of corners of the polygon that approximates a circle around an axis.
const N_TURNED: usize = 16;

/// Returns the triangles of a convex polygon.
fn fan(corners: &[Vec3]) -> impl Iterator<Item = [Vec3; 3]> {
    corners
        .windows(2)
        .skip(1)
        .map(|pair| [corners[0], pair[0], pair[1]])
}

/// Returns one strip around a sphere, from pole to pole, band by band.
fn strip(center: Vec3, radius: f32) -> Vec<Vec3> {
    let corner = |circle: usize, i: usize| {
        let (sin_polar, cos_polar) = (PI * circle as f32 / N_BANDS as f32).sin_cos();
        let (sin, cos) = (TAU * (i % N_CORNERS) as f32 / N_CORNERS as f32).sin_cos();
        center + radius * Vec3::new(sin_polar * cos, cos_polar, sin_polar * sin)
    };
    let pair = |band, i| [corner(band, i), corner(band + 1, i)];
    (0..N_BANDS)
        .flat_map(|band| (0..=N_CORNERS).rev().flat_map(move |i| pair(band, i)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Disk, Intersectable};

    /// Twice the areas of the strip's triangles, as vectors: every second triangle has the opposite
    /// orientation.
    fn double_areas(strip: &[Vec3]) -> impl Iterator<Item = Vec3> + '_ {
        strip.windows(3).enumerate().map(|(i, corners)| {
            let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if i % 2 == 0 { area } else { -area }
        })
    }

    #[test]
    fn a_strip_covers_the_sphere_once() {
        let strip = strip(Vec3::ONE, 2.0);
        assert!(
            strip
                .iter()
                .all(|c| (c.distance(Vec3::ONE) - 2.0).abs() < 1e-5)
        );
        let outward = double_areas(&strip).zip(strip.windows(3));
        let mut cosines = outward.map(|(area, corners)| area.dot(corners[1] - Vec3::ONE));
        assert!(cosines.all(|cosine| cosine > -1e-5));
        let closed: Vec3 = double_areas(&strip).sum();
        assert!(closed.length() < 1e-3, "{closed}");
        let area: f32 = double_areas(&strip).map(Vec3::length).sum::<f32>() / 2.0;
        assert!((0.96..1.0).contains(&(area / (4.0 * PI * 4.0))), "{area}");
    }

    #[test]
    fn a_disk_is_as_large_as_its_bounds() {
        let disk = Disk {
            center: Vec3::ONE,
            normal: Vec3::new(0.6, 0.0, 0.8),
            radius: 2.0,
        };
        let patch = disk.patch().unwrap();
        let found = Aabb::from_points(patch.corners().iter().copied());
        let bounds = disk.bounds();
        assert!(found.min.abs_diff_eq(bounds.min, 0.02));
        assert!(found.max.abs_diff_eq(bounds.max, 0.02));
    }
}
