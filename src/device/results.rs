//! The formulas of a path's steps, recorded: they read the path's state by its slots, and write their
//! results one after the other.

use math::simd::{Arithmetic, Real, Vector};
use tracer::shade::{Crossing, NextRay, PathFormulas, SurfaceKind};
use tracer::trace::ShadingPoint;
use world::light::Illumination;
use world::material::PictureFactors;

use crate::formulas::{coordinates, number, vector};
use crate::tape::{Operation, Register, Tape};

/// Defines the slots of a path's state, which the recorded functions read, with the list of their
/// names in `path.cl`.
macro_rules! slots {
    ($($(#[$doc:meta])* $name:ident = $number:literal,)*) => {
        pub(crate) mod slot {
            $($(#[$doc])* pub(crate) const $name: usize = $number;)*
            pub(crate) const ALL: &[(&str, usize)] = &[$((stringify!($name), $number)),*];
        }
    };
}

slots! {
    ORIGIN = 0,
    DIRECTION = 3,
    /// The parameter of the hit.
    T = 6,
    /// The density with which the direction was chosen.
    DENSITY = 7,
    EYE = 8,
    WEIGHT = 11,
    PIXEL = 14,
    SAMPLE = 15,
    DIMENSION = 16,
    /// Position, normal, geometric normal, color and error; then the side.
    POINT = 17,
    SIDE = 30,
    /// The opacity, then the factors of emission, roughness and metallicness.
    OPACITY = 31,
    FACTORS = 32,
    /// Direction, distance, radiance and density; 1 if it is behind the surface.
    LIGHT = 37,
    /// The crossing of a surface: eta, 1 if it is visible, and the indices here and behind it.
    CROSSING = 46,
    /// The length of the path before the ray.
    LENGTH = 50,
}

/// Number of slots.
pub(crate) const N_SLOTS: usize = slot::LENGTH + 1;

/// Records the point that the ray hits.
pub(crate) fn point_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
) -> Vec<Register<'t>> {
    let [mut data, mut place] = hit(tape);
    let [[t], [length]] = [slot::T, slot::LENGTH].map(|slot| tape.inputs(slot));
    let (point, opacity) = formulas.point(kind, ray(tape), [t, length], &mut data, &mut place);
    let vectors = [
        point.position,
        point.normal,
        point.geometric_normal,
        point.color,
    ];
    let vectors = vectors.into_iter().flat_map(coordinates);
    let mut results: Vec<_> = vectors.chain([point.error, point.side, opacity]).collect();
    if formulas.has_factors() {
        results.extend(coordinates(point.factors.emission));
        results.extend([point.factors.roughness, point.factors.metallic]);
    }
    results
}

/// Records the light of the point without light samples.
pub(crate) fn own_light_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
) -> Vec<Register<'t>> {
    let [mut data, mut place] = hit(tape);
    let at = point(formulas, tape);
    let t = tape.inputs(slot::T);
    let light = formulas.own_light(kind.class, &at, ray(tape), t, || {
        formulas.parameters(kind, &mut data, &mut place)
    });
    coordinates(light).into()
}

/// Records light sample `i`.
pub(crate) fn light_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    i: usize,
) -> Vec<Register<'t>> {
    let at = point(formulas, tape);
    let (light, _) = formulas.light(i, &at, sample(tape));
    let [x, y, z] = coordinates(light.direction);
    let [red, green, blue] = coordinates(light.radiance);
    let is_behind = number(light.distance, at.is_backed_by(light.direction));
    vec![
        x,
        y,
        z,
        light.distance,
        red,
        green,
        blue,
        light.density,
        is_behind,
    ]
}

/// Records if the light sample may arrive, and its shadow ray.
pub(crate) fn shadow_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
) -> Vec<Register<'t>> {
    let shadow = formulas.shadow(
        formulas.material(kind),
        &point(formulas, tape),
        &light(tape),
    );
    let [x, y, z] = coordinates(shadow.origin);
    vec![number(shadow.end, shadow.may_arrive), x, y, z, shadow.end]
}

/// Records the light of the light sample that the point reflects.
pub(crate) fn reflected_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
) -> Vec<Register<'t>> {
    let rays = [slot::EYE, slot::DIRECTION].map(|slot| at(tape, slot));
    let (of, at) = (formulas.material(kind), point(formulas, tape));
    let light = formulas.reflected(of, &at, &light(tape), rays, &crossing(tape));
    coordinates(light).into()
}

/// Records if there is a next ray; then its kind, 0 if reflected, 1 if refracted, 2 if diffuse; its
/// origin, direction, weight and density.
pub(crate) fn next_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
    is_late: bool,
) -> Vec<Register<'t>> {
    if !formulas.surface(formulas.material(kind)).continues {
        return vec![tape.zero(); 12];
    }
    let path = [slot::DIRECTION, slot::WEIGHT].map(|slot| at(tape, slot));
    let at = point(formulas, tape);
    let of = formulas.material(kind);
    let ray = formulas.next(of, &at, path, sample(tape), &crossing(tape), is_late);
    let density = ray.density;
    let [zero, one, two] = [0.0, 1.0, 2.0].map(|number| density.splat(number));
    let of_kind = Register::select(ray.is_diffuse, two, zero);
    let of_kind = Register::select(ray.is_refracted, one, of_kind);
    let head = [number(density, ray.is_alive), of_kind].into_iter();
    head.chain(numbers(&ray)).chain([density]).collect()
}

/// Records the two rays that continue a path that splits: of each, if there is one, its origin,
/// direction and weight.
pub(crate) fn split_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
) -> Vec<Register<'t>> {
    let path = [slot::DIRECTION, slot::WEIGHT].map(|slot| at(tape, slot));
    let [opacity] = tape.inputs(slot::OPACITY);
    let at = point(formulas, tape);
    let rays = formulas.split(formulas.material(kind), &at, path, opacity, &crossing(tape));
    let results =
        rays.map(|ray| std::iter::once(number(opacity, ray.is_alive)).chain(numbers(&ray)));
    results.into_iter().flatten().collect()
}

/// Records the rest of the ray past its hit: the share of light of a shadow ray; 1 if another ray
/// passes; the origin, and its distance from the old one.
pub(crate) fn passage_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
    kind: SurfaceKind,
) -> Vec<Register<'t>> {
    let [mut data, mut place] = hit(tape);
    let [t] = tape.inputs(slot::T);
    let past = formulas.passage(kind, ray(tape), t, &mut data, &mut place);
    let [x, y, z] = coordinates(past.origin);
    let is_passed = number(t, past.is_passed);
    vec![past.share, is_passed, x, y, z, past.advance]
}

/// Records the share of light that fog leaves on the way to the hit, and the light that it adds.
pub(crate) fn fade_results<'t>(formulas: &PathFormulas, tape: &'t Tape<'t>) -> Vec<Register<'t>> {
    let [t] = tape.inputs(slot::T);
    let (share, light) = formulas.fade(ray(tape), t);
    std::iter::once(share).chain(coordinates(light)).collect()
}

/// Records if the ray meets a particle of fog before its hit, and where.
pub(crate) fn flight_results<'t>(formulas: &PathFormulas, tape: &'t Tape<'t>) -> Vec<Register<'t>> {
    let [t] = tape.inputs(slot::T);
    let (is_met, t) = formulas.flight(ray(tape), t, sample(tape));
    vec![number(t, is_met), t]
}

/// Records the background that the ray sees.
pub(crate) fn background_results<'t>(
    formulas: &PathFormulas,
    tape: &'t Tape<'t>,
) -> Vec<Register<'t>> {
    let [density] = tape.inputs(slot::DENSITY);
    coordinates(formulas.background(ray(tape), density)).into()
}

/// Returns origin, direction and weight of a ray, one number after the other.
fn numbers<R: Real>(ray: &NextRay<R>) -> impl Iterator<Item = R> + use<R> {
    let vectors = [ray.origin, ray.direction, ray.weight];
    vectors.into_iter().flat_map(coordinates)
}

/// Returns the ray: its origin and its direction.
fn ray<'t>(tape: &'t Tape<'t>) -> [Vector<Register<'t>>; 2] {
    [slot::ORIGIN, slot::DIRECTION].map(|slot| at(tape, slot))
}

/// Returns the numbers of the primitive and of the instance that were hit.
fn hit<'t>(tape: &'t Tape<'t>) -> [impl FnMut() -> Register<'t>; 2] {
    [Operation::Data, Operation::Place].map(|of: fn(u32) -> Operation| tape.numbers(of))
}

/// Returns the vector in a slot and the next two.
fn at<'t>(tape: &'t Tape<'t>, slot: usize) -> Vector<Register<'t>> {
    vector(tape.inputs(slot))
}

/// Returns the numbers of pixel, sample and first dimension.
fn sample<'t>(tape: &'t Tape<'t>) -> [Register<'t>; 3] {
    [slot::PIXEL, slot::SAMPLE, slot::DIMENSION].map(|slot| tape.integer(slot))
}

/// Returns the point that was hit.
fn point<'t>(formulas: &PathFormulas, tape: &'t Tape<'t>) -> ShadingPoint<Register<'t>> {
    let [position, normal, geometric_normal, color] =
        [0, 3, 6, 9].map(|first| at(tape, slot::POINT + first));
    let ([error], [side]) = (tape.inputs(slot::POINT + 12), tape.inputs(slot::SIDE));
    let [roughness, metallic] = tape.inputs(slot::FACTORS + 3);
    ShadingPoint {
        position,
        normal,
        geometric_normal,
        color,
        error,
        side,
        factors: if formulas.has_factors() {
            PictureFactors {
                emission: at(tape, slot::FACTORS),
                roughness,
                metallic,
            }
        } else {
            PictureFactors::ones(side)
        },
    }
}

/// Returns the crossing of the surface.
fn crossing<'t>(tape: &'t Tape<'t>) -> Crossing<Register<'t>> {
    let [eta, visible, here, behind] = tape.inputs(slot::CROSSING);
    Crossing {
        eta,
        is_visible: visible.splat(0.0).lt(visible),
        indices: [here, behind],
    }
}

/// Returns the light of the light sample.
fn light<'t>(tape: &'t Tape<'t>) -> Illumination<Register<'t>> {
    let [direction, radiance] = [0, 4].map(|first| at(tape, slot::LIGHT + first));
    let ([distance], [density]) = (tape.inputs(slot::LIGHT + 3), tape.inputs(slot::LIGHT + 7));
    Illumination {
        direction,
        distance,
        radiance,
        density,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::path::Path;

    use math::sampling::{PixelPattern, Sampler};
    use proptest::prelude::*;
    use scene::build::Geometries;
    use scene::config::Config;
    use tracer::shade::{Shader, ShadowFormula};
    use world::scene::Scene;

    use super::*;
    use crate::tape::Program;

    /// Returns a scene of surfaces whose formulas look nothing up.
    fn scene(model: &str) -> Scene {
        let roughness = if model == "path" { 0.4 } else { 0.0 };
        let of_card = if model == "seed" {
            ""
        } else {
            ", two_sided: false, emission: 2, opacity: 0.4"
        };
        let text = format!(
            "image: {{ width: 4, height: 4 }}
camera: {{ look_at: {{ eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 }} }}
shading: {{ model: {model} }}
materials:
  checker: {{ color: {{ checker: {{ even: 1, odd: 0.2, size: 0.4 }} }} }}
  glossy: {{ color: [0.2, 0.5, 0.3], diffuse: 0.5, specular: 0.3, exponent: 40, reflection: 0.2, multiple_scattering: false }}
  mirror: {{ conductor: gold }}
  metal: {{ conductor: copper, roughness: {roughness}, multiple_scattering: false }}
  card: {{ color: 0.6{of_card} }}
lights:
  - point: {{ position: [2, 3, 4], intensity: 9, falloff: inverse_square }}
objects:
  - {{ plane: {{ point: [0, -1, 0], normal: [0, 1, 0] }}, material: checker }}
  - {{ sphere: {{ center: [0, 0, 0], radius: 0.5 }}, material: glossy }}
  - {{ sphere: {{ center: [1, 0, 0], radius: 0.5 }}, transform: [{{ scale: [1, 2, 1] }}, {{ rotate: {{ axis: [1, 2, 0], angle_deg: 20 }} }}], material: metal }}
  - {{ box: {{ min: [1, 1, 1], max: [2, 2, 2] }}, material: mirror }}
  - {{ disk: {{ center: [-1, 0, 0], normal: [1, 2, 3], radius: 0.6 }}, material: card }}
"
        );
        built(&text)
    }

    /// Builds the scene of a text.
    pub(crate) fn built(text: &str) -> Scene {
        let mut config: Config = scene::yaml::from_str(text).unwrap();
        let geometries = Geometries::read(&mut config, Path::new("."), u64::MAX).unwrap();
        scene::build::scene(&config, geometries).unwrap()
    }

    /// Records a formula.
    fn program(formula: impl for<'t> FnOnce(&'t Tape<'t>) -> Vec<Register<'t>>) -> Program {
        let tape = Tape::default();
        let program = {
            let results = formula(&tape);
            tape.program(&results)
        };
        assert_eq!(tape.refusal(), None);
        program
    }

    fn number_at(state: &[f32], slot: usize) -> Vector<f32> {
        Vector {
            x: state[slot],
            y: state[slot + 1],
            z: state[slot + 2],
        }
    }

    /// Returns a point on a surface, seen from outside.
    fn point_of(state: &[f32]) -> ShadingPoint<f32> {
        let at = |first| number_at(state, slot::POINT + first);
        let side = state[slot::SIDE];
        ShadingPoint {
            position: at(0),
            normal: at(3),
            geometric_normal: at(6),
            color: at(9),
            error: state[slot::POINT + 12],
            side,
            factors: PictureFactors::ones(side),
        }
    }

    fn is_same(found: &[f32], expected: &[f32]) -> bool {
        let is_same = |(a, b): (&f32, &f32)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        found.len() == expected.len() && found.iter().zip(expected).all(is_same)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The slow twin of recorded programs are their formulas for single numbers.
        #[test]
        fn programs_of_paths_compute_what_their_formulas_compute(
            numbers in prop::collection::vec(-1.0_f32..1.0, N_SLOTS),
            words in prop::array::uniform3(0_u32..1000),
            model in prop::sample::select(&["path", "blinn_phong", "seed", "ambient_occlusion"][..]),
        ) {
            let mut state = numbers;
            // Unit vectors, and a side.
            for slot in [slot::DIRECTION, slot::POINT + 3, slot::POINT + 6, slot::LIGHT] {
                let unit = coordinates(number_at(&state, slot).normalize());
                state[slot..slot + 3].copy_from_slice(&unit);
            }
            state[slot::SIDE] = if state[slot::T] < 0.0 { -1.0 } else { 1.0 };
            for (slot, word) in [slot::PIXEL, slot::SAMPLE, slot::DIMENSION].into_iter().zip(words) {
                state[slot] = f32::from_bits(word);
            }
            let scene = scene(model);
            let formulas = Shader::new(&scene, Sampler::new(PixelPattern::Sobol, 1, 7)).formulas(None);
            let at = point_of(&state);
            let arriving = Illumination {
                direction: number_at(&state, slot::LIGHT),
                distance: state[slot::LIGHT + 3],
                radiance: number_at(&state, slot::LIGHT + 4),
                density: state[slot::LIGHT + 7],
            };
            for primitive in 0..formulas.n_primitives() {
                let kind = formulas.kind(primitive).unwrap();
                let of = formulas.material(kind);
                let mut data = Vec::new();
                formulas.push_data(kind, primitive, &mut data);
                let evaluate = |program: &Program| program.evaluate([&state, &data, &[]]);

                let recorded = program(|tape| point_results(&formulas, tape, kind));
                let mut numbers = data.iter().copied();
                let ray = [slot::ORIGIN, slot::DIRECTION].map(|slot| number_at(&state, slot));
                let (found, opacity) = formulas.point(kind, ray, [slot::T, slot::LENGTH].map(|slot| state[slot]), &mut || numbers.next().unwrap(), &mut || 0.0);
                let vectors = [found.position, found.normal, found.geometric_normal, found.color];
                let mut expected: Vec<f32> = vectors.into_iter().flat_map(coordinates).collect();
                expected.extend([found.error, found.side, opacity]);
                prop_assert!(is_same(&evaluate(&recorded), &expected), "point of {kind:?}");

                let recorded = program(|tape| shadow_results(&formulas, tape, kind));
                let ShadowFormula { may_arrive, origin, end } = formulas.shadow(of, &at, &arriving);
                let [x, y, z] = coordinates(origin);
                let expected = [f32::from(u8::from(may_arrive)), x, y, z, end];
                prop_assert!(is_same(&evaluate(&recorded), &expected), "shadow of {kind:?}");

                let crossing = Crossing {
                    eta: state[slot::CROSSING],
                    is_visible: state[slot::CROSSING + 1] > 0.0,
                    indices: [state[slot::CROSSING + 2], state[slot::CROSSING + 3]],
                };
                let recorded = program(|tape| reflected_results(&formulas, tape, kind));
                let rays = [slot::EYE, slot::DIRECTION].map(|slot| number_at(&state, slot));
                let expected = coordinates(formulas.reflected(of, &at, &arriving, rays, &crossing));
                prop_assert!(is_same(&evaluate(&recorded), &expected), "reflected by {kind:?}");

                let recorded = program(|tape| split_results(&formulas, tape, kind));
                let path = [slot::DIRECTION, slot::WEIGHT].map(|slot| number_at(&state, slot));
                let rays = formulas.split(of, &at, path, state[slot::OPACITY], &crossing);
                let expected = rays.iter().flat_map(|ray| {
                    std::iter::once(f32::from(u8::from(ray.is_alive))).chain(super::numbers(ray))
                });
                let expected: Vec<f32> = expected.collect();
                prop_assert!(is_same(&evaluate(&recorded), &expected), "split at {kind:?}");

                let recorded = program(|tape| passage_results(&formulas, tape, kind));
                let mut numbers = data.iter().copied();
                let past = formulas.passage(kind, ray, state[slot::T], &mut || numbers.next().unwrap(), &mut || 0.0);
                let [x, y, z] = coordinates(past.origin);
                let expected = [past.share, f32::from(u8::from(past.is_passed)), x, y, z, past.advance];
                prop_assert!(is_same(&evaluate(&recorded), &expected), "passage of {kind:?}");

                if !formulas.surface(of).continues {
                    continue;
                }
                for is_late in [false, true] {
                    let recorded = program(|tape| next_results(&formulas, tape, kind, is_late));
                    let path = [slot::DIRECTION, slot::WEIGHT].map(|slot| number_at(&state, slot));
                    let ray: NextRay<f32> = formulas.next(of, &at, path, words, &crossing, is_late);
                    let of_kind = if ray.is_refracted { 1.0 } else if ray.is_diffuse { 2.0 } else { 0.0 };
                    let mut expected = vec![f32::from(u8::from(ray.is_alive)), of_kind];
                    expected.extend(super::numbers(&ray));
                    expected.push(ray.density);
                    prop_assert!(is_same(&evaluate(&recorded), &expected), "next ray of {kind:?}");
                }
            }
        }
    }
}
