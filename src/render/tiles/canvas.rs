//! Concurrent writes to a film.

use std::ops::{Range, RangeInclusive};
use std::sync::Mutex;

use crate::checkpoint::TileRecord;
use crate::film::{Film, PackedCounters, PixelColumns, Rendered, RenderedTile, STRIP_ROWS, Strip};
use crate::schedule::{Tile, TileGrid, TileRun};
use base::locked;
use world::color::Development;

/// A film whose strips and tiles each have a lock.
pub(super) struct Canvas<'a> {
    strips: Vec<Mutex<&'a mut Strip>>,
    /// Empty if the counters of the tiles are not stored.
    tiles: Vec<Mutex<&'a mut RenderedTile>>,
    /// The tiles of the picture, if the film has room for only one of them at a time.
    one_of: Option<TileGrid>,
    /// The rows of the film.
    rows: Range<u32>,
    /// Pixels per row.
    width: usize,
    /// Bytes of a pixel in all arrays that a rendering writes.
    bytes_per_pixel: usize,
    /// Pixels along a tile's side.
    tile_size: u32,
    development: Development,
}

impl<'a> Canvas<'a> {
    /// Creates a canvas that writes the tiles of a grid to a film, which may hold an earlier
    /// rendering: by another grid, it has stored the same counters.
    pub(super) fn new(film: &'a mut Film, grid: &TileGrid) -> Self {
        let rows = film.row_range();
        let tiles = if film.grid == *grid {
            &mut film.tiles[..]
        } else {
            &mut []
        };
        Self {
            one_of: None,
            rows,
            tile_size: film.grid.tile_size,
            bytes_per_pixel: film.strips.first().map_or(0, Strip::stored_bytes_per_pixel),
            width: film.grid.width as usize,
            development: film.development,
            strips: film.strips.iter_mut().map(Mutex::new).collect(),
            tiles: tiles.iter_mut().map(Mutex::new).collect(),
        }
    }

    /// Creates a canvas that writes one tile of the picture's grid after the other to a film of one
    /// tile.
    pub(super) fn one_tile(film: &'a mut Film, grid: TileGrid) -> Self {
        let of_film = film.grid;
        Self {
            one_of: Some(grid),
            ..Self::new(film, &of_film)
        }
    }

    /// Returns the position of a tile of the picture, or of its next rows, in the film.
    fn placed(&self, tile: &Tile) -> Tile {
        let Some(grid) = self.one_of else {
            return *tile;
        };
        let whole = grid.tile(tile.number);
        Tile {
            number: 0,
            columns: tile.columns.map(|x| x - whole.columns[0]),
            rows: tile.rows.map(|y| y - whole.rows[0]),
        }
    }

    /// Returns the numbers of the strips that a tile crosses; some of its rows are the film's.
    fn strips_of(&self, tile: &Tile) -> RangeInclusive<usize> {
        let Range { start, end } = self.rows;
        let [top, bottom] = tile.rows.map(|y| y.clamp(start, end) - start);
        (top / STRIP_ROWS) as usize..=((bottom - 1) / STRIP_ROWS) as usize
    }

    /// Writes the pixels of a tile, or of its next rows, to the film.
    pub(super) fn store(&self, tile: &Tile, rendered: &Rendered) {
        let tile = &self.placed(tile);
        if let Some(counters) = rendered.counters {
            let packed = PackedCounters::new(counters);
            if let Some(stored) = self.tiles.get(tile.number as usize) {
                let mut stored = locked(stored);
                if tile.rows[0].is_multiple_of(self.tile_size) {
                    // Counters of an earlier rendering.
                    stored.counters.clear();
                }
                stored.counters.push(packed);
            }
        }
        let [left, _] = tile.columns;
        let [top, bottom] = tile.rows;
        for number in self.strips_of(tile) {
            // One lock at a time, so that threads cannot deadlock.
            let mut strip = locked(&self.strips[number]);
            let first_row = strip.first_row;
            for y in top.max(first_row)..bottom.min(first_row + strip.n_rows) {
                let first = (y - first_row) as usize * self.width + left as usize;
                let from = tile.index(left, y) as usize;
                let row = from..from + tile.width();
                strip.put(first, rendered, row, &self.development);
            }
        }
    }

    /// Returns a finished tile as a record of this rendering.
    pub(super) fn record(&self, tile: &Tile, rendering: u8, run: TileRun) -> TileRecord<'static> {
        let place = self.placed(tile);
        let mut pixels = vec![0; place.n_pixels() * self.bytes_per_pixel];
        for number in self.strips_of(&place) {
            locked(&self.strips[number]).store_pixels(&place, &mut pixels);
        }
        let counted = self.tiles.get(place.number as usize);
        let counters = counted.map(|stored| locked(stored).counters.clone());
        TileRecord {
            rendering,
            tile: tile.number,
            run,
            counters: counters.unwrap_or_default(),
            pixels: pixels.into(),
        }
    }

    /// Writes the pixels and counters of a record of this tile. Returns false, with arbitrary
    /// pixels, if it shows none of `n_ids` objects and materials, or its size is wrong. Rows that
    /// the film lacks are left out.
    pub(super) fn restore(&self, tile: &Tile, record: TileRecord, n_ids: [usize; 2]) -> bool {
        let tile = &self.placed(tile);
        if record.pixels.len() != tile.n_pixels() * self.bytes_per_pixel {
            return false;
        }
        if let Some(stored) = self.tiles.get(tile.number as usize) {
            locked(stored).counters = record.counters;
        }
        self.strips_of(tile).all(|number| {
            let mut strip = locked(&self.strips[number]);
            strip.restore_pixels(tile, &record.pixels);
            strip.has_only(tile, n_ids)
        })
    }

    /// Makes the pixels of a tile, or of its next rows, black without a hit.
    pub(super) fn clear(&self, tile: &Tile) {
        let pixels = PixelColumns::none(tile.n_pixels());
        self.store(
            tile,
            &Rendered {
                pixels: &pixels,
                counters: None,
                bounces: &[],
                time_ns: &[],
                warm_up_ns: 0.0,
            },
        );
    }
}
