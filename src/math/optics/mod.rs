//! Light at surfaces, without geometry beyond two directions: Fresnel's equations, and rough
//! surfaces of microscopic facets.

mod fresnel;
mod ggx;
mod albedo;

pub use albedo::{Albedo, AlbedoByRoughness, schlick};
pub use fresnel::{Split, reflectance_of_metal, split};
pub use ggx::{Facets, Ggx, Masking};
