//! Colors from picture files.

mod mapping;
mod planar;
mod spherical;
mod triplanar;

use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use mapping::Mapping;
pub use planar::Planar;
pub use spherical::Spherical;
use triplanar::AxisProjection;
pub use triplanar::Triplanar;

use super::texture_point::TexturePoint;
use crate::color::Transfer;
use crate::geometry::RenderSpace;
use crate::picture::{Picture, Sampling, TexelFilter, Wrap};
use crate::values;
use math::simd::{DeviceTable, LookupTable, Real, Vector};

/// A picture on a surface.
///
/// ```
/// # use raycost_world::material::Texture;
/// let planks: Texture = scene::yaml::from_str("
/// image:
///   file: planks.png    # PNG, JPEG, Radiance HDR or OpenEXR, relative to the scene file
///   mapping: planar     # or uv, spherical, triplanar
///   size: [2, 0.5]      # of the picture: here in world units
///   wrap: repeat        # beyond its edges, or clamp, mirror
///   filter: trilinear   # between its texels, or bilinear, nearest
///   transfer: srgb      # what its numbers are, or linear
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a picture such as { file: planks.png }"
)]
pub struct ImageTexture {
    /// The file, relative to the scene file's folder.
    pub file: PathBuf,
    /// The mapping of the picture onto the surface.
    #[serde(default)]
    pub mapping: Mapping,
    /// Width and height of the picture in the units of the mapping; 1 by default.
    #[serde(default = "unit_size", with = "values::Size")]
    pub size: [f32; 2],
    /// The continuation of the picture beyond its edges.
    #[serde(default)]
    pub wrap: Wrap,
    /// The filter between the texels of the picture.
    #[serde(default)]
    pub filter: TexelFilter,
    /// The transfer function of the file's numbers; without it, the usual one of the format.
    #[serde(default)]
    pub transfer: Option<Transfer>,
    /// The coordinates of the picture at the origin of the mapping, in mesh files.
    #[serde(skip)]
    pub offset: [f32; 2],
    /// The factor of the picture's linear light, in mesh files.
    #[serde(skip, default = "white")]
    pub tint: Vec3,
    /// The picture: white until the file is read.
    #[serde(skip)]
    pub picture: Arc<Picture>,
}

fn unit_size() -> [f32; 2] {
    [1.0; 2]
}

fn white() -> Vec3 {
    Vec3::ONE
}

impl ImageTexture {
    /// Converts the mapping from world space to render space.
    pub(super) fn in_space(&mut self, space: &RenderSpace) {
        match &mut self.mapping {
            Mapping::Uv => return,
            Mapping::Spherical(sphere) => return sphere.in_space(space),
            Mapping::Planar(plane) => plane.in_space(space),
            Mapping::Triplanar(axes) => axes.in_space(space, self.size, self.wrap),
        }
        self.size = self.size.map(|length| space.length(length));
    }

    #[inline(always)]
    pub(super) fn color_at<R: Real>(&self, point: &TexturePoint<R>) -> Vector<R> {
        let [x, y, z, _] = self.values_at(point);
        Vector { x, y, z }.times(Vector::splat(x, self.tint))
    }

    /// Returns red, green, blue and opacity of the picture, without the tint, at a point.
    #[inline(always)]
    pub(super) fn values_at<R: Real>(&self, point: &TexturePoint<R>) -> [R; 4] {
        match &self.mapping {
            Mapping::Uv => self.look_up(point.uv, point.width * point.uv_density),
            Mapping::Planar(plane) => {
                let footprint = point.width * plane.density(point.normal);
                self.look_up(plane.uv(point.position), footprint)
            }
            Mapping::Spherical(sphere) => {
                let footprint = point.width * sphere.density(point.position);
                self.look_up(sphere.uv(point.position), footprint)
            }
            Mapping::Triplanar(axes) => self.blend(axes.projections(point)),
        }
    }

    /// Returns the vector of a normal map at a point, of any length. The picture's axes lie in the
    /// plane of the point's normal.
    #[inline(always)]
    pub(super) fn tilted<R: Real>(&self, point: &TexturePoint<R>, strength: f32) -> Vector<R> {
        let normal = point.normal;
        match &self.mapping {
            Mapping::Triplanar(axes) => {
                let mut sum = Vector::splat(normal.x, Vec3::ZERO);
                for projection in axes.projections(point) {
                    let values = self.look_up(projection.uv, projection.footprint);
                    let tilted = from_tangent_space(values, projection.axes, normal, strength);
                    sum = sum + tilted * projection.weight;
                }
                sum
            }
            Mapping::Uv => {
                let [right, up] = point.uv_axes;
                let [width, height] = self.size.map(f32::signum);
                let (across, along) = (point.width.splat(width), point.width.splat(height));
                let axes = [right * across, up * along];
                from_tangent_space(self.values_at(point), axes, normal, strength)
            }
            Mapping::Planar(plane) => {
                let axes = plane.axes(normal.x);
                from_tangent_space(self.values_at(point), axes, normal, strength)
            }
            Mapping::Spherical(sphere) => {
                let axes = sphere.axes(point.position);
                from_tangent_space(self.values_at(point), axes, normal, strength)
            }
        }
    }

    /// Returns the weighted mean of the picture's projections.
    #[inline(always)]
    fn blend<R: Real>(&self, projections: [AxisProjection<R>; 3]) -> [R; 4] {
        let zero = projections[0].weight.splat(0.0);
        let mut mean = [zero; 4];
        for projection in projections {
            let values = self.look_up(projection.uv, projection.footprint);
            for channel in 0..mean.len() {
                mean[channel] = mean[channel] + values[channel] * projection.weight;
            }
        }
        mean
    }

    /// Looks up the picture at coordinates of the mapping, filtered over a square of this side
    /// there.
    #[inline(always)]
    fn look_up<R: Real>(&self, [u, v]: [R; 2], footprint: R) -> [R; 4] {
        let ([width, height], [x, y]) = (self.size, self.offset);
        let side = footprint.splat((width * height).abs().sqrt());
        let place = [
            u / u.splat(width) + u.splat(x),
            v / v.splat(height) + v.splat(y),
        ];
        R::look_up(self, [place[0], place[1], footprint / side])
    }
}

/// Converts a vector from tangent space: its coordinates, from -1 at a value of 0 to 1, are along
/// the picture's axes right and up, projected perpendicular to the normal, and along the normal.
#[inline(always)]
fn from_tangent_space<R: Real>(
    [r, g, b, _]: [R; 4],
    [right, up]: [Vector<R>; 2],
    normal: Vector<R>,
    strength: f32,
) -> Vector<R> {
    let none = Vector::splat(r, Vec3::ZERO);
    let (two, one, strength) = (r.splat(2.0), r.splat(1.0), r.splat(strength));
    let right = (right - normal * normal.dot(right)).normalize_or(none);
    let up = up - normal * normal.dot(up);
    let up = (up - right * right.dot(up)).normalize_or(none);
    right * (strength * (two * r - one))
        + up * (strength * (two * g - one))
        + normal * (two * b - one)
}

impl LookupTable<3, 4> for ImageTexture {
    #[inline]
    fn values_at(&self, [u, v, footprint]: [f32; 3]) -> [f32; 4] {
        let sampling = Sampling {
            filter: self.filter,
            wrap: self.wrap,
        };
        self.picture.at(sampling, [u, v], footprint)
    }

    /// The filter, the continuation, then the picture.
    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        let head = [self.filter as u32, self.wrap as u32].into_iter();
        Ok(DeviceTable {
            function: "image_texture",
            words: head.chain(self.picture.words()?).collect(),
        })
    }
}
