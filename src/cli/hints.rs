//! Hints of `check` and `render`: scenes without a mistake that show nothing, or not what was meant.

use std::collections::{HashMap, HashSet};
use std::f32::consts::PI;

use host::text::one_line;
use output::look::Look;
use scene::config::{Config, Geometry, ShadingModel};
use world::background::Background;
use world::geometry::KeyedShape;

/// Greatest number of names in a hint.
const MOST_NAMES: usize = 5;

/// A likely mistake in a scene.
struct Hint {
    kind: HintKind,
    text: String,
}

/// The kinds of likely mistakes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum HintKind {
    NothingSeen,
    EyeInside,
    PlaneFills,
    White,
    NoLight,
    Unlit,
    Radians,
    LightInside,
    UnusedMaterials,
    EqualNames,
}

/// Hints on an animation: each kind once, with the first frame that has it.
#[derive(Debug, Default)]
pub(super) struct FrameHints(HashSet<HintKind>);

impl FrameHints {
    /// Returns one line for each likely mistake in a frame of a kind that no frame before has.
    pub(super) fn lines(&mut self, frame: u32, config: &Config, look: Option<Look>) -> String {
        let new = hints(config, look).filter(|hint| self.0.insert(hint.kind));
        let line = |Hint { text, .. }| format!("hint    frame {frame}: {text}\n");
        new.map(line).collect()
    }
}

/// Returns one line for each likely mistake; empty if there is none. Without a look, only mistakes
/// in the scene's text.
pub(super) fn lines(config: &Config, look: Option<Look>) -> String {
    let line = |Hint { text, .. }| format!("hint    {text}\n");
    hints(config, look).map(line).collect()
}

fn hints(config: &Config, look: Option<Look>) -> impl Iterator<Item = Hint> {
    let of_look = look.into_iter().flat_map(|look| {
        [
            view_hint(config, look),
            angle_hint(look),
            light_hint(config, look),
        ]
    });
    let of_config = [unused_materials(config), equal_names(config)];
    let hints: Vec<Hint> = of_look.chain(of_config).flatten().collect();
    hints.into_iter()
}

impl HintKind {
    fn with(self, text: impl Into<String>) -> Option<Hint> {
        let (kind, text) = (self, text.into());
        Some(Hint { kind, text })
    }
}

/// Returns the problem with the picture as a whole, if any.
fn view_hint(config: &Config, look: Look) -> Option<Hint> {
    let named = |object: u32| {
        let geometry = &config.objects[object as usize].geometry;
        format!("`objects[{object}]`, a `{geometry}`,")
    };
    if !look.has_hit() {
        return HintKind::NothingSeen.with(
            "the camera sees no object: check `eye`, `target` and the places of the objects",
        );
    }
    if let Some(object) = look.only_object() {
        let object_name = named(object);
        let hides = config.objects.len() > 1 || look.is_black;
        if look.around_eye == look.only_object() && hides {
            return HintKind::EyeInside.with(format!(
                "the eye is inside {object_name} which fills the picture"
            ));
        }
        if is_plane(config, object) && config.objects.len() > 1 {
            let side = "the eye may be behind it, such as below a floor";
            return HintKind::PlaneFills.with(format!("{object_name} fills the picture: {side}"));
        }
    }
    if look.is_white {
        return HintKind::White
            .with("the picture is white: lower `exposure` in `film`, or the light");
    }
    if !look.is_black {
        return None;
    }
    if !has_light(config) {
        let remedy = match config.shading.model {
            ShadingModel::Path => "a light, a material with `emission`, or a `background`",
            _ => "a light, or `ambient` light in `shading`",
        };
        return HintKind::NoLight.with(format!(
            "what the camera sees is black: nothing shines; add {remedy}"
        ));
    }
    HintKind::Unlit.with("what the camera sees is black: no light reaches it")
}

/// Returns the hint on an angle of view that is likely in radians: so narrow that it shows one
/// object or none.
fn angle_hint(look: Look) -> Option<Hint> {
    let shows_little = !look.has_hit() || look.only_object().is_some();
    let radians = look
        .fov_y_deg
        .filter(|&degrees| degrees < PI && shows_little)?;
    HintKind::Radians.with(format!(
        "the angle of view is {radians:.1} degrees: if these are radians, write {:.1}",
        radians.to_degrees()
    ))
}

/// Returns the hint on a light inside an object that light does not leave.
fn light_hint(config: &Config, look: Look) -> Option<Hint> {
    let (light, object) = look.light_inside?;
    let names = &config.objects[object as usize].material.0;
    let is_clear = |name: &String| {
        let material = config.materials.get(name);
        material
            .is_none_or(|material| material.kind.medium().is_some() || material.opacity.is_some())
    };
    let is_closed = !names.is_empty() && !names.iter().any(is_clear);
    let text =
        format!("`lights[{light}]` is inside `objects[{object}]`, which its light does not leave");
    HintKind::LightInside.with(text).filter(|_| is_closed)
}

fn is_plane(config: &Config, object: u32) -> bool {
    let geometry = &config.objects[object as usize].geometry;
    matches!(geometry, Geometry::Shape(KeyedShape::Plane(_)))
}

/// Returns the hint on two objects of the same name.
fn equal_names(config: &Config) -> Option<Hint> {
    let mut first_of = HashMap::new();
    config
        .objects
        .iter()
        .enumerate()
        .find_map(|(index, object)| {
            let name = object.name.as_ref()?;
            let first = first_of.insert(name, index)?;
            HintKind::EqualNames.with(format!(
            "`objects[{first}]` and `objects[{index}]` are both named `{}`: reports cannot tell \
             them apart",
            one_line(name)
        ))
        })
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
fn unused_materials(config: &Config) -> Option<Hint> {
    let objects = config.objects.iter();
    let used: HashSet<&String> = objects.flat_map(|object| &object.material.0).collect();
    let unused = config.materials.keys().filter(|name| !used.contains(name));
    let unused: Vec<String> = unused.map(|name| format!("`{}`", one_line(name))).collect();
    let (shown, more) = unused.split_at(unused.len().min(MOST_NAMES));
    let more = match more.len() {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let kind = HintKind::UnusedMaterials;
    match shown {
        [] => None,
        [one] => kind.with(format!("no object has the material {one}")),
        _ => kind.with(format!(
            "no object has the materials {}{more}",
            shown.join(", ")
        )),
    }
}
