//! The lights of a scene: the `lights` section, then emissive surfaces, then the environment map
//! and its sun.

use std::collections::BTreeMap;

use glam::Vec3;

use super::emitter::Emitter;
use super::environment::EnvironmentLight;
use super::instances::World;
use super::light_choice::{Chosen, LightChoice};
use super::light_source::{LightNumbers, LightSource};
use super::primitive::{MaterialId, Primitive};
use crate::background::Background;
use crate::fog::FogSphere;
use crate::geometry::{Aabb, N_PARAMETERS, ShapeKind, corners};
use crate::light::{Illumination, Light, LitPoint};
use crate::material::Material;
use crate::shading::LightSampling;
use math::simd::{Real, Vector};

/// The lights of a scene; see the module's documentation for their order.
#[derive(Debug, Clone, Default)]
pub struct Lights {
    sources: Vec<LightSource>,
    choice: LightChoice,
    need_choices: bool,
    /// The fog that attenuates their light.
    fog: Option<FogSphere>,
    /// True if media also attenuate it.
    has_media: bool,
    /// The index of the source for each material and kind of shape.
    emitters: Vec<Option<u32>>,
    /// The index of the environment map.
    environment: Option<u32>,
    /// The index of the sun.
    sun: Option<u32>,
}

/// The origin of a light of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightOrigin {
    /// The `lights` section, or the shading model.
    Listed,
    /// The surfaces of a material.
    Surfaces(MaterialId),
    /// The picture of the `background` section.
    Background,
    /// The sun of the `background` section.
    Sun,
}

impl Lights {
    /// Creates a single light: the space around each point, up to a distance.
    pub(super) fn surroundings(distance: f32) -> Self {
        Self {
            sources: vec![LightSource::Surroundings(distance)],
            ..Self::default()
        }
    }

    pub(super) fn new(
        lights: impl Iterator<Item = Light>,
        materials: &[Material],
        world: World,
        background: Option<&Background>,
        sampling: LightSampling,
        fog: Option<FogSphere>,
        has_media: bool,
    ) -> Self {
        // Collect the listed lights, then emissive surfaces, environment map and sun.
        let mut sources: Vec<LightSource> = lights.map(LightSource::Light).collect();
        let n_kinds = ShapeKind::ALL.len();
        let mut emitters = vec![None; materials.len() * n_kinds];
        for (key, (shapes, bounds)) in emitting_shapes(materials, world) {
            let (material, kind) = (key / n_kinds, ShapeKind::ALL[key % n_kinds]);
            let id = MaterialId(material as u32);
            if let Some(emitter) = Emitter::new(id, &materials[material], kind, shapes, bounds) {
                emitters[key] = Some(sources.len() as u32);
                sources.push(LightSource::Emitter(Box::new(emitter)));
            }
        }
        let map = background.and_then(Background::environment_map);
        let environment = map.and_then(EnvironmentLight::new).map(|environment| {
            sources.push(LightSource::Environment(Box::new(environment)));
            sources.len() as u32 - 1
        });
        let sun = background.and_then(Background::sun).map(|sun| {
            sources.push(LightSource::Sun(*sun));
            sources.len() as u32 - 1
        });
        // Choose how to sample them.
        let choice = LightChoice::new(sampling, &sources, &bounds(world.upper_level()));
        let has_shapes = sources.iter().any(LightSource::has_shapes);
        Self {
            need_choices: has_shapes || matches!(choice, LightChoice::ByPower(_)),
            choice,
            sources,
            fog,
            has_media,
            emitters,
            environment,
            sun,
        }
    }

    /// Returns the number of lights.
    pub fn n_sources(&self) -> usize {
        self.sources.len()
    }

    /// Returns the origin of the light with this index.
    #[inline]
    pub fn origin(&self, index: u32) -> LightOrigin {
        match &self.sources[index as usize] {
            LightSource::Emitter(emitter) => LightOrigin::Surfaces(emitter.material),
            LightSource::Environment(_) => LightOrigin::Background,
            LightSource::Sun(_) => LightOrigin::Sun,
            LightSource::Light(_) | LightSource::Surroundings(_) => LightOrigin::Listed,
        }
    }

    /// Returns the number of lights that are sampled at each point.
    #[inline]
    pub fn n_samples(&self) -> usize {
        match self.choice {
            LightChoice::Each => self.sources.len(),
            LightChoice::ByArrival | LightChoice::ByPower(_) => 1,
        }
    }

    /// Returns true if the choice of light at a point needs random numbers.
    pub fn are_random(&self) -> bool {
        let is_plain = |source: &LightSource| matches!(source, LightSource::Light(_));
        !self.samples_each() || !self.sources.iter().all(is_plain)
    }

    /// Returns true if a random number selects a light by power, or one of a light's shapes.
    #[inline]
    pub fn need_choices(&self) -> bool {
        self.need_choices
    }

    /// Returns the light of sample `i` if it needs no random numbers: it is always the same light,
    /// has no surface and is not attenuated.
    #[inline]
    pub fn plain(&self, i: usize) -> Option<&Light> {
        match &self.sources[i] {
            LightSource::Light(light) if self.samples_each() && !self.is_weakened() => Some(light),
            _ => None,
        }
    }

    /// Returns the light of sample `i` that arrives at a point, unless it is occluded, and the index
    /// of the light.
    #[inline(always)]
    pub fn illuminate<R: Real>(
        &self,
        i: usize,
        at: &LitPoint<R>,
        numbers: &LightNumbers<R>,
    ) -> (Illumination<R>, R) {
        let [number, v] = numbers.point;
        let Chosen {
            index,
            probability,
            number,
        } = self
            .choice
            .choose(i, &self.sources, at.position, numbers.source, number);
        let numbers = LightNumbers {
            point: [number, v],
            ..*numbers
        };
        let light = self.sample_sources(index, at, &numbers);
        let mut light = Illumination {
            radiance: light.radiance / probability,
            density: light.density * probability,
            ..light
        };
        if let Some(fog) = &self.fog {
            let transmittance = fog.transmittance([at.position, light.direction], light.distance);
            light.radiance = light.radiance * transmittance;
        }
        (light, index)
    }

    /// Samples the light of these sources.
    #[inline(always)]
    fn sample_sources<R: Real>(
        &self,
        sources: R,
        at: &LitPoint<R>,
        numbers: &LightNumbers<R>,
    ) -> Illumination<R> {
        let (zero, point) = (sources.splat(0.0), at.position);
        let mut light = Illumination {
            direction: point,
            distance: zero,
            radiance: point,
            density: zero,
        };
        let mut left = zero.splat_mask(true);
        let mut next = sources.next_index(left, 0);
        while let Some((index, source)) = next.and_then(|i| Some((i, self.sources.get(i)?))) {
            let is_next = sources.equals(sources.splat(index as f32));
            let found = source.illuminate(at, numbers);
            light = Illumination {
                direction: Vector::select(is_next, found.direction, light.direction),
                distance: R::select(is_next, found.distance, light.distance),
                radiance: Vector::select(is_next, found.radiance, light.radiance),
                density: R::select(is_next, found.density, light.density),
            };
            left = left & !is_next;
            next = sources.next_index(left, index + 1);
        }
        light
    }

    /// Returns the light for shapes of this material and kind, and its index; `None` if they are
    /// not sampled.
    #[inline]
    pub fn emitter(
        &self,
        material: MaterialId,
        kind: Option<ShapeKind>,
    ) -> Option<(&Emitter, u32)> {
        let key = material.0 as usize * ShapeKind::ALL.len() + kind? as usize;
        let index = (*self.emitters.get(key)?)?;
        let LightSource::Emitter(emitter) = &self.sources[index as usize] else {
            return None;
        };
        Some((emitter, index))
    }

    /// Returns the environment map and its index; `None` if it is not sampled.
    #[inline]
    pub fn environment(&self) -> Option<(&EnvironmentLight, u32)> {
        let index = self.environment?;
        let LightSource::Environment(environment) = &self.sources[index as usize] else {
            return None;
        };
        Some((environment, index))
    }

    /// Returns the index of the sun; `None` if it is not sampled.
    #[inline]
    pub fn sun(&self) -> Option<u32> {
        self.sun
    }

    /// Returns the probability that the light of this index is sampled at a point.
    #[inline(always)]
    pub fn probability<R: Real>(&self, index: u32, point: Vector<R>) -> R {
        self.choice.probability(index, &self.sources, point)
    }

    fn is_weakened(&self) -> bool {
        self.fog.is_some() || self.has_media
    }

    fn samples_each(&self) -> bool {
        matches!(self.choice, LightChoice::Each)
    }
}

/// Shapes and their bounds.
type Shapes = (Vec<[f32; N_PARAMETERS]>, Aabb);

/// Returns the shapes that emit light, by material and kind: the key is `material * n_kinds +
/// kind`.
fn emitting_shapes(materials: &[Material], world: World) -> BTreeMap<usize, Shapes> {
    let mut shapes = BTreeMap::<usize, Shapes>::new();
    if !materials.iter().any(Material::emits) {
        return shapes;
    }
    // If a picture or an opacity varies the light, rays find it by chance.
    let emits = |primitive: &&Primitive| {
        let material = &materials[primitive.material.0 as usize];
        let varies = material.factors.emission.is_some() || material.opacity.is_some();
        material.emits() && !varies
    };
    let mut add = |primitive: &Primitive, parameters, bounds| {
        let Some(kind) = primitive.kind() else {
            return;
        };
        let key = primitive.material.0 as usize * ShapeKind::ALL.len() + kind as usize;
        let of_key = shapes.entry(key).or_insert((Vec::new(), bounds));
        of_key.0.push(parameters);
        of_key.1 = of_key.1.union(bounds);
    };
    for primitive in world.in_render_space().iter().filter(emits) {
        add(primitive, primitive.parameters(), primitive.bounds());
    }
    for (instance, mesh) in world.placed_meshes() {
        for primitive in mesh.iter().filter(emits) {
            let triangle = instance.transform.outward_triangle(&primitive.parameters());
            let bounds = Aabb::from_points(corners(&triangle).map(Vec3::from));
            add(primitive, triangle, bounds);
        }
    }
    shapes
}

/// Returns the bounds of all bounded primitives.
pub(super) fn bounds(primitives: &[Primitive]) -> Aabb {
    let bounded = primitives
        .iter()
        .filter(|primitive| !primitive.is_unbounded());
    let union = bounded.map(Primitive::bounds).reduce(Aabb::union);
    union.unwrap_or(Aabb {
        min: glam::Vec3::ZERO,
        max: glam::Vec3::ZERO,
    })
}
