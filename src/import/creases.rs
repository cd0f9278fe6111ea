//! Smooth normals that stop at creases.

use glam::Vec3;

use super::mesh::{Mesh, angle};
use world::scene::CornerValues;

/// Groups of triangle corners, as a disjoint-set forest whose roots are their own parents.
struct CornerGroups(Vec<u32>);

impl CornerGroups {
    /// Returns the root of the group of a corner.
    fn root(&mut self, mut corner: u32) -> u32 {
        while self.0[corner as usize] != corner {
            let above = self.0[self.0[corner as usize] as usize];
            self.0[corner as usize] = above;
            corner = above;
        }
        corner
    }

    fn unite(&mut self, a: u32, b: u32) {
        let [a, b] = [self.root(a), self.root(b)];
        // The smaller number stays the root, so that the order of pairs does not matter.
        self.0[a.max(b) as usize] = a.min(b);
    }
}

impl Mesh {
    /// Returns normals that vary smoothly over the surface, except at edges whose two triangles
    /// enclose an angle of more than `most_deg`: at each corner the sum of the normals of the
    /// triangles around its vertex up to such edges, weighted as in
    /// [`smooth_normals`](Self::smooth_normals).
    pub fn creased_normals(&self, most_deg: f32) -> CornerValues<Vec3> {
        let normal = |corners: &[u32; 3]| self.triangle(*corners).normal().unwrap_or_default();
        let normals: Vec<Vec3> = self.triangles.iter().map(normal).collect();
        let n_corners = 3 * self.triangles.len() as u32;
        let mut groups = CornerGroups((0..n_corners).collect());
        // The sides of the triangles, each identified by the corner at which it begins.
        let mut sides: Vec<u32> = (0..n_corners).collect();
        sides.sort_unstable_by_key(|side| (self.ends(*side), *side));
        // Unite the corners at both ends of each smooth edge.
        let least_cos = libm::cosf(most_deg.to_radians());
        for pair in sides.windows(2) {
            let [one, other] = [pair[0], pair[1]];
            let [a, b] = [one, other].map(|side| normals[side as usize / 3]);
            // A triangle without area does not connect.
            let is_flat = a == Vec3::ZERO || b == Vec3::ZERO || a.dot(b) >= least_cos;
            if is_flat && self.ends(one) == self.ends(other) {
                let is_same_way = self.vertex(one) == self.vertex(other);
                let [first, second] = [other, next(other)];
                let [first, second] = if is_same_way {
                    [first, second]
                } else {
                    [second, first]
                };
                groups.unite(one, first);
                groups.unite(next(one), second);
            }
        }
        self.summed(&normals, groups)
    }

    /// Returns the sums of the normals of the groups' triangles.
    fn summed(&self, normals: &[Vec3], mut groups: CornerGroups) -> CornerValues<Vec3> {
        let mut found = CornerValues {
            values: Vec::new(),
            triangles: vec![[0; 3]; self.triangles.len()],
        };
        for (t, corners) in self.triangles.iter().enumerate() {
            let triangle = self.triangle(*corners);
            for i in 0..3 {
                let corner = (3 * t + i) as u32;
                let root = groups.root(corner);
                if root == corner {
                    found.triangles[t][i] = found.values.len() as u32;
                    found.values.push(Vec3::ZERO);
                } else {
                    // Roots come first.
                    let of_root = found.triangles[root as usize / 3][root as usize % 3];
                    found.triangles[t][i] = of_root;
                }
                let [a, b, c] = [0, 1, 2].map(|k| triangle.vertices[(i + k) % 3]);
                let value = &mut found.values[found.triangles[t][i] as usize];
                *value += angle(b - a, c - a) * normals[t];
            }
        }
        found
    }

    /// Returns the vertex of a corner.
    fn vertex(&self, corner: u32) -> u32 {
        self.triangles[corner as usize / 3][corner as usize % 3]
    }

    /// Returns the ends of the side that begins at a corner, the smaller number first.
    fn ends(&self, side: u32) -> [u32; 2] {
        let [a, b] = [side, next(side)].map(|corner| self.vertex(corner));
        [a.min(b), a.max(b)]
    }
}

/// Returns the next corner of the same triangle.
fn next(corner: u32) -> u32 {
    corner - corner % 3 + (corner + 1) % 3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of two triangles per side.
    fn cube() -> Mesh {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let sides = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        Mesh {
            vertices: (0..8).map(corner).collect(),
            triangles: sides
                .iter()
                .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
                .collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn a_cube_keeps_its_edges_below_its_angle_and_loses_them_above() {
        let cube = cube();
        let sharp = cube.creased_normals(30.0);
        for (i, &corners) in cube.triangles.iter().enumerate() {
            let normal = cube.triangle(corners).normal().unwrap();
            for found in sharp.at(i) {
                assert!(found.normalize().abs_diff_eq(normal, 1e-6), "{found}");
            }
        }
        // 4 corners on each of 6 sides.
        assert_eq!(sharp.values.len(), 24);
        let (round, smooth) = (cube.creased_normals(91.0), cube.smooth_normals());
        assert_eq!(round.values.len(), 8);
        for i in 0..cube.triangles.len() {
            for (found, expected) in round.at(i).into_iter().zip(smooth.at(i)) {
                assert!(found.abs_diff_eq(expected, 1e-5), "{found} {expected}");
            }
        }
    }
}
