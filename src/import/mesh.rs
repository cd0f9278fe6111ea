//! Triangle meshes.

use glam::{DVec3, Vec2, Vec3};

use super::left_out::LeftOut;
use super::materials::{MeshMaterial, picture_bytes};
use super::{FileFault, FileLocation, Result};
use world::color::Transfer;
use world::geometry::{Aabb, Triangle, origin_near};
use world::light::Light;
use world::scene::CornerValues;

/// Maximum number of nodes of a file that are separate objects.
const MAX_NODES: usize = 4096;

/// Maximum number of characters of a node's name.
const MAX_NODE_NAME: usize = 100;

/// The triangle mesh of a file. Triangles may be degenerate.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// The point in object space that is the origin of all coordinates.
    pub origin: DVec3,
    /// Positions, finite.
    pub vertices: Vec<Vec3>,
    /// Three indices of `vertices` per triangle, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The normals at the corners, if the file has any: directions, finite, of any
    /// length.
    pub normals: Option<CornerValues<Vec3>>,
    /// The texture coordinates at the corners, if the file has them for all triangles: finite; (0,
    /// 0) is the lower left corner of a picture, (1, 1) the upper right one.
    pub uvs: Option<CornerValues<Vec2>>,
    /// The numbers of an array at the corners, if one was read; NaN for missing ones.
    pub scalars: Option<CornerValues<f64>>,
    /// The least, the least positive and the greatest number of the array in the whole data set,
    /// with points and cells that are not on the surface; empty if there is none.
    pub scalar_ends: Vec<f64>,
    /// The colors at the corners, if the file has them for all vertices: linear light, from
    /// 0 to 1.
    pub colors: Option<CornerValues<Vec3>>,
    /// The opacities at the corners, from 0 to 1, if the file has any below 1.
    pub opacities: Option<CornerValues<f32>>,
    /// The names of the arrays of the file that may give colors, point arrays first.
    pub arrays: Vec<String>,
    /// The materials of the file, if they were read and there are any.
    pub materials: Vec<MeshMaterial>,
    /// The index of the material of each triangle, if there are materials.
    pub material_of: Vec<u32>,
    /// The names of the nodes of a glTF file or of the objects of an OBJ file, after an empty one for
    /// the nodes without a name, if they were read and there are any.
    pub nodes: Vec<String>,
    /// The index of the node of each triangle, if there are nodes.
    pub node_of: Vec<u32>,
    /// Sentences about what the file may have meant otherwise, or what is left out of it.
    pub notes: Vec<String>,
    /// The parts of the file that its reader leaves out.
    pub left_out: LeftOut,
    /// The lights of the file, if its materials were read.
    pub lights: Vec<Light>,
}

impl Mesh {
    /// Returns the triangle of these vertices.
    pub fn triangle(&self, indices: [u32; 3]) -> Triangle {
        Triangle {
            vertices: indices.map(|vertex| self.vertices[vertex as usize]),
        }
    }

    /// Returns the smallest box around all vertices, relative to its origin.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.vertices.iter().copied())
    }

    /// Returns the memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        let own = size_of_val(&self.vertices[..]) + size_of_val(&self.triangles[..]);
        let normals = self.normals.as_ref().map_or(0, CornerValues::n_bytes);
        let scalars = self.scalars.as_ref().map_or(0, CornerValues::n_bytes);
        let uvs = self.uvs.as_ref().map_or(0, CornerValues::n_bytes);
        let colors = self.colors.as_ref().map_or(0, CornerValues::n_bytes);
        let opacities = self.opacities.as_ref().map_or(0, CornerValues::n_bytes);
        let parts = size_of_val(&self.material_of[..]) + size_of_val(&self.node_of[..]);
        let materials = parts as u64 + picture_bytes(&self.materials);
        own as u64 + normals + uvs + scalars + colors + opacities + materials
    }

    /// Stores the names of the nodes of a file, shortened, and the number of each triangle's one,
    /// from 1, or 0 for none; a note takes the place of too many.
    pub(super) fn take_nodes<'a>(
        &mut self,
        names: impl ExactSizeIterator<Item = &'a str>,
        node_of: Vec<u32>,
    ) {
        let n = names.len();
        if n > MAX_NODES {
            let note =
                format!("its {n} objects are counted as one: at most {MAX_NODES} are kept apart");
            self.notes.push(note);
        } else if n > 0 {
            let short = |name: &str| name.chars().take(MAX_NODE_NAME).collect();
            self.nodes = std::iter::once("").chain(names).map(short).collect();
            self.node_of = node_of;
        }
    }

    /// Stores the vertices of a file relative to an origin near them, and leaves out triangles with
    /// a vertex that is not finite.
    pub(super) fn take_vertices(&mut self, vertices: Vec<DVec3>) {
        let finite = vertices
            .iter()
            .filter(|vertex| vertex.as_vec3().is_finite());
        self.origin = origin_near(finite.copied());
        let near = vertices
            .iter()
            .map(|vertex| (vertex - self.origin).as_vec3());
        self.vertices = near.collect();
        if !self.triangles.is_empty() && !self.vertices.iter().all(|vertex| vertex.is_finite()) {
            self.leave_out_unusable();
        }
    }

    /// Takes their area from the triangles with a vertex that is not finite, and gives all such
    /// vertices the place of another one.
    fn leave_out_unusable(&mut self) {
        let is_usable = |vertex: &Vec3| vertex.is_finite();
        let usable = self.vertices.iter().position(is_usable).unwrap_or(0);
        for (i, triangle) in self.triangles.iter_mut().enumerate() {
            let corners = triangle.map(|corner| self.vertices[corner as usize]);
            if !corners.iter().all(is_usable) {
                let place = FileLocation::Element("triangle".to_owned(), i as u64);
                self.left_out
                    .add("triangles with a corner that is not finite", place);
                *triangle = [usable as u32; 3];
            }
        }
        let place = Some(self.vertices[usable]).filter(is_usable);
        for vertex in self.vertices.iter_mut().filter(|vertex| !is_usable(vertex)) {
            *vertex = place.unwrap_or_default();
        }
    }

    /// Stores the normals of a file. If only some triangles have normals, the others get their
    /// geometric normal; if none has any, none are stored.
    pub(super) fn take_normals(&mut self, mut normals: CornerValues<Vec3>) {
        let CornerValues { values, triangles } = &mut normals;
        if triangles.is_empty() {
            return;
        }
        triangles.resize(self.triangles.len(), MISSING);
        for (normals, vertices) in triangles.iter_mut().zip(&self.triangles) {
            if *normals == MISSING {
                *normals = [values.len() as u32; 3];
                values.push(self.triangle(*vertices).normal().unwrap_or_default());
            }
        }
        self.normals = Some(normals);
    }

    /// Returns normals that vary smoothly over the surface: at each vertex the sum of its
    /// triangles' normals, weighted by their angles there, so that the triangulation of a face does
    /// not show (Thürmer and Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal of
    /// Graphics Tools 3(1), 1998).
    pub fn smooth_normals(&self) -> CornerValues<Vec3> {
        let mut values = vec![Vec3::ZERO; self.vertices.len()];
        for &indices in &self.triangles {
            let triangle = self.triangle(indices);
            let normal = triangle.normal().unwrap_or_default();
            for (i, vertex) in indices.into_iter().enumerate() {
                let [a, b, c] = [0, 1, 2].map(|k| triangle.vertices[(i + k) % 3]);
                values[vertex as usize] += angle(b - a, c - a) * normal;
            }
        }
        CornerValues {
            values,
            triangles: self.triangles.clone(),
        }
    }
}

/// Returns the angle between two vectors, in radians.
pub(super) fn angle(a: Vec3, b: Vec3) -> f32 {
    // libm's arc cosine returns the same bits on every machine.
    libm::acosf(
        a.normalize_or_zero()
            .dot(b.normalize_or_zero())
            .clamp(-1.0, 1.0),
    )
}

/// Placeholder indices for a triangle without values.
pub(super) const MISSING: [u32; 3] = [u32::MAX; 3];

/// Returns triangles whose vertices follow `n` others.
pub(super) fn moved(triangles: &[[u32; 3]], n: u32) -> impl Iterator<Item = [u32; 3]> {
    triangles
        .iter()
        .map(move |corners| corners.map(|corner| n + corner))
}

/// Converts numbers to a vector.
///
/// # Errors
/// A number is not finite.
pub(super) fn finite<const N: usize, T: From<[f32; N]>>(numbers: [f32; N]) -> Result<T> {
    let bad = numbers.iter().find(|number| !number.is_finite());
    match bad {
        None => Ok(numbers.into()),
        Some(number) => Err(FileFault::new(
            format!("a coordinate is {number}"),
            "finite numbers",
        )),
    }
}

/// Returns a number of an array, infinite beyond the range of 32 bits: such numbers stand for missing
/// ones.
pub(super) fn limited(number: f64) -> f64 {
    if number.abs() > f32::MAX.into() {
        f64::INFINITY.copysign(number)
    } else {
        number
    }
}

/// Converts coordinates to a point within the range of 32 bits.
///
/// # Errors
/// A coordinate is not finite, or too large.
pub(super) fn point(coordinates: [f64; 3]) -> Result<DVec3> {
    let _: Vec3 = finite(coordinates.map(|coordinate| coordinate as f32))?;
    Ok(coordinates.into())
}

/// Converts a display color to linear light.
///
/// # Errors
/// A number is not from 0 to 1.
pub(super) fn light(numbers: [f32; 3]) -> Result<Vec3> {
    let bad = numbers.iter().find(|number| !(0.0..=1.0).contains(*number));
    match bad {
        None => Ok(Vec3::from(
            numbers.map(|number| Transfer::Srgb.light(number)),
        )),
        Some(number) => Err(FileFault::new(
            format!("a color is {number}"),
            "numbers from 0 to 1",
        )),
    }
}

/// Converts a number of vertices or normals.
///
/// # Errors
/// There are more than 32-bit indices can distinguish.
pub(super) fn count(n: usize) -> Result<u32> {
    u32::try_from(n).map_err(|_| FileFault::new("too many vertices", "at most 4294967295"))
}

/// Triangulates a polygon as a fan of triangles that share its first corner.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let pairs = corners.windows(2).skip(1);
    pairs.map(|pair| [corners[0], pair[0], pair[1]])
}

/// Appends values at the vertices of triangles, after `n_before` others.
///
/// # Errors
/// There are too many values.
pub(super) fn append_corners<T>(
    corners: &mut CornerValues<T>,
    values: Vec<T>,
    triangles: &[[u32; 3]],
    n_before: usize,
) -> Result<()> {
    let first = count(corners.values.len() + values.len())? - values.len() as u32;
    corners.triangles.resize(n_before, MISSING);
    corners.triangles.extend(moved(triangles, first));
    corners.values.extend(values);
    Ok(())
}

/// Completes the values of `n` triangles with a default for those without; `None` if none has
/// any.
pub(super) fn completed<T>(
    mut corners: CornerValues<T>,
    n: usize,
    default: T,
) -> Option<CornerValues<T>> {
    if corners.triangles.is_empty() {
        return None;
    }
    corners.triangles.resize(n, MISSING);
    let n_values = corners.values.len() as u32;
    let missing = (corners.triangles.iter_mut()).filter(|corners| **corners == MISSING);
    missing.for_each(|corners| *corners = [n_values; 3]);
    corners.values.push(default);
    Some(corners)
}
