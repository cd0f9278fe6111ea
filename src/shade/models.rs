//! The shading models by their names in the scene file.

use super::model::Model;
use crate::scene::{MaterialId, Scene};

/// Calls the function with the model of the scene.
macro_rules! by_model {
    ($scene:expr, |$model:ident| $call:expr) => {
        match $scene.shading.model {
            $crate::config::ShadingModel::BlinnPhong => {
                let $model = $crate::shade::standard::Standard;
                $call
            }
            $crate::config::ShadingModel::Seed => {
                let $model = $crate::shade::seed::Seed;
                $call
            }
            $crate::config::ShadingModel::AmbientOcclusion => {
                let $model = $crate::shade::occlusion::AmbientOcclusion;
                $call
            }
            $crate::config::ShadingModel::Path => {
                let $model = $crate::shade::path_tracing::PathTracing;
                $call
            }
        }
    };
}
pub(super) use by_model;

/// Whether light samples contribute to what surfaces of a material reflect.
pub(super) fn is_lit(scene: &Scene, material: MaterialId) -> bool {
    by_model!(scene, |model| model.is_lit(scene.material(material)))
}
