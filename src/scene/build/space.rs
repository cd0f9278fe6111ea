//! Chooses the space in which a scene is traced, from its config and geometries.

use glam::{DAffine3, DVec3};

use super::geometries::{Geometries, ObjectGeometry};
use crate::config::Config;
use world::geometry::{Aabb, Intersectable, RenderSpace, world_from_object};
use world::shading::ShadingModel;

/// A box in world space.
type Corners = [DVec3; 2];

/// Returns the render space of a scene: scaled to the size of all bounded objects, with the most
/// digits near their point next to the camera.
///
/// The course's model offsets its rays by a distance in world units, so it stays in world space.
pub(super) fn render_space(config: &Config, geometries: &Geometries) -> RenderSpace {
    if config.shading.model == ShadingModel::Seed {
        return RenderSpace::default();
    }
    let [eye, target] = config.camera.focus();
    let distance = eye.distance(target);
    let objects = config.objects.iter().zip(&geometries.objects);
    let boxes = objects
        .filter_map(|(object, geometry)| corners(geometry, &world_from_object(&object.transform)));
    let bounds = boxes.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let bounds = bounds.filter(|[min, max]| min.is_finite() && max.is_finite());
    let Some([min, max]) = bounds else {
        return RenderSpace::new(distance, eye, distance);
    };
    let size = (max - min).max_element();
    RenderSpace::new(size, eye.clamp(min, max), size.min(distance))
}

/// Returns the box around an object; `None` for a plane.
fn corners(geometry: &ObjectGeometry, world_from_object: &DAffine3) -> Option<Corners> {
    let (origin, bounds) = match geometry {
        ObjectGeometry::Shape(shape) => (shape.origin, shape.geometry.bounds()),
        ObjectGeometry::Generator(generator) => {
            let corners = generator.corners();
            let bounds = Aabb::from_points(corners.geometry);
            (corners.origin, grown(bounds, generator.max_radius()))
        }
        ObjectGeometry::Mesh(mesh) => (mesh.origin, mesh.bounds()),
        ObjectGeometry::Spheres(spheres) => {
            let boxes = spheres.spheres.iter().map(Intersectable::bounds);
            (spheres.origin, boxes.fold(Aabb::EMPTY, Aabb::union))
        }
        ObjectGeometry::Tubes(tubes) => (tubes.origin, tubes.bounds()),
        ObjectGeometry::Instances(placed) => {
            let (origin, bounds) = (placed.mesh.origin, placed.mesh.bounds());
            let places = placed.places.iter().map(|place| {
                around(
                    &bounds,
                    &(*world_from_object * *place * DAffine3::from_translation(origin)),
                )
            });
            return places.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        }
    };
    let world_from_geometry = *world_from_object * DAffine3::from_translation(origin);
    (bounds != Aabb::ALL).then(|| around(&bounds, &world_from_geometry))
}

/// Returns the box around the image of a box.
fn around(bounds: &Aabb, map: &DAffine3) -> Corners {
    let corners = bounds
        .corners()
        .map(|corner| map.transform_point3(corner.as_dvec3()));
    corners.iter().fold([corners[0]; 2], |[min, max], corner| {
        [min.min(*corner), max.max(*corner)]
    })
}

/// Returns a box enlarged on all sides.
fn grown(bounds: Aabb, by: f32) -> Aabb {
    Aabb {
        min: bounds.min - by,
        max: bounds.max + by,
    }
}
