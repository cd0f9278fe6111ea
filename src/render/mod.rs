//! The tile loop: scene → film, on all threads.
//!
//! A thread takes a tile and renders it in one of two ways: many rays at once
//! (`stream`), so that the ray kernel always has one that need not wait for
//! memory, or ray after ray (`timed`), which gives every pixel a time of its
//! own. Both give the same pixels and the same counters.

mod tile;
mod view;
mod wave;
mod stream;
mod timed;

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::accel::Accel;
use crate::config::Image;
use crate::cost::{Cost, Meter, NoProbe};
use crate::film::{Film, Pixel, STRIP_ROWS};
use crate::scene::Scene;
use stream::StreamRenderer;
use tile::{Tile, Tiles};
use timed::TimedRenderer;
pub(crate) use view::View;

pub use tile::TILE_SIDE;

/// What has been rendered since the last report.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Pixels.
    pub n_pixels: u64,
    /// Rays; 0 where nothing is counted.
    pub n_rays: u64,
}

/// Renders the scene on the current rayon pool and measures every pixel with
/// the `meter`. `report` hears of each tile, from any thread.
pub fn render(
    scene: &Scene,
    accel: &Accel,
    image: &Image,
    meter: &Meter,
    report: impl Fn(Progress) + Sync,
) -> Film {
    let view = View::new(scene, accel, image);
    let film = Film::new(image.width, image.height, meter.mode());
    match meter {
        Meter::Off => render_tiles(film, || StreamRenderer::<NoProbe>::new(view), report),
        Meter::Counters => render_tiles(film, || StreamRenderer::<Cost>::new(view), report),
        Meter::Time(clock) => render_tiles(film, || TimedRenderer::new(view, clock), report),
    }
}

/// A way to render tiles, with room for one: each thread has its own.
trait TileRenderer {
    /// The tile's pixels, in the order of [`Tile::pixels`].
    fn render(&mut self, tile: &Tile) -> &[Pixel];
}

/// The film, all of its tiles rendered.
fn render_tiles<R: TileRenderer>(
    mut film: Film,
    renderer: impl Fn() -> R + Sync + Send,
    report: impl Fn(Progress) + Sync,
) -> Film {
    let tiles = Tiles::of(&film);
    let strips: Vec<_> = film.strips.iter_mut().map(Mutex::new).collect();
    let render_tile = |renderer: &mut R, number| {
        let tile = tiles.tile(number);
        let pixels = renderer.render(&tile);
        // The film is written a tile at a time, outside of any pixel's time:
        // first touches of its memory would show in the heatmap.
        let strip = &strips[(tile.rows[0] / STRIP_ROWS) as usize];
        tile.store(
            pixels,
            &mut strip.lock().unwrap_or_else(PoisonError::into_inner),
        );
        let costs = pixels.iter().filter_map(|pixel| pixel.cost);
        let counted = costs.fold(Cost::default(), |sum, cost| sum.with(cost.counted));
        report(Progress {
            n_pixels: pixels.len() as u64,
            n_rays: counted.n_rays(),
        });
        counted
    };
    let totals = (0..tiles.n)
        .into_par_iter()
        .map_init(renderer, render_tile)
        .reduce(Cost::default, Cost::with);
    drop(strips);
    film.totals = totals;
    film
}

/// The number of this thread in its pool.
fn thread_number() -> u32 {
    rayon::current_thread_index().unwrap_or(0) as u32
}
