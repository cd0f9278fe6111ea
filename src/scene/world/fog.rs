//! Creates the fog of a scene from its config.

use super::lights::bounds;
use super::surface_class::SurfaceClass;
use super::{MaterialId, Scene};
use crate::config::{Config, ShadingModel};
use crate::fog::{FogSphere, HenyeyGreenstein};
use crate::material::Material;
use crate::yaml::{Fault, FieldPath};
use base::text::keyword_name;

/// Checks that the shading model supports this kind of fog.
pub(super) fn check(config: &Config) -> Result<(), Fault> {
    let Some(fog) = config.fog else {
        return Ok(());
    };
    let model = config.shading.model;
    let path = FieldPath::default().key("fog");
    let fault = |path, what: &str, help: &str| {
        let message = format!("the shading model `{}` has no {what}", keyword_name(&model));
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

impl Scene {
    /// Adds the fog of the config once all objects are placed: as an additional primitive, which no
    /// ray hits, and whose material is the fog's particles.
    pub(super) fn add_fog(&mut self, config: &Config) {
        let Some(fog) = config.fog else {
            return;
        };
        let bounds = bounds(self.world().upper_level());
        let center = bounds.center();
        let to_corner = 0.5 * (bounds.max - bounds.min).length();
        let to_camera = self.sensor(config).plane.eye.distance(center);
        let around_all = to_corner.max(to_camera).max(f32::MIN_POSITIVE);
        let phase = HenyeyGreenstein {
            anisotropy: fog.anisotropy,
        };
        self.fog = Some(FogSphere {
            center,
            radius: fog
                .radius
                .map_or(around_all, |radius| self.space.length(radius)),
            extinction: 1.0 / self.space.length(fog.mean_free_path),
            color: fog.color,
            phase,
        });
        let material = MaterialId(self.materials.len() as u32);
        self.materials
            .push(Material::of_particles(fog.color, phase));
        let class = SurfaceClass::of_particles(material);
        self.classes.push(class);
    }

    /// Returns the fog whose particles scatter light.
    pub fn scattering_fog(&self) -> Option<&FogSphere> {
        self.fog.as_ref().filter(|_| self.scatters_paths())
    }

    /// Returns the fog that attenuates light without scattering it.
    pub fn fading_fog(&self) -> Option<&FogSphere> {
        self.fog.as_ref().filter(|_| !self.scatters_paths())
    }

    /// Returns the index of the fog's particles in hits: one past the last primitive.
    pub fn particles(&self) -> u32 {
        self.primitives.len() as u32
    }
}
