//! Sums the cost over the pixels of each object and of each tile.

use std::collections::HashMap;

use super::{CostGroup, Side, Total, Totals};
use base::text::Diagnostic;
use tracer::cost::Metric;

/// The pixels grouped by object and by tile, and the sums of the metrics added so far.
pub(super) struct Groups {
    /// One partition per side, since objects may have moved.
    by_object: [Partition; 2],
    /// The tiles of B.
    by_tile: Partition,
    object_totals: Vec<(Metric, [Vec<f64>; 2])>,
    tile_totals: Vec<(Metric, [Vec<f64>; 2])>,
    /// Pixels that show different objects in A and B.
    pub(super) n_other_objects: u64,
}

impl Groups {
    pub(super) fn new([a, b]: &[Side; 2]) -> Result<Self, Diagnostic> {
        let objects = [a.ids("object")?, b.ids("object")?];
        let differ = objects[0].iter().zip(&objects[1]).filter(|(a, b)| a != b);
        Ok(Self {
            n_other_objects: differ.count() as u64,
            by_object: [Partition::by(&objects[0]), Partition::by(&objects[1])],
            by_tile: Partition::by(&b.ids("tile")?),
            object_totals: Vec::new(),
            tile_totals: Vec::new(),
        })
    }

    /// Sums another metric over each group. Returns its totals over all pixels.
    pub(super) fn add(&mut self, metric: Metric, values: &[Vec<f64>; 2]) -> [f64; 2] {
        let both = |side: usize| {
            let values = &values[side];
            rayon::join(
                || self.by_object[side].totals(metric, values),
                || self.by_tile.totals(metric, values),
            )
        };
        let ((objects_a, tiles_a), (objects_b, tiles_b)) = rayon::join(|| both(0), || both(1));
        let objects = [objects_a, objects_b];
        let all = objects.each_ref().map(|totals| {
            let totals = totals.iter();
            totals.fold(0.0, |sum, &total| metric.combine(sum, total))
        });
        self.object_totals.push((metric, objects));
        self.tile_totals.push((metric, [tiles_a, tiles_b]));
        all
    }

    /// Returns the objects of both sides; objects with the same name are one group.
    pub(super) fn objects(&self, sides: &[Side; 2]) -> Vec<CostGroup> {
        let mut groups: Vec<CostGroup> = Vec::new();
        let mut group_of: HashMap<String, usize> = HashMap::new();
        for (side, output) in sides.iter().enumerate() {
            for (index, &id) in self.by_object[side].ids.iter().enumerate() {
                let name = output.object_name(id);
                let group = *group_of.entry(name.clone()).or_insert_with(|| {
                    let nothing = |(metric, _): &(Metric, _)| Total {
                        metric: *metric,
                        cost: [0.0; 2],
                    };
                    let totals = Totals(self.object_totals.iter().map(nothing).collect());
                    groups.push(CostGroup {
                        name,
                        bounds: None,
                        totals,
                    });
                    groups.len() - 1
                });
                let totals = &mut groups[group].totals.0;
                for (total, (metric, sums)) in totals.iter_mut().zip(&self.object_totals) {
                    let cost = &mut total.cost[side];
                    *cost = metric.combine(*cost, sums[side][index]);
                }
            }
        }
        groups
    }

    /// Returns the tiles of B with their bounds in a frame of this size.
    pub(super) fn tiles(&self, [width, _]: [u32; 2]) -> Vec<CostGroup> {
        let bounds = self.by_tile.bounds(width as usize);
        let group = |(index, id): (usize, &i32)| CostGroup {
            name: format!("tile {id}"),
            bounds: Some(bounds[index]),
            totals: Totals(
                self.tile_totals
                    .iter()
                    .map(|(metric, sums)| Total {
                        metric: *metric,
                        cost: [sums[0][index], sums[1][index]],
                    })
                    .collect(),
            ),
        };
        self.by_tile.ids.iter().enumerate().map(group).collect()
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

/// A partition of the pixels of a frame into groups.
struct Partition {
    /// ID of each group in the array, in the order of its first pixel.
    ids: Vec<i32>,
    /// The group of each pixel, as an index into `ids`.
    of_pixel: Vec<u32>,
}

impl Partition {
    /// Groups pixels with the same ID.
    fn by(pixel_ids: &[i32]) -> Self {
        let mut ids = Vec::new();
        let mut index_of: HashMap<i32, u32> = HashMap::new();
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
        let of_pixel = pixel_ids.iter().map(|&id| group_of(id)).collect();
        Self { ids, of_pixel }
    }

    /// Returns the total of each group.
    fn totals(&self, metric: Metric, values: &[f64]) -> Vec<f64> {
        let mut totals = vec![0.0; self.ids.len()];
        let Some(&first) = self.of_pixel.first() else {
            return totals;
        };
        // Neighbors are mostly in the same group, whose total is not stored in between.
        let (mut last, mut total) = (first as usize, 0.0);
        for (&group, &value) in self.of_pixel.iter().zip(values) {
            if group as usize != last {
                totals[last] = total;
                last = group as usize;
                total = totals[last];
            }
            total = metric.combine(total, value);
        }
        totals[last] = total;
        totals
    }

    /// Returns the bounds of each group in a frame of this width.
    fn bounds(&self, width: usize) -> Vec<PixelBounds> {
        let mut bounds = vec![PixelBounds::EMPTY; self.ids.len()];
        for (i, &group) in self.of_pixel.iter().enumerate() {
            bounds[group as usize].include(i % width, i / width);
        }
        bounds
    }
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
        let partition = Partition::by(&[7, 7, -1, 7, -1, 3]);
        assert_eq!(partition.ids, [7, -1, 3]);
        let values = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
        assert_eq!(partition.totals(Metric::TIME, &values), [11.0, 20.0, 32.0]);
        assert_eq!(partition.totals(Metric::DEPTH, &values), [8.0, 16.0, 32.0]);
        let bounds = partition.bounds(3);
        assert_eq!(
            bounds[0],
            PixelBounds {
                x: [0, 1],
                y: [0, 1]
            }
        );
        assert_eq!(
            bounds[2],
            PixelBounds {
                x: [2, 2],
                y: [1, 1]
            }
        );
    }
}
