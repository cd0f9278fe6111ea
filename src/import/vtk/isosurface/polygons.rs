//! The polygons in cells with a few corners in a known order.

use arrayvec::ArrayVec;

/// Maximum number of corners and edges of a solid cell: a hexagonal prism's.
pub(super) const MAX_CORNERS: usize = 12;
pub(super) const MAX_EDGES: usize = 18;

/// An edge of a cell that the surface crosses: its inside corner, and its outside corner.
pub(super) type CrossedEdge = [u8; 2];

/// Returns the polygons that separate the inside corners from the others, each as the edges that it
/// crosses: counter-clockwise as seen from the side of the others.
pub(super) fn polygons(
    faces: &[&[u8]],
    inside: &[bool],
) -> ArrayVec<ArrayVec<CrossedEdge, MAX_EDGES>, MAX_EDGES> {
    let mut lines = ArrayVec::<[CrossedEdge; 2], MAX_EDGES>::new();
    let is_inside = |corner: u8| inside[usize::from(corner)];
    for face in faces {
        lines.extend(face_lines(face, is_inside));
    }
    let mut found = ArrayVec::new();
    while let Some([first, mut next]) = lines.pop() {
        let mut polygon = ArrayVec::from_iter([first]);
        // Each edge belongs to two faces: one line ends at it, and another begins.
        while let Some(at) = lines.iter().position(|[from, _]| *from == next) {
            polygon.push(next);
            next = lines.remove(at)[1];
        }
        found.push(polygon);
    }
    found
}

/// Returns the lines on a face, one for each run of inside corners: from the edge before the run to
/// the edge after it, each as its inside and its outside corner.
///
/// All types of cells use this, so that they agree on shared faces.
pub(super) fn face_lines<C: Copy>(
    face: &[C],
    is_inside: impl Fn(C) -> bool,
) -> impl Iterator<Item = [[C; 2]; 2]> {
    let n = face.len();
    (0..n).filter_map(move |i| {
        let [before, first] = [face[i], face[(i + 1) % n]];
        if is_inside(before) || !is_inside(first) {
            return None;
        }
        let mut last = i + 1;
        while is_inside(face[(last + 1) % n]) {
            last += 1;
        }
        let behind = [face[last % n], face[(last + 1) % n]];
        Some([[first, before], behind])
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::cells::{CellShape, VOXEL};
    use super::*;

    #[test]
    fn a_corner_of_a_voxel_is_cut_off_by_a_triangle_that_faces_the_others() {
        let mut inside = [false; 8];
        inside[0] = true;
        let found = polygons(VOXEL, &inside);
        assert_eq!(found.len(), 1);
        let at = |edge: &CrossedEdge| match edge {
            [0, 1] => 'x',
            [0, 2] => 'y',
            [0, 4] => 'z',
            _ => '?',
        };
        let edges: String = found[0].iter().chain(&found[0]).map(at).collect();
        assert!(edges.contains("xyz"), "{edges}");
    }

    /// Each crossed edge belongs to one polygon, for all cases of all cells.
    #[test]
    fn every_crossed_edge_is_in_one_polygon() {
        for (cell_type, n) in [
            (10, 4),
            (11, 8),
            (12, 8),
            (13, 6),
            (14, 5),
            (15, 10),
            (16, 12),
        ] {
            let Some(CellShape::Solid(faces)) = CellShape::new(cell_type, n) else {
                panic!("{cell_type} is solid");
            };
            for case in 0..1_u32 << n {
                let inside: Vec<bool> = (0..n).map(|corner| case >> corner & 1 == 1).collect();
                let polygons = polygons(faces, &inside);
                let mut found: Vec<CrossedEdge> = polygons.iter().flatten().copied().collect();
                found.sort_unstable();
                let mut expected = Vec::new();
                for face in faces {
                    for i in 0..face.len() {
                        let [a, b] = [face[i], face[(i + 1) % face.len()]];
                        if inside[usize::from(a)] && !inside[usize::from(b)] {
                            expected.push([a, b]);
                        }
                    }
                }
                expected.sort_unstable();
                assert_eq!(found, expected, "{cell_type} {case}");
                assert!(polygons.iter().all(|polygon| polygon.len() > 2));
            }
        }
    }
}
