//! A picture of everything around the scene.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::color::Transfer;
use crate::picture::Picture;
use crate::values;
use math::simd::{Arithmetic, DeviceTable, LookupTable, Real, Vector, cos_sin, turns_of};

/// An equirectangular picture around the scene, as a [panorama camera](crate::camera::Panorama)
/// sees it: columns are at equal steps of longitude around +y, rows of latitude, with the top row
/// at +y. Its middle column is at -z, and columns to its right turn toward +x.
///
/// ```
/// # use raycost_world::background::Background;
/// let sky: Background = scene::yaml::from_str("
/// environment_map:
///   file: sky.hdr       # PNG, JPEG, Radiance HDR or OpenEXR, relative to the scene file
///   rotation_deg: 90    # about +y: the middle column is at -x
///   intensity: 0.5      # a factor on its colors
///   transfer: linear    # what its numbers are, or srgb
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(deny_unknown_fields, expecting = "a picture such as { file: sky.hdr }")]
pub struct EnvironmentMap {
    /// The file, relative to the scene file's folder.
    pub file: PathBuf,
    /// The rotation about +y in degrees, counterclockwise as seen from above; 0 by default.
    #[serde(default, with = "values::Coordinate")]
    pub rotation_deg: f32,
    /// A factor on the colors, at least 0; 1 by default.
    #[serde(default = "values::one", with = "values::NonNegative")]
    pub intensity: f32,
    /// The transfer function of the file's numbers; without it, the usual one of the format.
    #[serde(default)]
    pub transfer: Option<Transfer>,
    /// The picture: white until the file is read.
    #[serde(skip)]
    pub picture: Arc<Picture>,
}

/// Maximum radiance, as for any other light.
const MAX_RADIANCE: f32 = 1e15;

impl EnvironmentMap {
    /// Returns the radiance from a direction, a unit vector.
    #[inline(always)]
    pub fn radiance<R: Real>(&self, direction: Vector<R>) -> Vector<R> {
        let [x, y, z] = R::look_up(self, self.place(direction));
        Vector { x, y, z }
    }

    /// Returns the radiance for a number of the picture.
    #[inline(always)]
    pub fn brightness(&self, number: f32) -> f32 {
        Arithmetic::min(number * self.intensity, MAX_RADIANCE)
    }

    /// Returns the position of a direction in the picture: from 0 at the left edge to 1 at the
    /// right edge, plus any whole number, and from 0 at the lower edge to 1 at the upper edge.
    #[inline(always)]
    pub fn place<R: Real>(&self, Vector { x, y, z }: Vector<R>) -> [R; 2] {
        let half = x.splat(0.5);
        let around = (x * x + z * z).sqrt();
        [
            half + turns_of([-z, x]) + half.splat(self.turns()),
            half + half.splat(2.0) * turns_of([around, y]),
        ]
    }

    /// Returns the direction at a column's [place](Self::place) and a height, the sine of the
    /// latitude.
    #[inline(always)]
    pub fn direction<R: Real>(&self, column: R, height: R) -> Vector<R> {
        let (zero, one) = (height.splat(0.0), height.splat(1.0));
        let [cos, sin] = cos_sin(column - column.splat(0.5 + self.turns()));
        let around = (one - height * height).max(zero).sqrt();
        Vector {
            x: around * sin,
            y: height,
            z: -around * cos,
        }
    }

    /// Returns the rotation in turns, from 0 to 1.
    #[inline(always)]
    fn turns(&self) -> f32 {
        (f64::from(self.rotation_deg) / 360.0).rem_euclid(1.0) as f32
    }
}

/// Returns the radiance at a position in the picture.
impl LookupTable<2, 3> for EnvironmentMap {
    #[inline]
    fn values_at(&self, place: [f32; 2]) -> [f32; 3] {
        let [r, g, b, _] = self.picture.around(place);
        [self.brightness(r), self.brightness(g), self.brightness(b)]
    }

    /// The factor and the maximum of the radiance, then the picture.
    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        let head = [self.intensity, MAX_RADIANCE].map(f32::to_bits);
        Ok(DeviceTable {
            function: "environment_map",
            words: head.into_iter().chain(self.picture.words()?).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::picture::Texels;

    /// A map of 8 x 4 texels, with the column's number as red and the row's number as green.
    fn map(rotation_deg: f32) -> EnvironmentMap {
        let texel = |i: u8| [f32::from(i % 8), f32::from(i / 8), 1.0, 1.0];
        let texels = Texels::Floats((0..32).map(texel).collect());
        EnvironmentMap {
            file: PathBuf::new(),
            rotation_deg,
            intensity: 2.0,
            transfer: None,
            picture: Arc::new(Picture::new([8, 4], texels).unwrap()),
        }
    }

    #[test]
    fn directions_are_those_of_a_panorama() {
        for (rotation_deg, direction, expected) in [
            (0.0, Vec3::NEG_Z, [3.5, 1.5]),
            (0.0, Vec3::X, [5.5, 1.5]),
            (0.0, Vec3::NEG_X, [1.5, 1.5]),
            (90.0, Vec3::NEG_X, [3.5, 1.5]),
            (-450.0, Vec3::X, [3.5, 1.5]),
            // Between the first column and the last.
            (0.0, Vec3::Z, [3.5, 1.5]),
            (0.0, Vec3::new(0.0, 1.0, -1e-3), [3.5, 0.0]),
            (0.0, Vec3::new(0.0, -1.0, -1e-3), [3.5, 3.0]),
        ] {
            let map = map(rotation_deg);
            let found = Vec3::from(map.radiance(direction.normalize().into()));
            let expected = 2.0 * Vec3::new(expected[0], expected[1], 1.0);
            assert!(found.abs_diff_eq(expected, 1e-3), "{direction}: {found}");
        }
    }

    #[test]
    fn a_direction_of_a_place_is_at_that_place() {
        for rotation_deg in [0.0, 30.0, -1e4] {
            let map = map(rotation_deg);
            for i in 0..1000_u16 {
                let [column, height] = [f32::from(i) / 1000.0, f32::from(i) / 510.0 - 0.97];
                let direction = map.direction(column, height);
                let [u, v] = map.place(direction);
                let off = (u - column).abs().fract();
                assert!(off.min(1.0 - off) < 1e-6, "{column}: {u}");
                let latitude = std::f32::consts::PI * (v - 0.5);
                assert!((latitude.sin() - height).abs() < 1e-6, "{height}: {v}");
            }
        }
    }
}
