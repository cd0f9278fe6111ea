//! The polygons in polyhedra, whose faces may have any number and order.

use std::collections::HashMap;

use super::polygons::face_lines;

/// An edge of a cell that the surface crosses: its inside point, and its outside point.
pub(super) type CutEdge = [u32; 2];

/// Returns the polygons that separate the inside points of a polyhedron from the others, each as
/// the edges that it crosses, in either direction around it. Each face has its points in either
/// direction. `None` if the faces do not close the polyhedron.
pub(super) fn polygons<'a>(
    faces: impl Iterator<Item = &'a [u32]>,
    is_inside: impl Fn(u32) -> bool,
) -> Option<Vec<Vec<CutEdge>>> {
    // Find the lines on all faces, and the lines that end at each edge.
    let mut lines = Vec::new();
    for face in faces {
        lines.extend(face_lines(face, &is_inside));
    }
    let mut ends = HashMap::<CutEdge, Vec<usize>>::new();
    for (i, line) in lines.iter().enumerate() {
        for edge in line {
            ends.entry(*edge).or_default().push(i);
        }
    }
    // Chain the lines from edge to edge until each polygon closes.
    let mut is_used = vec![false; lines.len()];
    let mut found = Vec::new();
    for i in 0..lines.len() {
        if is_used[i] {
            continue;
        }
        is_used[i] = true;
        let [first, mut next] = lines[i];
        let mut polygon = vec![first];
        while next != first {
            polygon.push(next);
            let at_edge = ends.get_mut(&next)?;
            let line = std::iter::from_fn(|| at_edge.pop()).find(|&line| !is_used[line])?;
            is_used[line] = true;
            let [from, to] = lines[line];
            next = if from == next { to } else { from };
        }
        found.push(polygon);
    }
    Some(found)
}
