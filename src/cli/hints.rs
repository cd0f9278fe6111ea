//! Hints of `raycost check`: scenes without a mistake that show nothing.

use std::collections::HashSet;

use output::prediction::{Look, Prediction};
use scene::background::Background;
use scene::config::{Config, ShadingModel};

/// Greatest number of names in a hint.
const MOST_NAMES: usize = 5;

/// Returns one line for each likely mistake; empty if there is none.
pub(super) fn lines(config: &Config, expected: &Prediction) -> String {
    let hints = [of_view(config, expected.look), unused_materials(config)];
    let hints = hints.into_iter().flatten();
    hints.map(|hint| format!("hint    {hint}\n")).collect()
}

/// Returns the problem with the picture as a whole, if any.
fn of_view(config: &Config, look: Look) -> Option<String> {
    let Look {
        has_hit,
        is_black,
        only_object,
    } = look;
    if !has_hit {
        return Some(
            "the camera sees no object: check `eye`, `target` and the places of the objects"
                .to_owned(),
        );
    }
    if !is_black {
        return None;
    }
    if !has_light(config) {
        let remedy = match config.shading.model {
            ShadingModel::Path => "a light, a material with `emission`, or a `background`",
            _ => "a light, or `ambient` light in `shading`",
        };
        return Some(format!(
            "the picture will be black: nothing shines; add {remedy}"
        ));
    }
    if let Some(object) = only_object {
        return Some(format!(
            "the picture will be black, and `objects[{object}]` fills it: the camera may be inside it"
        ));
    }
    let reason = "no light reaches what the camera sees";
    Some(format!(
        "the picture may be black: in a small preview, {reason}"
    ))
}

/// Returns true if anything in the scene shines.
fn has_light(config: &Config) -> bool {
    let emits = config.materials.values().any(|material| material.emits());
    let is_path = config.shading.model == ShadingModel::Path;
    let has_ambient = config.shading.ambient != glam::Vec3::ZERO;
    let has_background = config.background != Background::default();
    !config.lights.is_empty() || has_ambient || emits || is_path && has_background
}

/// Returns the materials that no object has.
fn unused_materials(config: &Config) -> Option<String> {
    let objects = config.objects.iter();
    let used: HashSet<&String> = objects.flat_map(|object| &object.material.0).collect();
    let unused = config.materials.keys().filter(|name| !used.contains(name));
    let unused: Vec<String> = unused.map(|name| format!("`{name}`")).collect();
    let (shown, more) = unused.split_at(unused.len().min(MOST_NAMES));
    let more = match more.len() {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    match shown {
        [] => None,
        [one] => Some(format!("no object has the material {one}")),
        _ => Some(format!(
            "no object has the materials {}{more}",
            shown.join(", ")
        )),
    }
}
