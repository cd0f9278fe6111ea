//! Objects of many shapes, from a rule of one line.

use std::fmt;

use glam::{UVec3, Vec3};
use serde::Deserialize;
use serde::de::{Deserializer, Error as _, MapAccess, Unexpected};

use crate::geometry::Sphere;
use crate::sampling::uniform;
use crate::yaml;

/// Most shapes that one generator makes.
const MAX_SHAPES: u32 = 1_000_000_000;

/// A rule that makes many spheres.
#[derive(Debug, Clone, PartialEq)]
pub enum Generator {
    /// Spheres at random places in a box.
    SphereCloud(SphereCloud),
    /// Spheres in rows.
    SphereGrid(SphereGrid),
}

impl Generator {
    /// The YAML keys of all rules.
    pub const KEYS: &[&str] = &["sphere_cloud", "sphere_grid"];

    /// Reads the value behind `key`, one of [`Self::KEYS`], from `map`; `None`
    /// for another key.
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

    /// How many spheres it makes.
    pub fn n_spheres(&self) -> usize {
        match self {
            Self::SphereCloud(cloud) => cloud.count as usize,
            Self::SphereGrid(grid) => grid.counts.as_u64vec3().element_product() as usize,
        }
    }

    /// Sphere `i`, from 0 to [`n_spheres`](Self::n_spheres) - 1, and which of
    /// `n_materials` materials it gets.
    pub fn sphere(&self, i: usize, n_materials: usize) -> (Sphere, usize) {
        match self {
            Self::SphereCloud(cloud) => cloud.sphere(i, n_materials),
            Self::SphereGrid(grid) => (grid.sphere(i), i % n_materials),
        }
    }
}

/// The YAML key.
impl fmt::Display for Generator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SphereCloud(_) => "sphere_cloud",
            Self::SphereGrid(_) => "sphere_grid",
        })
    }
}

/// Spheres with centres uniform in a box, radii uniform in a range and
/// materials dealt out at random: the same ones for the same seed.
///
/// ```
/// # use raycost::config::SphereCloud;
/// let cloud: SphereCloud = raycost::yaml::from_str("
/// { count: 10000, min: [-5, 0, -5], max: [5, 2, 5], radius: [0.02, 0.06], seed: 1 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereCloud {
    /// How many spheres, at least 1.
    #[serde(deserialize_with = "yaml::count::<_, MAX_SHAPES>")]
    pub count: u32,
    /// One corner of the box of the centres.
    #[serde(deserialize_with = "yaml::point")]
    pub min: Vec3,
    /// The other corner.
    #[serde(deserialize_with = "yaml::point")]
    pub max: Vec3,
    /// Least and greatest radius, or one for all.
    #[serde(deserialize_with = "yaml::positive_range")]
    pub radius: [f32; 2],
    /// Seed of places, radii and materials; 0 if not given.
    #[serde(deserialize_with = "yaml::seed", default)]
    pub seed: u64,
}

impl SphereCloud {
    /// Makes so many spheres, at least 1, that fill the same share of space.
    pub(super) fn set_count(&mut self, count: u32) {
        let scale = (f64::from(self.count) / f64::from(count)).cbrt() as f32;
        self.radius = self.radius.map(|radius| radius * scale);
        self.count = count;
    }

    fn sphere(&self, i: usize, n_materials: usize) -> (Sphere, usize) {
        let [x, y, z, r] = uniform([self.seed, i as u64, 0]);
        let [m, ..] = uniform([self.seed, i as u64, 1]);
        let [least, greatest] = self.radius;
        let sphere = Sphere {
            center: self.min + (self.max - self.min) * Vec3::new(x, y, z),
            radius: least + (greatest - least) * r,
        };
        (sphere, (m * n_materials as f32) as usize)
    }
}

/// Spheres in a rectangular grid, x fastest, materials in turn.
///
/// ```
/// # use raycost::config::SphereGrid;
/// let grid: SphereGrid = raycost::yaml::from_str("
/// { counts: [10, 1, 10], min: [-5, 0, -5], max: [5, 0, 5], radius: 0.4 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereGrid {
    /// How many spheres along x, y and z, each at least 1.
    #[serde(deserialize_with = "counts")]
    pub counts: UVec3,
    /// The first sphere's centre.
    #[serde(deserialize_with = "yaml::point")]
    pub min: Vec3,
    /// The last sphere's centre.
    #[serde(deserialize_with = "yaml::point")]
    pub max: Vec3,
    /// The radius of all, greater than 0.
    #[serde(deserialize_with = "yaml::positive")]
    pub radius: f32,
}

impl SphereGrid {
    fn sphere(&self, i: usize) -> Sphere {
        let [nx, ny, _] = self.counts.to_array().map(|n| n as usize);
        let cell = [i % nx, i / nx % ny, i / (nx * ny)].map(|n| n as f32);
        let steps = self.counts.saturating_sub(UVec3::ONE).max(UVec3::ONE);
        let center = self.min + (self.max - self.min) * Vec3::from(cell) / steps.as_vec3();
        Sphere {
            center,
            radius: self.radius,
        }
    }
}

/// `[nx, ny, nz]`, their product at most [`MAX_SHAPES`].
fn counts<'de, D: Deserializer<'de>>(d: D) -> Result<UVec3, D::Error> {
    #[derive(Deserialize)]
    struct Count(#[serde(deserialize_with = "yaml::count::<_, MAX_SHAPES>")] u32);

    let counts = <[Count; 3]>::deserialize(d)?.map(|Count(n)| n);
    let product = counts
        .iter()
        .try_fold(1_u32, |product, &n| product.checked_mul(n));
    match product {
        Some(n) if n <= MAX_SHAPES => Ok(counts.into()),
        _ => Err(D::Error::invalid_value(
            Unexpected::Other("more than 1,000,000,000 spheres"),
            &"three counts with a smaller product",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloud_stays_in_its_box_and_deals_out_all_materials() {
        let cloud = SphereCloud {
            count: 1000,
            min: Vec3::new(-1.0, 2.0, 5.0),
            max: Vec3::new(1.0, 3.0, 9.0),
            radius: [0.1, 0.2],
            seed: 4,
        };
        let mut dealt = [0; 3];
        for i in 0..1000 {
            let (sphere, material) = cloud.sphere(i, 3);
            assert!(sphere.center.cmpge(cloud.min).all() && sphere.center.cmple(cloud.max).all());
            assert!((0.1..=0.2).contains(&sphere.radius));
            dealt[material] += 1;
        }
        assert!(dealt.iter().all(|n| (250..420).contains(n)), "{dealt:?}");
    }

    #[test]
    fn a_grid_reaches_from_corner_to_corner() {
        let grid = Generator::SphereGrid(SphereGrid {
            counts: UVec3::new(3, 1, 2),
            min: Vec3::ZERO,
            max: Vec3::new(4.0, 7.0, 1.0),
            radius: 0.5,
        });
        let centers: Vec<Vec3> = (0..grid.n_spheres())
            .map(|i| grid.sphere(i, 1).0.center)
            .collect();
        assert_eq!(centers.len(), 6);
        assert_eq!(centers[1], Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(centers[5], Vec3::new(4.0, 0.0, 1.0));
    }
}
