//! The polygons of polyhedra, which have any number of faces in any order.

use std::collections::HashMap;

use super::polygons::face_lines;

/// An edge of a cell that the surface crosses: the point inside, and the other one.
pub(super) type CutEdge = [u32; 2];

/// The polygons that separate the points inside from the others, each as the edges that it
/// crosses in either order around it, of a polyhedron with these faces, each the points
/// around it in either order. `None` where the faces do not close it.
pub(super) fn polygons<'a>(
    faces: impl Iterator<Item = &'a [u32]>,
    is_inside: impl Fn(u32) -> bool,
) -> Option<Vec<Vec<CutEdge>>> {
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
            at_edge.retain(|line| !is_used[*line]);
            let line = at_edge.pop()?;
            is_used[line] = true;
            let [from, to] = lines[line];
            next = if from == next { to } else { from };
        }
        found.push(polygon);
    }
    Some(found)
}
