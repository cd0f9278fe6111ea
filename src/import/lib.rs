//! Geometry files → checked values.
//!
//! Takes the path of a file; returns a [`Mesh`], [`Spheres`] or [`Tubes`] whose numbers are
//! finite and whose indices are in range, or a [`FileFault`] with the line or the
//! element. To add a mesh format, write its file, its `mod` line
//! and its line in `FORMATS`.

mod fault;
mod left_out;
mod choice;
mod lines;
mod budget;
mod percent;
mod gray_exr;
mod picture;
mod materials;
mod mesh;
mod polygons;
mod creases;
mod parts;
mod obj;
mod ply;
mod table;
mod spheres;
mod tubes;
mod stl;
mod gltf;
mod places;
mod vtk;
mod pieces;
mod series;

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use glam::Vec3;

use base::stop;
use host::files;
use world::material::ArrayChoice;

use budget::Budget;
pub use choice::{IsosurfaceChoice, RadiusChoice};
pub use fault::{FileFault, FileLocation};
pub use left_out::LeftOut;
pub use materials::{Finish, MeshMaterial, MeshOpacity, MeshPicture, picture_bytes};
pub use mesh::Mesh;
pub use parts::MeshPart;
pub use picture::read_picture;
pub use pieces::pieces_of;
pub use places::{InstancePlace, PlaceArrays};
pub use series::{DataSeries, TimeStep, is_series, read_series, time_steps};
pub use spheres::Spheres;
pub use tubes::Tubes;

/// The result of a reader.
pub type Result<T> = std::result::Result<T, FileFault>;

/// An open file to be read.
type GeometryFileReader = BufReader<Stoppable>;

/// A file whose reads fail once the program is asked to end.
#[derive(Debug)]
struct Stoppable(File);

impl Seek for Stoppable {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

impl Stoppable {
    /// Returns the length of the file in bytes.
    fn length(&self) -> io::Result<u64> {
        Ok(self.0.metadata()?.len())
    }
}

impl Read for Stoppable {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        stop::check().map_err(io::Error::other)?;
        self.0.read(bytes)
    }
}

/// A geometry file, and the time step of a file with several.
#[derive(Debug, Clone, Copy)]
pub struct DataFile<'a> {
    /// The file.
    pub path: &'a Path,
    /// The time step, counted from 0; the first by default.
    pub step: Option<usize>,
}

impl DataFile<'_> {
    /// Opens a file that has a single time step.
    fn open(self) -> Result<GeometryFileReader> {
        self.refuse_step()?;
        open(self.path)
    }

    /// Refuses a time step other than 0 of a file that has only one.
    fn refuse_step(self) -> Result<()> {
        match self.step.filter(|step| *step > 0) {
            None => Ok(()),
            Some(step) => {
                let problem = format!("it has no time step {step}");
                let expected = "a file with time steps: one of VTKHDF";
                Err(FileFault::new(problem, expected))
            }
        }
    }
}

impl<'a, P: AsRef<Path> + ?Sized> From<&'a P> for DataFile<'a> {
    fn from(path: &'a P) -> Self {
        let path = path.as_ref();
        Self { path, step: None }
    }
}

/// Upper bound of the memory of a reader, in bytes per byte of a file not in a VTK format. Each
/// corner of a polygon adds a triangle, and takes two bytes in a text file and one in a binary
/// file. A triangle takes twelve bytes; a growing vector takes up to three times that, and a grown
/// one twice. The triangles are copied for normals, for texture coordinates and for colors.
/// Vertices and the rows of tables take less, with 64-bit coordinates until their origin is known:
/// up to 72 bytes for 3 of a binary file, 160 for 6 of a table.
pub const MAX_BYTES_PER_BYTE: u64 = 60;

/// The context of a file for its reader.
#[derive(Debug, Clone, Copy)]
struct Surroundings<'a> {
    /// The folder of the file.
    folder: &'a Path,
    /// Bytes of memory for pictures, if the file's materials are wanted.
    memory: Option<u64>,
}

/// A reader of one format.
type MeshReader = fn(GeometryFileReader, &Surroundings) -> Result<Mesh>;

/// The mesh formats by file extension, in lower case, apart from VTK's.
const FORMATS: &[(&str, MeshReader)] = &[
    ("obj", obj::read),
    ("ply", ply::read),
    ("stl", stl::read),
    ("gltf", gltf::read),
    ("glb", gltf::read),
];

/// The extensions of tables, in lower case.
const TABLES: [&str; 2] = ["csv", "tsv"];

/// A format of other programs that raycost does not read.
#[derive(Debug, Clone, Copy)]
pub struct ForeignFormat {
    /// The name.
    pub name: &'static str,
    /// The extensions of its files, in lower case.
    extensions: &'static [&'static str],
    /// Advice to convert a file to a readable format.
    pub advice: &'static str,
}

/// Advice for the scenes and meshes of modeling programs.
const EXPORT: &str = "export glTF (.glb) or OBJ from the program that wrote it, or from Blender";
/// Advice for the data of simulations.
const PARAVIEW: &str = "open it in ParaView, and save the data as VTK (.vtu, .vtp or .vtm)";
/// Advice for the meshes of simulations.
const MESHIO: &str = "convert it by meshio: `pip install meshio`, `meshio convert FILE FILE.vtu`";
/// Advice for the meshes and points of scanners.
const MESHLAB: &str = "open it in MeshLab or CloudCompare, and export PLY";
/// Advice for volumes.
const VOLUME: &str = "open it in ParaView or 3D Slicer, and save it as VTK (.vti)";

const FOREIGN: &[ForeignFormat] = &[
    ForeignFormat::new("3D Studio", &["3ds"], EXPORT),
    ForeignFormat::new("3MF", &["3mf"], EXPORT),
    ForeignFormat::new("Alembic", &["abc"], EXPORT),
    ForeignFormat::new("Blender", &["blend"], EXPORT),
    ForeignFormat::new("Cinema 4D", &["c4d"], EXPORT),
    ForeignFormat::new("COLLADA", &["dae"], EXPORT),
    ForeignFormat::new("FBX", &["fbx"], EXPORT),
    ForeignFormat::new("IGES", &["iges", "igs"], EXPORT),
    ForeignFormat::new("Maya", &["ma", "mb"], EXPORT),
    ForeignFormat::new("3ds Max", &["max"], EXPORT),
    ForeignFormat::new("SketchUp", &["skp"], EXPORT),
    ForeignFormat::new("STEP", &["step", "stp"], EXPORT),
    ForeignFormat::new("USD", &["usd", "usda", "usdc", "usdz"], EXPORT),
    ForeignFormat::new("X3D", &["x3d"], EXPORT),
    ForeignFormat::new("Abaqus", &["inp"], MESHIO),
    ForeignFormat::new("Gmsh", &["msh"], MESHIO),
    ForeignFormat::new("Nastran", &["bdf", "nas"], MESHIO),
    ForeignFormat::new("CGNS", &["cgns"], PARAVIEW),
    ForeignFormat::new("EnSight", &["case", "encas"], PARAVIEW),
    ForeignFormat::new("Exodus", &["e", "ex2", "exo", "exii"], PARAVIEW),
    ForeignFormat::new("OpenFOAM", &["foam"], PARAVIEW),
    ForeignFormat::new("XDMF", &["xdmf", "xmf"], PARAVIEW),
    ForeignFormat::new("LAS", &["las", "laz"], MESHLAB),
    ForeignFormat::new("OFF", &["off"], MESHLAB),
    ForeignFormat::new("PCD", &["pcd"], MESHLAB),
    ForeignFormat::new("DICOM", &["dcm"], VOLUME),
    ForeignFormat::new("MetaImage", &["mha", "mhd"], VOLUME),
    ForeignFormat::new("NIfTI", &["nii"], VOLUME),
    ForeignFormat::new("NRRD", &["nhdr", "nrrd"], VOLUME),
    ForeignFormat::new("gzip", &["gz"], "unpack it by `gunzip`"),
    ForeignFormat::new("ZIP", &["zip"], "unpack it by `unzip`"),
];

impl ForeignFormat {
    const fn new(
        name: &'static str,
        extensions: &'static [&'static str],
        advice: &'static str,
    ) -> Self {
        Self {
            name,
            extensions,
            advice,
        }
    }

    /// Returns the format of a file, by its extension.
    pub fn of(path: &Path) -> Option<&'static Self> {
        let extension = extension(path);
        let mut known = FOREIGN.iter();
        known.find(|format| format.extensions.contains(&&*extension))
    }
}

/// Returns true if the file's extension belongs to a table.
pub fn is_table(path: &Path) -> bool {
    TABLES.contains(&&*extension(path))
}

/// Returns true if a table has a column of lines.
///
/// # Errors
/// The file cannot be read, or is damaged.
pub fn has_lines(path: &Path) -> Result<bool> {
    let found = open(path).and_then(|file| table::has_column(file, tubes::LINE));
    found.map_err(|fault| fault.in_file(path))
}

/// Returns true if a path names geometry: a mesh, a table or a series of them.
pub fn is_geometry(path: &Path) -> bool {
    is_mesh(path) || is_table(path) || series::is_list(path)
}

/// Returns true if the file's extension belongs to a mesh format.
pub fn is_mesh(path: &Path) -> bool {
    let extension = extension(path);
    extensions().any(|known| known == extension)
}

/// Returns the extensions of all mesh formats.
fn extensions() -> impl Iterator<Item = &'static str> {
    let own = FORMATS.iter().map(|(known, _)| *known);
    own.chain(vtk::EXTENSIONS)
}

/// Reads a triangle mesh; the file's extension determines the format. For a VTK file, reads the
/// surface.
///
/// # Errors
/// The file cannot be read, has an unknown format, is damaged, or has no triangle.
pub fn read_mesh(path: &Path) -> Result<Mesh> {
    read_mesh_with(path, None)
}

/// Reads a triangle mesh with the numbers of an array.
///
/// # Errors
/// As [`read_mesh`], or the file lacks the array.
pub fn read_mesh_with<'a>(
    file: impl Into<DataFile<'a>>,
    array: Option<&ArrayChoice>,
) -> Result<Mesh> {
    let file = file.into();
    with_triangles(read_any_mesh(file, array, None), file.path)
}

/// Reads a triangle mesh with the materials of its file; a file that has only vertex colors gets a
/// matte material with these. The pictures take at most `available` bytes of memory.
///
/// # Errors
/// As [`read_mesh`], or materials or pictures are missing or damaged.
pub fn read_mesh_with_materials<'a>(file: impl Into<DataFile<'a>>, available: u64) -> Result<Mesh> {
    let file = file.into();
    let mut mesh = with_triangles(read_any_mesh(file, None, Some(available)), file.path)?;
    if mesh.materials.is_empty() && mesh.colors.is_some() {
        mesh.material_of = vec![0; mesh.triangles.len()];
        mesh.materials.push(MeshMaterial {
            has_vertex_colors: true,
            ..MeshMaterial::new("vertex colors", Vec3::ONE)
        });
    }
    Ok(mesh)
}

/// Refuses a mesh without triangles.
fn with_triangles(read: Result<Mesh>, path: &Path) -> Result<Mesh> {
    let read = read.and_then(|mut mesh| {
        mesh.notes.extend(mesh.left_out.note());
        if mesh.triangles.is_empty() {
            let problem = ["no triangle in the file"].into_iter();
            let problem: Vec<&str> = problem
                .chain(mesh.notes.iter().map(String::as_str))
                .collect();
            let expected = if is_vtk(path) {
                "faces of cells; points are for `spheres`, lines for `tubes`"
            } else {
                "faces"
            };
            Err(FileFault::new(problem.join("; "), expected))
        } else {
            Ok(mesh)
        }
    });
    read.map_err(|fault| fault.in_file(path))
}

/// Reads a mesh, and its materials if there is `memory` for their pictures.
fn read_any_mesh(file: DataFile, array: Option<&ArrayChoice>, memory: Option<u64>) -> Result<Mesh> {
    let path = file.path;
    if is_vtk(path) {
        return vtk::read_mesh(file, array);
    }
    file.refuse_step()?;
    let extension = extension(path);
    let known = FORMATS.iter().find(|(known, _)| *known == extension);
    let (_, read) = known.ok_or_else(|| unknown_format(path))?;
    if let Some(array) = array {
        return Err(without_arrays(array));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    read(open(path)?, &Surroundings { folder, memory })
}

/// Creates the fault of a file that is not a VTK file, and whose array is wanted.
fn without_arrays(array: &ArrayChoice) -> FileFault {
    let problem = format!("it cannot have an array `{}`", array.name);
    let expected = "a VTK file, such as one that ends in .vtp or .vtu";
    FileFault::new(problem, expected)
}

/// Reads isosurfaces of an array of a VTK file, with the numbers of another array.
///
/// # Errors
/// The file cannot be read, is damaged, lacks the array, or no cell contains the array's values.
pub fn read_isosurface<'a>(
    file: impl Into<DataFile<'a>>,
    choice: &IsosurfaceChoice,
    array: Option<&ArrayChoice>,
) -> Result<Mesh> {
    let file = file.into();
    let read = if is_vtk(file.path) {
        vtk::read_isosurface(file, choice, array)
    } else {
        let expected = "a VTK file, such as one that ends in .vti or .vtu";
        Err(FileFault::new(
            "it has no arrays for an isosurface",
            expected,
        ))
    };
    read.map_err(|fault| fault.in_file(file.path))
}

/// Reads a list of spheres from a table of comma-separated values, with the numbers of a column.
/// `radius` is the radius of all spheres if the table has no column `r`, or another column.
///
/// # Errors
/// The file cannot be read, is damaged, or lacks a radius, the column or any sphere.
pub fn read_spheres<'a>(
    file: impl Into<DataFile<'a>>,
    radius: Option<&RadiusChoice>,
    array: Option<&ArrayChoice>,
) -> Result<Spheres> {
    let file = file.into();
    let read = file
        .open()
        .and_then(|table| spheres::read(table, radius, array));
    read.map_err(|fault| fault.in_file(file.path))
}

/// Reads the points of a VTK file as spheres, with the numbers of an array, or the vertices of
/// another mesh, with their colors.
///
/// # Errors
/// The file cannot be read, is damaged, or lacks the array or any point.
pub fn read_points<'a>(
    file: impl Into<DataFile<'a>>,
    radius: &RadiusChoice,
    array: Option<&ArrayChoice>,
) -> Result<Spheres> {
    let file = file.into();
    let read = if is_vtk(file.path) {
        vtk::read_spheres(file, radius, array)
    } else {
        read_vertices(file, radius, array)
    };
    let read = read.and_then(|spheres| {
        if spheres.spheres.is_empty() {
            Err(FileFault::new(
                "no point in the file",
                "a point for each sphere",
            ))
        } else {
            Ok(spheres)
        }
    });
    read.map_err(|fault| fault.in_file(file.path))
}

/// Reads the vertices of a mesh that is not a VTK file as spheres.
fn read_vertices(
    file: DataFile,
    radius: &RadiusChoice,
    array: Option<&ArrayChoice>,
) -> Result<Spheres> {
    let mesh = read_any_mesh(file, array, None)?;
    match radius {
        RadiusChoice::Same(radius) => Ok(Spheres::at_vertices(mesh, *radius)),
        RadiusChoice::Array { array, .. } => Err(without_arrays(array)),
    }
}

/// Reads tubes from a table of comma-separated values, with the numbers of a column. `radius` is
/// the radius of all tubes if the table has no column `r`, or another column.
///
/// # Errors
/// The file cannot be read, is damaged, or lacks a radius, the column or any line.
pub fn read_tubes<'a>(
    file: impl Into<DataFile<'a>>,
    radius: Option<&RadiusChoice>,
    array: Option<&ArrayChoice>,
) -> Result<Tubes> {
    let file = file.into();
    let read = file
        .open()
        .and_then(|table| tubes::read(table, radius, array));
    read.map_err(|fault| fault.in_file(file.path))
}

/// Reads the lines of a VTK file as tubes, with the numbers of an array.
///
/// # Errors
/// The file cannot be read, is damaged, or lacks the array or any line.
pub fn read_lines<'a>(
    file: impl Into<DataFile<'a>>,
    radius: &RadiusChoice,
    array: Option<&ArrayChoice>,
) -> Result<Tubes> {
    let file = file.into();
    vtk::read_tubes(file, radius, array).map_err(|fault| fault.in_file(file.path))
}

/// Reads the placements of instances: from a table of comma-separated values, which has no arrays,
/// or from the points of a VTK file, except for points whose scale is 0 or missing.
///
/// # Errors
/// The file cannot be read, is damaged, or lacks the array or any placement.
pub fn read_places(path: &Path, arrays: PlaceArrays) -> Result<Vec<InstancePlace>> {
    let read = if is_vtk(path) {
        vtk::read_places(path.into(), arrays).and_then(places::usable)
    } else {
        let table = arrays.none().and_then(|()| open(path));
        table.and_then(places::read)
    };
    read.map_err(|fault| fault.in_file(path))
}

/// Returns true if the file's extension is one of VTK's, or of ParaView's lists of such files.
pub fn is_vtk(path: &Path) -> bool {
    vtk::is_collection(path) || vtk::EXTENSIONS.contains(&extension(path).as_str())
}

/// Returns an upper bound of the memory needed to read a geometry file, whatever it contains, in
/// bytes. The arrays of a VTK file, which may be compressed, are excluded: their memory is checked
/// as they are read.
///
/// # Errors
/// The path is not a regular file, or its metadata cannot be read.
pub fn max_bytes(path: &Path) -> Result<u64> {
    let per_byte = if is_vtk(path) { 1 } else { MAX_BYTES_PER_BYTE };
    let length = length_of(path).map_err(|fault| fault.in_file(path))?;
    Ok(length.saturating_mul(per_byte))
}

/// Returns the length of a regular file in bytes.
fn length_of(path: &Path) -> Result<u64> {
    let metadata = path.metadata()?;
    if metadata.is_file() {
        Ok(metadata.len())
    } else {
        Err(FileFault::new("it is not a file", "a file"))
    }
}

fn open(path: &Path) -> Result<GeometryFileReader> {
    let mut file = Stoppable(files::open(path)?);
    let mut start = Vec::new();
    let length = files::GIT_LFS.len() as u64;
    file.by_ref().take(length).read_to_end(&mut start)?;
    if start == files::GIT_LFS {
        let problem = "it is a pointer of Git LFS, not the file itself";
        return Err(FileFault::new(
            problem,
            "the file that `git lfs pull` fetches",
        ));
    }
    file.seek(SeekFrom::Start(0))?;
    Ok(BufReader::with_capacity(1 << 18, file))
}

/// Returns all bytes of a file that has not been read yet, if the budget has room for them.
fn read_whole(file: GeometryFileReader, budget: &mut Budget) -> Result<Vec<u8>> {
    let file = file.into_inner();
    let length = file.length()?;
    budget.take(length)?;
    let mut bytes = Vec::with_capacity(length as usize);
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Returns the file name's extension in lower case; empty for none.
fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

/// Formats a list such as "a, b or c".
fn listed(words: &[String]) -> String {
    match words.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => words.concat(),
    }
}

fn unknown_format(path: &Path) -> FileFault {
    let extension = extension(path);
    let known: Vec<String> = extensions().map(|known| format!(".{known}")).collect();
    let problem = match (&*extension, ForeignFormat::of(path)) {
        ("", _) => "its name has no extension".to_owned(),
        (_, Some(ForeignFormat { name, advice, .. })) => {
            format!("raycost does not read {name} files; {advice}")
        }
        _ => format!("unknown mesh format `.{extension}`"),
    };
    FileFault::new(problem, format!("a file that ends in {}", listed(&known)))
}
