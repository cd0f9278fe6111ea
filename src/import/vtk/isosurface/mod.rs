//! Isosurfaces: the points in solid cells at which a point array has a value.
//!
//! Lorensen and Cline, "Marching Cubes: A High Resolution 3D Surface Construction Algorithm"
//! (SIGGRAPH 1987), without its table of cases, so that the cells need not be cubes: the polygons
//! of a cell follow from its faces. On a face, a line leads from the edge before each run of inside
//! corners to the edge after it. Two cells agree on the lines of a shared face, so that the surface
//! has no holes.

mod polygons;
mod polyhedron;
mod gradient;
mod contour;

use std::collections::HashMap;

use glam::Vec3;

use super::super::mesh::Mesh;
use super::super::polygons::Polygons;
use super::super::{FileFault, Result};
use super::IsosurfaceChoice;
use super::budget::Budget;
use super::piece::{Piece, Topology};
use contour::Contour;
use world::material::ArrayChoice;
use world::scene::CornerValues;

/// The isosurfaces of the pieces so far.
pub(super) struct Isosurfaces<'a> {
    choice: &'a IsosurfaceChoice,
    /// The array of the colors.
    array: Option<&'a ArrayChoice>,
    mesh: Mesh,
    /// The directions of descent at the vertices; zero if undefined.
    normals: Vec<Vec3>,
    /// True if all pieces are grids, which have gradients.
    has_normals: bool,
    scalars: CornerValues<f64>,
    /// The polygons in polyhedra, which need not be convex.
    polygons: Polygons,
    /// The least and the greatest number of the array.
    range: [f64; 2],
    /// True for each value that no cell has yet.
    is_empty: Vec<bool>,
}

impl<'a> Isosurfaces<'a> {
    pub(super) fn new(choice: &'a IsosurfaceChoice, array: Option<&'a ArrayChoice>) -> Self {
        Self {
            choice,
            array,
            mesh: Mesh::default(),
            normals: Vec::new(),
            has_normals: true,
            scalars: CornerValues::default(),
            polygons: Polygons::default(),
            range: [f64::INFINITY, f64::NEG_INFINITY],
            is_empty: vec![true; choice.values.len()],
        }
    }

    /// Adds the isosurfaces of a piece.
    ///
    /// # Errors
    /// An array is missing, positions are not finite, cells have unknown types, or there are too
    /// many triangles for the memory.
    pub(super) fn add(&mut self, piece: &Piece, budget: &mut Budget) -> Result<()> {
        budget.take_of::<[f64; 2]>(piece.n_points() + piece.n_cells())?;
        let (_, values) = piece.scalars(&self.choice.array)?;
        let colors = self.array.map(|array| piece.scalars(array)).transpose()?;
        self.has_normals &= matches!(piece.topology, Topology::Grid(_));
        for value in values.iter().filter(|value| value.is_finite()) {
            self.range = [self.range[0].min(*value), self.range[1].max(*value)];
        }
        if self.mesh.vertices.is_empty() {
            self.mesh.origin = piece.origin();
        }
        for (surface, &level) in self.choice.values.iter().enumerate() {
            let n_before = self.mesh.vertices.len();
            let mut contour = Contour {
                piece,
                values: &values,
                level,
                colors: colors.as_ref().map(|(of, values)| (*of, &values[..])),
                vertices: HashMap::new(),
                of_all: self,
                budget,
            };
            contour.add_cells()?;
            self.is_empty[surface] &= self.mesh.vertices.len() == n_before;
        }
        Ok(())
    }

    /// Returns the mesh of all pieces.
    ///
    /// # Errors
    /// The mesh has no triangle.
    pub(super) fn finish(mut self) -> Result<Mesh> {
        let mut mesh = self.mesh;
        if mesh.triangles.is_empty() {
            return Err(nowhere(self.choice, self.range));
        }
        for (value, _) in self
            .choice
            .values
            .iter()
            .zip(self.is_empty)
            .filter(|(_, empty)| *empty)
        {
            mesh.left_out
                .add("isosurfaces whose value no cell has", value);
        }
        self.polygons.triangulate(
            &mesh.vertices,
            &mut mesh.triangles,
            &mut [&mut self.scalars.triangles],
        );
        mesh.scalars = self.array.map(|_| self.scalars);
        mesh.normals = Some(if self.has_normals {
            CornerValues {
                values: self.normals,
                triangles: mesh.triangles.clone(),
            }
        } else {
            mesh.smooth_normals()
        });
        Ok(mesh)
    }
}

/// Creates the fault of values that the array does not reach within any solid cell.
fn nowhere(choice: &IsosurfaceChoice, [low, high]: [f64; 2]) -> FileFault {
    let values: Vec<String> = choice.values.iter().map(f64::to_string).collect();
    let (name, values) = (&choice.array.name, super::super::listed(&values));
    let problem = format!("`{name}` is nowhere {values} in a solid cell");
    let expected = if low < high {
        let [low, high] = [low, high].map(shortest);
        format!("a value between {low} and {high}, in a grid or other cells with a volume")
    } else {
        "cells with a volume, and an array that varies".to_owned()
    };
    FileFault::new(problem, expected)
}

/// Formats a number with as many digits as its type needs, often 32 bits.
fn shortest(number: f64) -> String {
    let single = number as f32;
    if f64::from(single) == number {
        single.to_string()
    } else {
        number.to_string()
    }
}
