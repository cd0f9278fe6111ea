//! The arrays that give surfaces their colors.

use std::borrow::Cow;

use crate::config::{Config, Object};
use crate::yaml::{Fault, FieldPath};
use world::material::{ArrayChoice, ArrayTexture, Material};

/// Returns the array that the materials of an object name, if there is one.
///
/// # Errors
/// They name different arrays.
pub(super) fn choice<'a>(
    config: &'a Config,
    object: &Object,
) -> Result<Option<&'a ArrayChoice>, Fault> {
    let mut found: Option<&ArrayChoice> = None;
    for name in &object.material.0 {
        // Unknown materials are reported later.
        let material = config.materials.get(name);
        let Some(choice) = material.and_then(|material| material.color.array_choice()) else {
            continue;
        };
        if found.is_some_and(|found| *found != *choice) {
            let path = FieldPath::default().key("materials").key(name);
            let path = path.key("color").key("array");
            let message = "an object has materials of different arrays";
            return Err(Fault::new(
                path,
                message,
                "expected one array for all of them",
            ));
        }
        found = Some(choice);
    }
    Ok(found)
}

/// Assigns colors to the numbers on all surfaces of materials of arrays; `places` are the indices
/// of the objects in the scene file, and `numbers_of` returns the numbers of an object by its
/// index, from which a texture's range comes.
///
/// # Errors
/// An object with such a material lacks the array.
pub(super) fn prepare<'a>(
    config: &Config,
    places: &[usize],
    numbers_of: impl Fn(usize, &ArrayTexture) -> Option<Cow<'a, [f64]>>,
    materials: &mut [Material],
) -> Result<(), Fault> {
    let transfer = config.film.transfer(config.shading.model);
    for (name, material) in config.materials.keys().zip(materials) {
        let Some(texture) = material.color.array_mut() else {
            continue;
        };
        let mut numbers = Vec::new();
        for (i, object) in config.objects.iter().enumerate() {
            if !object.material.0.contains(name) {
                continue;
            }
            let of_object = numbers_of(i, texture);
            let of_object = of_object.ok_or_else(|| {
                let path = FieldPath::default().key("objects").index(places[i]);
                has_none(object, path, name, &texture.choice)
            })?;
            numbers.extend_from_slice(&of_object);
        }
        texture.prepare(&numbers, transfer);
    }
    Ok(())
}

fn has_none(object: &Object, path: FieldPath, material: &str, choice: &ArrayChoice) -> Fault {
    let message = format!(
        "the material `{material}` has the colors of the array `{}`, which a {} has not",
        choice.name, object.geometry
    );
    Fault::new(
        path.key("material"),
        message,
        "expected a mesh of a VTK file, or spheres or tubes of one or of a table",
    )
}
