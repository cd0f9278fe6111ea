//! The lights of a scene: those of its `lights` section, then the surfaces that emit
//! light, then the picture around it and its sun.

use super::emitter::{Emitter, luminance};
use super::environment::EnvironmentLight;
use super::primitive::{MaterialId, Primitive};
use crate::background::{Background, Sun};
use crate::config::LightSampling;
use crate::geometry::{Aabb, N_PARAMETERS, ShapeKind};
use crate::light::{Illumination, Light};
use crate::material::Material;
use crate::sampling::{AliasTable, hemisphere};
use crate::simd::{Mask, Real, Vector};

/// See the file's documentation.
#[derive(Debug, Clone, Default)]
pub struct Lights {
    sources: Vec<LightSource>,
    /// The sources by power, unless each is sampled.
    by_power: Option<AliasTable>,
    /// The index of the source of each material and kind of shape.
    emitters: Vec<Option<u32>>,
    /// The index of the picture around the scene.
    environment: Option<u32>,
    /// The index of the sun.
    sun: Option<u32>,
}

/// Where a light of a scene comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightOrigin {
    /// The `lights` section, or the model of shading.
    Listed,
    /// The surfaces of a material.
    Surfaces(MaterialId),
    /// The picture of the `background` section.
    Background,
    /// The sun of the `background` section.
    Sun,
}

#[derive(Debug, Clone)]
enum LightSource {
    Light(Light),
    Emitter(Box<Emitter>),
    Environment(Box<EnvironmentLight>),
    Sun(Sun),
    /// The space around a point, up to a distance.
    Surroundings(f32),
}

/// The random numbers that choose the light at a point.
#[derive(Debug, Clone, Copy)]
pub struct LightNumbers<R> {
    /// Chooses one of the lights.
    pub source: R,
    /// Chooses one of the shapes of a light.
    pub shape: R,
    /// Choose the point of a shape.
    pub point: [R; 2],
}

impl Lights {
    /// The space around each point, up to a distance, as the only light.
    pub(super) fn surroundings(distance: f32) -> Self {
        Self {
            sources: vec![LightSource::Surroundings(distance)],
            ..Self::default()
        }
    }

    pub(super) fn new(
        lights: &[Light],
        materials: &[Material],
        primitives: &[Primitive],
        background: Option<&Background>,
        sampling: LightSampling,
    ) -> Self {
        let mut sources: Vec<LightSource> =
            lights.iter().copied().map(LightSource::Light).collect();
        let n_kinds = ShapeKind::ALL.len();
        let mut emitters = vec![None; materials.len() * n_kinds];
        for (key, shapes) in emitting_shapes(materials, primitives) {
            let (material, kind) = (key / n_kinds, ShapeKind::ALL[key % n_kinds]);
            let id = MaterialId(material as u32);
            if let Some(emitter) = Emitter::new(id, &materials[material], kind, shapes) {
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
        let by_power = match sampling {
            LightSampling::Each => None,
            LightSampling::Power => {
                let bounds = bounds(primitives);
                let powers: Vec<f64> = sources.iter().map(|of| of.power(&bounds)).collect();
                AliasTable::new(&powers)
            }
        };
        Self {
            sources,
            by_power,
            emitters,
            environment,
            sun,
        }
    }

    /// Number of lights.
    pub fn n_sources(&self) -> usize {
        self.sources.len()
    }

    /// Where the light with this index comes from.
    pub fn origin(&self, index: u32) -> LightOrigin {
        match &self.sources[index as usize] {
            LightSource::Emitter(emitter) => LightOrigin::Surfaces(emitter.material),
            LightSource::Environment(_) => LightOrigin::Background,
            LightSource::Sun(_) => LightOrigin::Sun,
            LightSource::Light(_) | LightSource::Surroundings(_) => LightOrigin::Listed,
        }
    }

    /// Number of lights that are sampled at each point.
    pub fn n_samples(&self) -> usize {
        match self.by_power {
            Some(_) => 1,
            None => self.sources.len(),
        }
    }

    /// Whether the choice of light at a point needs random numbers.
    pub fn are_random(&self) -> bool {
        let is_plain = |source: &LightSource| matches!(source, LightSource::Light(_));
        self.by_power.is_some() || !self.sources.iter().all(is_plain)
    }

    /// The light of sample `i`, if it is always the same one and has no surface, so that
    /// it needs no random numbers.
    #[inline]
    pub fn plain(&self, i: usize) -> Option<&Light> {
        match &self.sources[i] {
            LightSource::Light(light) if self.by_power.is_none() => Some(light),
            _ => None,
        }
    }

    /// The light of sample `i` that arrives at a point with a normal, unless it is
    /// occluded, and the index of the light.
    #[inline(always)]
    pub fn illuminate<R: Real>(
        &self,
        i: usize,
        at: [Vector<R>; 2],
        numbers: &LightNumbers<R>,
    ) -> (Illumination<R>, R) {
        let one = numbers.source.splat(1.0);
        let (source, probability) = match &self.by_power {
            None => (one.splat(i as f32), one),
            Some(by_power) => {
                let source = by_power.choose(numbers.source);
                (source, by_power.probability(source))
            }
        };
        let light = self.of_sources(source, at, numbers);
        let light = Illumination {
            radiance: light.radiance / probability,
            density: light.density * probability,
            ..light
        };
        (light, source)
    }

    /// The light of these sources.
    #[inline(always)]
    fn of_sources<R: Real>(
        &self,
        sources: R,
        at: [Vector<R>; 2],
        numbers: &LightNumbers<R>,
    ) -> Illumination<R> {
        let (zero, [point, _]) = (sources.splat(0.0), at);
        let mut light = Illumination {
            direction: point,
            distance: zero,
            radiance: point,
            density: zero,
        };
        let mut left = zero.equals(zero);
        while left.bits() != 0 {
            let next = sources.lane(left.bits().trailing_zeros() as usize);
            let is_next = sources.equals(sources.splat(next));
            let found = self.sources[next as usize].illuminate(at, numbers);
            light = Illumination {
                direction: Vector::select(is_next, found.direction, light.direction),
                distance: R::select(is_next, found.distance, light.distance),
                radiance: Vector::select(is_next, found.radiance, light.radiance),
                density: R::select(is_next, found.density, light.density),
            };
            left = left & !is_next;
        }
        light
    }

    /// The light that shapes of this material and kind are, and the probability of its
    /// choice; `None` if they are not sampled.
    #[inline]
    pub fn emitter(
        &self,
        material: MaterialId,
        kind: Option<ShapeKind>,
    ) -> Option<(&Emitter, f32)> {
        let key = material.0 as usize * ShapeKind::ALL.len() + kind? as usize;
        let index = (*self.emitters.get(key)?)?;
        let LightSource::Emitter(emitter) = &self.sources[index as usize] else {
            return None;
        };
        Some((emitter, self.probability(index)))
    }

    /// The picture around the scene and the probability of its choice; `None` if it is not
    /// sampled.
    #[inline]
    pub fn environment(&self) -> Option<(&EnvironmentLight, f32)> {
        let index = self.environment?;
        let LightSource::Environment(environment) = &self.sources[index as usize] else {
            return None;
        };
        Some((environment, self.probability(index)))
    }

    /// The sun and the probability of its choice; `None` if it is not sampled.
    #[inline]
    pub fn sun(&self) -> Option<(&Sun, f32)> {
        let index = self.sun?;
        let LightSource::Sun(sun) = &self.sources[index as usize] else {
            return None;
        };
        Some((sun, self.probability(index)))
    }

    /// The probability of the choice of a light.
    fn probability(&self, index: u32) -> f32 {
        let by_power = self.by_power.as_ref();
        by_power.map_or(1.0, |by_power| by_power.probability(index as f32))
    }
}

impl LightSource {
    #[inline(always)]
    fn illuminate<R: Real>(
        &self,
        [point, normal]: [Vector<R>; 2],
        numbers: &LightNumbers<R>,
    ) -> Illumination<R> {
        match self {
            Self::Surroundings(distance) => surroundings(normal, *distance, numbers.point),
            Self::Light(light) => light.illuminate(point),
            Self::Emitter(emitter) => emitter.illuminate(point, numbers.shape, numbers.point),
            Self::Environment(environment) => environment.illuminate(numbers.point),
            Self::Sun(sun) => sun.illuminate(numbers.point),
        }
    }

    /// The power, of a light without surface that which a sphere around the scene gets.
    fn power(&self, scene: &Aabb) -> f64 {
        let center = scene.center();
        let radius = (0.5 * (scene.max - scene.min).length()).max(1e-6);
        let radiance = match self {
            Self::Surroundings(_) => return 0.0,
            Self::Emitter(emitter) => return emitter.power(),
            Self::Environment(environment) => return environment.power(radius),
            Self::Sun(sun) => luminance(sun.of_white()),
            Self::Light(light) => match light.position() {
                // At this distance, whatever the falloff.
                Some(position) => {
                    let point = position + radius * glam::Vec3::Y;
                    4.0 * luminance(light.illuminate(point.into()).radiance.into())
                }
                None => luminance(light.illuminate(center.into()).radiance.into()),
            },
        };
        let pi = std::f64::consts::PI;
        pi * pi * f64::from(radius).powi(2) * f64::from(radiance)
    }
}

/// White light of radiance 1 from the directions around a normal, in proportion to their
/// cosine, and as far as nothing is nearer than a distance.
#[inline(always)]
fn surroundings<R: Real>(normal: Vector<R>, distance: f32, numbers: [R; 2]) -> Illumination<R> {
    let [x, y, cos] = hemisphere(numbers);
    Illumination {
        direction: normal.around([x, y, cos]).normalize(),
        distance: cos.splat(distance),
        radiance: Vector::splat(cos, glam::Vec3::ONE),
        density: cos * cos.splat(std::f32::consts::FRAC_1_PI),
    }
}

/// The shapes that emit light, by material and kind: its key is
/// `material * n_kinds + kind`.
fn emitting_shapes(
    materials: &[Material],
    primitives: &[Primitive],
) -> std::collections::BTreeMap<usize, Vec<[f32; N_PARAMETERS]>> {
    let mut shapes = std::collections::BTreeMap::<_, Vec<_>>::new();
    if !materials.iter().any(Material::emits) {
        return shapes;
    }
    for primitive in primitives {
        let material = primitive.material.0 as usize;
        if let Some(kind) = primitive.kind()
            && materials[material].emits()
        {
            let key = material * ShapeKind::ALL.len() + kind as usize;
            shapes.entry(key).or_default().push(primitive.parameters());
        }
    }
    shapes
}

/// The bounds of all primitives that have some.
fn bounds(primitives: &[Primitive]) -> Aabb {
    let bounded = primitives
        .iter()
        .filter(|primitive| !primitive.is_unbounded());
    let union = bounded.map(Primitive::bounds).reduce(Aabb::union);
    union.unwrap_or(Aabb {
        min: glam::Vec3::ZERO,
        max: glam::Vec3::ZERO,
    })
}
