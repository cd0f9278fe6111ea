//! The look of a picture of a scene: what speaks for a mistake in the scene.

use glam::Vec3;

use render::film::Film;
use scene::build::Sensor;
use scene::config::Config;
use tracer::cost::NoProbe;
use tracer::trace::Tracer;
use world::camera::Projection;
use world::geometry::Ray;
use world::light::Light;

/// The camera's view in a picture.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// The least and the greatest number of an object in a pixel, -1 for none.
    objects: [i32; 2],
    /// True if all pixels with an object are black.
    pub is_black: bool,
    /// True if all pixels are white.
    pub is_white: bool,
    /// The object around the eye.
    pub around_eye: Option<u32>,
    /// The first light inside an object that is not around the eye: its position in the scene's
    /// list, and the object.
    pub light_inside: Option<(usize, u32)>,
    /// The vertical angle of view of a perspective camera, in degrees.
    pub fov_y_deg: Option<f32>,
}

impl Look {
    /// Looks at a scene, and at all pixels of a film, which may have none yet.
    pub fn new(film: &Film, config: &Config, tracer: Tracer) -> Self {
        let scene = tracer.scene;
        let plane = Sensor::new(scene, config).plane;
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
        let mut this = Self {
            objects: [i32::MAX, i32::MIN],
            is_black: true,
            is_white: true,
            around_eye,
            light_inside: config.lights.iter().enumerate().find_map(inside),
            fov_y_deg: matches!(plane.projection, Projection::Perspective)
                .then(|| 2.0 * (0.5 * height / to_middle.length()).atan().to_degrees()),
        };
        this.add(film);
        this
    }

    /// Looks at more pixels of the picture.
    pub fn add(&mut self, film: &Film) {
        let [least, most] = &mut self.objects;
        for strip in &film.strips {
            // More pixels change nothing then.
            if *least < *most && !self.is_black && !self.is_white {
                return;
            }
            for (rgb, &object) in strip.rgb.iter().zip(&strip.object) {
                (*least, *most) = (object.min(*least), object.max(*most));
                self.is_black &= object < 0 || *rgb == [0; 3];
                self.is_white &= *rgb == [u8::MAX; 3];
            }
        }
    }

    /// Returns true if the camera sees any object.
    pub fn has_hit(&self) -> bool {
        self.objects[1] >= 0
    }

    /// Returns the object that all pixels show, if there is only one.
    pub fn only_object(&self) -> Option<u32> {
        let [least, most] = self.objects;
        u32::try_from(least).ok().filter(|_| least == most)
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
