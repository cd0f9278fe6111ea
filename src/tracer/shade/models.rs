//! The shading models by their names in the scene file.

use super::model::Model;
use crate::trace::{PointGroup, Points};
use world::scene::Scene;

/// Calls the function with the model of the scene.
macro_rules! by_model {
    ($scene:expr, |$model:ident| $call:expr) => {
        match $scene.shading.model {
            world::shading::ShadingModel::BlinnPhong => {
                let $model = $crate::shade::standard::Standard;
                $call
            }
            world::shading::ShadingModel::Seed => {
                let $model = $crate::shade::seed::Seed;
                $call
            }
            world::shading::ShadingModel::AmbientOcclusion => {
                let $model = $crate::shade::occlusion::AmbientOcclusion;
                $call
            }
            world::shading::ShadingModel::Path => {
                let $model = $crate::shade::path_tracing::PathTracing;
                $call
            }
        }
    };
}
pub(super) use by_model;

/// Returns the groups of points whose reflection light samples contribute to.
pub(super) fn lit_groups<'a>(
    scene: &'a Scene,
    points: &'a Points,
) -> impl Iterator<Item = &'a PointGroup> {
    let is_lit = move |group: &&PointGroup| {
        let material = scene.material(group.material);
        by_model!(scene, |model| model.is_lit(material))
    };
    points.groups().iter().filter(is_lit)
}
