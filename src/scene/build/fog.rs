//! Checks the fog of a config.

use crate::config::Config;
use crate::yaml::{Fault, FieldPath};
use base::Keyword;
use world::shading::ShadingModel;

/// Checks that the shading model supports this kind of fog.
pub(super) fn check(config: &Config) -> Result<(), Fault> {
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
