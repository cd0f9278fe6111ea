//! The polygons of polyhedra, which have any number of faces in any order.

use std::collections::HashMap;

/// An edge of a cell that the surface crosses: the point inside, and the other one.
pub(super) type CutEdge = [u32; 2];

/// The polygons that separate the points inside from the others, each as the edges that it
/// crosses in either order around it, of a polyhedron with these faces, each the points
/// around it in either order. `None` where the faces do not close it.
///
/// The lines on a face are those of [`super::polygons`], so that cells of all types agree on
/// the faces that they share.
pub(super) fn polygons<'a>(
    faces: impl Iterator<Item = &'a [u32]>,
    is_inside: impl Fn(u32) -> bool,
) -> Option<Vec<Vec<CutEdge>>> {
    let mut lines = Vec::new();
    for face in faces {
        add_lines(face, &is_inside, &mut lines);
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

/// Adds the lines on a face, one for each run of points that are inside: from the edge before
/// the run to the edge behind it.
fn add_lines(face: &[u32], is_inside: impl Fn(u32) -> bool, lines: &mut Vec<[CutEdge; 2]>) {
    let n = face.len();
    for i in 0..n {
        let [before, first] = [face[i], face[(i + 1) % n]];
        if is_inside(before) || !is_inside(first) {
            continue;
        }
        let mut last = i + 1;
        while is_inside(face[(last + 1) % n]) {
            last += 1;
        }
        lines.push([[first, before], [face[last % n], face[(last + 1) % n]]]);
    }
}
