//! A part of a data set: points, cells and their arrays.

use glam::{DVec3, Vec3};

use super::super::fault::cut;
use super::super::mesh::{self, light, limited};
use super::super::{FileFault, Result, listed};
use super::cells::Cells;
use super::numbers::Numbers;
use host::text::did_you_mean;
use world::geometry::origin_near;
use world::material::{ArrayChoice, ArrayOf};

/// A part of a data set.
#[derive(Debug)]
pub(super) struct Piece {
    pub(super) points: PointPositions,
    pub(super) topology: Topology,
    pub(super) point_data: PieceArrays,
    pub(super) cell_data: PieceArrays,
}

/// The positions of points.
#[derive(Debug)]
pub(super) enum PointPositions {
    /// One triple of coordinates per point.
    Explicit(Numbers),
    /// The coordinates along each axis.
    Axes([Numbers; 3]),
    Lattice(Lattice),
}

/// The points of an image.
#[derive(Debug)]
pub(super) struct Lattice {
    /// Points along each axis.
    pub(super) size: [usize; 3],
    /// The index of the first point along each axis.
    pub(super) first: [i64; 3],
    pub(super) origin: [f64; 3],
    pub(super) spacing: [f64; 3],
    /// The rows of the matrix that rotates the axes.
    pub(super) direction: [f64; 9],
}

/// The cells that the points form.
#[derive(Debug)]
pub(super) enum Topology {
    Cells(Cells),
    /// A grid with these numbers of points along each axis, x first.
    Grid([usize; 3]),
}

/// The arrays of the points or of the cells.
#[derive(Debug, Default)]
pub(super) struct PieceArrays {
    /// The names of all arrays.
    pub(super) names: Vec<String>,
    /// The arrays that were read, with their names.
    pub(super) arrays: Vec<(String, Numbers)>,
    /// The name of the array of normals.
    pub(super) normals: Option<String>,
    /// The name of the array of texture coordinates.
    pub(super) uvs: Option<String>,
}

/// The names that VTK and ParaView give to arrays of normals, of texture coordinates and of ghost
/// types.
const NORMALS: &str = "Normals";
const UVS: [&str; 3] = ["TCoords", "Texture Coordinates", "TextureCoordinates"];
pub(super) const GHOSTS: &str = "vtkGhostType";
/// The bit of a hidden point's ghost type.
const HIDDEN_POINT: u8 = 2;

/// The arrays to read, besides those that every mesh needs.
pub(super) type Wanted<'a> = [&'a str];

/// Returns true if an array is to be read.
pub(super) fn is_wanted(name: &str, wanted: &Wanted) -> bool {
    let own = [NORMALS, GHOSTS].into_iter().chain(UVS);
    own.chain(wanted.iter().copied()).any(|known| known == name)
}

impl PieceArrays {
    /// Returns the array of this name if it was read.
    pub(super) fn get(&self, name: &str) -> Option<&Numbers> {
        let found = self.arrays.iter().find(|(known, _)| known == name);
        found.map(|(_, numbers)| numbers)
    }

    /// Checks the lengths of all arrays.
    ///
    /// # Errors
    /// An array has more or fewer tuples.
    pub(super) fn check(&self, n_tuples: usize) -> Result<()> {
        let mut arrays = self.arrays.iter();
        arrays.try_for_each(|(name, numbers)| numbers.check(&cut(name), n_tuples))
    }

    /// Returns the normals, if there are any.
    pub(super) fn normals(&self) -> Option<&Numbers> {
        let named = self.normals.as_deref().and_then(|name| self.get(name));
        named
            .or_else(|| self.get(NORMALS))
            .filter(|numbers| numbers.n_components == 3)
    }

    /// Returns the texture coordinates, if there are any: two or three numbers each.
    pub(super) fn uvs(&self) -> Option<&Numbers> {
        let named = self.uvs.as_deref().and_then(|name| self.get(name));
        named
            .or_else(|| UVS.iter().find_map(|name| self.get(name)))
            .filter(|numbers| (2..=3).contains(&numbers.n_components))
    }
}

impl Piece {
    /// Returns the number of points.
    pub(super) fn n_points(&self) -> usize {
        match &self.topology {
            Topology::Grid(size) => size.iter().product(),
            Topology::Cells(cells) => cells.n_points,
        }
    }

    /// Returns the number of cells.
    pub(super) fn n_cells(&self) -> usize {
        match &self.topology {
            Topology::Grid(size) => size.iter().map(|n| (n - 1).max(1)).product(),
            Topology::Cells(cells) => cells.len(),
        }
    }

    /// Checks the lengths of all arrays.
    ///
    /// # Errors
    /// An array has more or fewer tuples than there are points or cells.
    pub(super) fn check(&self) -> Result<()> {
        if let PointPositions::Explicit(points) = &self.points {
            points.check("Points", self.n_points())?;
        }
        self.point_data.check(self.n_points())?;
        self.cell_data.check(self.n_cells())
    }

    /// Returns the position of a point.
    ///
    /// # Errors
    /// A coordinate is not finite.
    pub(super) fn position(&self, point: usize) -> Result<DVec3> {
        let position = match &self.points {
            PointPositions::Explicit(points) => points.triple(point),
            PointPositions::Axes(axes) => {
                let at = grid_index(axes.each_ref().map(Numbers::len), point);
                [0, 1, 2].map(|axis| axes[axis].at(at[axis]))
            }
            PointPositions::Lattice(lattice) => lattice.position(point),
        };
        mesh::point(position)
    }

    /// Returns true if any of these points of a cell is hidden, and with it the cell.
    pub(super) fn has_hidden(&self, points: &[u32]) -> bool {
        let is_hidden =
            |ghosts: &Numbers, point: &u32| ghosts.at(*point as usize) as u8 & HIDDEN_POINT != 0;
        let ghosts = self.point_data.get(GHOSTS);
        ghosts.is_some_and(|ghosts| points.iter().any(|point| is_hidden(ghosts, point)))
    }

    /// Returns the origin for the coordinates of the points.
    pub(super) fn origin(&self) -> DVec3 {
        origin_near((0..self.n_points()).filter_map(|point| self.position(point).ok()))
    }

    /// Returns the numbers of an array, one per point or cell: a component, or by default the
    /// magnitude of vectors.
    ///
    /// # Errors
    /// The array or the component is missing.
    pub(super) fn scalars(&self, choice: &ArrayChoice) -> Result<(ArrayOf, Vec<f64>)> {
        let (of, numbers) = self.chosen(choice)?;
        let n = numbers.n_components;
        let tuples = (0..numbers.len()).step_by(n);
        let magnitude = |first: usize| {
            let squares = (first..first + n).map(|i| numbers.at(i) * numbers.at(i));
            limited(squares.sum::<f64>().sqrt())
        };
        Ok(match choice.component {
            None if n == 1 => (of, numbers.iter().map(limited).collect()),
            None => (of, tuples.map(magnitude).collect()),
            Some(component) if component < n => (
                of,
                tuples.map(|i| limited(numbers.at(i + component))).collect(),
            ),
            Some(component) => {
                let problem = format!("`{}` has no component {component}", cut(&choice.name));
                let expected = format!("one of its {n}, of which the first is 0");
                return Err(FileFault::new(problem, expected));
            }
        })
    }

    /// Returns the colors of an array, one per point or cell: linear light.
    ///
    /// # Errors
    /// The array is missing, or its tuples are not colors.
    pub(super) fn colors(&self, choice: &ArrayChoice) -> Result<(ArrayOf, Vec<Vec3>)> {
        let (of, numbers) = self.chosen(choice)?;
        let n = numbers.n_components;
        if n < 3 {
            let problem = format!("the values of `{}` are not colors", cut(&choice.name));
            return Err(FileFault::new(
                problem,
                "three or four numbers: red, green and blue",
            ));
        }
        // Text files may also store them as whole numbers.
        let is_bytes = numbers.are_whole() || numbers.iter().any(|number| number > 1.0);
        let largest = if is_bytes { 255.0 } else { 1.0 };
        let tuples = (0..numbers.len()).step_by(n);
        let color = |i: usize| light([0, 1, 2].map(|k| (numbers.at(i + k) / largest) as f32));
        Ok((of, tuples.map(color).collect::<Result<_>>()?))
    }

    /// Returns the array of a choice.
    pub(super) fn chosen(&self, choice: &ArrayChoice) -> Result<(ArrayOf, &Numbers)> {
        let of_points = self.point_data.get(&choice.name);
        let of_points = of_points.map(|numbers| (ArrayOf::Points, numbers));
        let of_cells = self.cell_data.get(&choice.name);
        let of_cells = of_cells.map(|numbers| (ArrayOf::Cells, numbers));
        let found = match choice.of {
            None => of_points.or(of_cells),
            Some(ArrayOf::Points) => of_points,
            Some(ArrayOf::Cells) => of_cells,
        };
        found.ok_or_else(|| self.unknown(choice))
    }

    /// Returns the names of the arrays that may give colors, point arrays first, without the arrays
    /// that VTK and ParaView add for internal use.
    pub(super) fn color_arrays(&self) -> Vec<String> {
        let own = |of: &PieceArrays, name: &String| {
            let active = [&of.normals, &of.uvs].contains(&&Some(name.clone()));
            let is_known = is_wanted(name, &[]) || name.starts_with("vtk");
            active || is_known || name.ends_with("Ids") || name.is_empty()
        };
        let of_one = |of: &PieceArrays| {
            let names = of.names.iter().filter(|name| !own(of, name));
            names.cloned().collect::<Vec<_>>()
        };
        [of_one(&self.point_data), of_one(&self.cell_data)].concat()
    }

    fn unknown(&self, choice: &ArrayChoice) -> FileFault {
        let lists = match choice.of {
            None => vec![&self.point_data.names, &self.cell_data.names],
            Some(ArrayOf::Points) => vec![&self.point_data.names],
            Some(ArrayOf::Cells) => vec![&self.cell_data.names],
        };
        let known: Vec<&str> = lists.into_iter().flatten().map(String::as_str).collect();
        let of = choice.of.map_or("", |of| match of {
            ArrayOf::Points => " of points",
            ArrayOf::Cells => " of cells",
        });
        let mut problem = format!("it has no array{of} `{}`", cut(&choice.name));
        if let Some(suggestion) = did_you_mean(&choice.name, known.iter().copied()) {
            problem += &format!(", {suggestion}");
        }
        let names = known
            .iter()
            .take(MAX_LISTED)
            .map(|name| format!("`{}`", cut(name)));
        let expected = match known.len() {
            0 => "a file with arrays".to_owned(),
            _ => format!(
                "one of its arrays, such as {}",
                listed(&names.collect::<Vec<_>>())
            ),
        };
        FileFault::new(problem, expected)
    }
}

/// Maximum number of names of arrays in a message.
const MAX_LISTED: usize = 8;

impl Lattice {
    fn position(&self, point: usize) -> [f64; 3] {
        let at = grid_index(self.size, point);
        let along = [0, 1, 2].map(|i| self.spacing[i] * (self.first[i] + at[i] as i64) as f64);
        let (rows, _) = self.direction.as_chunks::<3>();
        [0, 1, 2].map(|i| {
            let row = rows[i];
            self.origin[i] + row[0] * along[0] + row[1] * along[1] + row[2] * along[2]
        })
    }
}

/// Returns the indices along the axes of a point of a grid.
pub(super) fn grid_index([nx, ny, _]: [usize; 3], point: usize) -> [usize; 3] {
    [point % nx, point / nx % ny, point / nx / ny]
}

/// Returns the number of points of a grid along each axis, given the first and the last index.
///
/// # Errors
/// There are none, or more than 32 bits can number.
pub(super) fn grid_size(extent: [i64; 6]) -> Result<[usize; 3]> {
    let n = |axis: usize| {
        let n = extent[2 * axis + 1]
            .checked_sub(extent[2 * axis])?
            .checked_add(1)?;
        u32::try_from(n).ok().filter(|n| *n > 0)
    };
    let sides = [n(0), n(1), n(2)];
    let product = sides
        .iter()
        .try_fold(1_u32, |product, side| product.checked_mul((*side)?));
    if let ([Some(nx), Some(ny), Some(nz)], Some(_)) = (sides, product) {
        return Ok([nx, ny, nz].map(|n| n as usize));
    }
    let problem = format!("a grid extends over {extent:?}");
    Err(FileFault::new(problem, "1 to 4294967295 points"))
}
