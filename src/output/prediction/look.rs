//! The look of a picture of a scene: what speaks for a mistake in the scene.

use glam::Vec3;

use render::film::Film;
use scene::camera::Projection;
use scene::config::Config;
use scene::geometry::Ray;
use scene::light::Light;
use tracer::cost::NoProbe;
use tracer::trace::Tracer;

/// The camera's view in a picture.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// True if it sees any object.
    pub has_hit: bool,
    /// True if all pixels with an object are black.
    pub is_black: bool,
    /// True if all pixels are white.
    pub is_white: bool,
    /// The object that all pixels show, if there is only one.
    pub only_object: Option<u32>,
    /// The object around the eye.
    pub around_eye: Option<u32>,
    /// The first light inside an object that is not around the eye: its position in the scene's
    /// list, and the object.
    pub light_inside: Option<(usize, u32)>,
    /// The vertical angle of view of a perspective camera, in degrees.
    pub fov_y_deg: Option<f32>,
}

impl Look {
    /// Looks at a whole film of a scene.
    pub fn new(film: &Film, config: &Config, tracer: Tracer) -> Self {
        let scene = tracer.scene;
        let plane = scene.sensor(config).plane;
        let of_strips = || {
            film.strips
                .iter()
                .flat_map(|strip| strip.rgb.iter().zip(&strip.object))
        };
        let mut hits = of_strips().filter(|(_, object)| **object >= 0);
        let mut objects = of_strips().map(|(_, object)| u32::try_from(*object).ok());
        let first = objects.next().flatten();
        let around_eye = surrounding(tracer, plane.eye);
        let inside = |(index, light): (usize, &Light)| {
            let place = scene.space.point(light.position()?);
            let object = surrounding(tracer, place).filter(|object| Some(*object) != around_eye)?;
            Some((index, object))
        };
        let height = plane.down.length() * plane.size[1] as f32;
        let to_middle = plane.to_first
            + 0.5 * (plane.size[0] as f32 - 1.0) * plane.right
            + 0.5 * (plane.size[1] as f32 - 1.0) * plane.down;
        Self {
            has_hit: film.n_hits() > 0,
            is_black: hits.all(|(rgb, _)| *rgb == [0; 3]),
            is_white: of_strips().all(|(rgb, _)| *rgb == [u8::MAX; 3]),
            only_object: first.filter(|_| objects.all(|object| object == first)),
            around_eye,
            light_inside: config.lights.iter().enumerate().find_map(inside),
            fov_y_deg: matches!(plane.projection, Projection::Perspective)
                .then(|| 2.0 * (0.5 * height / to_middle.length()).atan().to_degrees()),
        }
    }
}

/// Returns the object around a point: the one that rays in the six directions of the axes meet
/// first.
fn surrounding(tracer: Tracer, point: Vec3) -> Option<u32> {
    let mut met = [Vec3::X, Vec3::Y, Vec3::Z]
        .into_iter()
        .flat_map(|axis| [axis, -axis]);
    let mut object = |direction| {
        let ray = Ray {
            origin: point,
            direction,
        };
        let hit = tracer.accel.nearest(&ray, &mut NoProbe)?;
        Some(tracer.scene.primitives[hit.primitive as usize].object.0)
    };
    let first = met.next().and_then(&mut object)?;
    met.all(|direction| object(direction) == Some(first))
        .then_some(first)
}
