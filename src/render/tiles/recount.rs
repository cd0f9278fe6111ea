//! Renders a picture once more for counters.

use rayon::prelude::*;

use super::stream::StreamRenderer;
use super::view::View;
use super::{MAX_PIXELS, OnProgress, Progress, TileRenderer};
use crate::film::Film;
use crate::schedule::Tile;
use base::stop;
use tracer::cost::Counters;

/// Renders the tiles of a film once more, with the numbers of samples that it has, on the current
/// rayon pool. Calls `keep` with each part of a tile and the counters of its pixels, row by row, and
/// `report` after each tile.
pub(crate) fn recount(
    view: View,
    film: &Film,
    keep: impl Fn(&Tile, &Counters) + Sync,
    report: OnProgress,
) {
    let n_samples = film.samples();
    let width = film.grid.width;
    let planned = |part: &Tile| {
        let [left, right] = part.columns;
        let [top, bottom] = part.rows;
        let row = |y: u32| &n_samples[(y * width + left) as usize..(y * width + right) as usize];
        (top..bottom).flat_map(row).copied().collect()
    };
    let renderer = || StreamRenderer::<Counters>::new(view);
    let render = |renderer: &mut StreamRenderer<Counters>, number: u32| {
        let tile = film.grid.tile(number);
        if film.tiles[number as usize].is_missing || stop::is_requested() {
            return;
        }
        for part in tile.parts(MAX_PIXELS) {
            if view.rounds.are_planned() {
                renderer.render_first(&part);
                renderer.planned = planned(&part);
                renderer.render_planned();
            } else {
                renderer.render(&part);
            }
            keep(&part, renderer.probe());
        }
        report(Progress::from_pixels(tile.n_pixels() as u64, 0));
    };
    let tiles = (0..film.grid.n_tiles()).into_par_iter();
    tiles.for_each_init(renderer, render);
}
