//! Pixels that belong together: those of an object, those of a tile.

use std::collections::HashMap;

use super::measure::Measure;
use super::{Group, Side, Total, Totals};
use crate::text::Diagnostic;

/// The pixels by object and tile, and what is summed of them so far.
pub(super) struct Groups {
    /// Each side's own, since objects may have moved.
    by_object: [Partition; 2],
    /// B's: a tile is a part of the picture, whoever rendered it.
    by_tile: Partition,
    object_totals: Vec<(Measure, [Vec<f64>; 2])>,
    tile_totals: Vec<(Measure, [Vec<f64>; 2])>,
    /// Pixels that are not of the same object on both sides.
    pub(super) n_other_objects: u64,
}

impl Groups {
    pub(super) fn of([a, b]: &[Side; 2]) -> Result<Self, Diagnostic> {
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

    /// Sums another cost.
    pub(super) fn add(&mut self, measure: Measure, values: &[Vec<f64>; 2]) {
        let objects = [0, 1].map(|side| self.by_object[side].totals(measure, &values[side]));
        let tiles = [0, 1].map(|side| self.by_tile.totals(measure, &values[side]));
        self.object_totals.push((measure, objects));
        self.tile_totals.push((measure, tiles));
    }

    /// The objects of both sides, those of one name together.
    pub(super) fn objects(&self, sides: &[Side; 2]) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        let mut place_of: HashMap<String, usize> = HashMap::new();
        for (side, output) in sides.iter().enumerate() {
            for (index, &id) in self.by_object[side].ids.iter().enumerate() {
                let name = output.object_name(id);
                let place = *place_of.entry(name.clone()).or_insert_with(|| {
                    let nothing = |(measure, _): &(Measure, _)| Total {
                        measure: *measure,
                        cost: [0.0; 2],
                    };
                    let totals = Totals(self.object_totals.iter().map(nothing).collect());
                    groups.push(Group {
                        name,
                        bounds: None,
                        totals,
                    });
                    groups.len() - 1
                });
                let totals = &mut groups[place].totals.0;
                for (total, (measure, sums)) in totals.iter_mut().zip(&self.object_totals) {
                    let cost = &mut total.cost[side];
                    *cost = measure.add(*cost, sums[side][index]);
                }
            }
        }
        groups
    }

    pub(super) fn tiles(&self, [width, _]: [u32; 2]) -> Vec<Group> {
        let bounds = self.by_tile.bounds(width as usize);
        let group = |(index, id): (usize, &i32)| Group {
            name: format!("tile {id}"),
            bounds: Some(bounds[index]),
            totals: Totals(
                self.tile_totals
                    .iter()
                    .map(|(measure, sums)| Total {
                        measure: *measure,
                        cost: [sums[0][index], sums[1][index]],
                    })
                    .collect(),
            ),
        };
        self.by_tile.ids.iter().enumerate().map(group).collect()
    }
}

/// The greatest change first; of equal ones as they came.
pub(super) fn sorted(mut groups: Vec<Group>) -> Vec<Group> {
    groups.sort_by(|x, y| y.change().abs().total_cmp(&x.change().abs()));
    groups
}

/// The pixels of a frame, dealt out to groups.
struct Partition {
    /// What each group is called in the array, in the order of first sight.
    ids: Vec<i32>,
    /// The group of each pixel, as an index into `ids`.
    of_pixel: Vec<u32>,
}

impl Partition {
    /// Pixels with the same id are a group.
    fn by(pixel_ids: &[i32]) -> Self {
        let mut ids = Vec::new();
        let mut index_of: HashMap<i32, u32> = HashMap::new();
        // Neighbors mostly belong together.
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

    /// What the pixels of each group cost together.
    fn totals(&self, measure: Measure, values: &[f64]) -> Vec<f64> {
        let mut totals = vec![0.0; self.ids.len()];
        for (&group, &value) in self.of_pixel.iter().zip(values) {
            let total = &mut totals[group as usize];
            *total = measure.add(*total, value);
        }
        totals
    }

    /// The least rectangle around each group in a frame of this width.
    fn bounds(&self, width: usize) -> Vec<Rectangle> {
        let mut bounds = vec![Rectangle::EMPTY; self.ids.len()];
        for (i, &group) in self.of_pixel.iter().enumerate() {
            bounds[group as usize].include(i % width, i / width);
        }
        bounds
    }
}

/// Some columns and rows of a frame, the last ones included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Rectangle {
    /// First and last column.
    pub x: [usize; 2],
    /// First and last row, row 0 on top.
    pub y: [usize; 2],
}

impl Rectangle {
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
        assert_eq!(partition.totals(Measure::TIME, &values), [11.0, 20.0, 32.0]);
        assert_eq!(partition.totals(Measure::DEPTH, &values), [8.0, 16.0, 32.0]);
        let bounds = partition.bounds(3);
        assert_eq!(
            bounds[0],
            Rectangle {
                x: [0, 1],
                y: [0, 1]
            }
        );
        assert_eq!(
            bounds[2],
            Rectangle {
                x: [2, 2],
                y: [1, 1]
            }
        );
    }
}
