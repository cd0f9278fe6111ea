//! Checks the settings of a config that may contradict each other.

use crate::config::Config;
use crate::yaml::{Fault, FieldPath};
use base::Keyword;
use world::material::MaterialKind;
use world::shading::ShadingModel;

/// Checks the settings that may contradict each other.
pub(super) fn settings(config: &Config) -> Result<(), Fault> {
    if config.objects.is_empty() {
        let objects = FieldPath::default().key("objects");
        let fault = Fault::new(objects, "the scene has no objects", "expected at least one");
        let help = "add `- sphere: { center: [0, 0, 0], radius: 1 }` with a `material`";
        return Err(fault.with_help(help));
    }
    check_materials(config)?;
    check_fog(config)?;
    config.image.check_sampling()
}

/// Checks that the shading model supports the materials.
fn check_materials(config: &Config) -> Result<(), Fault> {
    let model = config.shading.model;
    let is_seed = model == ShadingModel::Seed;
    let is_path = model == ShadingModel::Path;
    for (name, material) in &config.materials {
        let is_principled = matches!(material.kind, MaterialKind::Principled { .. });
        let (key, what, help) = if is_seed && material.kind.medium().is_some() {
            ("dielectric", "refraction", NOT_SEED)
        } else if is_seed && material.emits() {
            ("emission", "surfaces that emit light", NOT_SEED)
        } else if is_seed && let Some(opacity) = &material.opacity {
            (opacity.keys()[0], "openings of surfaces", NOT_SEED)
        } else if is_seed && !material.two_sided {
            ("two_sided", "sides", NOT_SEED)
        } else if !is_path && material.kind.roughness() > 0.0 {
            ("roughness", "rough media and metals", PATH)
        } else if !is_path && is_principled {
            ("principled", "principled surfaces", PATH)
        } else {
            continue;
        };
        let path = FieldPath::default().key("materials").key(name).key(key);
        let message = format!("the shading model `{}` has no {what}", model.name());
        return Err(Fault::new(path, message, "expected a material without it").with_help(help));
    }
    Ok(())
}

const NOT_SEED: &str = "remove `model: seed` from `shading`";
const PATH: &str = "trace paths by `shading: { model: path }`";

/// Checks that the shading model supports this kind of fog.
fn check_fog(config: &Config) -> Result<(), Fault> {
    let Some(fog) = config.fog else {
        return Ok(());
    };
    let model = config.shading.model;
    let path = FieldPath::default().key("fog");
    let fault = |path, what: &str, help: &str| {
        let message = format!("the shading model `{}` has no {what}", model.name());
        Err(Fault::new(path, message, "expected none").with_help(help))
    };
    match model {
        ShadingModel::Seed | ShadingModel::AmbientOcclusion => {
            let help = "remove it, or set `shading: { model: blinn_phong }` or `path`";
            fault(path, "fog", help)
        }
        ShadingModel::BlinnPhong if fog.anisotropy != 0.0 => {
            let help = "trace paths by `shading: { model: path }`";
            fault(path.key("anisotropy"), "fog that scatters light", help)
        }
        ShadingModel::BlinnPhong | ShadingModel::Path => Ok(()),
    }
}
