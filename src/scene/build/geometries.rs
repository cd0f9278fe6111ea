//! The geometries of all objects and the pictures of all materials, with the contents of
//! their files.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use glam::DAffine3;

use super::arrays;
use super::own_materials::{self, Names};
use super::pictures::Pictures;
use crate::config::{
    Config, Creases, Generator, Geometry, GeometryFile, InstancePlaces, InstancedMesh, MeshFile,
    MeshNormals, Object, at_value,
};
use crate::yaml::{Fault, FieldPath, Folders};
use base::numbers::memory_sizes;
use import::{DataFile, DataSeries, FileFault, InstancePlace, Mesh, Spheres, Tubes};
use world::geometry::{Located, Shape, Transform, TransformStep, world_from_object};
use world::light::Light;
use world::material::{ArrayChoice, ArrayTexture};
use world::scene::CornerValues;

/// The geometries of the objects of a config, and the pictures of its materials.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometries {
    pub(super) objects: Vec<ObjectGeometry>,
    pub(super) pictures: Pictures,
    /// The index of each object in the scene file.
    pub(super) places: Vec<usize>,
    /// Bytes of memory of the pictures of mesh files' materials.
    own_picture_bytes: u64,
    /// Warnings about ambiguous or ignored content of files.
    pub(super) notes: Vec<String>,
}

/// The geometry of one object.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ObjectGeometry {
    Shape(Located<Shape>),
    Generator(Generator),
    Mesh(Box<Mesh>),
    Spheres(Spheres),
    Tubes(Tubes),
    Instances(Box<MeshInstances>),
}

/// A mesh with the places of its instances.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeshInstances {
    pub(super) mesh: Mesh,
    /// The maps from the coordinates of the mesh to the object's, one per instance: at least one.
    pub(super) places: Arc<[DAffine3]>,
    /// The number of an array for each instance, if one was read; NaN for missing ones.
    pub(super) scalars: Option<Arc<[f64]>>,
}

impl ObjectGeometry {
    /// Returns true if the whole geometry has texture coordinates.
    pub(super) fn has_uvs(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.uvs.is_some(),
            Self::Instances(placed) => placed.mesh.uvs.is_some(),
            Self::Shape(_) | Self::Generator(_) | Self::Spheres(_) | Self::Tubes(_) => false,
        }
    }

    /// Returns true if all of its vertices or spheres have colors.
    pub(super) fn has_vertex_colors(&self) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.colors.is_some(),
            Self::Instances(placed) => placed.mesh.colors.is_some(),
            Self::Spheres(spheres) => spheres.colors.is_some(),
            Self::Shape(_) | Self::Generator(_) | Self::Tubes(_) => false,
        }
    }

    /// Returns the notes on its file.
    fn notes(&self) -> &[String] {
        match self {
            Self::Mesh(mesh) => &mesh.notes,
            Self::Instances(placed) => &placed.mesh.notes,
            Self::Spheres(spheres) => &spheres.notes,
            Self::Shape(_) | Self::Generator(_) | Self::Tubes(_) => &[],
        }
    }

    /// Returns the memory of the contents of its files in bytes.
    fn n_bytes(&self) -> u64 {
        match self {
            Self::Shape(_) | Self::Generator(_) => 0,
            Self::Mesh(mesh) => mesh.n_bytes(),
            Self::Spheres(spheres) => spheres.n_bytes(),
            Self::Tubes(tubes) => tubes.n_bytes(),
            Self::Instances(placed) => {
                placed.mesh.n_bytes() + size_of_val(&placed.places[..]) as u64
            }
        }
    }

    /// Returns the numbers of an array if one was read.
    pub(super) fn scalars(&self) -> Option<&[f64]> {
        match self {
            Self::Mesh(mesh) => mesh.scalars.as_ref().map(|scalars| &scalars.values[..]),
            Self::Instances(placed) => match &placed.scalars {
                Some(scalars) => Some(scalars),
                None => placed.mesh.scalars.as_ref().map(|of| &of.values[..]),
            },
            Self::Spheres(spheres) => spheres.scalars.as_deref(),
            Self::Tubes(tubes) => tubes.scalars.as_ref().map(|scalars| scalars.as_flattened()),
            Self::Shape(_) | Self::Generator(_) => None,
        }
    }

    /// Returns the numbers of an array that a texture's range comes from: those of the surface,
    /// and the ends of the whole data set for its range; `None` if no array was read.
    pub(super) fn numbers_for(&self, texture: &ArrayTexture) -> Option<Cow<'_, [f64]>> {
        let numbers = self.scalars()?;
        match self {
            Self::Mesh(mesh) if texture.spans_data() && !mesh.scalar_ends.is_empty() => {
                Some([numbers, &mesh.scalar_ends].concat().into())
            }
            _ => Some(numbers.into()),
        }
    }
}

impl Geometries {
    /// Reads the geometries and the pictures of a config, with file paths relative to their
    /// `folders`, using at most `available` bytes of memory. In the config, a mesh without a
    /// material becomes one object per material and node of its file, and adds the lights of its file.
    ///
    /// # Errors
    /// The first file that cannot be read, is damaged, or may need more memory.
    pub fn read<F: Folders + ?Sized>(
        config: &mut Config,
        folders: &F,
        available: u64,
    ) -> Result<Self, Fault> {
        let mut found = Self {
            objects: Vec::with_capacity(config.objects.len()),
            pictures: Pictures::read(config, folders, available)?,
            places: Vec::new(),
            own_picture_bytes: 0,
            notes: Vec::new(),
        };
        let mut available = available.saturating_sub(found.pictures.n_bytes());
        for (index, object) in config.objects.iter().enumerate() {
            let geometry = match &object.geometry {
                Geometry::Shape(shape) => ObjectGeometry::Shape(shape.shape()),
                Geometry::Generator(generator) => ObjectGeometry::Generator(generator.clone()),
                Geometry::Tube(tube) => ObjectGeometry::Tubes(tube.tubes().clone()),
                Geometry::File(file) => {
                    let path = FieldPath::default().key("objects").index(index);
                    let path = path.key(file.to_string()).key("file");
                    let folder = folders.folder_of(&path);
                    let array = arrays::choice(config, object)?;
                    let extra = Extra::new(object, array, available);
                    read_checked(file, folder, extra, available, &path)?
                }
                Geometry::Instances(instances) => {
                    let path = FieldPath::default().key("objects").index(index);
                    let path = path.key(InstancedMesh::KEY);
                    let array = arrays::choice(config, object)?;
                    let extra = Extra::new(object, array, available);
                    read_instances(instances, folders, extra, available, &path)?
                }
            };
            available = available.saturating_sub(geometry.n_bytes());
            found.objects.push(geometry);
        }
        Ok(found.in_parts(config))
    }

    /// Splits each mesh with its own materials into one object per material and node, here and in
    /// the config.
    fn in_parts(self, config: &mut Config) -> Self {
        let mut found = Self {
            objects: Vec::with_capacity(self.objects.len()),
            places: Vec::with_capacity(self.objects.len()),
            ..self
        };
        let mut names = Names::new(config);
        let objects = std::mem::take(&mut config.objects);
        for (place, (object, geometry)) in objects.into_iter().zip(self.objects).enumerate() {
            found.add_notes(&object.geometry, geometry.notes());
            let parts = match geometry {
                ObjectGeometry::Mesh(mesh) if object.material.0.is_empty() => {
                    found.own_picture_bytes += import::picture_bytes(&mesh.materials);
                    config.lights.extend(own_lights(&object, &mesh));
                    let parts = own_materials::parts(config, &mut names, object, *mesh).into_iter();
                    parts
                        .map(|(part, mesh)| (part, ObjectGeometry::Mesh(Box::new(mesh))))
                        .collect()
                }
                ObjectGeometry::Instances(placed) if object.material.0.is_empty() => {
                    found.own_picture_bytes += import::picture_bytes(&placed.mesh.materials);
                    let MeshInstances {
                        mesh,
                        places,
                        scalars,
                    } = *placed;
                    let parts = own_materials::parts(config, &mut names, object, mesh).into_iter();
                    let instances = |mesh| MeshInstances {
                        mesh,
                        places: Arc::clone(&places),
                        scalars: scalars.clone(),
                    };
                    parts
                        .map(|(part, mesh)| {
                            (part, ObjectGeometry::Instances(Box::new(instances(mesh))))
                        })
                        .collect()
                }
                geometry => vec![(object, geometry)],
            };
            for (part, geometry) in parts {
                config.objects.push(part);
                found.objects.push(geometry);
                found.places.push(place);
            }
        }
        found
    }

    /// Adds the notes on the file of a geometry, each of which is said once.
    fn add_notes(&mut self, geometry: &Geometry, notes: &[String]) {
        let file = own_materials::file_word(geometry);
        for note in notes {
            let note = format!("{file}: {note}");
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }

    /// Returns an upper bound of the number of primitives, including one per instance.
    pub fn n_primitives(&self) -> usize {
        let of_object = |geometry: &ObjectGeometry| match geometry {
            ObjectGeometry::Shape(_) => 1,
            ObjectGeometry::Generator(generator) => generator.n_spheres(),
            ObjectGeometry::Mesh(mesh) => mesh.triangles.len(),
            ObjectGeometry::Spheres(spheres) => spheres.spheres.len(),
            ObjectGeometry::Tubes(tubes) => tubes.capsules().len(),
            ObjectGeometry::Instances(placed) => placed.mesh.triangles.len() + placed.places.len(),
        };
        self.objects.iter().map(of_object).sum()
    }

    /// Returns the number of spheres and capsules of objects of many that a stretching transform
    /// turns into shapes with a transform each.
    pub fn n_stretched(&self, config: &Config) -> usize {
        let stretches = |step: &TransformStep| match step {
            TransformStep::Scale(by) => by.abs().min_element() != by.abs().max_element(),
            TransformStep::Translate(_) | TransformStep::Rotate(_) => false,
        };
        let is_stretched = |steps: &[TransformStep]| steps.iter().any(stretches);
        let of_object = |(geometry, object): (&ObjectGeometry, &Object)| match geometry {
            _ if !is_stretched(&object.transform) => 0,
            ObjectGeometry::Generator(generator) => generator.n_spheres(),
            ObjectGeometry::Spheres(spheres) => spheres.spheres.len(),
            ObjectGeometry::Tubes(tubes) => tubes.capsules().len(),
            _ => 0,
        };
        self.objects
            .iter()
            .zip(&config.objects)
            .map(of_object)
            .sum()
    }

    /// Returns the number of instances.
    pub fn n_instances(&self) -> usize {
        let of_object = |geometry: &ObjectGeometry| match geometry {
            ObjectGeometry::Instances(placed) => placed.places.len(),
            _ => 0,
        };
        self.objects.iter().map(of_object).sum()
    }

    /// Returns the memory of the pictures in bytes.
    pub fn picture_bytes(&self) -> u64 {
        self.pictures.n_bytes() + self.own_picture_bytes
    }

    /// Returns the memory of the contents of the files in bytes, without the pictures.
    pub fn n_bytes(&self) -> u64 {
        self.objects.iter().map(ObjectGeometry::n_bytes).sum()
    }
}

/// Returns the lights of an object's file, in world space.
fn own_lights(object: &Object, mesh: &Mesh) -> Vec<Light> {
    let factor = match &object.geometry {
        Geometry::File(GeometryFile::Mesh(file)) => file.lights,
        _ => 0.0,
    };
    if factor == 0.0 {
        return Vec::new();
    }
    let world_from_object = world_from_object(&object.transform);
    let lights = mesh.lights.iter();
    let placed = lights.filter_map(|light| light.placed(&world_from_object, factor));
    placed.collect()
}

/// Data read from a file besides shapes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Extra<'a> {
    /// The numbers of an array, if one is given.
    Array(Option<&'a ArrayChoice>),
    /// The materials, whose pictures take at most this memory in bytes.
    Materials(u64),
}

impl<'a> Extra<'a> {
    /// Returns the data that an object needs whose materials name this array, or none.
    pub(super) fn new(object: &Object, array: Option<&'a ArrayChoice>, available: u64) -> Self {
        if object.material.0.is_empty() {
            Self::Materials(available)
        } else {
            Self::Array(array)
        }
    }

    /// Returns the array.
    fn array(self) -> Option<&'a ArrayChoice> {
        match self {
            Self::Array(array) => array,
            Self::Materials(_) => None,
        }
    }
}

/// Reads a file that fits into memory; of a series the first one. `path` leads to the value that
/// names the file.
pub(super) fn read_checked(
    file: &GeometryFile,
    folder: &Path,
    extra: Extra,
    available: u64,
    path: &FieldPath,
) -> Result<ObjectGeometry, Fault> {
    let of_series;
    let chosen = DataFile {
        path: &folder.join(file.file()),
        ..file.data_file()
    };
    let file = if import::is_series(chosen) {
        let series = import::read_series(folder, file.file());
        let DataSeries(steps) = series.map_err(at_value(path))?;
        of_series = file.at(&steps[0]);
        &of_series
    } else {
        file
    };
    check_size(&folder.join(file.file()), available, path)?;
    read(file, folder, extra).map_err(at_value(path))
}

/// Reads the mesh of instances and their places; `path` leads to the instances.
fn read_instances<F: Folders + ?Sized>(
    instances: &InstancedMesh,
    folders: &F,
    extra: Extra,
    available: u64,
    path: &FieldPath,
) -> Result<ObjectGeometry, Fault> {
    let of_mesh = path.clone().key("mesh").key("file");
    let file = folders.folder_of(&of_mesh).join(&instances.mesh.file);
    refuse_series(&file, &of_mesh)?;
    check_size(&file, available, &of_mesh)?;
    let of_points = instances.points_file().is_some_and(import::is_vtk);
    let mesh_extra = match extra {
        // The array belongs to the points.
        Extra::Array(_) if of_points => Extra::Array(None),
        extra => extra,
    };
    let mesh = read_mesh(&instances.mesh, &file, mesh_extra);
    let mut mesh = mesh.map_err(at_value(&of_mesh))?;
    let available = available.saturating_sub(mesh.n_bytes());
    let (places, scalars) = read_places(
        instances,
        folders,
        extra.array().filter(|_| of_points),
        available,
        path,
    )?;
    if scalars.is_some() {
        // Each triangle has the number of its instance.
        mesh.scalars = Some(CornerValues {
            values: vec![f64::NAN],
            triangles: vec![[0; 3]; mesh.triangles.len()],
        });
    }
    Ok(ObjectGeometry::Instances(Box::new(MeshInstances {
        mesh,
        places,
        scalars,
    })))
}

/// The places of instances, and the numbers of an array for them, if there is one.
type PlacesAndScalars = (Arc<[DAffine3]>, Option<Arc<[f64]>>);

/// Reads the places of instances; `path` leads to the instances.
fn read_places<F: Folders + ?Sized>(
    instances: &InstancedMesh,
    folders: &F,
    array: Option<&ArrayChoice>,
    available: u64,
    path: &FieldPath,
) -> Result<PlacesAndScalars, Fault> {
    match &instances.places {
        InstancePlaces::Listed(all) => {
            let of_place = |(i, steps): (usize, &Vec<_>)| {
                let place = world_from_object(steps);
                Transform::new(&place).map(|_| place).ok_or_else(|| {
                    let path = path.clone().key("places").index(i);
                    let message = "the place of this instance has no inverse";
                    Fault::new(path, message, "expected `scale` factors other than 0")
                })
            };
            let places: Result<Vec<_>, Fault> = all.iter().enumerate().map(of_place).collect();
            Ok((places?.into(), None))
        }
        InstancePlaces::Cloud(cloud) => {
            let n = cloud.count as usize;
            check_room(n as u64 * size_of::<DAffine3>() as u64, available, path)?;
            Ok(((0..n).map(|i| cloud.place(i)).collect(), None))
        }
        InstancePlaces::Points(points) => {
            let path = path.clone().key("points").key("file");
            let file = folders.folder_of(&path).join(&points.file);
            refuse_series(&file, &path)?;
            if array.is_some_and(|array| array.is_color) {
                let message = "instances have no colors of points";
                let expected = "expected a material with `color: { array: … }`";
                return Err(Fault::new(path, message, expected));
            }
            check_size(&file, available, &path)?;
            let read = points.read(&file, array);
            let read = read.map_err(at_value(&path))?;
            let scalars = array.map(|_| read.iter().map(|place| place.scalar).collect());
            Ok((read.iter().map(InstancePlace::matrix).collect(), scalars))
        }
    }
}

/// Refuses a series of files, one per time step.
fn refuse_series(file: &Path, path: &FieldPath) -> Result<(), Fault> {
    if !import::is_series(file) {
        return Ok(());
    }
    let message = "instances cannot have a file for each time step";
    Err(Fault::new(
        path.clone(),
        message,
        "expected one file for all",
    ))
}

/// Returns an error if this many places do not fit into memory.
fn check_room(needed: u64, available: u64, path: &FieldPath) -> Result<(), Fault> {
    if needed <= available {
        return Ok(());
    }
    let path = path.clone().key("cloud").key("count");
    let message = "the places of the instances do not fit into memory";
    Err(Fault::new(path, message, "expected a smaller number"))
}

/// Returns an error if the file may not fit into memory, whatever it contains.
fn check_size(file: &Path, available: u64, path: &FieldPath) -> Result<(), Fault> {
    let needed = import::max_bytes(file).map_err(at_value(path))?;
    if needed <= available {
        return Ok(());
    }
    let [needed, free] = memory_sizes([needed, available]);
    let message = format!(
        "`{}` is too large: up to {needed} of memory are needed to read it, {free} are free",
        file.display(),
    );
    Err(Fault::new(path.clone(), message, "expected a smaller file"))
}

fn read(file: &GeometryFile, folder: &Path, extra: Extra) -> import::Result<ObjectGeometry> {
    let path = folder.join(file.file());
    match file {
        GeometryFile::Mesh(file) => {
            let mesh = read_mesh(file, &path, extra)?;
            Ok(ObjectGeometry::Mesh(Box::new(mesh)))
        }
        GeometryFile::Spheres(file) => {
            let spheres = file.read(&path, extra.array());
            spheres.map(ObjectGeometry::Spheres)
        }
        GeometryFile::Tubes(file) => file.read(&path, extra.array()).map(ObjectGeometry::Tubes),
    }
}

fn read_mesh(file: &MeshFile, path: &Path, extra: Extra) -> import::Result<Mesh> {
    let mut mesh = match (&file.isosurface, extra) {
        (Some(isosurface), Extra::Array(array)) => {
            import::read_isosurface(file.data_file(path), &isosurface.choice(), array)?
        }
        (Some(_), Extra::Materials(_)) => return Err(FileFault::without_materials(path)),
        (None, Extra::Array(array)) => import::read_mesh_with(file.data_file(path), array)?,
        (None, Extra::Materials(available)) => {
            let mesh = import::read_mesh_with_materials(file.data_file(path), available)?;
            if mesh.materials.is_empty() {
                return Err(FileFault::without_materials(path));
            }
            mesh
        }
    };
    match file.normals {
        MeshNormals::File => {}
        MeshNormals::Smooth(creases) => {
            mesh.normals = None;
            mesh.normals = Some(match creases {
                None => mesh.smooth_normals(),
                Some(Creases { angle_deg }) => mesh.creased_normals(angle_deg),
            });
        }
        MeshNormals::Flat => mesh.normals = None,
    }
    Ok(mesh)
}
