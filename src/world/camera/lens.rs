//! The thin lens of a perspective camera.
//!
//! All rays of a pixel meet at one point of the plane in focus. Points in front of it and beyond it
//! become blur circles: a point at depth `d` fills a circle of diameter `2 radius |d - focus| / d`
//! on the plane in focus.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::basis::Basis;
use crate::geometry::RenderSpace;
use crate::kinds;
use crate::values::{self, Number, Whole};
use math::sampling::{Polygon, disk};
use math::simd::{Real, Vector};

/// Height of a photographic film frame in meters: the 36 x 24 mm format.
pub(super) const FRAME_HEIGHT: f32 = 0.024;

/// A thin lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// The radius, greater than 0.
    pub radius: f32,
    /// The distance from the lens to the plane in focus, greater than 0.
    pub focus_distance: f32,
    /// The shape of the aperture; `None` for a round one.
    blades: Option<Polygon>,
    basis: Basis,
}

/// The scene file's `lens`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(
    try_from = "LensFields",
    into = "LensFields",
    expecting = "a lens such as { radius: 0.05 }"
)]
pub(super) struct LensKeys {
    size: LensSize,
    focus: Focus,
    blades: u32,
    rotation_deg: f32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum LensSize {
    /// Radius in world units, at least 0.
    Radius(f32),
    /// Ratio of the focal length to the diameter.
    FNumber(f32),
}

/// The point in focus.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Focus {
    /// The target of the camera.
    Target,
    /// The plane at this distance from the lens.
    Distance(f32),
    /// The plane through this point.
    Point(DVec3),
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(deny_unknown_fields, expecting = "a lens such as { radius: 0.05 }")]
#[cfg_attr(
    feature = "schema",
    schemars(
        transform = values::exactly_one("radius f_number"),
        transform = values::at_most_one("focus_distance focus_point"),
    )
)]
struct LensFields {
    /// The radius of the lens in world units; 0 is a pinhole.
    #[serde(default, with = "values::NonNegative")]
    radius: Option<f32>,
    /// Instead of the radius: the focal length divided by the diameter.
    #[serde(default, with = "FNumber")]
    f_number: Option<f32>,
    /// The distance of the plane in focus from the eye, in world units.
    #[serde(default, with = "values::Positive")]
    focus_distance: Option<f32>,
    /// Instead of the distance: a point of the plane in focus; the target if neither is given.
    #[serde(default, with = "values::Point")]
    focus_point: Option<DVec3>,
    /// The number of corners of the aperture, 3 to 32; 0 for a circle, as if not given.
    #[serde(default, with = "Blades")]
    #[cfg_attr(
        feature = "schema",
        schemars(
            with = "values::Either<values::Between<0, 0>, values::Between<3, 32>>",
            extend("expected" = "3 to 32, or 0 for a round one"),
        )
    )]
    blades: u32,
    /// The rotation of the aperture in degrees, counterclockwise; at 0 a corner is on top.
    #[serde(default, with = "values::Coordinate")]
    rotation_deg: f32,
}

kinds! {
    FNumber: f32 = Number { expected: "an f-number from 0.1 to 10000", ranges: &[[0.1, 1e4]] };
    Blades: u32 = Whole(0..=32), |n| match n {
        1 | 2 => Err("cannot enclose an aperture, expected 3 to 32, or 0 for a round one"),
        n => Ok(n),
    };
}

impl TryFrom<LensFields> for LensKeys {
    type Error = &'static str;

    fn try_from(fields: LensFields) -> Result<Self, Self::Error> {
        let size = match (fields.radius, fields.f_number) {
            (Some(radius), None) => LensSize::Radius(radius),
            (None, Some(n)) => LensSize::FNumber(n),
            (Some(_), Some(_)) => {
                return Err("cannot have two sizes, expected either `radius` or `f_number`");
            }
            (None, None) => return Err("needs a size, expected `radius` or `f_number`"),
        };
        let focus = match (fields.focus_distance, fields.focus_point) {
            (None, None) => Focus::Target,
            (Some(distance), None) => Focus::Distance(distance),
            (None, Some(point)) => Focus::Point(point),
            (Some(_), Some(_)) => {
                return Err(
                    "cannot focus twice, expected either `focus_distance` or `focus_point`",
                );
            }
        };
        Ok(Self {
            size,
            focus,
            blades: fields.blades,
            rotation_deg: fields.rotation_deg,
        })
    }
}

impl From<LensKeys> for LensFields {
    fn from(keys: LensKeys) -> Self {
        let (radius, f_number) = match keys.size {
            LensSize::Radius(radius) => (Some(radius), None),
            LensSize::FNumber(n) => (None, Some(n)),
        };
        let (focus_distance, focus_point) = match keys.focus {
            Focus::Target => (None, None),
            Focus::Distance(distance) => (Some(distance), None),
            Focus::Point(point) => (None, Some(point)),
        };
        Self {
            radius,
            f_number,
            focus_distance,
            focus_point,
            blades: keys.blades,
            rotation_deg: keys.rotation_deg,
        }
    }
}

impl LensKeys {
    /// Returns the lens of a camera at `eye` that looks at `target`; `half_height` is half the
    /// height of view at distance 1. `None` for a pinhole.
    ///
    /// # Errors
    /// The point in focus is not in front of the camera.
    pub(super) fn placed(
        &self,
        [eye, target]: [DVec3; 2],
        basis: Basis,
        half_height: f32,
    ) -> Result<Option<Lens>, &'static str> {
        let depth = |point: DVec3| (point - eye).dot(basis.forward.as_dvec3()) as f32;
        let focus_distance = match self.focus {
            Focus::Target => depth(target),
            Focus::Distance(distance) => distance,
            Focus::Point(point) => depth(point),
        };
        if focus_distance <= 0.0 {
            return Err(
                "cannot focus behind the eye, expected a `focus_point` in front of the camera",
            );
        }
        let radius = match self.size {
            LensSize::Radius(radius) => radius,
            // The focal length at which the frame has this height of view.
            LensSize::FNumber(n) => 0.5 * FRAME_HEIGHT / half_height / (2.0 * n),
        };
        // The first corner is on top.
        let polygon = || Polygon::new(self.blades, 0.25 + self.rotation_deg / 360.0);
        Ok((radius > 0.0).then_some(Lens {
            radius,
            focus_distance,
            blades: (self.blades > 0).then(polygon),
            basis,
        }))
    }
}

impl Lens {
    /// Converts the lens from world space to render space.
    pub(super) fn in_space(self, space: &RenderSpace) -> Self {
        Self {
            radius: space.length(self.radius),
            focus_distance: space.length(self.focus_distance),
            ..self
        }
    }

    /// Moves pinhole rays to points of the lens that `uv`, numbers in [0, 1), samples uniformly:
    /// returns origins and unit directions, of one ray or one per lane.
    #[inline(always)]
    pub fn refracted<R: Real>(
        &self,
        [center, direction]: [Vector<R>; 2],
        uv: [R; 2],
    ) -> [Vector<R>; 2] {
        let like = uv[0];
        let [x, y] = match &self.blades {
            None => disk(uv),
            Some(polygon) => polygon.point(uv),
        };
        let Basis { forward, right, up } = self.basis;
        let on_lens = Vector::splat(like, self.radius * right) * x
            + Vector::splat(like, self.radius * up) * y;
        let cosine = direction.dot(Vector::splat(like, forward));
        let to_focus = direction * (like.splat(self.focus_distance) / cosine);
        [center + on_lens, (to_focus - on_lens).normalize()]
    }

    /// Returns the distance of a point from the plane of the lens.
    pub(super) fn depth(&self, eye: Vec3, point: Vec3) -> f32 {
        (point - eye).dot(self.basis.forward)
    }
}
