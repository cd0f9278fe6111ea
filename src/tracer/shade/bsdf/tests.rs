//! Tests of all scattering functions against quadrature.

use std::f32::consts::{PI, TAU};

use super::*;
use math::optics::Masking;
use scene::yaml;
use world::geometry::RenderSpace;
use world::material::PictureFactors;

/// Directions of equal solid angles along each axis.
const N: u32 = 160;

fn material(text: &str) -> Material {
    let material: Material = yaml::from_str(text).unwrap();
    material.in_scene(&RenderSpace::default(), Some(Masking::default()))
}

/// Returns rough materials for which light samples contribute.
fn rough() -> Vec<Material> {
    let texts = [
        "{ color: 0.8 }",
        "{ color: 0.5, diffuse: 0.3, specular: 0.4, exponent: 12, reflection: 0.3 }",
        "{ conductor: gold, roughness: 0.5 }",
        "{ conductor: silver, roughness: 1, multiple_scattering: false }",
        "{ dielectric: { index: 1.5 }, roughness: 0.6 }",
        "{ dielectric: { index: 2.4 }, roughness: 1, multiple_scattering: false }",
        "{ color: 0.7, principled: { roughness: 0.6 } }",
        "{ color: 0.6, principled: { metallic: 0.3, transmission: 0.6, roughness: 0.7 } }",
    ];
    texts.map(material).into()
}

fn direction(cos: f32, turn: f32) -> Vector<f32> {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (y, x) = (TAU * turn).sin_cos();
    Vector {
        x: sin * x,
        y: sin * y,
        z: cos,
    }
}

/// Returns a point of a surface in the plane of x and y, whose shading normal is tilted by an
/// angle.
fn leaving(to_viewer: Vector<f32>, tilt_deg: f32) -> Leaving<f32> {
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    let point = ShadingPoint {
        position: Vec3::ZERO.into(),
        normal: Vec3::new(0.6 * sin, 0.8 * sin, cos).into(),
        geometric_normal: Vec3::Z.into(),
        color: Vec3::new(0.8, 0.5, 0.3).into(),
        error: 0.0,
        side: 1.0,
        factors: PictureFactors::ones(0.0),
    };
    Leaving::new(point, to_viewer)
}

/// Returns the surface of the material's medium, from outside or from inside.
fn boundary(material: &Material, is_inside: bool) -> Boundary<f32> {
    let index = material.kind.medium().map_or(1.0, |medium| medium.index);
    Boundary {
        eta: if is_inside { index } else { 1.0 / index },
        is_visible: true,
    }
}

fn evaluated(
    material: &Material,
    at: &Leaving<f32>,
    boundary: &Boundary<f32>,
    to_light: Vector<f32>,
) -> Scattering<f32> {
    by_kind!(Bsdf::new(material), |of| evaluate(
        of, at, boundary, to_light
    ))
}

fn sampled(
    material: &Material,
    at: &Leaving<f32>,
    boundary: &Boundary<f32>,
    [u, v, lobe]: [f32; 3],
) -> Scattered<f32> {
    by_kind!(Bsdf::new(material), |of| sample(
        of,
        at,
        boundary,
        [u, v],
        lobe
    ))
}

/// Returns the directions of light that this material scatters: from all sides, or from above the
/// surface.
fn directions(material: &Material) -> impl Iterator<Item = Vector<f32>> {
    let is_all = by_kind!(Bsdf::new(material), |of| of.is_lit_from_all_sides());
    let middle = move |k: u32| (k as f32 + 0.5) / N as f32;
    let all = (0..N * N).map(move |i| direction(2.0 * middle(i / N) - 1.0, middle(i % N)));
    all.filter(move |direction| is_all || direction.z > 0.0)
}

/// Returns numbers from 0 to 1 in three dimensions.
fn numbers() -> impl Iterator<Item = [f32; 3]> {
    (0..N * N).map(|i| {
        let golden = (f64::from(i) * 0.618_033_988_749_895).fract() as f32;
        let [u, v] = [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32);
        [u, v, golden]
    })
}

/// Returns true if light from a direction is ever evaluated.
fn is_lit(material: &Material, at: &Leaving<f32>, to_light: Vector<f32>) -> bool {
    let is_lit = by_kind!(Bsdf::new(material), |of| of.is_lit_from_all_sides());
    is_lit || at.point.is_faced_by(to_light)
}

fn finite(v: Vector<f32>) -> bool {
    Vec3::from(v).is_finite()
}

#[test]
fn samples_have_the_light_and_the_density_of_quadrature() {
    for material in rough() {
        for (cos, tilt, is_inside) in [
            (0.9, 0.0, false),
            (0.4, 0.0, true),
            (0.7, 12.0, false),
            (0.15, 12.0, false),
            (0.3, 50.0, false),
            (0.3, 50.0, true),
        ] {
            // Behind the shading normal, if it is tilted much.
            let at = leaving(direction(cos, 0.65), tilt);
            let boundary = boundary(&material, is_inside);
            let [mut light, mut density] = [0.0_f64; 2];
            for to_light in directions(&material) {
                let found = evaluated(&material, &at, &boundary, to_light);
                light += f64::from(found.value.x / PI);
                density += f64::from(found.density);
            }
            let per_direction = 2.0 * f64::from(TAU) / f64::from(N * N);
            let [mut of_samples, mut chosen, mut of_mirror] = [0.0_f64; 3];
            for numbers in numbers() {
                let found = sampled(&material, &at, &boundary, numbers);
                let factor = f64::from(found.factor.x);
                if found.density == f32::INFINITY {
                    of_mirror += 1.0;
                    continue;
                }
                of_samples += factor;
                if factor == 0.0 {
                    continue;
                }
                chosen += 1.0;
                let to_light = found.direction;
                let expected = evaluated(&material, &at, &boundary, to_light).density;
                let is_close = (found.density / expected - 1.0).abs() < 0.02;
                assert!(
                    is_close || to_light.z.abs() < 1e-3 || expected < 1e-3,
                    "{material:?} {cos} {tilt}: {} {expected}",
                    found.density
                );
            }
            let n = f64::from(N * N);
            for (by_quadrature, by_samples) in [(light, of_samples), (density, chosen)] {
                let (quadrature, samples) = (by_quadrature * per_direction, by_samples / n);
                assert!(
                    (quadrature - samples).abs() < 0.015,
                    "{material:?} {cos} {tilt}: {quadrature} {samples}"
                );
                assert!(samples + of_mirror / n < 1.0 + 1e-6 || by_samples == of_samples);
            }
        }
    }
}

#[test]
fn a_tilted_normal_keeps_the_light() {
    for text in [
        "{ color: 1 }",
        "{ conductor: { index: 0, extinction: 1 }, roughness: 0.4 }",
        "{ conductor: { index: 0, extinction: 1 }, roughness: 1 }",
        "{ color: 1, principled: { roughness: 0.6 } }",
    ] {
        let material = material(text);
        for (cos, tilt) in [(0.9, 5.0), (0.3, 20.0), (0.1, 40.0), (0.05, 80.0)] {
            for turn in [0.15, 0.4, 0.65] {
                let mut at = leaving(direction(cos, turn), tilt);
                at.point.color = Vec3::ONE.into();
                let boundary = boundary(&material, false);
                let sum: f64 = numbers()
                    .map(|numbers| {
                        let found = sampled(&material, &at, &boundary, numbers);
                        assert!(found.direction.z > 0.0 || found.factor.x == 0.0);
                        f64::from(found.factor.x)
                    })
                    .sum();
                let mean = sum / f64::from(N * N);
                assert!((mean - 1.0).abs() < 0.01, "{text} {cos} {tilt}: {mean}");
            }
        }
    }
}

#[test]
fn a_normal_that_is_not_tilted_changes_no_bit() {
    for material in rough() {
        let boundary = boundary(&material, false);
        let at = leaving(direction(0.4, 0.1), 0.0);
        for to_light in directions(&material) {
            let found = evaluated(&material, &at, &boundary, to_light);
            let plain = by_kind!(Bsdf::new(&material), |of| of
                .evaluate(&at, &boundary, to_light));
            assert_eq!((found.value, found.density), (plain.value, plain.density));
        }
        for [u, v, lobe] in numbers() {
            let found = sampled(&material, &at, &boundary, [u, v, lobe]);
            let plain = by_kind!(Bsdf::new(&material), |of| of.sample(
                &at,
                &boundary,
                [u, v],
                lobe
            ));
            assert_eq!(
                (found.direction, found.density),
                (plain.direction, plain.density)
            );
        }
    }
}

#[test]
fn light_is_finite_at_all_extremes() {
    let mut texts = Vec::new();
    for roughness in [0.0, 0.01, 0.011, 0.3, 1.0] {
        for metal in [[0.0, 0.0], [0.0, 1000.0], [1.0, 0.0], [1000.0, 1000.0]] {
            let [index, extinction] = metal;
            texts.push(format!(
                "conductor: {{ index: {index}, extinction: {extinction} }}, roughness: {roughness}"
            ));
        }
        for index in [1.0, 1.0005, 1.5, 10.0] {
            texts.push(format!(
                "dielectric: {{ index: {index} }}, roughness: {roughness}"
            ));
            for clear in [0, 1] {
                texts.push(format!("color: 0, principled: {{ transmission: {clear}, index: {index}, roughness: {roughness} }}"));
            }
        }
    }
    for exponent in [0.0, 1.0, 1e15] {
        texts.push(format!(
            "color: 1, diffuse: 0, specular: 1, exponent: {exponent}"
        ));
    }
    let ends = [1e-30, 1e-9, 1e-4, 0.3, 1.0 - 6e-8, 1.0];
    let numbers = [0.0, 1e-9, 0.5, 1.0 - 6e-8];
    for text in texts {
        let material = material(&format!("{{ {text} }}"));
        let cases = ends
            .into_iter()
            .flat_map(|cos| [0.0, 0.01, 60.0].map(|tilt| (cos, tilt)));
        for ((cos, tilt), is_inside) in cases.flat_map(|case| [(case, false), (case, true)]) {
            let at = leaving(direction(cos, 0.65), tilt);
            let boundary = boundary(&material, is_inside);
            for height in ends.into_iter().flat_map(|z| [z, -z]) {
                for turn in [0.15, 0.65] {
                    let to_light = direction(height, turn);
                    if !is_lit(&material, &at, to_light) {
                        continue;
                    }
                    let found = evaluated(&material, &at, &boundary, to_light);
                    let is_finite = finite(found.value) && found.density.is_finite();
                    assert!(is_finite, "{text} {cos} {tilt} {height}: {found:?}");
                }
            }
            for u in numbers {
                for (v, lobe) in numbers.into_iter().flat_map(|v| numbers.map(|w| (v, w))) {
                    let found = sampled(&material, &at, &boundary, [u, v, lobe]);
                    let is_finite = finite(found.factor) && finite(found.direction);
                    assert!(
                        is_finite && found.density >= 0.0,
                        "{text} {cos} {tilt} {u} {v} {lobe}: {found:?}"
                    );
                }
            }
        }
    }
}

/// The half vector of opposite directions is zero, and its unit vector NaN.
#[test]
fn a_facet_that_is_seen_edge_on_mirrors_nothing() {
    for material in rough() {
        let at = leaving(direction(0.6, 0.65), 0.0);
        let opposite = -at.to_viewer;
        let boundary = boundary(&material, false);
        let scattering = evaluated(&material, &at, &boundary, opposite);
        let found = at.reflected(opposite, scattering);
        assert_eq!(Vec3::from(found.factor), Vec3::ZERO, "{material:?}");
        assert_eq!(found.density, 0.0, "{material:?}");
    }
}

/// Returns the greatest difference between the scattering from one direction to another and in
/// reverse, over their sum.
fn irreciprocity(material: &Material) -> f32 {
    let boundary = boundary(material, false);
    let grid =
        || (1..=8).flat_map(|i| [0.0, 0.1, 0.35].map(|turn| direction(i as f32 / 8.1, turn)));
    let of = |to_viewer: Vector<f32>, to_light: Vector<f32>| {
        let found = evaluated(material, &leaving(to_viewer, 0.0), &boundary, to_light);
        found.value.x / to_light.z
    };
    let pairs = grid().flat_map(|a| grid().map(move |b| (a, b)));
    let differences = pairs.map(|(a, b)| {
        let [there, back] = [of(a, b), of(b, a)];
        (there - back).abs() / (there + back).max(1e-6)
    });
    differences.fold(0.0, f32::max)
}

#[test]
fn single_scattering_is_reciprocal_and_the_light_between_facets_is_not() {
    let cases = [
        ("color: 1", 0.0),
        (
            "conductor: gold, roughness: 1, multiple_scattering: false",
            0.0,
        ),
        (
            "dielectric: { index: 1.5 }, roughness: 0.5, multiple_scattering: false",
            0.0,
        ),
        (
            "color: 1, diffuse: 0.3, specular: 0.7, multiple_scattering: false",
            0.0,
        ),
        ("conductor: gold, roughness: 0.3", 0.5),
        ("conductor: gold, roughness: 1", 0.5),
        ("dielectric: { index: 1.5 }, roughness: 0.5", 0.5),
        ("color: 1, principled: { roughness: 0.5 }", 0.5),
    ];
    for (text, most) in cases {
        let found = irreciprocity(&material(&format!("{{ {text} }}")));
        let is_reciprocal = found < 0.01;
        assert!(
            is_reciprocal == (most == 0.0) && found < most + 0.01,
            "{text}: {found}"
        );
    }
}
