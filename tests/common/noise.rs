//! Films of noise.

use bytemuck::cast_slice_mut;
use render::film::{Film, PackedCounters, RenderedTile};
use render::schedule::TileGrid;
use scene::config::{CostMode, ExtraArrays, RatioMetrics, Repeats, WrittenArrays};
use tracer::cost::{Cost, Counters};

/// Returns a film of noise: all arrays differ, and NaN occurs with many bit patterns.
pub fn noise(width: u32, height: u32, cost: CostMode, seed: u32) -> Film {
    let extra = ExtraArrays {
        groups: false,
        tests: false,
        lanes: None,
        cycles: false,
        sm: false,
        metrics: RatioMetrics::default(),
        radiance: true,
        radiance_in_vtk: true,
        albedo: true,
        noise: None,
        bounces: true,
        instance: true,
        written: WrittenArrays::default(),
    };
    let grid = TileGrid::new(width, height, 7);
    let mut film = Film::with_extra(extra, grid, 0x1234_5678, cost);
    let mut state = seed;
    let mut noise = || {
        // The linear congruential generator of Numerical Recipes.
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    film.repeats = Repeats::Auto;
    for strip in &mut film.strips {
        strip.time_mad_ns = vec![0.0; strip.time_ns.len()];
        let arrays: [&mut [u8]; 13] = [
            cast_slice_mut(&mut strip.rgb),
            cast_slice_mut(&mut strip.position),
            cast_slice_mut(&mut strip.normal),
            cast_slice_mut(&mut strip.distance),
            cast_slice_mut(&mut strip.footprint),
            cast_slice_mut(&mut strip.object),
            cast_slice_mut(&mut strip.material),
            cast_slice_mut(&mut strip.time_ns),
            cast_slice_mut(&mut strip.time_mad_ns),
            cast_slice_mut(&mut strip.radiance),
            cast_slice_mut(&mut strip.albedo),
            cast_slice_mut(&mut strip.bounces),
            cast_slice_mut(&mut strip.instance),
        ];
        for array in arrays {
            array.fill_with(&mut noise);
        }
    }
    let mut word = || u32::from_ne_bytes([0; 4].map(|_| noise()));
    for number in 0..film.grid.n_tiles() {
        let counters = |n_pixels| {
            let mut counters = Counters::default();
            counters.reset(n_pixels, film.n_samples);
            for pixel in 0..n_pixels {
                let mut count = || u64::from(word());
                let cost = Cost {
                    node_visits: count(),
                    primitive_tests: count(),
                    rays: [film.n_samples.into(), count(), count(), count(), count()],
                    depth: count(),
                };
                counters.add(pixel, &cost);
            }
            PackedCounters::new(&counters)
        };
        let parts = film.grid.tile(number).parts(20);
        let counters = if cost.has_counters() {
            parts.map(|part| part.n_pixels()).map(counters).collect()
        } else {
            Vec::new()
        };
        film.tiles[number as usize] = RenderedTile {
            is_missing: false,
            thread: word() >> 1,
            counters,
        };
    }
    film
}
