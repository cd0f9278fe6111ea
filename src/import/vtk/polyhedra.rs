//! The faces of polyhedra.

use super::super::mesh::count;
use super::super::{FileFault, Result};
use super::budget::Budget;
use super::numbers::Numbers;

/// The faces of a piece's polyhedral cells.
#[derive(Debug, Default)]
pub(super) struct Polyhedra {
    /// The end of each cell's faces.
    ends: Vec<usize>,
    /// The faces of all cells: indices of the faces below.
    faces: Vec<u32>,
    /// The end of each face's points.
    face_ends: Vec<usize>,
    /// Indices of points.
    points: Vec<u32>,
}

impl Polyhedra {
    /// Creates polyhedra from the four arrays that VTK has written since version 9.4: the points of
    /// faces and the end of each face's points, the faces of cells and the end of each cell's
    /// faces.
    ///
    /// # Errors
    /// Points, faces or ends do not exist, or there are too many for the memory.
    pub(super) fn of_arrays(
        [points, face_ends, faces, ends]: [&Numbers; 4],
        n_points: usize,
        budget: &mut Budget,
    ) -> Result<Self> {
        budget.take_of::<u32>(points.len() + faces.len())?;
        budget.take_of::<usize>(face_ends.len() + ends.len())?;
        Ok(Self {
            ends: ascending(ends.iter(), faces.len())?,
            faces: indices(faces.iter(), face_ends.len(), "face")?,
            face_ends: ascending(face_ends.iter(), points.len())?,
            points: indices(points.iter(), n_points, "point")?,
        })
    }

    /// Creates polyhedra from the two arrays that older versions write: for each cell the number of
    /// its faces, and for each face the number of its points and the points; and the end of each
    /// cell's entries, or -1 for cells of other types.
    ///
    /// # Errors
    /// As [`of_arrays`](Self::of_arrays).
    pub(super) fn of_stream(
        [stream, ends]: [&Numbers; 2],
        n_points: usize,
        budget: &mut Budget,
    ) -> Result<Self> {
        budget.take_of::<[usize; 4]>(stream.len())?;
        budget.take_of::<usize>(ends.len())?;
        let mut found = Self::default();
        let mut at = 0;
        let mut next = || {
            at += 1;
            (at <= stream.len())
                .then(|| stream.at(at - 1))
                .ok_or_else(|| {
                    let problem =
                        format!("the faces of its polyhedra end early, at {}", stream.len());
                    FileFault::new(problem, "the points of each face")
                })
        };
        for end in ends.iter() {
            if end >= 0.0 {
                let n_faces = next()?;
                let mut n = 0.0;
                while n < n_faces {
                    let n_corners = next()?;
                    let mut k = 0.0;
                    while k < n_corners {
                        found.points.extend(indices([next()?], n_points, "point")?);
                        k += 1.0;
                    }
                    found.faces.push(count(found.face_ends.len() + 1)? - 1);
                    found.face_ends.push(found.points.len());
                    n += 1.0;
                }
            }
            found.ends.push(found.faces.len());
        }
        Ok(found)
    }

    /// Returns the faces of a cell, each as its points in order around it; none if it is not a
    /// polyhedron.
    pub(super) fn faces(&self, cell: usize) -> impl ExactSizeIterator<Item = &[u32]> {
        self.of_cell(cell).iter().map(|&face| self.points(face))
    }

    /// Returns the points of a cell's face with this number.
    pub(super) fn face(&self, cell: usize, number: usize) -> &[u32] {
        self.points(self.of_cell(cell)[number])
    }

    fn of_cell(&self, cell: usize) -> &[u32] {
        match self.ends.get(cell) {
            Some(end) => &self.faces[begin(&self.ends, cell)..*end],
            None => &[],
        }
    }

    fn points(&self, face: u32) -> &[u32] {
        let face = face as usize;
        &self.points[begin(&self.face_ends, face)..self.face_ends[face]]
    }
}

/// Returns the start of the part with this index, given the ends of all parts.
fn begin(ends: &[usize], index: usize) -> usize {
    index.checked_sub(1).map_or(0, |before| ends[before])
}

/// Returns numbers that must not descend or exceed `most`.
fn ascending(numbers: impl Iterator<Item = f64>, most: usize) -> Result<Vec<usize>> {
    let mut last = 0.0;
    let in_order = numbers.map(|number| {
        if !(number >= last && number <= most as f64) {
            let problem = format!("the faces of its polyhedra end at {number} of {most}");
            return Err(FileFault::new(problem, format!("at {last} or later")));
        }
        last = number;
        Ok(number as usize)
    });
    in_order.collect()
}

/// Returns indices, which must be less than the number `n` of these things.
fn indices(numbers: impl IntoIterator<Item = f64>, n: usize, kind: &str) -> Result<Vec<u32>> {
    let in_range = numbers.into_iter().map(|number| {
        if number >= 0.0 && number < n as f64 {
            return Ok(number as u32);
        }
        let problem = format!("a polyhedron has the {kind} {number}");
        let expected = format!("one of the {n} {kind}s, of which the first is 0");
        Err(FileFault::new(problem, expected))
    });
    in_range.collect()
}
