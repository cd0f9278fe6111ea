//! Lenses and other cameras against closed forms.

use crate::common::{film, lasting, parse};
use render::film::Film;
use scene::config::Config;

/// A white sphere in front of black, seen from the origin toward -z.
fn sphere(depth: f32, radius: f32, lens: &str) -> Config {
    parse(&format!(
        "
image: {{ width: 96, height: 96, samples_per_pixel: 64, sampler: sobol }}
camera: {{ look_at: {{ eye: [0, 0, 0], target: [0, 0, -4], fov_y_deg: 30{lens} }} }}
shading: {{ ambient: 1 }}
film: {{ transfer: linear }}
materials: {{ white: {{ color: 1 }} }}
lights: []
objects:
  - sphere: {{ center: [0, 0, -{depth}], radius: {radius} }}
    material: white
"
    ))
}

/// The diameter in pixels of the uniform circle with the variance of the picture's light,
/// and all of its light in pixels.
fn diameter_and_light(film: &Film) -> (f64, f64) {
    let [width, height] = [film.grid.width, film.grid.height].map(f64::from);
    let (mut sum, mut second) = (0.0, 0.0);
    for (i, [light, ..]) in film.values(|strip| &strip.rgb).enumerate() {
        let light = f64::from(light) / 255.0;
        let x = (i as f64 % width).floor() - 0.5 * (width - 1.0);
        let y = (i as f64 / width).floor() - 0.5 * (height - 1.0);
        sum += light;
        second += light * (x * x + y * y);
    }
    // The mean square distance in a circle is half of its squared radius.
    (2.0 * (2.0 * second / sum).sqrt(), sum)
}

/// A point at depth d is a circle of diameter 2 r |d - f| / d on the plane in focus at f.
#[test]
fn blur_circles_have_the_diameter_of_the_thin_lens_formula() {
    // World units per pixel at distance 1.
    let pitch = 2.0 * 15_f64.to_radians().tan() / 96.0;
    for (depth, lens, [radius, focus]) in [
        (4.0, ", lens: { radius: 0.15 }", [0.15, 4.0]),
        (2.5, ", lens: { radius: 0.15 }", [0.15, 4.0]),
        (
            8.0,
            ", lens: { radius: 0.25, focus_distance: 3.5 }",
            [0.25, 3.5],
        ),
        (
            5.0,
            ", lens: { radius: 0.2, focus_point: [1, 2, -9] }",
            [0.2, 9.0],
        ),
    ] {
        let size = 8.0 * pitch * depth;
        let config = sphere(depth as f32, size as f32, lens);
        let (found, light) = diameter_and_light(&film(&config, 2));
        // Seen from the side, a sphere is a little wider than its center's disk.
        let sharp = 2.0 * size / (depth * depth - size * size).sqrt() / pitch;
        let blur = 2.0 * radius * (depth - focus).abs() / (depth * focus) / pitch;
        let expected = sharp.hypot(blur);
        assert!(
            (found / expected - 1.0).abs() < 0.015,
            "{lens}: {found}, {expected}"
        );
        let of_disk = std::f64::consts::FRAC_PI_4 * sharp * sharp;
        assert!(
            (light / of_disk - 1.0).abs() < 0.015,
            "{lens}: {light}, {of_disk}"
        );
    }
}

#[test]
fn a_lens_without_extent_is_a_pinhole() {
    let [pinhole, tiny, none] = ["", ", lens: { radius: 1e-14 }", ", lens: { radius: 0 }"]
        .map(|lens| film(&sphere(3.0, 0.7, lens), 2));
    let close = |(a, b): ([u8; 3], [u8; 3])| a[0].abs_diff(b[0]) <= 4;
    let colors = |film: &Film| film.values(|strip| &strip.rgb).collect::<Vec<_>>();
    assert!(colors(&pinhole).into_iter().zip(colors(&tiny)).all(close));
    assert!(lasting(pinhole) == lasting(none));
}

#[test]
fn the_footprint_behind_a_lens_is_that_of_the_depth() {
    let config = parse(
        "
image: { width: 40, height: 30 }
camera: { look_at: { eye: [0, 0, 0], target: [0, 0, -4], fov_y_deg: 40, lens: { radius: 0.3 } } }
materials: { white: { color: 1 } }
lights: []
objects: [{ plane: { point: [0, 0, -7], normal: [0, 0, 1] }, material: white }]
",
    );
    let film = film(&config, 1);
    let expected = 7.0 * 2.0 * 20_f32.to_radians().tan() / 30.0;
    for footprint in film.values(|strip| &strip.footprint) {
        assert!((footprint / expected - 1.0).abs() < 1e-5, "{footprint}");
    }
    let depths = film.values(|strip| &strip.position);
    let mut depths = depths.map(|point| film.space.world_point(point).z);
    assert!(depths.all(|z| z == -7.0));
}

/// Across an edge the light is the integral of the filter.
#[test]
fn edges_have_the_profile_of_the_filter() {
    let tent = |x: f64| {
        let x = x.clamp(-1.0, 1.0);
        0.5 + x - 0.5 * x * x.abs()
    };
    // The integral of the window of Blackman and Harris.
    let bell = |x: f64| {
        let x = x.clamp(-1.0, 1.0);
        let wave = |k: f64| (k * std::f64::consts::PI * x).sin() / (k * std::f64::consts::PI);
        let waves = 0.48829 * wave(1.0) + 0.14128 * wave(2.0) + 0.01168 * wave(3.0);
        0.5 + 0.5 * (x + waves / 0.35875)
    };
    let square = |x: f64| 0.5 + 0.5 * x.clamp(-1.0, 1.0);
    type Profile<'a> = &'a dyn Fn(f64) -> f64;
    let profiles: [(&str, f64, Profile); 4] = [
        ("box", 0.5, &square),
        ("box, filter_radius: 3", 3.0, &square),
        ("tent", 1.0, &tent),
        ("blackman_harris, filter_radius: 4", 4.0, &bell),
    ];
    for (filter, radius, integral) in profiles {
        // White to the right of x = 0.3 pixels.
        let film = film(
            &parse(&format!(
                "
image: {{ width: 16, height: 4, samples_per_pixel: 1024, sampler: sobol, filter: {filter} }}
camera: {{ orthographic: {{ eye: [0, 0, 5], target: [0, 0, 0], height: 4 }} }}
shading: {{ ambient: 1 }}
film: {{ transfer: linear }}
materials: {{ white: {{ color: 1 }} }}
lights: []
objects: [{{ box: {{ min: [0.3, -90, -1], max: [90, 90, 0] }}, material: white }}]
"
            )),
            1,
        );
        for (i, [light, ..]) in film.values(|strip| &strip.rgb).enumerate() {
            let center = (i % 16) as f64 - 7.5;
            let expected = integral((center - 0.3) / radius);
            let found = f64::from(light) / 255.0;
            assert!(
                (found - expected).abs() < 0.005,
                "{filter} {i}: {found}, {expected}"
            );
        }
    }
}
