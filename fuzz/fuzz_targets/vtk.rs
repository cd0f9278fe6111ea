//! VTK files.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| raycost_fuzz::targets::vtk(input));
