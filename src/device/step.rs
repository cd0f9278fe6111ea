//! The steps of a path: they read its state by its slots, and return their results one after the
//! other.

use math::simd::{Real, Vector};
use tracer::shade::{Crossing, NextRay, PathFormulas, SurfaceKind};
use tracer::trace::ShadingPoint;
use world::light::Illumination;
use world::material::PictureFactors;

use crate::formulas::{coordinates, number, vector};
use crate::tape::{Operation, Program, Register, Tape};

/// Defines the slots of a path's state, which the recorded functions read, with the list of their
/// names in `path.cl`.
macro_rules! slots {
    ($($(#[$doc:meta])* $name:ident = $number:literal,)*) => {
        pub(crate) mod slot {
            $($(#[$doc])* pub(crate) const $name: usize = $number;)*
            pub(crate) const ALL: &[(&str, u32)] = &[$((stringify!($name), $number)),*];
        }
    };
}

slots! {
    ORIGIN = 0,
    DIRECTION = 3,
    WEIGHT = 6,
    /// The length of the path before the ray.
    LENGTH = 9,
    /// The parameter of the hit.
    T = 10,
    /// The density with which the direction was chosen.
    DENSITY = 11,
    EYE = 12,
    PIXEL = 15,
    SAMPLE = 16,
    DIMENSION = 17,
    /// Position, normal, geometric normal, color and error; then the side.
    POINT = 18,
    SIDE = 31,
    /// The opacity, then the factors of emission, roughness and metallicness.
    OPACITY = 32,
    FACTORS = 33,
    /// Direction, distance, radiance and density; 1 if it is behind the surface.
    LIGHT = 38,
    /// The crossing of a surface: eta, 1 if it is visible, and the indices here and behind it.
    CROSSING = 47,
}

/// Number of slots.
pub(crate) const N_SLOTS: usize = slot::CROSSING + 4;

/// Numbers of an instance.
pub(crate) const N_PLACE: usize = 23;

/// A step of a path, with the numbers that its formulas read.
pub(crate) struct PathStep<'a, R> {
    pub(crate) formulas: &'a PathFormulas<'a>,
    /// The state, by its slots.
    pub(crate) state: [R; N_SLOTS],
    /// The numbers of the primitive and of the instance that were hit, by their indices.
    pub(crate) numbers: [&'a dyn Fn(u32) -> R; 2],
}

/// Records a step.
pub(crate) fn record<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    step: impl FnOnce(&PathStep<Register<'t>>) -> Vec<Register<'t>>,
) -> Program {
    let results = step(&PathStep {
        formulas,
        state: tape.inputs(0),
        numbers: [&|i| tape.leaf(Operation::Data(i)), &|i| {
            tape.leaf(Operation::Place(i))
        }],
    });
    tape.program(&results)
}

impl<R: Real> PathStep<'_, R> {
    /// Returns the point that the ray hits.
    pub(crate) fn point(&self, kind: SurfaceKind) -> Vec<R> {
        let [mut data, mut place] = self.hit();
        let lengths = [slot::T, slot::LENGTH].map(|slot| self.state[slot]);
        let ray = self.ray();
        let (point, opacity) = (self.formulas).point(kind, ray, lengths, &mut data, &mut place);
        let vectors = [
            point.position,
            point.normal,
            point.geometric_normal,
            point.color,
        ];
        let vectors = vectors.into_iter().flat_map(coordinates);
        let mut results: Vec<_> = vectors.chain([point.error, point.side, opacity]).collect();
        if self.formulas.has_factors() {
            results.extend(coordinates(point.factors.emission));
            results.extend([point.factors.roughness, point.factors.metallic]);
        }
        results
    }

    /// Returns the light of the point without light samples.
    pub(crate) fn own_light(&self, kind: SurfaceKind) -> Vec<R> {
        let [mut data, mut place] = self.hit();
        let (at, t) = (self.shading_point(), self.at(slot::T));
        let parameters = || self.formulas.parameters(kind, &mut data, &mut place);
        let light = (self.formulas).own_light(kind.class, &at, self.ray(), t, parameters);
        coordinates(light).into()
    }

    /// Returns light sample `i`.
    pub(crate) fn light(&self, i: usize) -> Vec<R> {
        let at = self.shading_point();
        let (light, _) = self.formulas.light(i, &at, self.sample());
        let is_behind = number(light.distance, at.is_backed_by(light.direction));
        let mut results = coordinates(light.direction).to_vec();
        results.push(light.distance);
        results.extend(coordinates(light.radiance));
        results.extend([light.density, is_behind]);
        results
    }

    /// Returns if the light sample may arrive, and its shadow ray.
    pub(crate) fn shadow(&self, kind: SurfaceKind) -> Vec<R> {
        let (of, at) = (self.formulas.material(kind), self.shading_point());
        let shadow = self.formulas.shadow(of, &at, &self.light_sample());
        let [x, y, z] = coordinates(shadow.origin);
        vec![number(shadow.end, shadow.may_arrive), x, y, z, shadow.end]
    }

    /// Returns the light of the light sample that the point reflects.
    pub(crate) fn reflected(&self, kind: SurfaceKind) -> Vec<R> {
        let (of, at) = (self.formulas.material(kind), self.shading_point());
        let rays = [slot::EYE, slot::DIRECTION].map(|slot| self.vector(slot));
        let light = self.light_sample();
        let light = (self.formulas).reflected(of, &at, &light, rays, &self.crossing());
        coordinates(light).into()
    }

    /// Returns if there is a next ray; then its kind, 0 if reflected, 1 if refracted, 2 if diffuse;
    /// its origin, direction, weight and density.
    pub(crate) fn next(&self, kind: SurfaceKind, is_late: bool) -> Vec<R> {
        let [zero, one, two] = [0.0, 1.0, 2.0].map(|number| self.state[0].splat(number));
        let (of, at) = (self.formulas.material(kind), self.shading_point());
        if !self.formulas.surface(of).continues {
            return vec![zero; 12];
        }
        let path = [slot::DIRECTION, slot::WEIGHT].map(|slot| self.vector(slot));
        let (sample, crossing) = (self.sample(), self.crossing());
        let ray = (self.formulas).next(of, &at, path, sample, &crossing, is_late);
        let of_kind = R::select(ray.is_diffuse, two, zero);
        let of_kind = R::select(ray.is_refracted, one, of_kind);
        let head = [number(zero, ray.is_alive), of_kind].into_iter();
        head.chain(numbers(&ray)).chain([ray.density]).collect()
    }

    /// Returns the two rays that continue a path that splits: of each, if there is one, its origin,
    /// direction and weight.
    pub(crate) fn split(&self, kind: SurfaceKind) -> Vec<R> {
        let (of, at) = (self.formulas.material(kind), self.shading_point());
        let path = [slot::DIRECTION, slot::WEIGHT].map(|slot| self.vector(slot));
        let opacity = self.state[slot::OPACITY];
        let rays = (self.formulas).split(of, &at, path, opacity, &self.crossing());
        let is_alive = |ray: &NextRay<R>| number(opacity, ray.is_alive);
        let results = rays.map(|ray| std::iter::once(is_alive(&ray)).chain(numbers(&ray)));
        results.into_iter().flatten().collect()
    }

    /// Returns the rest of the ray past its hit: the share of light of a shadow ray; 1 if another ray
    /// passes; the origin, and its distance from the old one.
    pub(crate) fn passage(&self, kind: SurfaceKind) -> Vec<R> {
        let [mut data, mut place] = self.hit();
        let t = self.state[slot::T];
        let past = (self.formulas).passage(kind, self.ray(), t, &mut data, &mut place);
        let [x, y, z] = coordinates(past.origin);
        let is_passed = number(t, past.is_passed);
        vec![past.share, is_passed, x, y, z, past.advance]
    }

    /// Returns the share of light that fog leaves on the way to the hit, and the light that it adds.
    pub(crate) fn fade(&self) -> Vec<R> {
        let (share, light) = self.formulas.fade(self.ray(), self.state[slot::T]);
        std::iter::once(share).chain(coordinates(light)).collect()
    }

    /// Returns if the ray meets a particle of fog before its hit, and where.
    pub(crate) fn flight(&self) -> Vec<R> {
        let t = self.state[slot::T];
        let (is_met, t) = self.formulas.flight(self.ray(), t, self.sample());
        vec![number(t, is_met), t]
    }

    /// Returns the background that the ray sees.
    pub(crate) fn background(&self) -> Vec<R> {
        let density = self.state[slot::DENSITY];
        coordinates(self.formulas.background(self.ray(), density)).into()
    }

    /// Returns the numbers in a slot and the next ones.
    fn at<const N: usize>(&self, slot: usize) -> [R; N] {
        std::array::from_fn(|i| self.state[slot + i])
    }

    fn vector(&self, slot: usize) -> Vector<R> {
        vector(self.at(slot))
    }

    /// Returns the ray: its origin and its direction.
    fn ray(&self) -> [Vector<R>; 2] {
        [slot::ORIGIN, slot::DIRECTION].map(|slot| self.vector(slot))
    }

    /// Returns readers of the numbers of the primitive and of the instance.
    fn hit(&self) -> [impl FnMut() -> R; 2] {
        self.numbers.map(|number| {
            let mut next = 0..;
            move || number(next.next().unwrap_or(0))
        })
    }

    /// Returns the numbers of pixel, sample and first dimension.
    fn sample(&self) -> [R::Integer; 3] {
        [slot::PIXEL, slot::SAMPLE, slot::DIMENSION].map(|slot| self.state[slot].to_integer_bits())
    }

    /// Returns the point that was hit.
    fn shading_point(&self) -> ShadingPoint<R> {
        let [position, normal, geometric_normal, color] =
            [0, 3, 6, 9].map(|first| self.vector(slot::POINT + first));
        let [error, side] = [slot::POINT + 12, slot::SIDE].map(|slot| self.state[slot]);
        let [roughness, metallic] = self.at(slot::FACTORS + 3);
        ShadingPoint {
            position,
            normal,
            geometric_normal,
            color,
            error,
            side,
            factors: if self.formulas.has_factors() {
                PictureFactors {
                    emission: self.vector(slot::FACTORS),
                    roughness,
                    metallic,
                }
            } else {
                PictureFactors::ones(side)
            },
        }
    }

    /// Returns the crossing of the surface.
    fn crossing(&self) -> Crossing<R> {
        let [eta, visible, here, behind] = self.at(slot::CROSSING);
        Crossing {
            eta,
            is_visible: visible.splat(0.0).lt(visible),
            indices: [here, behind],
        }
    }

    /// Returns the light of the light sample.
    fn light_sample(&self) -> Illumination<R> {
        let [distance, .., density] = self.at::<5>(slot::LIGHT + 3);
        Illumination {
            direction: self.vector(slot::LIGHT),
            distance,
            radiance: self.vector(slot::LIGHT + 4),
            density,
        }
    }
}

/// Returns origin, direction and weight of a ray, one number after the other.
fn numbers<R: Real>(ray: &NextRay<R>) -> impl Iterator<Item = R> + use<R> {
    let vectors = [ray.origin, ray.direction, ray.weight];
    vectors.into_iter().flat_map(coordinates)
}

#[cfg(test)]
pub(crate) mod tests {
    use std::path::Path;

    use math::sampling::{PixelPattern, Sampler};
    use proptest::prelude::*;
    use scene::build::Geometries;
    use scene::config::Config;
    use tracer::shade::Shader;
    use world::scene::Scene;

    use super::*;

    /// Returns a scene of surfaces whose formulas look nothing up.
    fn scene(model: &str) -> Scene {
        let roughness = if model == "path" { 0.4 } else { 0.0 };
        let of_card = if model == "seed" {
            ""
        } else {
            ", two_sided: false, emission: 2, opacity: 0.4"
        };
        let of_glass = match model {
            "seed" => "color: [0.8, 1, 0.9], specular: 0.6, exponent: 90",
            _ => "dielectric: { index: 1.5, absorption: [0, 0.1, 0.5] }",
        };
        let (of_frosted, sampling) = match model {
            "path" => (
                "principled: { metallic: 0.2, roughness: 0.3, transmission: 0.5, index: 1.45 }, multiple_scattering: false",
                ", light_sampling: each",
            ),
            _ => ("diffuse: 0.3, reflection: 0.5", ""),
        };
        let folder = env!("CARGO_MANIFEST_DIR");
        let text = format!(
            "shading: {{ model: {model}{sampling} }}
materials:
  checker: {{ color: {{ checker: {{ even: 1, odd: 0.2, size: 0.4 }} }} }}
  glossy: {{ color: [0.2, 0.5, 0.3], diffuse: 0.5, specular: 0.3, exponent: 40, reflection: 0.2, multiple_scattering: false }}
  mirror: {{ conductor: gold }}
  metal: {{ conductor: copper, roughness: {roughness}, multiple_scattering: false }}
  card: {{ color: 0.6{of_card} }}
  glass: {{ {of_glass} }}
  frosted: {{ color: [1, 0.9, 0.8], {of_frosted} }}
lights:
  - point: {{ position: [2, 3, 4], intensity: 9, falloff: inverse_square }}
  - spot: {{ position: [0, 5, 0], target: [0, 0, 1], angle_deg: 40, soft_edge: 0.2, intensity: 20, falloff: inverse }}
  - directional: {{ direction: [-1, -2, 1], color: [2, 2, 2] }}
objects:
  - {{ plane: {{ point: [0, -1, 0], normal: [0, 1, 0] }}, material: checker }}
  - {{ sphere: {{ center: [0, 0, 0], radius: 0.5 }}, material: glossy }}
  - {{ sphere: {{ center: [1, 0, 0], radius: 0.5 }}, transform: [{{ scale: [1, 2, 1] }}, {{ rotate: {{ axis: [1, 2, 0], angle_deg: 20 }} }}], material: metal }}
  - {{ box: {{ min: [1, 1, 1], max: [2, 2, 2] }}, material: mirror }}
  - {{ disk: {{ center: [-1, 0, 0], normal: [1, 2, 3], radius: 0.6 }}, material: card }}
  - {{ rectangle: {{ corner: [-1, 4, -1], edges: [[2, 0, 0], [0, 0, 2]] }}, material: glass }}
  - {{ cylinder: {{ ends: [[0, 0, 2], [0, 3, 2]], radius: 0.2 }}, material: frosted }}
  - {{ cone: {{ ends: [[0, 3, 2], [0, 4, 2]], radius: [0.4, 0.1] }}, material: glossy }}
  - {{ capsule: {{ ends: [[1, 0, 2], [2, 0, 2]], radius: [0.2, 0.1] }}, material: glass }}
  - {{ triangle: {{ vertices: [[-1, 0, 2], [1, 0, 2], [0, 1, 2]] }}, material: metal }}
  - instances:
      mesh: {{ file: {folder}/../../tests/device/octahedron.obj, normals: smooth }}
      places: [[{{ scale: [-1, 1, 0.5] }}, {{ rotate: {{ axis: [0, 1, 0], angle_deg: 30 }} }}, {{ translate: [2, 0, 0] }}]]
    material: glossy
"
        );
        built(&text)
    }

    /// Builds the scene of a text without image and camera.
    pub(crate) fn built(text: &str) -> Scene {
        let view = "image: { width: 4, height: 4 }
camera: { look_at: { eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 } }
";
        let mut config: Config = scene::yaml::from_str(&(view.to_owned() + text)).unwrap();
        let geometries = Geometries::read(&mut config, Path::new("."), u64::MAX).unwrap();
        scene::build::scene(&config, geometries).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The slow twin of a recorded step is the same step with single numbers.
        #[test]
        fn recorded_steps_compute_what_they_compute_with_numbers(
            numbers in prop::array::uniform::<_, N_SLOTS>(-1.0_f32..1.0),
            words in prop::array::uniform3(0_u32..1000),
            model in prop::sample::select(&["path", "blinn_phong", "seed", "ambient_occlusion"][..]),
        ) {
            let mut state = numbers;
            // Unit vectors, and a side.
            for slot in [slot::DIRECTION, slot::POINT + 3, slot::POINT + 6, slot::LIGHT] {
                let unit = vector([0, 1, 2].map(|i| state[slot + i])).normalize();
                state[slot..slot + 3].copy_from_slice(&coordinates(unit));
            }
            // Among others, equal and opposite normals.
            if let factor @ (1.0 | -1.0) = 1.0 - (words[0] % 8) as f32 {
                let normal = vector([3, 4, 5].map(|i| state[slot::POINT + i])) * factor;
                state[slot::POINT + 6..][..3].copy_from_slice(&coordinates(normal));
            }
            state[slot::SIDE] = if state[slot::T] < 0.0 { -1.0 } else { 1.0 };
            for (slot, word) in [slot::PIXEL, slot::SAMPLE, slot::DIMENSION].into_iter().zip(words) {
                state[slot] = f32::from_bits(word);
            }
            let scene = scene(model);
            let formulas = &Shader::new(&scene, Sampler::new(PixelPattern::Sobol, 1, 7)).formulas(None);
            let mut places = Vec::new();
            formulas.push_instances(&mut places);
            places.resize(places.len().max(N_PLACE), 0.0);
            for primitive in 0..formulas.n_primitives() {
                // The box of instances is not a surface.
                let Some(kind) = formulas.kind(primitive) else { continue };
                let mut data = Vec::new();
                formulas.push_data(kind, primitive, &mut data);
                let numbers: [&dyn Fn(u32) -> f32; 2] = [&|i| data[i as usize], &|i| places[i as usize]];
                let plain = PathStep { formulas, state, numbers };
                macro_rules! check {
                    ($step:ident.$method:ident($($of:expr),*)) => {
                        let tape = Tape::default();
                        let program = record(formulas, &tape, |$step| $step.$method($($of),*));
                        prop_assert_eq!(tape.refusal(), None);
                        let expected = plain.$method($($of),*);
                        let checked = program.check([&state, &data, &places], &expected);
                        prop_assert_eq!(checked, Ok(()), "{} of {:?}", stringify!($method), kind);
                    };
                }
                check!(step.point(kind));
                check!(step.own_light(kind));
                for light in 0..formulas.rules().n_lights {
                    check!(step.light(light));
                }
                check!(step.shadow(kind));
                check!(step.reflected(kind));
                check!(step.next(kind, false));
                check!(step.next(kind, true));
                check!(step.split(kind));
                check!(step.passage(kind));
                check!(step.background());
                check!(step.fade());
                check!(step.flight());
            }
        }
    }
}
