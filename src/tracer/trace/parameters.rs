//! The shapes that rays have hit, in lanes.

use math::simd::{InstructionSet, N_LANES};
use world::geometry::N_PARAMETERS;
use world::scene::{InstanceId, PlacedPrimitive, Scene};

/// Returns the parameters of eight primitives, in world space for instances.
#[inline(always)]
pub(super) fn parameters<I: InstructionSet>(
    set: I,
    scene: &Scene,
    primitives: &[u32; N_LANES],
    instances: &[Option<InstanceId>; N_LANES],
) -> [I::Lanes; N_PARAMETERS] {
    let mut parameters = [set.splat(0.0); N_PARAMETERS];
    if scene.instances.is_none() && *primitives == [primitives[0]; N_LANES] {
        let shape = scene.primitives[primitives[0] as usize].parameters();
        for i in 0..N_PARAMETERS {
            parameters[i] = set.splat(shape[i]);
        }
        return parameters;
    }
    let mut columns = [[0.0; N_LANES]; N_PARAMETERS];
    for lane in 0..N_LANES {
        let shape = scene.parameters(PlacedPrimitive {
            primitive: primitives[lane],
            instance: instances[lane],
        });
        for i in 0..N_PARAMETERS {
            columns[i][lane] = shape[i];
        }
    }
    for i in 0..N_PARAMETERS {
        parameters[i] = set.load(&columns[i]);
    }
    parameters
}
