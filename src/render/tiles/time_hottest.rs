//! Repeated timing of the most expensive pixels before one is named.
//!
//! The longest of many times is the most disturbed one, and the first that a user looks at.

use super::TilePlan;
use super::groups::GroupRenderer;
use super::samples::median_and_deviation;
use super::timed::SingleRayRenderer;
use super::view::View;
use crate::film::{Film, HotPixel};
use crate::schedule::{MAX_PIXELS, Tile};
use base::stop;
use tracer::cost::{CpuWait, Meter, Metric};

/// Pixels that are timed together.
const N_PIXELS: usize = 20;
/// Times of each pixel, whose median counts.
const N_TIMES: usize = 5;
/// Neighbors that are rendered before the pixel each time, as in a picture.
const N_BEFORE: u32 = 4;
/// Greatest number of rounds: in each, the pixels that replace others are timed, too.
const N_ROUNDS: usize = 5;

/// Times each of these pixels of the film once, in nanoseconds.
type TimePixels<'a> = &'a mut dyn FnMut(&[(u32, u32)], &mut CpuWait) -> Vec<f32>;

/// Times the most expensive pixels of a film until the first of them has been timed again, and
/// gives the film the medians of their times. A film without rows, or without times, stays as it
/// is.
pub(super) fn time_hottest_again(film: &mut Film, view: View, meter: &Meter, plan: &TilePlan) {
    if !film.has_rows() {
        return;
    }
    match meter {
        Meter::Off | Meter::Counters => {}
        Meter::Time(clock) => {
            let mut renderer = GroupRenderer::new(view, clock);
            again(film, &mut |places, wait| {
                time_groups(&mut renderer, plan, places, wait)
            });
        }
        Meter::SingleRayTime(clock) => {
            let room = (N_BEFORE as usize + 1, &plan.image);
            let mut renderer = SingleRayRenderer::new(view, clock, room);
            again(film, &mut |places, wait| {
                let places = places.iter().map(|&place| in_picture(plan, place));
                let time = |place| {
                    let before = before(place, plan.image.width);
                    wait.begin();
                    renderer.time_last(before.chain([place]), wait)
                };
                places.map(time).collect()
            });
        }
    }
}

/// Times the groups of these pixels once, all groups of a part of a tile together.
fn time_groups(
    renderer: &mut GroupRenderer,
    plan: &TilePlan,
    places: &[(u32, u32)],
    wait: &mut CpuWait,
) -> Vec<f32> {
    let mut times = vec![0.0; places.len()];
    for (i, &place) in places.iter().enumerate() {
        let is_timed = times[i] > 0.0;
        if is_timed {
            continue;
        }
        let part = part(plan, place);
        let of_part = || (i..places.len()).filter(|&i| part.has(places[i]));
        let pixels: Vec<(u32, u32)> = of_part().map(|i| in_picture(plan, places[i])).collect();
        let in_picture = plan.in_picture(&part);
        wait.begin();
        let timed = renderer.time_pixels(&in_picture, &pixels, wait);
        for (i, ns) in of_part().zip(timed) {
            times[i] = ns;
        }
    }
    times
}

fn again(film: &mut Film, time_pixels: TimePixels) {
    let mut wait = CpuWait::of_this_thread();
    let mut timed: Vec<(u32, u32)> = Vec::new();
    for _ in 0..N_ROUNDS {
        let hottest = film.hottest(Metric::TIME, N_PIXELS);
        let is_timed = |pixel: &HotPixel| timed.contains(&pixel.place);
        if stop::is_requested() || hottest.first().is_none_or(is_timed) {
            return;
        }
        let new = hottest.into_iter().filter(|pixel| !is_timed(pixel));
        let new: Vec<(u32, u32)> = new.map(|pixel| pixel.place).collect();
        let mut times = vec![Vec::new(); new.len()];
        for _ in 0..N_TIMES {
            for (times, ns) in times.iter_mut().zip(time_pixels(&new, &mut wait)) {
                times.push(f64::from(ns));
            }
        }
        for (mut times, &place) in times.into_iter().zip(&new) {
            let [median_ns, mad_ns] = median_and_deviation(&mut times);
            let has_spread = film.n_repeats > 1;
            film.set_time(place, [median_ns, if has_spread { mad_ns } else { 0.0 }]);
        }
        timed.extend(new);
    }
}

/// Returns the part of a tile of the film that a pixel was rendered with.
fn part(plan: &TilePlan, (x, y): (u32, u32)) -> Tile {
    let size = plan.grid.tile_size;
    let tile = plan.grid.tile(y / size * plan.grid.n_columns + x / size);
    let mut parts = tile.parts(MAX_PIXELS);
    parts.find(|part| part.has((x, y))).unwrap_or(tile)
}

/// Returns the position of a pixel of the film in the picture.
fn in_picture(plan: &TilePlan, (x, y): (u32, u32)) -> (u32, u32) {
    let pixel = Tile {
        number: 0,
        columns: [x, x + 1],
        rows: [y, y + 1],
    };
    (x, plan.in_picture(&pixel).rows[0])
}

/// Returns the pixels to the left of a pixel, or to the right if there are none.
fn before((x, y): (u32, u32), width: u32) -> impl Iterator<Item = (u32, u32)> {
    let columns = match x {
        0 => 1..width.min(1 + N_BEFORE),
        _ => x.saturating_sub(N_BEFORE)..x,
    };
    columns.map(move |x| (x, y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::render;
    use scene::config::{Config, CostMode, Tiling};
    use scene::world::{Geometries, Scene};
    use scene::yaml::Source;
    use tracer::accel::Accel;
    use tracer::cost::Meter;

    #[test]
    fn a_pixel_that_was_disturbed_is_not_the_hottest() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../configs/seed_extended.yaml"
        );
        let source = Source::read(file.as_ref()).unwrap();
        let mut config: Config = source.parse().unwrap();
        (config.image.width, config.image.height) = (40, 30);
        let geometries = Geometries::read(&mut config, source.folder(), u64::MAX).unwrap();
        let scene = Scene::new(&config, geometries).unwrap();
        let accel = Accel::new(&scene, config.acceleration);
        let plan = TilePlan::new(&scene, &accel, &config.image, Tiling::default());
        let meter = Meter::new(CostMode::Time);
        let (mut film, _) = render(&scene, &accel, &plan, &meter, |_| {});
        // Neighbors, so that they are trusted; one of them is at the left edge.
        let disturbed = [(0, 20), (1, 20), (39, 29), (38, 29)];
        for place in disturbed {
            film.set_time(place, [1e15, 0.0]);
        }
        let view = View::new(&scene, &accel, &plan.image);
        time_hottest_again(&mut film, view, &meter, &plan);
        let [hottest] = film.hottest(Metric::TIME, 1)[..] else {
            panic!("no time is trusted");
        };
        assert!(hottest.value < 1e15);
        let times: Vec<f32> = film.values(|strip| &strip.time_ns).collect();
        assert!(
            disturbed
                .iter()
                .all(|&(x, y)| times[(40 * y + x) as usize] < 1e15)
        );
    }

    #[test]
    fn pixels_beside_a_pixel_warm_it_up() {
        let beside = |place, width| before(place, width).collect::<Vec<_>>();
        assert_eq!(beside((2, 7), 9), [(0, 7), (1, 7)]);
        assert_eq!(beside((8, 7), 9), [(4, 7), (5, 7), (6, 7), (7, 7)]);
        assert_eq!(beside((0, 3), 3), [(1, 3), (2, 3)]);
        assert_eq!(beside((0, 3), 1), []);
    }
}
