//! A film keeps the light of its pixels as it is, whatever its picture shows.

use glam::Vec3;
use render::film::Film;
use scene::config::{Config, CostMode, ExtraArrays, OptionalOutput};
use world::color::{Development, ToneCurve, Transfer};

use crate::common::{config, film, parse, with_cost};

/// The film of the config with its radiance.
fn with_radiance(config: &Config) -> Film {
    let mut config = config.clone();
    config.output.add(OptionalOutput::Radiance);
    film(&config, 2)
}

fn radiance(film: &Film) -> Vec<Vec3> {
    film.values(|strip| &strip.radiance).collect()
}

/// A plane that fills the picture and emits nothing but ambient light of 3 times its
/// color, under a light that is nowhere.
fn bright(model: &str) -> Config {
    parse(&format!(
        "image: {{ width: 4, height: 4, samples_per_pixel: 3 }}
camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 20 }} }}
shading: {{ model: {model}, ambient: 3 }}
materials: {{ m: {{ color: [1, 0.5, 0.25] }} }}
lights: [{{ point: {{ position: [0, 0, 5], intensity: 1e-9 }} }}]
objects: [{{ plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}, material: m }}]
"
    ))
}

#[test]
fn light_above_1_is_kept_but_by_the_seed() {
    let standard = radiance(&with_radiance(&bright("blinn_phong")));
    let expected = 3.0 * Vec3::new(1.0, 0.5, 0.25);
    assert!(
        standard
            .iter()
            .all(|light| light.abs_diff_eq(expected, 1e-5))
    );
    let seed = radiance(&with_radiance(&bright("seed")));
    assert!(seed.iter().all(|light| *light == Vec3::ONE));
}

#[test]
fn the_picture_is_developed_from_the_radiance() {
    for name in ["textures", "seed_extended"] {
        let mut config = config(name);
        (config.image.width, config.image.height) = (50, 40);
        for (exposure, curve) in [(0.0, ToneCurve::None), (1.5, ToneCurve::Agx)] {
            (config.film.exposure, config.film.tone_curve) = (exposure, curve);
            let film = with_radiance(&config);
            let transfer = match name {
                "seed_extended" => Transfer::Linear,
                _ => Transfer::Srgb,
            };
            let development = Development::new(exposure, curve, transfer);
            let developed = radiance(&film)
                .into_iter()
                .map(|light| development.rgb8(light));
            assert!(developed.eq(film.values(|strip| &strip.rgb)), "{name}");
        }
    }
}

#[test]
fn streams_and_single_rays_keep_the_same_bits() {
    for name in ["textures", "trellis", "seed_extended"] {
        let mut config = config(name);
        (config.image.width, config.image.height) = (60, 45);
        let [streams, single] = [CostMode::Counters, CostMode::SingleRayTime]
            .map(|mode| with_radiance(&with_cost(config.clone(), mode)));
        let bits = |film: &Film| -> Vec<_> {
            radiance(film)
                .into_iter()
                .map(|light| light.to_array().map(f32::to_bits))
                .collect()
        };
        assert_eq!(bits(&streams), bits(&single), "{name}");
    }
}

#[test]
fn a_film_keeps_it_on_request_alone() {
    let film = film(&config("seed_sphere"), 2);
    assert_eq!(film.extra, ExtraArrays::default());
    assert_eq!(film.values(|strip| &strip.radiance).count(), 0);
}
