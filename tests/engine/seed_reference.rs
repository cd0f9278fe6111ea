//! The seed model against pictures of the course's NumPy model. Random scenes
//! are compared by `tests/with-numpy`.

use crate::common::{config, film, in_repository, parse, rays, sum, total};
use render::film::Film;
use tracer::cost::Counter;

/// The share of pixels that differ from the reference by at most 1/255 in
/// every channel.
fn agreement(film: &Film, reference: &str) -> f64 {
    let path = in_repository(&format!("tests/reference/{reference}.png"));
    let picture = image::open(path).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (film.grid.width, film.grid.height));
    let close = film
        .values(|strip| &strip.rgb)
        .zip(picture.pixels())
        .filter(|(ours, theirs)| ours.iter().zip(theirs.0).all(|(a, b)| a.abs_diff(b) <= 1))
        .count();
    close as f64 / (film.grid.width * film.grid.height) as f64
}

/// What the NumPy model counted in a picture.
fn fact(picture: &str, name: &str) -> u64 {
    let facts = std::fs::read_to_string(in_repository("tests/reference/facts.json")).unwrap();
    let facts: serde_json::Value = serde_json::from_str(&facts).unwrap();
    facts[picture][name].as_u64().unwrap()
}

fn sphere_at(size: u32) {
    let name = format!("seed_sphere_{size}x{size}");
    let mut config = config("seed_sphere");
    (config.image.width, config.image.height) = (size, size);
    let film = film(&config, 2);

    let agreement = agreement(&film, &name);
    assert!(agreement >= 0.9999, "{name}: {agreement}");

    let expected = fact(&name, "hits") as f64;
    let n_hits = film.n_hits() as f64;
    assert!(
        (n_hits / expected - 1.0).abs() <= 1e-4,
        "{n_hits} hits, should be {expected}"
    );
}

#[test]
fn the_sphere_at_100_pixels() {
    sphere_at(100);
}

#[test]
fn the_sphere_at_400_pixels() {
    sphere_at(400);
}

#[test]
fn the_sphere_at_1000_pixels() {
    sphere_at(1000);
}

#[test]
fn the_extended_scene() {
    let film = film(&config("seed_extended"), 2);
    let agreement = agreement(&film, "seed_extended_400x300");
    assert!(agreement >= 0.999, "{agreement}");
}

/// Where a path grazes an edge, 32-bit numbers may decide otherwise than the
/// model's 64-bit ones: at most one ray in 10,000.
#[test]
fn the_extended_scene_shoots_the_same_rays() {
    let film = film(&config("seed_extended"), 2);
    let expected = |kind| fact("seed_extended_400x300", kind);
    let close = |ours: u64, theirs: u64| ours.abs_diff(theirs) <= theirs / 10_000;
    let shadow = sum(&film, Counter::ShadowRays);
    let reflection = sum(&film, Counter::ReflectionRays);
    let camera = total(&rays(&film)) - shadow - reflection;
    assert!(
        close(shadow, expected("shadow_rays")),
        "{shadow} shadow rays"
    );
    assert!(
        close(reflection, expected("reflection_rays")),
        "{reflection} reflection rays"
    );
    assert_eq!(camera, expected("camera_rays"));
}

#[test]
fn the_pixels_that_the_course_names() {
    let film = film(&config("seed_extended"), 1);
    let rgb: Vec<[u8; 3]> = film.values(|strip| &strip.rgb).collect();
    let named = [
        ((200, 150), [69, 69, 69]),
        ((300, 190), [19, 19, 187]),
        ((150, 150), [147, 85, 147]),
        ((60, 150), [234, 157, 86]),
    ];
    for ((x, y), expected) in named {
        let found = rgb[y * 400 + x];
        let close = found
            .iter()
            .zip(expected)
            .all(|(a, b): (_, u8)| a.abs_diff(b) <= 1);
        assert!(close, "({x}, {y}) is {found:?}, should be {expected:?}");
    }
}

fn variant() -> String {
    std::fs::read_to_string(in_repository("tests/reference/seed_variant.yaml")).unwrap()
}

#[test]
fn a_scene_with_a_colored_light_and_a_plane_seen_from_behind() {
    let film = film(&parse(&variant()), 2);
    let agreement = agreement(&film, "seed_variant");
    assert!(agreement >= 0.9995, "{agreement}");
}

/// They scale the light's color, which is in the highlight alone.
#[test]
fn intensity_and_falloff_scale_the_highlight_alone() {
    let picture = |light: &str| {
        let old = "position: [-3, 2.5, 3], color: [1.2, 0.3, 0.7]";
        assert!(variant().contains(old));
        let film = film(&parse(&variant().replace(old, light)), 1);
        film.values(|strip| &strip.rgb).collect::<Vec<_>>()
    };
    let halved = picture("position: [-3, 2.5, 3], color: [0.6, 0.15, 0.35]");
    let dimmed = picture("position: [-3, 2.5, 3], color: [1.2, 0.3, 0.7], intensity: 0.5");
    assert!(halved == dimmed);
    let black = picture("position: [-3, 2.5, 3], color: [0, 0, 0]");
    let far = picture("position: [-3, 2.5, 3], intensity: 1e-9, falloff: inverse_square");
    assert!(black == far);
    let diffuse = black.iter().filter(|rgb| rgb.iter().any(|&c| c > 60));
    assert!(diffuse.count() > 1000, "diffuse light is left");
}
