//! Config → [`Scene`]: everything placed in render space, ids instead of names.
//!
//! Takes a checked [`Config`] and its [`Geometries`]; returns the tracer's input, or a [`Fault`] if
//! two parts of the file contradict each other: an undefined material, a transform without an
//! inverse.

mod check;
mod pictures;
mod arrays;
mod mesh_material;
mod own_materials;
mod geometries;
mod needs;
mod space;
mod placement;
mod lower_level;
mod timeline;
mod sensor;

use crate::config::{Config, Geometry, GeometryFile, Object};
use crate::yaml::{Fault, FieldPath};
use host::text::did_you_mean;
use world::geometry::RenderSpace;
use world::material::{ArrayTexture, Material};
use world::scene::{LowerLevel, MaterialId, ObjectId, Scene};
use world::shading::ShadingModel;

use geometries::ObjectGeometry;
use lower_level::{add_instances, check_emission};
use needs::Needs;
use placement::Placement;

pub use geometries::Geometries;
pub use sensor::Sensor;
pub use timeline::{SceneFrame, Timeline};

/// Creates the scene of a config and the geometries of its objects.
///
/// # Errors
/// The first value of the file that contradicts others.
pub fn scene(config: &Config, geometries: Geometries) -> Result<Scene, Fault> {
    let space = space::render_space(config, &geometries);
    scene_in_space(config, geometries, space)
}

/// Creates the same scene in another render space.
///
/// # Errors
/// The first value of the file that contradicts others.
pub fn scene_in_space(
    config: &Config,
    geometries: Geometries,
    space: RenderSpace,
) -> Result<Scene, Fault> {
    check::settings(config)?;
    let mut scene = without_objects(config, &geometries, space)?;
    let lower_level = place_objects(&mut scene, config, geometries)?;
    // The instances, the fog and the lights need all primitives.
    if scene.scatters_paths() {
        check_emission(&lower_level, config)?;
    }
    scene.add_lower_level(lower_level);
    if let Some(fog) = &config.fog {
        let eye = Sensor::new(&scene, config).plane.eye;
        scene.add_fog(fog, eye);
    }
    scene.add_lights(&config.lights);
    Ok(scene)
}

/// Returns the scene with its settings and materials, but neither objects nor lights.
fn without_objects(
    config: &Config,
    geometries: &Geometries,
    space: RenderSpace,
) -> Result<Scene, Fault> {
    let is_path = config.shading.model == ShadingModel::Path;
    let masking = is_path.then_some(config.shading.masking);
    let materials = config.materials.values().cloned();
    let mut scene = Scene::new(
        space,
        config.shading.in_space(&space),
        materials
            .map(|material| material.in_scene(&space, masking))
            .collect(),
        geometries.pictures.background(config),
    );
    scene.notes = geometries.notes.clone();
    scene.reserve(geometries.n_primitives());
    complete_materials(&mut scene.materials, config, geometries)?;
    Ok(scene)
}

/// Gives the materials their pictures and the colors of arrays.
fn complete_materials(
    materials: &mut [Material],
    config: &Config,
    geometries: &Geometries,
) -> Result<(), Fault> {
    for (name, material) in config.materials.keys().zip(&mut *materials) {
        geometries.pictures.give_to(name, material);
    }
    let numbers_of =
        |object: usize, texture: &ArrayTexture| geometries.objects[object].numbers_for(texture);
    arrays::prepare(config, &geometries.places, numbers_of, materials)
}

/// Adds the primitives of all objects; returns the lower level, with the instanced meshes.
fn place_objects(
    scene: &mut Scene,
    config: &Config,
    geometries: Geometries,
) -> Result<LowerLevel, Fault> {
    let space = scene.space;
    let mut lower_level = LowerLevel::default();
    let objects = config.objects.iter().zip(geometries.objects);
    for (index, (object, geometry)) in objects.enumerate() {
        let path = FieldPath::default()
            .key("objects")
            .index(geometries.places[index]);
        let materials = material_ids(config, object, &path)?;
        let needs = Needs::find(config, object, &geometry, &path)?;
        let id = ObjectId(index as u32);
        let placement = Placement::new(
            object,
            id,
            &materials,
            &scene.materials,
            needs,
            &path,
            &space,
        );
        if let ObjectGeometry::Instances(placed) = geometry {
            let added = add_instances(
                &mut lower_level,
                &placement,
                *placed,
                &mut scene.n_degenerate,
            )?;
            let (first, attributes) = added;
            scene.end_instanced_object(first, attributes);
            continue;
        }
        let attributes =
            placement.add_geometry(geometry, &mut scene.primitives, &mut scene.n_degenerate)?;
        scene.end_object(attributes);
    }
    Ok(lower_level)
}

fn material_ids(
    config: &Config,
    object: &Object,
    path: &FieldPath,
) -> Result<Vec<MaterialId>, Fault> {
    let names = &object.material.0;
    if names.is_empty() {
        let message = format!("the {} has no material", object.geometry);
        return Err(Fault::new(path.clone(), message, "expected a `material`"));
    }
    let path = path.clone().key("material");
    let takes_many = matches!(
        object.geometry,
        Geometry::Generator(_) | Geometry::File(GeometryFile::Spheres(_))
    );
    if names.len() > 1 && !takes_many {
        let message = format!(
            "a {} has one material, not {}",
            object.geometry,
            names.len()
        );
        return Err(Fault::new(path, message, "expected one name")
            .with_help("a list of names is for generators, which deal them out"));
    }
    let id_of = |(i, name): (usize, &String)| match config.materials.get_index_of(name) {
        Some(id) => Ok(MaterialId(id as u32)),
        None => Err(unknown_material(config, name, path.clone().index(i))),
    };
    names.iter().enumerate().map(id_of).collect()
}

fn unknown_material(config: &Config, name: &str, path: FieldPath) -> Fault {
    let known: Vec<&str> = config.materials.keys().map(String::as_str).collect();
    let list = if known.is_empty() {
        "there are no `materials`".to_owned()
    } else {
        format!("the materials are {}", known.join(", "))
    };
    let help = match did_you_mean(name, known) {
        Some(suggestion) => format!("{suggestion} ({list})"),
        None => list,
    };
    Fault::new(
        path,
        format!("unknown material `{name}`"),
        "expected a key of `materials`",
    )
    .with_help(help)
}
