//! Numbers of samples by efficiency: in proportion to the root of variance over cost, which gives
//! the least squared error for the cost of all samples together.
//!
//! Variance and cost come from the first samples of the pixel's eight neighbors. A pixel's own
//! samples do not decide about their number, so that all of them count and their mean has no bias.
//! They need not be in the same tile: a ring of pixels around a tile is rendered for this and
//! forgotten, so that tiles, windows and parts of a picture change no number.

use super::prepass::{chunks, probed_pixels};
use super::rounds::{FirstSamples, Rounds};
use super::stream::StreamRenderer;
use super::view::View;
use crate::schedule::{Tile, TileGrid};
use scene::build::Sensor;
use scene::config::Image;
use tracer::cost::{Counters, PixelProbe};
use tracer::trace::Tracer;

/// Pixels of a picture for each whose neighbors show the variance and the cost of all, the least and
/// the greatest number of these pixels, and their least distance in columns and rows.
const PER_PROBED: f64 = 64.0;
const LEAST_PROBED: f64 = 128.0;
const MOST_PROBED: f64 = 1024.0;
const LEAST_STEP: u32 = 3;

/// Steps of the bisection that finds the factor of a picture.
const N_BISECTIONS: u32 = 64;

/// Plans the numbers of samples of a tile's pixels.
pub(super) struct SamplePlanner<'a> {
    /// Renders the first samples of pixels of the whole picture.
    stream: StreamRenderer<'a, Counters>,
    rounds: Rounds,
    /// The first pixel of the image in the picture, and the size of the picture.
    origin: [u32; 2],
    size: [u32; 2],
    /// The first samples of a tile's pixels and of the ring around them, row by row.
    firsts: Vec<FirstSamples>,
}

impl<'a> SamplePlanner<'a> {
    /// Creates a planner for the pixels of a view; `None` unless efficiency decides.
    pub(super) fn of(view: View<'a>) -> Option<Self> {
        view.rounds.are_planned().then(|| Self {
            stream: StreamRenderer::new(view.of_first_samples()),
            rounds: view.rounds,
            origin: view.origin(),
            size: view.picture_size(),
            firsts: Vec::new(),
        })
    }

    /// Overwrites `planned` with the number of samples of each pixel of a tile, row by row.
    pub(super) fn plan(&mut self, tile: &Tile, planned: &mut Vec<u32>) {
        let around = self.around(&self.in_picture(tile));
        self.render(&around, |_| true);
        self.plan_rendered(tile, planned);
    }

    /// Overwrites `planned` with the number of samples of each pixel of a tile, row by row, after a
    /// stream has rendered their first samples.
    pub(super) fn plan_after<P: PixelProbe>(
        &mut self,
        tile: &Tile,
        stream: &StreamRenderer<P>,
        planned: &mut Vec<u32>,
    ) {
        let inside = self.in_picture(tile);
        let around = self.around(&inside);
        self.render(&around, |(x, y)| !inside.has(x, y));
        let [left, top] = self.origin;
        for (i, (x, y)) in stream.started().enumerate() {
            self.firsts[around.index(left + x, top + y) as usize] = stream.first_samples(i);
        }
        self.plan_rendered(tile, planned);
    }

    /// Renders the first samples of some pixels of a rectangle of the picture.
    fn render(&mut self, around: &Tile, is_wanted: impl Fn((u32, u32)) -> bool) {
        let places = || around.pixels().filter(|&at| is_wanted(at));
        self.stream.follow((0..).zip(places()));
        self.firsts.clear();
        self.firsts
            .resize(around.n_pixels(), FirstSamples::default());
        for (i, (x, y)) in places().enumerate() {
            self.firsts[around.index(x, y) as usize] = self.stream.first_samples(i);
        }
    }

    /// Plans the pixels of a tile after the first samples of all are rendered.
    fn plan_rendered(&self, tile: &Tile, planned: &mut Vec<u32>) {
        let inside = self.in_picture(tile);
        let around = self.around(&inside);
        planned.clear();
        planned.resize(inside.n_pixels(), 0);
        for (x, y) in inside.pixels() {
            let neighbors = neighbors(x, y, self.size);
            let firsts = neighbors.map(|(x, y)| self.firsts[around.index(x, y) as usize]);
            planned[inside.index(x, y) as usize] = self.rounds.planned(root(firsts));
        }
    }

    /// Returns the place of a tile in the picture.
    fn in_picture(&self, tile: &Tile) -> Tile {
        let [left, top] = self.origin;
        Tile {
            columns: tile.columns.map(|x| left + x),
            rows: tile.rows.map(|y| top + y),
            ..*tile
        }
    }

    /// Returns a rectangle of the picture with the ring of pixels around it.
    fn around(&self, inside: &Tile) -> Tile {
        let widened = |[first, end]: [u32; 2], n: u32| [first.saturating_sub(1), n.min(end + 1)];
        Tile {
            columns: widened(inside.columns, self.size[0]),
            rows: widened(inside.rows, self.size[1]),
            ..*inside
        }
    }
}

/// Returns the samples of one pixel, planned if efficiency decides.
pub(crate) fn rounds_of(view: View, (x, y): (u32, u32)) -> Rounds {
    let mut planned = Vec::new();
    if let Some(mut planner) = SamplePlanner::of(view) {
        planner.plan(&Tile::one_pixel(x, y), &mut planned);
    }
    (planned.first()).map_or(view.rounds, |&n| view.rounds.with_samples(n))
}

/// Returns the neighbors of a pixel in a picture of this size.
fn neighbors(x: u32, y: u32, [width, height]: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    let beside = |i: u32, n: u32| i.saturating_sub(1)..n.min(i + 2);
    let columns = beside(x, width);
    let all = beside(y, height).flat_map(move |y| columns.clone().map(move |x| (x, y)));
    all.filter(move |&at| at != (x, y))
}

/// Returns the root of variance over cost of some pixels together.
fn root(firsts: impl Iterator<Item = FirstSamples>) -> f64 {
    let (mut variance, mut cost) = (0.0, 0);
    for first in firsts {
        variance += first.variance;
        cost += first.cost;
    }
    (variance / cost.max(1) as f64).sqrt()
}

/// Returns the sensor with the samples of a pixel per root of variance over cost, if efficiency
/// decides about samples and they are not known: the same for each window and each part of the
/// picture.
///
/// Some pixels of the whole picture are probed, evenly spread, on the current rayon pool; with
/// another seed than the picture's, so that they are independent of its samples.
pub fn with_samples_planned(tracer: Tracer, sensor: &Sensor) -> Sensor {
    let is_planned = Rounds::new(sensor).are_planned() && sensor.samples_per_root.is_none();
    let probed = || {
        let image = Image {
            seed: !sensor.image.seed,
            ..sensor.image
        };
        let view = View::new(tracer, &Sensor { image, ..*sensor });
        samples_per_root(view, image.samples_per_pixel)
    };
    Sensor {
        samples_per_root: is_planned.then(probed).or(sensor.samples_per_root),
        ..*sensor
    }
}

/// Returns the samples of a pixel per root of variance over cost with which the pixels of the view's
/// picture have about `n_samples` in the mean, at least the first ones.
fn samples_per_root(view: View, n_samples: u32) -> f64 {
    let size = view.picture_size();
    let [width, height] = size;
    let n_pixels = f64::from(width) * f64::from(height);
    let n_probed = (n_pixels / PER_PROBED).clamp(LEAST_PROBED, MOST_PROBED);
    let step = (n_pixels / n_probed).sqrt() as u32;
    let grid = TileGrid::new(width, height, step.max(LEAST_STEP));
    let renderer = || StreamRenderer::<Counters>::new(view.of_first_samples());
    let roots: Vec<f64> = chunks(&grid, 8, renderer, |renderer, tiles| {
        let probed = |tile| probed_pixels(tile, grid.tile_size);
        let beside = |(x, y)| neighbors(x, y, size);
        let places = tiles.iter().flat_map(probed).flat_map(beside);
        renderer.follow((0..).zip(places));
        let mut firsts = 0..;
        let of_pixel = |at| {
            let n = beside(at).count();
            root(firsts.by_ref().take(n).map(|i| renderer.first_samples(i)))
        };
        tiles.iter().flat_map(probed).map(of_pixel).collect()
    });
    factor(&roots, &view.rounds, n_samples)
}

/// Returns the factor with which `roots` are `n_samples` in the mean, within the limits of `rounds`.
fn factor(roots: &[f64], rounds: &Rounds, n_samples: u32) -> f64 {
    let most = f64::from(rounds.n_most());
    let least = roots.iter().copied().filter(|root| *root > 0.0);
    let wanted = f64::from(n_samples) * roots.len() as f64;
    // With the greatest factor, all pixels with noise have the most samples.
    let (mut low, mut high) = (0.0, most / least.fold(f64::INFINITY, f64::min));
    for _ in 0..N_BISECTIONS {
        let middle = 0.5 * (low + high);
        let n: f64 = roots
            .iter()
            .map(|root| (middle * root).clamp(f64::from(rounds.n_least()), most))
            .sum();
        if n > wanted {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}
