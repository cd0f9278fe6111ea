//! The shapes that rays have hit, in lanes.

use crate::geometry::N_PARAMETERS;
use crate::scene::Scene;
use crate::simd::{InstructionSet, N_LANES};

/// The parameters of eight primitives.
#[inline(always)]
pub(super) fn parameters<I: InstructionSet>(
    set: I,
    scene: &Scene,
    primitives: &[u32; N_LANES],
) -> [I::Lanes; N_PARAMETERS] {
    let mut columns = [[0.0; N_LANES]; N_PARAMETERS];
    for lane in 0..N_LANES {
        let parameters = scene.primitives[primitives[lane] as usize].parameters();
        for i in 0..N_PARAMETERS {
            columns[i][lane] = parameters[i];
        }
    }
    let mut parameters = [set.splat(0.0); N_PARAMETERS];
    for i in 0..N_PARAMETERS {
        parameters[i] = set.load(&columns[i]);
    }
    parameters
}
