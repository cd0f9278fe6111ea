//! Meshes and tables of spheres.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| raycost_fuzz::targets::geometry(input));
