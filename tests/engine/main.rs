//! What is computed: meshes in, rays, pixels and their counters out.

#[path = "../common/mod.rs"]
mod common;

mod accel;
mod adaptive;
mod awkward;
mod by_efficiency;
mod cameras;
mod counters;
mod determinism;
mod environment;
mod finite;
mod fog;
mod gltf;
mod gltf_parts;
mod growth;
mod import;
mod instances;
mod invariance;
mod lanes;
mod media;
mod attribution;
mod meshes;
mod noise;
mod mirrored;
mod observe;
mod opacity;
mod own_colors;
mod path_tracing;
mod pictures;
mod radiance;
mod refit;
mod repeats;
mod rounding;
mod schedule;
mod seed_reference;
mod shading_normals;
mod streams;
mod turned;
mod watertight;
mod windows;
