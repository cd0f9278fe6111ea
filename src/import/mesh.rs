//! Triangle meshes.

use glam::Vec3;

use super::{FileFault, Result};
use crate::geometry::Triangle;

/// The triangle mesh of a file. Its triangles may be degenerate.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Positions, finite.
    pub vertices: Vec<Vec3>,
    /// Three indices of `vertices` each, counter-clockwise as seen from
    /// outside.
    pub triangles: Vec<[u32; 3]>,
    /// The normals at the corners, if the file has any.
    pub normals: Option<Normals>,
}

/// A normal for each corner of each triangle of a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Normals {
    /// Directions, finite, of any length.
    pub vectors: Vec<Vec3>,
    /// Three indices of `vectors` for each triangle of the mesh.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The triangle of these vertices.
    pub fn triangle(&self, indices: [u32; 3]) -> Triangle {
        Triangle {
            vertices: indices.map(|vertex| self.vertices[vertex as usize]),
        }
    }

    /// Its memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        let of_arrays = |vectors: &[Vec3], triangles: &[[u32; 3]]| {
            (size_of_val(vectors) + size_of_val(triangles)) as u64
        };
        let normals = self.normals.as_ref();
        of_arrays(&self.vertices, &self.triangles)
            + normals.map_or(0, |normals| of_arrays(&normals.vectors, &normals.triangles))
    }

    /// Normals that vary smoothly over the surface: at each vertex the sum of
    /// its triangles' normals, weighted by their angles there, so that
    /// the triangulation of a face does not show (Thürmer and Wüthrich, "Computing Vertex
    /// Normals from Polygonal Facets", Journal of Graphics Tools 3(1), 1998).
    pub fn smooth_normals(&self) -> Normals {
        let mut vectors = vec![Vec3::ZERO; self.vertices.len()];
        for &indices in &self.triangles {
            let triangle = self.triangle(indices);
            let normal = triangle.normal().unwrap_or_default();
            for (i, vertex) in indices.into_iter().enumerate() {
                let [a, b, c] = [0, 1, 2].map(|k| triangle.vertices[(i + k) % 3]);
                vectors[vertex as usize] += angle(b - a, c - a) * normal;
            }
        }
        Normals {
            vectors,
            triangles: self.triangles.clone(),
        }
    }
}

/// The angle between two vectors, in radians.
fn angle(a: Vec3, b: Vec3) -> f32 {
    // libm's arc cosine returns the same bits on every machine.
    libm::acosf(
        a.normalize_or_zero()
            .dot(b.normalize_or_zero())
            .clamp(-1.0, 1.0),
    )
}

/// Makes a vector of three numbers.
///
/// # Errors
/// A number that is not finite.
pub(super) fn finite(numbers: [f32; 3]) -> Result<Vec3> {
    let bad = numbers.iter().find(|number| !number.is_finite());
    match bad {
        None => Ok(numbers.into()),
        Some(number) => Err(FileFault::new(
            format!("a coordinate is {number}"),
            "finite numbers",
        )),
    }
}

/// Converts a number of vertices or normals.
///
/// # Errors
/// More than indices of 32 bits can distinguish.
pub(super) fn count(n: usize) -> Result<u32> {
    u32::try_from(n).map_err(|_| FileFault::new("too many vertices", "at most 4294967295"))
}

/// Triangulates a polygon: a fan of triangles that share its first corner.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let pairs = corners.windows(2).skip(1);
    pairs.map(|pair| [corners[0], pair[0], pair[1]])
}
