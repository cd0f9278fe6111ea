//! Repeated timing of the most expensive pixels before one is named.
//!
//! The longest of many times is the most disturbed one, and the first that a user looks at.

use std::time::{Duration, Instant};

use super::TilePlan;
use super::groups::GroupRenderer;
use super::samples::median_and_deviation;
use super::timed::SingleRayRenderer;
use super::view::View;
use crate::film::{Film, HotPixel};
use crate::schedule::{MAX_PIXELS, Tile};
use base::stop;
use tracer::cost::{Meter, Metric};

/// Times of each pixel, whose median counts.
const N_TIMES: usize = 5;
/// Neighbors that are rendered before the pixel each time, as in a picture.
const N_BEFORE: u32 = 4;

/// The limit is this part of the time of the renderings, or [`LEAST_LIMIT`] if that is more.
const PART_OF_RENDERING: u32 = 50;
const LEAST_LIMIT: Duration = Duration::from_millis(4);

/// Renders a group of pixels of the film once. Returns the nanoseconds of its pixels, row by row.
type TimeGroup<'a> = &'a mut dyn FnMut(&Tile) -> Vec<f32>;

/// Returns the time that may be spent on timing pixels again after renderings that took `elapsed`
/// together.
pub(super) fn limit_after(elapsed: Duration) -> Duration {
    LEAST_LIMIT.max(elapsed / PART_OF_RENDERING)
}

/// Times the most expensive pixel of a film, with the others of its group, until one is the most
/// expensive again or the limit is reached, and gives the film the medians of the times. A film
/// without rows, or without times, stays as it is.
pub(super) fn time_hottest_again(
    film: &mut Film,
    view: View,
    meter: &Meter,
    plan: &TilePlan,
    limit: Duration,
) {
    if !film.has_rows() {
        return;
    }
    let end = Instant::now() + limit;
    match meter {
        Meter::Off | Meter::Counters => {}
        Meter::Time(clock) => {
            let mut renderer = GroupRenderer::new(view, clock);
            let n_samples = view.rounds.n_uniform();
            let group_of = |x, y| {
                let mut groups = part(plan, x, y).groups(n_samples);
                groups.find(|group| group.has(x, y))
            };
            again(film, end, group_of, &mut |group| {
                let (x, y) = first_pixel(group);
                let [part, group] = [&part(plan, x, y), group].map(|tile| plan.in_picture(tile));
                renderer.time_group(&part, &group)
            });
        }
        Meter::SingleRayTime(clock) => {
            let room = (N_BEFORE as usize + 1, &plan.sensor.image);
            let mut renderer = SingleRayRenderer::new(view, clock, room);
            let group_of = |x, y| Some(Tile::one_pixel(x, y));
            again(film, end, group_of, &mut |group| {
                let (x, y) = first_pixel(&plan.in_picture(group));
                let warm_up = before(x, y, plan.sensor.image.width);
                vec![renderer.time_last(warm_up.chain([(x, y)]))]
            });
        }
    }
}

fn again(
    film: &mut Film,
    end: Instant,
    group_of: impl Fn(u32, u32) -> Option<Tile>,
    time_group: TimeGroup,
) {
    let is_over = || stop::is_requested() || Instant::now() >= end;
    let mut timed: Vec<Tile> = Vec::new();
    while !stop::is_requested()
        && let [HotPixel { place: (x, y), .. }] = film.hottest(Metric::TIME, 1)[..]
        && !timed.iter().any(|group| group.has(x, y))
        && let Some(group) = group_of(x, y)
    {
        // Time the group.
        let mut times = vec![Vec::with_capacity(N_TIMES); group.n_pixels()];
        for i in 0..N_TIMES {
            if i > 0 && is_over() {
                break;
            }
            for (times, ns) in times.iter_mut().zip(time_group(&group)) {
                times.push(f64::from(ns));
            }
        }
        // Give the film the medians.
        let has_spread = film.n_repeats > 1;
        let [[left, right], [top, bottom]] = [group.columns, group.rows];
        let places = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
        for (mut times, (x, y)) in times.into_iter().zip(places) {
            let [median_ns, mad_ns] = median_and_deviation(&mut times);
            film.set_time(x, y, [median_ns, if has_spread { mad_ns } else { 0.0 }]);
        }
        timed.push(group);
        if is_over() {
            return;
        }
    }
}

/// Returns the part of a tile of the film that a pixel was rendered with.
fn part(plan: &TilePlan, x: u32, y: u32) -> Tile {
    let tile = plan.grid.tile(plan.grid.number_at(x, y));
    let mut parts = tile.parts(MAX_PIXELS);
    parts.find(|part| part.has(x, y)).unwrap_or(tile)
}

/// Returns the left pixel of a group's first row.
fn first_pixel(group: &Tile) -> (u32, u32) {
    (group.columns[0], group.rows[0])
}

/// Returns the pixels to the left of a pixel, or to the right if there are none.
fn before(x: u32, y: u32, width: u32) -> impl Iterator<Item = (u32, u32)> {
    let columns = match x {
        0 => 1..width.min(1 + N_BEFORE),
        _ => x.saturating_sub(N_BEFORE)..x,
    };
    columns.map(move |x| (x, y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::{mirrors, render};
    use scene::build::Sensor;
    use scene::config::{CostMode, Tiling};
    use tracer::accel::Accel;
    use tracer::cost::Meter;
    use tracer::trace::Tracer;

    #[test]
    fn a_pixel_that_was_disturbed_is_not_the_hottest() {
        let (config, scene) = mirrors(40, 30);
        let accel = Accel::new(&scene, config.acceleration);
        let tracer = Tracer::new(&scene, &accel);
        let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), Tiling::default());
        let meter = Meter::new(CostMode::Time);
        let (mut film, _) = render(tracer, &plan, &meter, &|_| {});
        // Neighbors, so that they are trusted; one of them is at the left edge.
        let disturbed = [(0, 20), (1, 20), (39, 29), (38, 29)];
        for (x, y) in disturbed {
            film.set_time(x, y, [1e15, 0.0]);
        }
        let view = View::new(tracer, &plan.sensor);
        time_hottest_again(&mut film, view, &meter, &plan, Duration::from_secs(60));
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
        let beside = |x, y, width| before(x, y, width).collect::<Vec<_>>();
        assert_eq!(beside(2, 7, 9), [(0, 7), (1, 7)]);
        assert_eq!(beside(8, 7, 9), [(4, 7), (5, 7), (6, 7), (7, 7)]);
        assert_eq!(beside(0, 3, 3), [(1, 3), (2, 3)]);
        assert_eq!(beside(0, 3, 1), []);
    }
}
