//! Films of noise.

use bytemuck::cast_slice_mut;
use raycost::config::CostMode;
use raycost::film::Film;

/// A film of noise: no array can be taken for another, and NaN comes in all
/// its shapes.
pub fn noise(width: u32, height: u32, cost: CostMode, seed: u32) -> Film {
    let mut film = Film::new(width, height, cost);
    let mut state = seed;
    let mut noise = || {
        // The generator of Numerical Recipes.
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    for strip in &mut film.strips {
        let arrays: [&mut [u8]; 17] = [
            cast_slice_mut(&mut strip.rgb),
            cast_slice_mut(&mut strip.position),
            cast_slice_mut(&mut strip.normal),
            cast_slice_mut(&mut strip.distance),
            cast_slice_mut(&mut strip.footprint),
            cast_slice_mut(&mut strip.object),
            cast_slice_mut(&mut strip.material),
            cast_slice_mut(&mut strip.time_ns),
            cast_slice_mut(&mut strip.node_visits),
            cast_slice_mut(&mut strip.primitive_tests),
            cast_slice_mut(&mut strip.rays),
            cast_slice_mut(&mut strip.shadow_rays),
            cast_slice_mut(&mut strip.reflection_rays),
            cast_slice_mut(&mut strip.refraction_rays),
            cast_slice_mut(&mut strip.depth),
            cast_slice_mut(&mut strip.tile),
            cast_slice_mut(&mut strip.thread),
        ];
        for array in arrays {
            array.fill_with(&mut noise);
        }
    }
    film
}
