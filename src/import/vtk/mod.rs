//! Files of VTK data sets: XML files, their lists of pieces and blocks, and legacy files.
//!
//! A file is read whole, but only the wanted arrays are decoded. Memory is taken from a budget
//! before it is allocated.

mod numbers;
mod document;
mod collection;
mod polyhedra;
mod cells;
mod piece;
mod array_of_pieces;
mod surface;
mod legacy;
mod xml;
mod hdf;
mod mesh;
mod points;
mod places;
mod lines;
mod isosurface;

use std::path::Path;

use super::budget::{self, Budget};
use super::choice::{IsosurfaceChoice, RadiusChoice};
use super::mesh::Mesh;
use super::places::{InstancePlace, PlaceArrays};
use super::spheres::Spheres;
use super::tubes::Tubes;
use super::{DataFile, FileFault, Result, extension, max_bytes, open, read_whole};
use array_of_pieces::ArrayOfPieces;
pub(super) use collection::{ListedStep, read as read_collection};
pub(super) use hdf::{is_hdf, read_times};
use piece::{Piece, Wanted};
use world::material::ArrayChoice;
use xml::Contents;

/// The extensions of VTK files, in lower case.
pub(super) const EXTENSIONS: [&str; 13] = [
    "vtp",
    "vtu",
    "vts",
    "vtr",
    "vti",
    "vtk",
    "pvtp",
    "pvtu",
    "pvts",
    "pvtr",
    "pvti",
    "vtm",
    hdf::EXTENSION,
];

/// Returns true if a file lists files over time.
pub(super) fn is_collection(path: &Path) -> bool {
    extension(path) == "pvd"
}

/// Reads the surface of a data set, with the numbers of an array.
pub(super) fn read_mesh(file: DataFile, array: Option<&ArrayChoice>) -> Result<Mesh> {
    let mut mesh = mesh::Pieces::new(array);
    let wanted: Vec<&str> = array.iter().map(|array| array.name.as_str()).collect();
    for_each_piece(file, &wanted, &mut |piece, budget| mesh.add(piece, budget))?;
    mesh.finish()
}

/// Reads the isosurfaces of an array of a data set, with the numbers of another array.
pub(super) fn read_isosurface(
    file: DataFile,
    choice: &IsosurfaceChoice,
    array: Option<&ArrayChoice>,
) -> Result<Mesh> {
    refuse_colors(array, "an isosurface")?;
    let mut surfaces = isosurface::Isosurfaces::new(choice, array);
    let wanted = array.into_iter().chain([&choice.array]);
    let wanted: Vec<&str> = wanted.map(|array| array.name.as_str()).collect();
    for_each_piece(file, &wanted, &mut |piece, budget| {
        surfaces.add(piece, budget)
    })?;
    surfaces.finish()
}

/// Reads the points of a data set as spheres, with the numbers of an array.
pub(super) fn read_spheres(
    file: DataFile,
    radius: &RadiusChoice,
    array: Option<&ArrayChoice>,
) -> Result<Spheres> {
    let wanted = wanted_arrays(radius, array);
    let mut spheres = Spheres {
        scalars: array.filter(|array| !array.is_color).map(|_| Vec::new()),
        colors: array.filter(|array| array.is_color).map(|_| Vec::new()),
        ..Spheres::default()
    };
    let mut numbers = ArrayOfPieces::default();
    for_each_piece(file, &wanted, &mut |piece, budget| {
        if spheres.arrays.is_empty() {
            spheres.arrays = piece.color_arrays();
        }
        points::add(piece, radius, (array, &mut numbers), &mut spheres, budget)
    })?;
    spheres.notes.extend(numbers.check()?);
    Ok(spheres)
}

/// Reads the points of a data set as placements of instances.
pub(super) fn read_places(file: DataFile, arrays: PlaceArrays) -> Result<Vec<InstancePlace>> {
    let of_arrays = arrays.color.into_iter().chain(arrays.scale);
    let names = of_arrays.map(|array| array.name.as_str());
    let wanted: Vec<&str> = names.chain(arrays.orient).collect();
    let mut found = Vec::new();
    for_each_piece(file, &wanted, &mut |piece, budget| {
        places::add(piece, arrays, &mut found, budget)
    })?;
    Ok(found)
}

/// Reads the lines of a data set as tubes, with the numbers of an array.
pub(super) fn read_tubes(
    file: DataFile,
    radius: &RadiusChoice,
    array: Option<&ArrayChoice>,
) -> Result<Tubes> {
    refuse_colors(array, "tubes")?;
    let mut tubes = Tubes::with_scalars(array.is_some());
    let mut numbers = ArrayOfPieces::default();
    for_each_piece(file, &wanted_arrays(radius, array), &mut |piece, budget| {
        lines::add(piece, radius, (array, &mut numbers), &mut tubes, budget)
    })?;
    numbers.check()?;
    tubes.at_least_one()
}

/// Refuses an array of colors for shapes that take only numbers.
fn refuse_colors(array: Option<&ArrayChoice>, shapes: &str) -> Result<()> {
    match array.filter(|array| array.is_color) {
        None => Ok(()),
        Some(_) => {
            let problem = format!("{shapes} cannot have the colors of an array");
            Err(FileFault::new(
                problem,
                "an array of numbers with a color map",
            ))
        }
    }
}

/// Returns the names of the arrays of radii and of colors.
fn wanted_arrays<'a>(radius: &'a RadiusChoice, array: Option<&'a ArrayChoice>) -> Vec<&'a str> {
    let of_radius = match radius {
        RadiusChoice::Same(_) => None,
        RadiusChoice::Array { array, .. } => Some(array),
    };
    let wanted = array.into_iter().chain(of_radius);
    wanted.map(|array| array.name.as_str()).collect()
}

/// The function called with each piece of a data set.
type Visit<'a> = dyn FnMut(&Piece, &mut Budget) -> Result<()> + 'a;

/// Reads a data set piece by piece.
fn for_each_piece(file: DataFile, wanted: &Wanted, visit: &mut Visit) -> Result<()> {
    let budget = &mut Budget::new();
    let path = file.path;
    let step = file.step.unwrap_or(0);
    if is_hdf(path) {
        let pieces = hdf::read(path, step, wanted, budget)?;
        return pieces.iter().try_for_each(|piece| visit(piece, budget));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    if is_collection(path) {
        let mut steps = read_collection(&read_whole(open(path)?, budget)?)?;
        if step >= steps.len() {
            let problem = format!("it has no time step {step}");
            return Err(FileFault::new(
                problem,
                format!("less than its {}", steps.len()),
            ));
        }
        let parts = steps.swap_remove(step).files;
        return parts.iter().try_for_each(|part| {
            let path = folder.join(part);
            let read = for_each_piece_of(&path, wanted, budget, visit);
            read.map_err(|fault| fault.in_file(&path))
        });
    }
    file.refuse_step()?;
    for_each_piece_of(path, wanted, budget, visit)
}

/// Reads a file, or the files of its pieces.
fn for_each_piece_of(
    path: &Path,
    wanted: &Wanted,
    budget: &mut Budget,
    visit: &mut Visit,
) -> Result<()> {
    let files = match read_file(path, wanted, budget)? {
        Contents::Pieces(pieces) => {
            return pieces.iter().try_for_each(|piece| visit(piece, budget));
        }
        Contents::Files(files) => files,
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    for file in files {
        let path = folder.join(file);
        let read = match read_file(&path, wanted, budget) {
            Ok(Contents::Pieces(pieces)) => {
                pieces.iter().try_for_each(|piece| visit(piece, budget))
            }
            Ok(Contents::Files(_)) => {
                let expected = "pieces that have their data themselves";
                Err(FileFault::new(
                    "it is a piece, and consists of pieces",
                    expected,
                ))
            }
            Err(fault) => Err(fault),
        };
        read.map_err(|fault| fault.in_file(&path))?;
    }
    Ok(())
}

fn read_file(path: &Path, wanted: &Wanted, budget: &mut Budget) -> Result<Contents> {
    // A piece may be named like a device, which never ends.
    max_bytes(path)?;
    let bytes = read_whole(open(path)?, budget)?;
    if bytes.starts_with(legacy::SIGNATURE) {
        let piece = legacy::read(&bytes, wanted, budget)?;
        return Ok(Contents::Pieces(vec![piece]));
    }
    let start = bytes.trim_ascii_start();
    if start.starts_with(b"<") || start.starts_with(b"\xef\xbb\xbf<") {
        return xml::read(&bytes, wanted, budget);
    }
    let problem = format!(
        "it is not a VTK file, although its name ends in `.{}`",
        extension(path)
    );
    Err(FileFault::new(
        problem,
        "`# vtk DataFile Version` or `<VTKFile` at the start of the file",
    ))
}
