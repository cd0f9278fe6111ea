//! The media in which camera rays start.

use glam::Vec3;

use super::media::Media;
use crate::cost::{NoProbe, RayKind};
use crate::trace::{SurfacePoint, Tracer};
use world::camera::ImagePlane;
use world::geometry::{Aabb, Ray};

/// The media around the eye of a camera, or around the points from which its rays start.
#[derive(Debug, Clone, Copy)]
pub struct EyeMedia<'a> {
    tracer: Tracer<'a>,
    eye: Vec3,
    /// The media at the eye.
    at_eye: Media,
    /// True if a surface of a medium may lie between the eye and the start of a ray.
    vary: bool,
}

/// Three directions at right angles to each other, along no axis, edge or diagonal of a box.
const DIRECTIONS: [Vec3; 3] = [
    Vec3::new(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0),
    Vec3::new(6.0 / 7.0, 2.0 / 7.0, -3.0 / 7.0),
    Vec3::new(-3.0 / 7.0, 6.0 / 7.0, -2.0 / 7.0),
];

/// Maximum number of surfaces that a ray to the eye crosses; those farther away do not count.
const MAX_SURFACES: usize = 10_000;

impl<'a> EyeMedia<'a> {
    /// Finds the media around the eye of a picture, whose camera rays pass through points up to
    /// `margin` pixels outside of it.
    pub fn new(tracer: Tracer<'a>, plane: &ImagePlane, margin: f32) -> Self {
        let eye = plane.eye;
        let has_media = tracer.scene.has_media();
        Self {
            tracer,
            eye,
            at_eye: if has_media {
                media_at(&tracer, eye)
            } else {
                Media::default()
            },
            vary: has_media
                && plane.eye().is_none()
                && has_media_in(&tracer, plane.origins(margin)),
        }
    }

    /// Returns the media at the start of a camera ray: where they vary, those at the eye, changed by
    /// the surfaces on the way from there.
    pub(super) fn at(&self, origin: Vec3) -> Media {
        let way = origin - self.eye;
        let length = way.length();
        if !self.vary || length == 0.0 {
            return self.at_eye;
        }
        let ray = Ray {
            origin: self.eye,
            direction: way / length,
        };
        let surfaces = crossed_surfaces(&self.tracer, ray, length);
        surfaces.fold(self.at_eye, |media, point| {
            crossed(&self.tracer, media, &point, !point.is_flipped)
        })
    }
}

/// Returns the media at a point: those of most rays that come from infinity, in pairs from opposite
/// sides. So all rays find the media inside of closed surfaces, and half of them that of a plane,
/// which is the half-space behind it and prevails.
fn media_at(tracer: &Tracer, point: Vec3) -> Media {
    let mut found = Vec::new();
    for direction in DIRECTIONS.into_iter().flat_map(|axis| [axis, -axis]) {
        let ray = Ray {
            origin: point,
            direction,
        };
        // From the last surface to the first one: in the direction of the ray that comes.
        let surfaces: Vec<SurfacePoint> = crossed_surfaces(tracer, ray, f32::INFINITY).collect();
        let media = surfaces.iter().rfold(Media::default(), |media, point| {
            crossed(tracer, media, point, point.is_flipped)
        });
        found.push(media);
    }
    let n_equal = |media: &Media| found.iter().filter(|other| *other == media).count();
    let most = found.iter().max_by_key(|media| (n_equal(media), media.n()));
    most.copied().unwrap_or_default()
}

/// Returns the media past a surface that a ray enters or leaves.
fn crossed(tracer: &Tracer, media: Media, point: &SurfacePoint, enters: bool) -> Media {
    let scene = tracer.scene;
    match scene.material(point.material).kind.medium() {
        None => media,
        Some(_) => media.cross(point.material, enters, &scene.materials).behind,
    }
}

/// Returns the surfaces that a ray crosses before a distance.
fn crossed_surfaces<'a>(
    tracer: &'a Tracer,
    mut ray: Ray,
    mut left: f32,
) -> impl Iterator<Item = SurfacePoint> + 'a {
    let next = move || {
        let point = tracer.trace(&ray, RayKind::Camera, &mut NoProbe)?;
        left -= point.distance;
        ray = Ray::leaving(
            [point.position, point.geometric_normal],
            point.error,
            ray.direction,
        );
        (left > 0.0).then_some(point)
    };
    std::iter::from_fn(next).take(MAX_SURFACES)
}

/// Returns true if the surface of a medium may be in a box. The bounds of an instance are those of
/// a medium.
fn has_media_in(tracer: &Tracer, region: Aabb) -> bool {
    let scene = tracer.scene;
    let is_medium = |material| scene.material(material).kind.medium().is_some();
    (0..)
        .zip(scene.world().upper_level())
        .any(|(i, primitive)| {
            let is_instance = || {
                scene
                    .instances
                    .as_ref()
                    .is_some_and(|of| of.by_box(i).is_some())
            };
            (is_instance() || is_medium(primitive.material))
                && (primitive.is_unbounded() || primitive.bounds().overlaps(region))
        })
}
