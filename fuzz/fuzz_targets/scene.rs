//! Scenes.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| raycost_fuzz::targets::scene(input));
