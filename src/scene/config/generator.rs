//! Generators: objects of many shapes, described by a few parameters.

use std::fmt;
use std::marker::PhantomData;

use glam::{DVec3, UVec3, Vec3};
use schemars::JsonSchema;
use serde::de::MapAccess;
use serde::{Deserialize, Serialize};

use math::sampling::uniform;
use world::geometry::{Located, Sphere, located};
use world::kinds;
use world::values;

/// Maximum number of shapes of one generator.
pub const MAX_SHAPES: u32 = 1_000_000_000;

/// A procedural set of spheres.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Generator {
    /// Spheres at random positions in a box.
    SphereCloud(SphereCloud),
    /// Spheres on a regular grid.
    SphereGrid(SphereGrid),
}

impl Generator {
    /// The YAML keys of all generators.
    pub const KEYS: &[&str] = &["sphere_cloud", "sphere_grid"];

    /// Reads the value of `key` from `map`; returns `None` if `key` is not one of
    /// [`Self::KEYS`].
    pub fn next_value<'de, A: MapAccess<'de>>(
        key: &str,
        map: &mut A,
    ) -> Result<Option<Self>, A::Error> {
        match key {
            "sphere_cloud" => map.next_value().map(|cloud| Some(Self::SphereCloud(cloud))),
            "sphere_grid" => map.next_value().map(|grid| Some(Self::SphereGrid(grid))),
            _ => Ok(None),
        }
    }

    /// Returns the number of spheres.
    pub fn n_spheres(&self) -> usize {
        match self {
            Self::SphereCloud(cloud) => cloud.count as usize,
            Self::SphereGrid(grid) => grid.counts.as_u64vec3().element_product() as usize,
        }
    }

    /// Returns the corners of the box of the centers, around the origin of the spheres.
    pub fn corners(&self) -> Located<[Vec3; 2]> {
        located(match self {
            Self::SphereCloud(cloud) => [cloud.min, cloud.max],
            Self::SphereGrid(grid) => [grid.min, grid.max],
        })
    }

    /// Returns the greatest radius.
    pub fn max_radius(&self) -> f32 {
        match self {
            Self::SphereCloud(cloud) => cloud.radius[1],
            Self::SphereGrid(grid) => grid.radius,
        }
    }

    /// Returns sphere `i`, from 0 to [`n_spheres`](Self::n_spheres) - 1, and the index of its
    /// material among `n_materials`. `corners` come from [`corners`](Self::corners).
    pub fn sphere(&self, corners: [Vec3; 2], i: usize, n_materials: usize) -> (Sphere, usize) {
        match self {
            Self::SphereCloud(cloud) => cloud.sphere(corners, i, n_materials),
            Self::SphereGrid(grid) => (grid.sphere(corners, i), i % n_materials),
        }
    }
}

/// Formats the YAML key.
impl fmt::Display for Generator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SphereCloud(_) => "sphere_cloud",
            Self::SphereGrid(_) => "sphere_grid",
        })
    }
}

/// Spheres with random centers in a box, random radii in a range and random
/// materials, all uniformly distributed. The same seed gives the same spheres.
///
/// ```
/// # use raycost_scene::config::SphereCloud;
/// let cloud: SphereCloud = raycost_scene::yaml::from_str("
/// { count: 10000, min: [-5, 0, -5], max: [5, 2, 5], radius: [0.02, 0.06], seed: 1 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereCloud {
    /// The number of spheres, at least 1.
    #[serde(with = "values::Count::<MAX_SHAPES>")]
    pub count: u32,
    /// One corner of the box of the centers.
    #[serde(with = "values::Point")]
    pub min: DVec3,
    /// The opposite corner.
    #[serde(with = "values::Point")]
    pub max: DVec3,
    /// Least and greatest radius, or a single one for all.
    #[serde(with = "values::PositiveRange")]
    pub radius: [f32; 2],
    /// The seed of centers, radii and materials; 0 if not given.
    #[serde(with = "values::Unsigned", default)]
    pub seed: u64,
}

impl SphereCloud {
    /// Sets the number of spheres, at least 1, and scales their radii so that
    /// they fill the same share of the box.
    pub(super) fn set_count(&mut self, count: u32) {
        let scale = (f64::from(self.count) / f64::from(count)).cbrt() as f32;
        self.radius = self.radius.map(|radius| radius * scale);
        self.count = count;
    }

    fn sphere(&self, [min, max]: [Vec3; 2], i: usize, n_materials: usize) -> (Sphere, usize) {
        let [x, y, z, r] = uniform([self.seed, i as u64, 0]);
        let [m, ..] = uniform([self.seed, i as u64, 1]);
        let [least, greatest] = self.radius;
        let sphere = Sphere {
            center: min + (max - min) * Vec3::new(x, y, z),
            radius: least + (greatest - least) * r,
        };
        (sphere, (m * n_materials as f32) as usize)
    }
}

/// Spheres on a rectangular grid, x fastest; materials alternate.
///
/// ```
/// # use raycost_scene::config::SphereGrid;
/// let grid: SphereGrid = raycost_scene::yaml::from_str("
/// { counts: [10, 1, 10], min: [-5, 0, -5], max: [5, 0, 5], radius: 0.4 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereGrid {
    /// The number of spheres along x, y and z, each at least 1.
    #[serde(with = "Counts")]
    pub counts: UVec3,
    /// The center of the first sphere.
    #[serde(with = "values::Point")]
    pub min: DVec3,
    /// The center of the last sphere.
    #[serde(with = "values::Point")]
    pub max: DVec3,
    /// The radius of all spheres, greater than 0.
    #[serde(with = "values::Positive")]
    pub radius: f32,
}

impl SphereGrid {
    fn sphere(&self, [min, max]: [Vec3; 2], i: usize) -> Sphere {
        let [nx, ny, _] = self.counts.to_array().map(|n| n as usize);
        let cell = [i % nx, i / nx % ny, i / (nx * ny)].map(|n| n as f32);
        let steps = self.counts.saturating_sub(UVec3::ONE).max(UVec3::ONE);
        let center = min + (max - min) * Vec3::from(cell) / steps.as_vec3();
        Sphere {
            center,
            radius: self.radius,
        }
    }
}

/// The number along an axis.
#[derive(Deserialize, JsonSchema)]
struct AxisCount(#[serde(with = "values::Count::<MAX_SHAPES>")] u32);

kinds! {
    /// The numbers along each axis, with a product of at most [`MAX_SHAPES`].
    Counts: UVec3 = PhantomData::<[AxisCount; 3]>, |counts| {
        let product = counts.iter().try_fold(1_u32, |product, n| product.checked_mul(n.0));
        let is_allowed = product.is_some_and(|n| n <= MAX_SHAPES);
        is_allowed.then(|| counts.map(|AxisCount(n)| n).into()).ok_or(
            "invalid value: more than 1,000,000,000 spheres, \
             expected three counts with a smaller product",
        )
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloud_stays_in_its_box_and_uses_all_materials_equally() {
        let cloud = SphereCloud {
            count: 1000,
            min: DVec3::new(-1.0, 2.0, 5.0),
            max: DVec3::new(1.0, 3.0, 9.0),
            radius: [0.1, 0.2],
            seed: 4,
        };
        let mut n_of_material = [0; 3];
        for i in 0..1000 {
            let [min, max] = [cloud.min, cloud.max].map(|corner| corner.as_vec3());
            let (sphere, material) = cloud.sphere([min, max], i, 3);
            assert!(sphere.center.cmpge(min).all() && sphere.center.cmple(max).all());
            assert!((0.1..=0.2).contains(&sphere.radius));
            n_of_material[material] += 1;
        }
        let is_even = n_of_material.iter().all(|n| (250..420).contains(n));
        assert!(is_even, "{n_of_material:?}");
    }

    #[test]
    fn a_grid_reaches_from_corner_to_corner() {
        let grid = Generator::SphereGrid(SphereGrid {
            counts: UVec3::new(3, 1, 2),
            min: DVec3::ZERO,
            max: DVec3::new(4.0, 7.0, 1.0),
            radius: 0.5,
        });
        let centers: Vec<Vec3> = (0..grid.n_spheres())
            .map(|i| grid.sphere(grid.corners().geometry, i, 1).0.center)
            .collect();
        assert_eq!(centers.len(), 6);
        assert_eq!(centers[1], Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(centers[5], Vec3::new(4.0, 0.0, 1.0));
    }
}
