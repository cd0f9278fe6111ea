//! The formulas of whole paths, for devices that follow paths by themselves.
//!
//! A device knows the loop: hit, point, own light, light samples with their shadow rays, the next
//! ray. [`PathFormulas`] has what it computes there: the formulas of the waves, generic over the
//! kind of number, each for all points of one [`SurfaceKind`].

use glam::Vec3;

use super::bsdf::{Boundary, Bsdf, by_kind};
use super::emission::{Arrival, emitted, weight, weighted_background};
use super::fresnel::{mirrored_share, split_at};
use super::model::{Bounce, Model};
use super::models::by_model;
use super::numbers::{PointNumbers, SampleId};
use super::path::is_worth_tracing;
use super::path_tracing::ROULETTE_DEPTH;
use super::scatter::Continuation;
use super::surface_data::{DataReader, surface_data};
use crate::trace::{HitAttributes, HitPlace, ShadingPoint, passed_opacity, shading_point};
use math::sampling::{Dimension, Sampler};
use math::simd::{Real, Vector};
use world::camera::RayCone;
use world::geometry::{InstancePlacement, N_PARAMETERS, Seen, ShapeKind, ShapePlacement, leaving};
use world::light::Illumination;
use world::material::{Material, MaterialKind, PictureFactors, TexturePoint};
use world::scene::{AttributeKind, InstanceId, Scene, SurfaceClass, scalar_along};
use world::scene::{LightNumbers, interpolated_scalar, with_uv};

/// The formulas of the paths of a scene.
#[derive(Debug, Clone, Copy)]
pub struct PathFormulas<'a> {
    scene: &'a Scene,
    /// The numbers of the paths' samples.
    pub sampler: Sampler,
    /// The footprint of the camera rays, by which textures are filtered; `None` for points.
    pub cone: Option<RayCone>,
}

/// The rules of the loop, the same for all surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathRules {
    /// Greatest number of bounces.
    pub max_depth: u32,
    /// Bounces after which [`PathFormulas::next`] is asked for late rays.
    pub late_depth: u32,
    /// Number of light samples at each point.
    pub n_lights: usize,
    /// True if points have light samples after the last bounce, too.
    pub lights_last_points: bool,
    /// True if shadow rays decide which light samples arrive.
    pub casts_shadows: bool,
    /// True if a shadow ray ignores the object that it leaves.
    pub ignores_own_object: bool,
    /// True if a point that no light reaches is black and ends its path.
    pub needs_light: bool,
    /// The first dimension of the point that a camera ray hits, and its growth with each bounce.
    pub dimensions: [u32; 2],
    /// True if paths split: then a point continues them by [`PathFormulas::split`].
    pub splits: bool,
    /// True if rays enter and leave media, which weaken light.
    pub has_media: bool,
    /// True if light passes any surface, in part or at holes.
    pub has_openings: bool,
    /// True if media weaken light samples, too.
    pub weakens_lights: bool,
    /// True if fog fades light without scattering it.
    pub has_fading_fog: bool,
    /// The number of the primitive of fog particles that rays may meet; `None` without.
    pub particles: Option<u32>,
}

/// Surfaces whose points have the same formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfaceKind {
    /// The material, the shape and the attributes.
    pub class: SurfaceClass,
    /// The shape, before its transform if it has one.
    shape: ShapeKind,
    /// The primitives of instanced meshes.
    instances: Option<InstanceKind>,
    /// True if light passes in part or at holes, and the vertices have opacities.
    has_opacities: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct InstanceKind {
    /// True if each instance has its number of an array.
    has_scalars: bool,
}

/// The rules of the loop at surfaces of one material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SurfaceRules {
    /// True if light samples contribute.
    pub is_lit: bool,
    /// True if the surface continues paths.
    pub continues: bool,
    /// True if a medium is behind the surface.
    pub is_medium: bool,
    /// True if light passes in part or at holes.
    pub is_open: bool,
    /// True if a part of the light goes on past the surface, after any number of bounces.
    pub is_veil: bool,
}

/// A surface that a ray meets, as the media on both sides make it.
#[derive(Clone, Copy)]
pub struct Crossing<R: Real> {
    /// Ratio of the indices of refraction, before the surface over behind it.
    pub eta: R,
    /// True if the effective medium changes.
    pub is_visible: R::Mask,
    /// The indices of refraction where the ray is, and behind the surface if it enters there.
    pub indices: [R; 2],
}

/// The shadow ray of a light sample.
pub struct ShadowFormula<R: Real> {
    /// True if the light may arrive; otherwise there is no ray.
    pub may_arrive: R::Mask,
    /// The origin of the ray, in the direction of the light.
    pub origin: Vector<R>,
    /// The parameter at which it ends.
    pub end: R,
}

/// The rest of a ray past a surface that is not opaque.
pub struct PassageFormula<R: Real> {
    /// The share of light that passes, of a shadow ray.
    pub share: R,
    /// True if any other ray passes.
    pub is_passed: R::Mask,
    /// Its origin past the surface.
    pub origin: Vector<R>,
    /// The distance of the new origin from the old one, along the ray.
    pub advance: R,
}

/// A ray that continues a path.
pub struct NextRay<R: Real> {
    /// True if there is one.
    pub is_alive: R::Mask,
    /// The origin.
    pub origin: Vector<R>,
    /// The direction, a unit vector.
    pub direction: Vector<R>,
    /// The share of the light met by the ray that reaches the camera.
    pub weight: Vector<R>,
    /// The density with which the direction was chosen.
    pub density: R,
    /// True for a refracted ray.
    pub is_refracted: R::Mask,
    /// True for a ray that is scattered diffusely.
    pub is_diffuse: R::Mask,
}

/// Most lights in a choice: each becomes a part of the program.
const MAX_CHOICE: usize = 32;

impl<'a> PathFormulas<'a> {
    pub(super) fn new(scene: &'a Scene, sampler: Sampler) -> Self {
        Self {
            scene,
            sampler,
            cone: None,
        }
    }

    /// Filters textures by the footprint of camera rays.
    pub(super) fn with_cone(self, cone: Option<RayCone>) -> Self {
        Self { cone, ..self }
    }

    /// Returns the part of the scene for which there are no formulas, if there is one.
    pub fn refusal(&self) -> Option<&'static str> {
        let lights = &self.scene.lights;
        let chooses = lights.n_samples() < lights.n_sources();
        let is_long = chooses && lights.n_sources() > MAX_CHOICE;
        is_long.then_some("a choice among more than 32 lights")
    }

    /// Returns the rules of the loop.
    pub fn rules(&self) -> PathRules {
        let shading = &self.scene.shading;
        let max_depth = u32::from(shading.max_depth);
        let lights = &self.scene.lights;
        let [first, second] = [0, 1].map(|depth| Dimension::after_bounces(depth, 0));
        by_model!(self.scene, |model| {
            let n_lights = |depth| model.n_light_samples(lights, depth, max_depth);
            PathRules {
                max_depth,
                late_depth: ROULETTE_DEPTH,
                n_lights: n_lights(0).max(n_lights(max_depth)),
                lights_last_points: n_lights(max_depth) > 0,
                casts_shadows: shading.shadows,
                ignores_own_object: ignores_own_object(model),
                needs_light: needs_light(model),
                dimensions: [first.0, second.0 - first.0],
                splits: self.scene.splits_paths(),
                has_media: self.scene.has_media(),
                has_openings: self.scene.has_openings(),
                weakens_lights: self.scene.weakens_lights(),
                has_fading_fog: self.scene.fading_fog().is_some(),
                particles: self.particles(),
            }
        })
    }

    fn particles(&self) -> Option<u32> {
        let fog = self.scene.scattering_fog();
        fog.map(|_| self.scene.particles())
    }

    /// Returns the kind of the surface of a primitive; `None` for the box of an instance.
    pub fn kind(&self, primitive: u32) -> Option<SurfaceKind> {
        let mut of_instances = None;
        if self.particles() == Some(primitive) {
            return Some(SurfaceKind {
                class: self.scene.class(primitive),
                shape: ShapeKind::Sphere,
                instances: None,
                has_opacities: false,
            });
        }
        if let Some(instances) = &self.scene.instances
            && let Some(InstanceId(instance)) = instances.by_box(primitive)
        {
            if (instance as usize) < instances.n_instances() {
                return None;
            }
            let mesh = instances.mesh_with(primitive)?;
            let mesh = &instances.meshes()[mesh as usize];
            let has_scalars = instances.scalar(mesh.first).is_some();
            of_instances = Some(InstanceKind { has_scalars });
        }
        let class = self.scene.class(primitive);
        let is_open = self.scene.material(class.material()).opacity.is_some();
        Some(SurfaceKind {
            class,
            shape: self.scene.primitives[primitive as usize].shape_kind(),
            instances: of_instances,
            has_opacities: is_open && self.scene.vertex_opacities(primitive).is_some(),
        })
    }

    /// Returns the number of primitives, with the particles of fog.
    pub fn n_primitives(&self) -> u32 {
        self.scene.primitives.len() as u32 + u32::from(self.particles().is_some())
    }

    /// Returns for each material the index of refraction, the absorption of each channel and the
    /// bits of the priority of its medium.
    pub fn media(&self) -> Vec<[f32; 5]> {
        let media = self.scene.materials.iter().map(|material| {
            let medium = material.kind.medium()?;
            let [red, green, blue] = medium.absorption.to_array();
            let priority = f32::from_bits(medium.priority as u32);
            Some([medium.index, red, green, blue, priority])
        });
        media.map(Option::unwrap_or_default).collect()
    }

    /// Appends the numbers of a primitive that [`point`](Self::point) and
    /// [`own_light`](Self::own_light) read for surfaces of its kind.
    pub fn push_data(&self, kind: SurfaceKind, primitive: u32, numbers: &mut Vec<f32>) {
        if self.is_particle(kind) {
            return;
        }
        let attributes = kind.class.attributes();
        surface_data(
            self.scene,
            attributes,
            kind.has_opacities,
            primitive,
            numbers,
        );
    }

    /// Appends the numbers that they read for each instance.
    pub fn push_instances(&self, numbers: &mut Vec<f32>) {
        let Some(instances) = &self.scene.instances else {
            return;
        };
        for id in (0..instances.n_instances() as u32).map(InstanceId) {
            let transform = instances.get(id).transform;
            let sign = if transform.is_mirrored() { -1.0 } else { 1.0 };
            let [x, y, z, _] = transform.mesh_from_world();
            let there = transform.world_from_mesh();
            numbers.push(sign);
            numbers.extend(there.iter().chain(&[x, y, z]).flat_map(Vec3::to_array));
            numbers.push(instances.scalar(id).unwrap_or(f32::NAN));
        }
    }

    fn is_particle(&self, kind: SurfaceKind) -> bool {
        matches!(self.material(kind).kind, MaterialKind::Particles(_))
    }

    /// Returns the material of surfaces of a kind.
    pub fn material(&self, kind: SurfaceKind) -> &'a Material {
        self.scene.material(kind.class.material())
    }

    /// Returns true if a part of the light goes on past surfaces of a material, which splits paths.
    fn is_veil(&self, material: &Material) -> bool {
        material.is_veil() && self.scene.splits_at_veils()
    }

    /// Returns the rules at surfaces of a material.
    pub fn surface(&self, material: &Material) -> SurfaceRules {
        by_model!(self.scene, |model| SurfaceRules {
            is_lit: model.is_lit(material),
            continues: match bounce(model) {
                Bounce::None => false,
                Bounce::Mirrored => material.kind.mirrors() || material.kind.medium().is_some(),
                Bounce::Scattered => material.scatters(),
            },
            is_medium: material.kind.medium().is_some(),
            is_open: material.opacity.is_some(),
            is_veil: self.is_veil(material),
        })
    }

    /// Returns true if pictures vary the roughness, the metallicness or the emission of surfaces.
    pub fn has_factors(&self) -> bool {
        self.scene.has_factors
    }

    /// Returns the point of a surface that a ray, with this origin and direction, hits at `t`, after
    /// a path of this length, and its opacity. `data` are the numbers of the primitive, `place` the
    /// numbers of the instance.
    pub fn point<R: Real>(
        &self,
        kind: SurfaceKind,
        [origin, direction]: [Vector<R>; 2],
        [t, length]: [R; 2],
        data: &mut dyn FnMut() -> R,
        place: &mut dyn FnMut() -> R,
    ) -> (ShadingPoint<R>, R) {
        let near = origin + direction * t;
        if self.is_particle(kind) {
            return (self.particle(near), t.splat(1.0));
        }
        let mut data = DataReader(data);
        let surface = self.hit_surface(kind, &mut data, place);
        let parameters = surface.parameters;
        let ([position, outward], error) = surface.project(kind.shape, near);
        let attributes = kind.class.attributes();
        let place = HitPlace {
            position,
            outward,
            error,
            direction,
        };
        let turned = |normals: [Vector<R>; 3]| match &surface.instance {
            None => normals,
            Some(instance) => normals.map(|normal| instance.world_normal(normal)),
        };
        let uvs = (attributes.has_uvs()).then(|| [(); 3].map(|()| data.numbers()));
        let normals = attributes.has_normals().then(|| turned(data.vectors()));
        let colors = attributes.has_corner_colors().then(|| data.vectors());
        let scalar = if attributes.has_corner_scalars() {
            let of_corners = data.numbers();
            let scalars = surface.scalar.map_or(of_corners, |scalar| [scalar; 3]);
            Some(interpolated_scalar(&parameters, scalars, position))
        } else {
            match attributes {
                AttributeKind::Scalars => Some(data.number()),
                AttributeKind::Ends => {
                    let point = match surface.placement {
                        None => position,
                        Some((placement, _)) => placement.object_point(position),
                    };
                    Some(scalar_along(&parameters, data.numbers(), point))
                }
                _ => None,
            }
        };
        let cone = self.cone.map(|cone| (cone, length + t));
        let attributes = HitAttributes {
            parameters,
            normals,
            uvs,
            colors,
            scalar,
            color: matches!(attributes, AttributeKind::Colors).then(|| data.vector()),
        };
        let opacity = if self.is_veil(self.material(kind)) {
            self.opacity(kind, &surface, [position, outward], uvs)
        } else {
            t.splat(1.0)
        };
        let point = shading_point(self.material(kind), &place, &attributes, cone);
        (point, opacity)
    }

    /// Returns the opacity at a position on a surface with this outward normal and these texture
    /// coordinates at its vertices.
    fn opacity<R: Real>(
        &self,
        kind: SurfaceKind,
        surface: &HitSurface<R>,
        [position, outward]: [Vector<R>; 2],
        uvs: Option<[[R; 2]; 3]>,
    ) -> R {
        let one = position.x.splat(1.0);
        let Some(opacity) = &self.material(kind).opacity else {
            return one;
        };
        let mut at = TexturePoint::new(position, outward);
        if let Some(uvs) = uvs {
            at = with_uv(at, &surface.parameters, uvs);
        }
        let of_vertices = surface.opacities.map_or(one, |opacities| {
            interpolated_scalar(&surface.parameters, opacities, position)
        });
        opacity.at(&at, of_vertices)
    }

    /// Returns what is left of a ray past the surface that it hits at `t`.
    pub fn passage<R: Real>(
        &self,
        kind: SurfaceKind,
        ray: [Vector<R>; 2],
        t: R,
        data: &mut dyn FnMut() -> R,
        place: &mut dyn FnMut() -> R,
    ) -> PassageFormula<R> {
        let [origin, direction] = ray;
        let mut data = DataReader(data);
        let surface = self.hit_surface(kind, &mut data, place);
        let (at, error) = surface.project(kind.shape, origin + direction * t);
        let uvs = (kind.class.attributes().has_uvs()).then(|| [(); 3].map(|()| data.numbers()));
        let opacity = self.opacity(kind, &surface, at, uvs);
        let next = leaving(at, error, direction);
        PassageFormula {
            share: t.splat(1.0) - opacity,
            is_passed: opacity.le(passed_opacity(self.scene, ray)),
            origin: next,
            advance: (next - origin).dot(direction),
        }
    }

    /// Returns the particle of fog at a position.
    fn particle<R: Real>(&self, position: Vector<R>) -> ShadingPoint<R> {
        let [none, color] = [
            Vec3::ZERO,
            self.scene.fog.map_or(Vec3::ZERO, |fog| fog.color),
        ]
        .map(|vector| Vector::splat(position.x, vector));
        let one = position.x.splat(1.0);
        ShadingPoint {
            position,
            normal: none,
            geometric_normal: none,
            color,
            error: one.splat(0.0),
            side: one,
            factors: PictureFactors::ones(one),
        }
    }

    /// Returns true if a ray that hits something at `t` meets a particle of fog before, and where.
    pub fn flight<R: Real>(
        &self,
        ray: [Vector<R>; 2],
        t: R,
        [pixel, sample, dimension]: [R::Integer; 3],
    ) -> (R::Mask, R) {
        let Some(fog) = self.scene.scattering_fog() else {
            return (t.splat_mask(false), t);
        };
        let id = SampleId { pixel, sample };
        let numbers = PointNumbers::from_dimension(self.sampler, id, dimension);
        fog.flight(ray, t, numbers.flight())
    }

    /// Reads the shape of a primitive that was hit.
    fn hit_surface<R: Real>(
        &self,
        kind: SurfaceKind,
        data: &mut DataReader<R>,
        place: &mut dyn FnMut() -> R,
    ) -> HitSurface<R> {
        let parameters: [R; N_PARAMETERS] = data.numbers();
        let mut surface = HitSurface {
            parameters,
            placement: None,
            instance: None,
            mirror: None,
            scalar: None,
            opacities: None,
        };
        if kind.class.shape().is_none() {
            let placement = ShapePlacement::new(data.vectors(), data.vectors());
            surface.placement = Some((placement, data.number()));
        }
        if let Some(of_instances) = kind.instances {
            let mut place = DataReader(place);
            surface.mirror = Some(place.number());
            let instance = InstancePlacement::new(place.vectors(), place.vectors());
            surface.parameters = instance.world_triangle(&parameters);
            surface.instance = Some(instance);
            let scalar = place.number();
            surface.scalar = of_instances.has_scalars.then_some(scalar);
        }
        surface.opacities = kind.has_opacities.then(|| data.numbers());
        surface
    }

    /// Returns true where a point is on a side of its surface that scatters light.
    pub(super) fn scatters<R: Real>(&self, material: &Material, at: &ShadingPoint<R>) -> R::Mask {
        if material.two_sided {
            return at.side.splat_mask(true);
        }
        at.side.splat(0.0).lt(at.side)
    }

    /// Returns the parameters of the shape of a primitive, in render space unless it has a
    /// transform.
    pub fn parameters<R: Real>(
        &self,
        kind: SurfaceKind,
        data: &mut dyn FnMut() -> R,
        place: &mut dyn FnMut() -> R,
    ) -> [R; N_PARAMETERS] {
        let surface = self.hit_surface(kind, &mut DataReader(data), place);
        surface.parameters
    }

    /// Returns the light of a point without light samples: ambient and emitted light. The ray has an
    /// origin and a direction, which was chosen with this density, and hits the point at `t`.
    /// `parameters` are the shape's.
    pub fn own_light<R: Real>(
        &self,
        class: SurfaceClass,
        at: &ShadingPoint<R>,
        [from, direction]: [Vector<R>; 2],
        [t, density]: [R; 2],
        parameters: impl FnOnce() -> [R; N_PARAMETERS],
    ) -> Vector<R> {
        let material = self.scene.material(class.material());
        let ambient = self.scene.shading.ambient;
        let reflected = by_model!(self.scene, |model| model
            .ambient(material, ambient, at.color));
        let none = Vector::splat(t, Vec3::ZERO);
        let radiance = Vector::select(self.scatters(material, at), reflected, none);
        if !material.emits() {
            return radiance;
        }
        let mut emitted = emitted(material, at);
        let lights = &self.scene.lights;
        let emitter = lights.emitter(class.material(), class.shape());
        if let Some((emitter, index)) = emitter.filter(|_| self.scene.scatters_paths()) {
            let arrival = Arrival {
                from,
                density,
                seen: Seen {
                    direction,
                    distance: t,
                    cos: -at.outward(at.geometric_normal).dot(direction),
                },
                shape: parameters(),
            };
            emitted = emitted * weight(lights, emitter, index, &arrival);
        }
        radiance + emitted
    }

    /// Returns the light of light sample `i` at a point, not yet weakened by media, and the index of
    /// the light. The numbers of its pixel, its sample and its first dimension choose it.
    pub fn light<R: Real>(
        &self,
        i: usize,
        at: &ShadingPoint<R>,
        [pixel, sample, dimension]: [R::Integer; 3],
    ) -> (Illumination<R>, R) {
        let lights = &self.scene.lights;
        match lights.plain(i) {
            Some(light) => (light.illuminate(at.position), at.side.splat(i as f32)),
            None => {
                let id = SampleId { pixel, sample };
                let numbers = PointNumbers::from_dimension(self.sampler, id, dimension);
                let numbers: LightNumbers<R> = numbers.light(lights, i);
                lights.illuminate(i, &at.lit(), &numbers)
            }
        }
    }

    /// Returns the shadow ray of a light sample.
    pub fn shadow<R: Real>(
        &self,
        material: &Material,
        at: &ShadingPoint<R>,
        light: &Illumination<R>,
    ) -> ShadowFormula<R> {
        by_model!(self.scene, |model| ShadowFormula {
            may_arrive: model.may_arrive(material, at, light) & self.scatters(material, at),
            origin: model.origin(at, light.direction),
            end: model.end(light),
        })
    }

    /// Returns the light of an unoccluded light sample that a point reflects along a ray in
    /// `direction`, of a path from `eye`.
    pub fn reflected<R: Real>(
        &self,
        material: &Material,
        at: &ShadingPoint<R>,
        light: &Illumination<R>,
        [eye, direction]: [Vector<R>; 2],
        crossing: &Crossing<R>,
    ) -> Vector<R> {
        let boundary = self.boundary(material, crossing);
        by_model!(self.scene, |model| {
            let to_viewer = model.to_viewer(at, eye, direction);
            model.reflected(material, &boundary, at, light, to_viewer)
        })
    }

    /// Returns the ray that continues a path of this weight, whose ray in `direction` has hit a
    /// point; late, after [`PathRules::late_depth`], rays of little weight may end.
    pub fn next<R: Real>(
        &self,
        material: &Material,
        at: &ShadingPoint<R>,
        [direction, weight]: [Vector<R>; 2],
        [pixel, sample, dimension]: [R::Integer; 3],
        crossing: &Crossing<R>,
        is_late: bool,
    ) -> NextRay<R> {
        let scatters = self.scatters(material, at);
        let one = at.side.splat(1.0);
        if self.scene.scatters_paths() {
            let id = SampleId { pixel, sample };
            let numbers = PointNumbers::from_dimension(self.sampler, id, dimension);
            let boundary = self.boundary(material, crossing);
            let continuation = by_kind!(Bsdf::new(material), |of| Continuation::sample(
                of, at, direction, &boundary, &numbers, weight
            ));
            let depth = if is_late { ROULETTE_DEPTH } else { 0 };
            let [here, behind] = crossing.indices;
            let index = if self.scene.has_media() {
                R::select(continuation.is_refracted, behind, here)
            } else {
                one
            };
            let (is_alive, weight) = continuation.survive(index, depth);
            return NextRay {
                is_alive: is_alive & scatters,
                origin: continuation.origin,
                direction: continuation.direction,
                weight,
                density: continuation.density,
                is_refracted: continuation.is_refracted,
                is_diffuse: continuation.is_diffuse,
            };
        }
        let mirrored = at.mirrored(direction);
        let no = one.splat_mask(false);
        NextRay {
            is_alive: scatters,
            origin: by_model!(self.scene, |model| model.origin(at, mirrored)),
            direction: mirrored,
            weight: weight.times(mirrored_share(material, at, direction)),
            density: one.splat(f32::INFINITY),
            is_refracted: no,
            is_diffuse: no,
        }
    }

    /// Returns the rays that continue a path, whose ray in `direction` has hit a point of this
    /// opacity: the reflected ray, then the ray on the other side of the surface.
    pub fn split<R: Real>(
        &self,
        material: &Material,
        at: &ShadingPoint<R>,
        [direction, weight]: [Vector<R>; 2],
        opacity: R,
        crossing: &Crossing<R>,
    ) -> [NextRay<R>; 2] {
        let one = opacity.splat(1.0);
        let no = one.splat_mask(false);
        let ray = |is_alive, direction, weight| NextRay {
            is_alive,
            origin: by_model!(self.scene, |model| model.origin(at, direction)),
            direction,
            weight,
            density: one.splat(f32::INFINITY),
            is_refracted: no,
            is_diffuse: no,
        };
        let (scatters, mirrored) = (self.scatters(material, at), at.mirrored(direction));
        if material.kind.medium().is_some() {
            let split = split_at(at, direction, crossing.eta, crossing.is_visible);
            let worth = |share: R| is_worth_tracing(weight * share) & scatters;
            let [reflected, refracted] = [split.reflectance, one - split.reflectance];
            return [
                ray(worth(reflected), mirrored, weight * reflected),
                NextRay {
                    is_refracted: one.splat_mask(true),
                    ..ray(worth(refracted), split.refracted, weight * refracted)
                },
            ];
        }
        let share = mirrored_share(material, at, direction);
        let reflects = if material.kind.mirrors() {
            scatters
        } else {
            no
        };
        let passing = one - opacity;
        let passes = if self.is_veil(material) {
            is_worth_tracing(weight * passing)
        } else {
            no
        };
        [
            ray(reflects, mirrored, (weight * opacity).times(share)),
            NextRay {
                is_refracted: one.splat_mask(true),
                ..ray(passes, direction, weight * passing)
            },
        ]
    }

    /// Returns the share of light that fog leaves on the way of a ray to its hit at `t`, and the
    /// light that it adds.
    pub fn fade<R: Real>(&self, ray: [Vector<R>; 2], t: R) -> (R, Vector<R>) {
        match self.scene.fading_fog() {
            Some(fog) => fog.fade(ray, t),
            None => (t.splat(1.0), Vector::splat(t, Vec3::ZERO)),
        }
    }

    /// Returns the boundary that scattering needs.
    fn boundary<R: Real>(&self, material: &Material, crossing: &Crossing<R>) -> Boundary<R> {
        match material.kind.medium() {
            None => Boundary::without_medium(crossing.eta),
            Some(_) => Boundary {
                eta: crossing.eta,
                is_visible: crossing.is_visible,
            },
        }
    }

    /// Returns the background seen by a ray without a hit, whose direction was chosen with this
    /// density.
    pub fn background<R: Real>(&self, ray: [Vector<R>; 2], density: R) -> Vector<R> {
        weighted_background(self.scene, ray, density)
    }
}

/// The shape of a primitive that was hit.
struct HitSurface<R> {
    /// In render space, unless there is a placement.
    parameters: [R; N_PARAMETERS],
    /// The transform of the shape, and the bound of rounding errors on it.
    placement: Option<(ShapePlacement<R>, R)>,
    instance: Option<InstancePlacement<R>>,
    /// Negative on a mirrored instance.
    mirror: Option<R>,
    /// The instance's number of an array.
    scalar: Option<R>,
    /// The opacities of the vertices.
    opacities: Option<[R; 3]>,
}

impl<R: Real> HitSurface<R> {
    /// Returns the point of the surface near a point, with the outward normal, and the bound of its
    /// distance from the surface.
    fn project(&self, shape: ShapeKind, near: Vector<R>) -> ([Vector<R>; 2], R) {
        let parameters = &self.parameters;
        let (position, outward, error) = match self.placement {
            None => {
                let (position, outward) = shape.project_onto(parameters, near);
                let error = shape.rounding_along(parameters, [position, outward]);
                (position, outward, error)
            }
            Some((placement, error)) => {
                let near = placement.object_point(near);
                let (position, outward) = shape.project_onto(parameters, near);
                let position = placement.world_point(position);
                (position, placement.world_normal(outward), error)
            }
        };
        let outward = match self.mirror {
            None => outward,
            Some(sign) => outward.flip_sign_by(sign),
        };
        ([position, outward], error)
    }
}

fn bounce<M: Model>(_: M) -> Bounce {
    M::BOUNCE
}

fn ignores_own_object<M: Model>(_: M) -> bool {
    M::IGNORES_OWN_OBJECT
}

fn needs_light<M: Model>(_: M) -> bool {
    M::NEEDS_LIGHT
}
