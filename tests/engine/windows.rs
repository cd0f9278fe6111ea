//! A window has the pixels of the whole picture.

use crate::common::{config, counts, film, with_cost};
use render::film::Film;
use scene::config::{Adaptive, CostMode, PixelPattern, SampleRule};
use tracer::cost::Counter;

/// The bytes of all arrays that a rendering stores, and the counters, of a pixel.
fn pixel(film: &Film, (x, y): (u32, u32)) -> (Vec<u8>, Vec<u32>) {
    let strip = &film.strips[y as usize / render::film::STRIP_ROWS as usize];
    let i = ((y - strip.first_row) * film.grid.width + x) as usize;
    let columns = film.kept_columns().filter(|column| {
        column.is_in_strips() && !["time_ns", "time_mad_ns"].contains(&column.name)
    });
    let mut bytes = Vec::new();
    for column in columns {
        let all = column.bytes(film, strip, &mut Vec::new()).to_vec();
        bytes.extend_from_slice(&all[i * column.stride()..][..column.stride()]);
    }
    bytes.extend(bytemuck::bytes_of(&strip.position[i]));
    let number = (y * film.grid.width + x) as usize;
    let counted = Counter::ALL.map(|counter| counts(film, counter)[number]);
    (bytes, counted.to_vec())
}

#[test]
fn a_window_has_the_pixels_of_the_picture() {
    let by_efficiency = Adaptive {
        by: SampleRule::Efficiency,
        noise: None,
        min_samples: 3,
    };
    let cases = [
        ("seed_extended", None),
        ("hall_of_mirrors", None),
        ("glass", None),
        ("glass", Some(by_efficiency)),
    ];
    for (name, adaptive) in cases {
        let mut config = config(name);
        (config.image.width, config.image.height) = (70, 50);
        (config.image.samples_per_pixel, config.image.adaptive) = (4, adaptive);
        if adaptive.is_some() {
            config.image.sampler = PixelPattern::Sobol;
        }
        for mode in [CostMode::Counters, CostMode::Time, CostMode::SingleRayTime] {
            let config = with_cost(config.clone(), mode);
            let whole = film(&config, 2);
            let [x, y] = [19, 7];
            let mut window = config.clone();
            window.image = config.image.cropped([x, y, 33, 21]).unwrap();
            let window = film(&window, 2);
            assert_eq!((window.grid.width, window.grid.height), (33, 21));
            for place in (0..21).flat_map(|y| (0..33).map(move |x| (x, y))) {
                let in_whole = (place.0 + x, place.1 + y);
                assert!(
                    pixel(&window, place) == pixel(&whole, in_whole),
                    "{name} {mode:?} {place:?}"
                );
            }
        }
    }
}

#[test]
fn a_window_is_within_the_picture() {
    let image = config("seed_sphere").image;
    let [width, height] = [image.width, image.height];
    let whole = image.cropped([0, 0, width, height]).unwrap();
    assert_eq!(whole.origin(), [0, 0]);
    let inner = image.cropped([10, 20, 30, 40]).unwrap();
    let innermost = inner.cropped([1, 2, 3, 4]).unwrap();
    assert_eq!(innermost.origin(), [11, 22]);
    assert_eq!(innermost.picture_size(), [width, height]);
    for window in [
        [0, 0, 0, 1],
        [0, 0, 1, 0],
        [1, 0, width, 1],
        [0, 1, 1, height],
        [u32::MAX, 0, 1, 1],
    ] {
        assert_eq!(image.cropped(window), None, "{window:?}");
    }
}
