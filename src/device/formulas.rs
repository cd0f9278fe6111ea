//! The formulas of traversal, recorded as functions of the device's language.

use std::fmt::Write;

use math::simd::{Real, Vector};
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
    text += &function("prepared", &recorded(|numbers| prepared(numbers)));
    text += &function("box_span", &recorded(|numbers| box_span(numbers)));
    text += &function("triangle_test", &recorded(|numbers| triangle_test(numbers)));
    text += &function("sphere_test", &recorded(|numbers| sphere_test(numbers)));
    // Shapes by their kind.
    let mut cases = String::new();
    for (number, &kind) in ShapeKind::ALL.iter().enumerate() {
        if let Some(program) = shape_test(kind) {
            text += &function(&format!("shape_{number}"), &program);
            let call = format!("shape_{number}(in, out); return;");
            let _ = writeln!(cases, "  if (kind == {number}u) {{ {call} }}");
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

/// Records a formula of `N` numbers.
fn recorded<const N: usize>(
    formula: impl for<'t> Fn([Register<'t>; N]) -> Vec<Register<'t>>,
) -> Program {
    let tape = Tape::default();
    tape.program(&formula(tape.inputs(0)))
}

/// Returns the vectors that start at these numbers.
fn vectors_at<R: Copy, const N: usize>(numbers: &[R], first: [usize; N]) -> [Vector<R>; N] {
    first.map(|first| vector([0, 1, 2].map(|i| numbers[first + i])))
}

/// Origin, direction, largest coordinate of the boxes → the set-up of slabs, the origin with permuted
/// axes, the shear, the squared length and its reciprocal, if y and if z is the dominant axis.
fn prepared<R: Real>(numbers: [R; 7]) -> Vec<R> {
    let [origin, direction] = vectors_at(&numbers, [0, 3]);
    let largest = numbers[6];
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
    vectors.chain([squared, inverse]).chain(is).collect()
}

/// Near planes, far planes, the set-up of slabs, limit → where a ray enters a box and leaves it.
fn box_span<R: Real>(numbers: [R; 16]) -> Vec<R> {
    let [near, far, inverse_direction, origin_of_near, origin_of_far] =
        vectors_at(&numbers, [0, 3, 6, 9, 12]);
    let slabs = SlabSetup {
        inverse_direction,
        origin_of_near,
        origin_of_far,
    };
    let (enter, exit) = slabs.span(near, far, numbers[15]);
    vec![enter, exit]
}

/// Vertices, origin and shear, all with permuted axes → the parameter of the hit, if there is one,
/// if that is unsure, and the sheared vertices.
fn triangle_test<R: Real>(numbers: [R; 15]) -> Vec<R> {
    let [a, b, c, origin, shear] = vectors_at(&numbers, [0, 3, 6, 9, 12]);
    let vertices = [a, b, c].map(|vertex| sheared(vertex - origin, shear));
    let test = Areas::new(&vertices).test(shear.z);
    let is = [test.hits, test.is_unsure].map(|mask| number(shear.z, mask));
    let vertices = vertices.into_iter().flat_map(coordinates);
    [test.t].into_iter().chain(is).chain(vertices).collect()
}

/// Center, squared radius, origin, direction, its squared length and the reciprocal → the parameter
/// of the hit, or 0.
fn sphere_test<R: Real>(numbers: [R; 12]) -> Vec<R> {
    let [center, origin, direction] = vectors_at(&numbers, [0, 4, 7]);
    let lengths = (numbers[10], numbers[11]);
    let equation = SphereEquation::new(center - origin, numbers[3], direction, lengths);
    let none = numbers[3].splat(0.0);
    vec![R::select(equation.hits(), equation.first(), none)]
}

/// Parameters, origin, direction → the parameter of the hit on a kind of shape; not a positive
/// number for a miss. `None` for shapes that are tested in double precision, by hand: see
/// `traversal.cl`.
fn shape_test(kind: ShapeKind) -> Option<Program> {
    let tape = Tape::default();
    let t = hits(kind, tape.inputs(0))?;
    Some(tape.program(&[t]))
}

/// Returns the parameter of the hit, given the shape's parameters and the ray's origin and direction.
fn hits<R: Real>(kind: ShapeKind, numbers: [R; N_PARAMETERS + 6]) -> Option<R> {
    let [origin, direction] = vectors_at(&numbers, [N_PARAMETERS, N_PARAMETERS + 3]);
    let parameters = numbers.first_chunk()?;
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
        /// The slow twin of a recorded formula is the formula for single numbers.
        #[test]
        fn programs_compute_what_their_formulas_compute(
            input in prop::array::uniform16(-2.0_f32..2.0),
            scale in prop::sample::select(&[1.0_f32, 1e-20, 1e20, 0.0][..]),
        ) {
            let input = input.map(|number| if number < -1.5 { scale * number } else { number });
            let check = |program: Program, expected: &[f32]| {
                prop_assert_eq!(program.check([&input, &[], &[]], expected), Ok(()), "{:?}", input);
                Ok(())
            };
            macro_rules! check_all {
                ($($formula:ident),*) => {$(
                    let numbers = *input.first_chunk().unwrap();
                    check(recorded(|numbers| $formula(numbers)), &$formula(numbers))?;
                )*};
            }
            check_all!(prepared, box_span, triangle_test, sphere_test);
            for &kind in ShapeKind::ALL {
                let program = shape_test(kind);
                let is_by_hand = matches!(kind, ShapeKind::Triangle | ShapeKind::Rectangle);
                prop_assert_eq!(program.is_none(), is_by_hand);
                if let Some(program) = program {
                    let expected = hits(kind, *input.first_chunk().unwrap()).unwrap();
                    check(program, &[expected])?;
                }
            }
        }
    }
}
