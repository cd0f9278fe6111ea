//! The text of the device's program.

use tracer::accel::{CAPSULE_BIT, ID_BIT};
use world::geometry::{MIN_COS, ShapeKind};

use crate::formulas;

/// Levels of nodes by which the sizes of stacks grow: a program serves hierarchies of similar depth.
const LEVEL_STEP: usize = 8;

/// A kernel of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Kernel {
    pub(crate) name: &'static str,
    /// The number of the scene's arrays that it reads, from the first on.
    pub(crate) n_arrays: usize,
}

impl Kernel {
    /// Finds the nearest hits of rays.
    pub(crate) const NEAREST: Self = Self::new("nearest", 5);
    /// Finds if anything is in the way of rays.
    pub(crate) const OCCLUDED: Self = Self::new("occluded", 5);
    /// Follows whole paths.
    pub(crate) const PATH: Self = Self::new("path", 9);
    /// Computes with triples of numbers.
    pub(crate) const ARITHMETIC: Self = Self::new("arithmetic", 0);

    const fn new(name: &'static str, n_arrays: usize) -> Self {
        Self { name, n_arrays }
    }
}

/// No primitive, object, hit or multiprocessor.
pub(crate) const NONE: u32 = u32::MAX;

/// The kind of an instance in a record, after the kinds of shapes.
pub(crate) const INSTANCE: u32 = ShapeKind::ALL.len() as u32;

/// Returns the program for hierarchies with this many levels of nodes, of the world and, with
/// instances, of their meshes, without the prelude of a language; with the functions of whole paths,
/// it follows them. If it does not count, its counters are 0.
pub(crate) fn text(
    world_levels: usize,
    mesh_levels: Option<usize>,
    paths: Option<&str>,
    counts: bool,
) -> String {
    // Each level leaves at most seven children on the stack, beside the sentinel and the eight of
    // the last one.
    let stack = |n_levels: usize| 7 * n_levels.next_multiple_of(LEVEL_STEP) + 9;
    let count = if counts { "n += by" } else { "(void)0" };
    let mut text = format!(
        "#define COUNT(n, by) {count}
#define NONE {NONE}u
#define END 3u
#define ID_BIT {ID_BIT}u
#define CAPSULE_BIT {CAPSULE_BIT}u
#define MIN_COS {:?}
#define INSTANCE {INSTANCE}u
",
        f64::from(MIN_COS),
    );
    for (kind, number) in ShapeKind::ALL.iter().zip(0..) {
        let name = format!("{kind:?}").to_uppercase();
        text += &format!("#define {name} {number}u\n");
    }
    text += &formulas::functions();
    text += include_str!("traversal.cl");
    if let Some(n_levels) = mesh_levels {
        text += &format!("#define MESH_STACK {}\n", stack(n_levels));
        text += "#define STACK MESH_STACK
#define TRAVERSE search_mesh
#define TEST(i) test_in_mesh(world, ray, search, is_nearest, placement, i)
#define FOUND(t, i) found_in_mesh(world, search, is_nearest, placement, t, i)
";
        text += include_str!("level.cl");
        text += "#undef STACK\n#undef TRAVERSE\n#undef TEST\n#undef FOUND\n";
    }
    text += include_str!("world.cl");
    text += &format!("#define STACK {}\n", stack(world_levels));
    text += "#define TRAVERSE search_world
#define TEST(i) test_in_world(world, ray, search, is_nearest, i)
#define FOUND(t, i) found(world, search, is_nearest, t, i, 0u)
";
    text += include_str!("level.cl");
    text += include_str!("kernels.cl");
    if let Some(functions) = paths {
        text += include_str!("functions.cl");
        text += include_str!("tables.cl");
        text += include_str!("pictures.cl");
        text += functions;
        text += include_str!("media.cl");
        text += include_str!("path.cl");
    }
    text
}
