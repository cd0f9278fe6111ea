//! The formulas of traversal, recorded as functions of the device's language.

use std::fmt::Write;

use math::simd::{Arithmetic, Real, Vector};
use tracer::accel::SlabSetup;
use world::geometry::{
    Areas, Capsule, Cone, Cuboid, Disk, N_PARAMETERS, Plane, RayTest, ShapeKind, Sphere,
    SphereEquation, dominant_axis, permuted_by, shear_constants, sheared, squared_length,
};

use crate::print::function;
use crate::tape::{Program, Register, Tape};

/// Returns the functions of all formulas.
pub(crate) fn functions() -> String {
    let mut text = String::new();
    text += &function("prepared", &prepared());
    text += &function("box_span", &box_span());
    text += &function("triangle_test", &triangle_test());
    text += &function("sphere_test", &sphere_test());
    // Shapes by their kind.
    let mut cases = String::new();
    for (number, &kind) in ShapeKind::ALL.iter().enumerate() {
        if let Some(program) = shape_test(kind) {
            let name = format!("shape_{number}");
            text += &function(&name, &program);
            let _ = writeln!(
                cases,
                "  if (kind == {number}u) {{ {name}(in, out); return; }}"
            );
        }
    }
    text + "FUNCTION void shape_test(uint kind, const float *in, float *out) {\n"
        + &cases
        + "  out[0] = 0.0f;\n}\n"
}

pub(crate) fn vector<R>([x, y, z]: [R; 3]) -> Vector<R> {
    Vector { x, y, z }
}

pub(crate) fn coordinates<R>(Vector { x, y, z }: Vector<R>) -> [R; 3] {
    [x, y, z]
}

/// Returns 1 where the mask is true, else 0.
pub(crate) fn number<R: Real>(like: R, mask: R::Mask) -> R {
    R::select(mask, like.splat(1.0), like.splat(0.0))
}

/// Origin, direction, largest coordinate of the boxes → the set-up of slabs, the origin with permuted
/// axes, the shear, the squared length and its reciprocal, if y and if z is the dominant axis.
fn prepared() -> Program {
    let tape = Tape::default();
    let [origin, direction] = [0, 3].map(|first| vector(tape.inputs(first)));
    let [largest] = tape.inputs(6);
    let slabs = SlabSetup::new(origin, direction, largest);
    let axis = dominant_axis(direction);
    let vectors = [
        slabs.inverse_direction,
        slabs.origin_of_near,
        slabs.origin_of_far,
        permuted_by(origin, axis),
        shear_constants(permuted_by(direction, axis)),
    ];
    let (squared, inverse) = squared_length(direction);
    let is = [axis.0, axis.1].map(|mask| number(largest, mask));
    let vectors = vectors.into_iter().flat_map(coordinates);
    let results: Vec<_> = vectors.chain([squared, inverse]).chain(is).collect();
    tape.program(&results)
}

/// Near planes, far planes, the set-up of slabs, limit → where a ray enters a box and leaves it.
fn box_span() -> Program {
    let tape = Tape::default();
    let [near, far, inverse_direction, origin_of_near, origin_of_far] =
        [0, 3, 6, 9, 12].map(|first| vector(tape.inputs(first)));
    let [limit] = tape.inputs(15);
    let slabs = SlabSetup {
        inverse_direction,
        origin_of_near,
        origin_of_far,
    };
    let (enter, exit) = slabs.span(near, far, limit);
    tape.program(&[enter, exit])
}

/// Vertices, origin and shear, all with permuted axes → the parameter of the hit, if there is one,
/// if that is unsure, and the sheared vertices.
fn triangle_test() -> Program {
    let tape = Tape::default();
    let [a, b, c, origin, shear] = [0, 3, 6, 9, 12].map(|first| vector(tape.inputs(first)));
    let vertices = [a, b, c].map(|vertex| sheared(vertex - origin, shear));
    let test = Areas::new(&vertices).test(shear.z);
    let is = [test.hits, test.is_unsure].map(|mask| number(shear.z, mask));
    let vertices = vertices.into_iter().flat_map(coordinates);
    let results: Vec<_> = [test.t].into_iter().chain(is).chain(vertices).collect();
    tape.program(&results)
}

/// Center, squared radius, origin, direction, its squared length and the reciprocal → the parameter
/// of the hit, or 0.
fn sphere_test() -> Program {
    let tape = Tape::default();
    let [center, origin, direction] = [0, 4, 7].map(|first| vector(tape.inputs(first)));
    let ([r2], [a, inverse_a]) = (tape.inputs(3), tape.inputs(10));
    let equation = SphereEquation::new(center - origin, r2, direction, (a, inverse_a));
    let t = Register::select(equation.hits(), equation.first(), r2.splat(0.0));
    tape.program(&[t])
}

/// Parameters, origin, direction → the parameter of the hit on a kind of shape; not a positive
/// number for a miss. `None` for shapes that are tested in double precision, by hand: see
/// `traversal.cl`.
fn shape_test(kind: ShapeKind) -> Option<Program> {
    let tape = Tape::default();
    let parameters: [_; N_PARAMETERS] = tape.inputs(0);
    let vectors = [0, 3].map(|first| vector(tape.inputs(N_PARAMETERS + first)));
    let t = hits(kind, &parameters, vectors)?;
    Some(tape.program(&[t]))
}

/// Returns the parameter of the hit of a ray, given its origin and direction.
fn hits<R: Real>(
    kind: ShapeKind,
    parameters: &[R; N_PARAMETERS],
    [origin, direction]: [Vector<R>; 2],
) -> Option<R> {
    let hits = match kind {
        ShapeKind::Sphere => Sphere::hits,
        ShapeKind::Plane => Plane::hits,
        ShapeKind::Disk => Disk::hits,
        ShapeKind::Cuboid => Cuboid::hits,
        ShapeKind::Cylinder | ShapeKind::Cone => Cone::hits,
        ShapeKind::Capsule => Capsule::hits,
        ShapeKind::Triangle | ShapeKind::Rectangle => return None,
    };
    Some(hits(parameters, origin, direction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The slow twin of a recorded program is its formula for single numbers.
        #[test]
        fn programs_compute_what_their_formulas_compute(
            input in prop::array::uniform15(-2.0_f32..2.0),
            scale in prop::sample::select(&[1.0_f32, 1e-20, 1e20, 0.0][..]),
        ) {
            let input = input.map(|number| if number < -1.5 { scale * number } else { number });
            let [a, b, c, d, e, f, g, h, i, ox, oy, oz, dx, dy, dz] = input;
            let parameters = [a, b, c, d, e, f, g, h, i];
            let (x, y) = ([ox, oy, oz], [dx, dy, dz]);
            let vectors = [x, y].map(|[x, y, z]| Vector { x, y, z });
            for &kind in ShapeKind::ALL {
                let Some(program) = shape_test(kind) else { continue };
                let expected = hits(kind, &parameters, vectors).unwrap();
                let found = program.evaluate([&input, &[], &[]])[0];
                let is_same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
                prop_assert!(is_same, "{kind:?}: {found} is not {expected} for {input:?}");
            }
        }
    }

    #[test]
    fn all_kinds_but_two_are_recorded() {
        let by_hand = ShapeKind::ALL
            .iter()
            .filter(|&&kind| shape_test(kind).is_none());
        let by_hand: Vec<_> = by_hand.collect();
        assert_eq!(by_hand, [&ShapeKind::Triangle, &ShapeKind::Rectangle]);
    }
}
