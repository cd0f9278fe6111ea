//! Sums the cost over the pixels of each object and of each tile.

use std::collections::HashMap;
use std::ops::Range;

use rayon::prelude::*;

use super::{CostGroup, Side, Total, Totals};
use host::text::Diagnostic;
use tracer::cost::{Metric, MetricUnit};

/// The pixels grouped by object and by tile, and the sums of the metrics over each group.
pub(super) struct Groups {
    /// One grouping per side, since objects may have moved.
    by_object: [Grouping; 2],
    /// The tiles of B.
    by_tile: Grouping,
    tile_bounds: Vec<PixelBounds>,
    sums: Vec<MetricSums>,
    /// Pixels that show different objects in A and B.
    pub(super) n_other_objects: u64,
    /// Pixels with different counters in A and B.
    pub(super) n_other_counts: u64,
}

/// The sums of a metric over each group, of A and B.
struct MetricSums {
    metric: Metric,
    objects: [Vec<f64>; 2],
    tiles: [Vec<f64>; 2],
}

impl Groups {
    /// Sums these metrics over the pixels of both sides.
    ///
    /// # Errors
    /// An array cannot be read.
    pub(super) fn sum(sides: &[Side; 2], metrics: Vec<Metric>) -> Result<Self, Diagnostic> {
        let nothing = |metric| MetricSums {
            metric,
            objects: Default::default(),
            tiles: Default::default(),
        };
        let mut groups = Self {
            by_object: Default::default(),
            by_tile: Grouping::default(),
            tile_bounds: Vec::new(),
            sums: metrics.into_iter().map(nothing).collect(),
            n_other_objects: 0,
            n_other_counts: 0,
        };
        for rows in sides[0].bands() {
            groups.add(sides, rows)?;
        }
        Ok(groups)
    }

    /// Adds the pixels in `rows`.
    fn add(&mut self, sides: &[Side; 2], rows: Range<u32>) -> Result<(), Diagnostic> {
        let [a, b] = sides;
        let first_row = rows.start as usize;
        let ids = [(a, "object"), (b, "object"), (b, "tile")];
        let ids = ids
            .into_par_iter()
            .map(|(side, name)| side.ids(name, rows.clone()));
        let ids: Vec<Vec<i32>> = ids.collect::<Result<_, _>>()?;
        let differ = ids[0].iter().zip(&ids[1]).filter(|(a, b)| a != b);
        self.n_other_objects += differ.count() as u64;
        let objects = [0, 1].map(|side| self.by_object[side].groups(&ids[side]));
        let tiles = self.by_tile.groups(&ids[2]);
        self.tile_bounds
            .resize(self.by_tile.ids.len(), PixelBounds::EMPTY);
        for (row, y) in tiles.chunks_exact(b.size()[0] as usize).zip(first_row..) {
            for (&tile, x) in row.iter().zip(0..) {
                self.tile_bounds[tile as usize].include(x, y);
            }
        }
        let n_objects = self.by_object.each_ref().map(|objects| objects.ids.len());
        let n_tiles = self.by_tile.ids.len();
        let other_counts = self.sums.par_iter_mut().map(|sums| {
            let MetricSums { metric, .. } = *sums;
            let costs = [
                a.costs(metric, rows.clone())?,
                b.costs(metric, rows.clone())?,
            ];
            for (side, costs) in costs.iter().enumerate() {
                let of_objects = &mut sums.objects[side];
                of_objects.resize(n_objects[side], 0.0);
                add_costs(metric, &objects[side], costs, of_objects);
                let of_tiles = &mut sums.tiles[side];
                of_tiles.resize(n_tiles, 0.0);
                add_costs(metric, &tiles, costs, of_tiles);
            }
            let [a, b] = &costs;
            let differ = |(a, b)| metric.unit == MetricUnit::Count && a != b;
            Ok(a.iter().zip(b).map(differ).collect::<Vec<bool>>())
        });
        let other_counts = other_counts.try_reduce(Vec::new, |some, others| {
            let (mut all, others) = if some.is_empty() {
                (others, some)
            } else {
                (some, others)
            };
            all.iter_mut()
                .zip(others)
                .for_each(|(one, other)| *one |= other);
            Ok(all)
        })?;
        self.n_other_counts += other_counts.into_iter().filter(|differ| *differ).count() as u64;
        Ok(())
    }

    /// Returns the totals of each metric over all pixels.
    pub(super) fn totals(&self) -> Totals {
        let total = |sums: &MetricSums| {
            let metric = sums.metric;
            let add = |sum: f64, &cost: &f64| metric.combine(sum, cost);
            let all = |objects: &Vec<f64>| objects.iter().fold(0.0, add);
            let cost = sums.objects.each_ref().map(all);
            Total { metric, cost }
        };
        Totals(self.sums.iter().map(total).collect())
    }

    /// Returns the objects of both sides; objects with the same name are one group.
    pub(super) fn objects(&self, sides: &[Side; 2]) -> Vec<CostGroup> {
        let mut groups: Vec<CostGroup> = Vec::new();
        let mut group_of: HashMap<String, usize> = HashMap::new();
        for (side, output) in sides.iter().enumerate() {
            for (index, &id) in self.by_object[side].ids.iter().enumerate() {
                let name = output.object_name(id);
                let group = *group_of.entry(name.clone()).or_insert_with(|| {
                    let nothing = |&MetricSums { metric, .. }: &MetricSums| Total {
                        metric,
                        cost: [0.0; 2],
                    };
                    let totals = Totals(self.sums.iter().map(nothing).collect());
                    groups.push(CostGroup {
                        name,
                        bounds: None,
                        totals,
                    });
                    groups.len() - 1
                });
                let totals = &mut groups[group].totals.0;
                for (total, sums) in totals.iter_mut().zip(&self.sums) {
                    let cost = &mut total.cost[side];
                    *cost = sums.metric.combine(*cost, sums.objects[side][index]);
                }
            }
        }
        groups
    }

    /// Returns the tiles of B with their bounds.
    pub(super) fn tiles(&self) -> Vec<CostGroup> {
        let group = |(index, (id, &bounds)): (usize, (&i32, &PixelBounds))| {
            let total = |sums: &MetricSums| Total {
                metric: sums.metric,
                cost: sums.tiles.each_ref().map(|tiles| tiles[index]),
            };
            CostGroup {
                name: format!("tile {id}"),
                bounds: Some(bounds),
                totals: Totals(self.sums.iter().map(total).collect()),
            }
        };
        let tiles = self.by_tile.ids.iter().zip(&self.tile_bounds);
        tiles.enumerate().map(group).collect()
    }
}

/// Sorts groups by their change, the greatest first; the sort is stable.
pub(super) fn sorted(mut groups: Vec<CostGroup>, ratios: &[Metric]) -> Vec<CostGroup> {
    groups
        .iter_mut()
        .for_each(|group| group.totals.add_ratios(ratios));
    groups.sort_by(|x, y| y.change().abs().total_cmp(&x.change().abs()));
    groups
}

/// Groups pixels with the same ID.
#[derive(Default)]
struct Grouping {
    /// ID of each group in the array, in the order of its first pixel.
    ids: Vec<i32>,
    /// The index in `ids` of each ID.
    index_of: HashMap<i32, u32>,
}

impl Grouping {
    /// Returns the groups of pixels with these IDs, as indices into [`Self::ids`].
    fn groups(&mut self, pixel_ids: &[i32]) -> Vec<u32> {
        let Self { ids, index_of } = self;
        // Neighbors are mostly in the same group.
        let mut last = None;
        let mut group_of = |id: i32| match last {
            Some((last_id, group)) if last_id == id => group,
            _ => {
                let group = *index_of.entry(id).or_insert_with(|| {
                    ids.push(id);
                    ids.len() as u32 - 1
                });
                last = Some((id, group));
                group
            }
        };
        pixel_ids.iter().map(|&id| group_of(id)).collect()
    }
}

/// Adds the cost of each pixel to the sum of its group.
fn add_costs(metric: Metric, groups: &[u32], costs: &[f64], sums: &mut [f64]) {
    let Some(&first) = groups.first() else {
        return;
    };
    // Neighbors are mostly in the same group, whose sum is not stored in between.
    let mut last = first as usize;
    let mut sum = sums[last];
    for (&group, &cost) in groups.iter().zip(costs) {
        if group as usize != last {
            sums[last] = sum;
            last = group as usize;
            sum = sums[last];
        }
        sum = metric.combine(sum, cost);
    }
    sums[last] = sum;
}

/// A rectangle of pixels in a frame; both ends are inclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct PixelBounds {
    /// First and last column.
    pub x: [usize; 2],
    /// First and last row, row 0 on top.
    pub y: [usize; 2],
}

impl PixelBounds {
    const EMPTY: Self = Self {
        x: [usize::MAX, 0],
        y: [usize::MAX, 0],
    };

    fn include(&mut self, x: usize, y: usize) {
        self.x = [self.x[0].min(x), self.x[1].max(x)];
        self.y = [self.y[0].min(y), self.y[1].max(y)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_summed_by_their_ids() {
        let mut grouping = Grouping::default();
        let bands = [[7, 7, -1], [7, -1, 3]].map(|ids| grouping.groups(&ids));
        assert_eq!(grouping.ids, [7, -1, 3]);
        assert_eq!(bands, [[0, 0, 1], [0, 1, 2]]);
        let sums = |metric| {
            let mut sums = [0.0; 3];
            add_costs(metric, &bands[0], &[1.0, 2.0, 4.0], &mut sums);
            add_costs(metric, &bands[1], &[8.0, 16.0, 32.0], &mut sums);
            sums
        };
        assert_eq!(sums(Metric::TIME), [11.0, 20.0, 32.0]);
        assert_eq!(sums(Metric::DEPTH), [8.0, 16.0, 32.0]);
    }

    #[test]
    fn bounds_include_their_pixels() {
        let mut bounds = PixelBounds::EMPTY;
        bounds.include(2, 1);
        bounds.include(0, 4);
        let (x, y) = ([0, 2], [1, 4]);
        assert_eq!(bounds, PixelBounds { x, y });
    }
}
