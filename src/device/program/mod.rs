//! The text of the device's program.

use tracer::accel::{CAPSULE_BIT, ID_BIT};
use world::geometry::{MIN_COS, ShapeKind};

use crate::formulas;

/// Levels of nodes by which the sizes of stacks grow: a program serves hierarchies of similar depth.
const LEVEL_STEP: usize = 8;

/// A kernel of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// Finds the nearest hits of rays.
    Nearest,
    /// Finds if anything is in the way of rays.
    Occluded,
    /// Follows whole paths.
    Path,
    /// Computes with triples of numbers.
    Arithmetic,
}

impl Kernel {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Occluded => "occluded",
            Self::Path => "path",
            Self::Arithmetic => "arithmetic",
        }
    }

    /// Returns the number of arrays of the scene that it reads: so many of the first ones.
    pub(crate) fn n_arrays(self) -> usize {
        match self {
            Self::Nearest | Self::Occluded => 5,
            Self::Path => 9,
            Self::Arithmetic => 0,
        }
    }
}

/// The kind of an instance in a record, after the kinds of shapes.
pub(crate) const INSTANCE: u32 = ShapeKind::ALL.len() as u32;

/// The depths of a scene's hierarchies, for which a program is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Depths {
    pub(crate) world: usize,
    /// The greatest depth of an instanced mesh; `None` without instances.
    pub(crate) mesh: Option<usize>,
}

impl Depths {
    /// Rounds the depths of hierarchies with this many levels of nodes up.
    pub(crate) fn new(world: usize, mesh: Option<usize>) -> Self {
        let rounded = |n_levels: usize| n_levels.next_multiple_of(LEVEL_STEP);
        Self {
            world: rounded(world),
            mesh: mesh.map(rounded),
        }
    }
}

/// Returns the program for scenes of these depths, without the prelude of a language; with the
/// functions of whole paths, it follows them.
pub(crate) fn text(depths: Depths, paths: Option<&str>) -> String {
    // Each level leaves at most seven children on the stack, beside the sentinel and the eight of
    // the last one.
    let stack = |n_levels: usize| 7 * n_levels + 9;
    let kind = |kind: ShapeKind| kind as u32;
    let mut text = format!(
        "#define NONE 0xffffffffu
#define END 3u
#define ID_BIT {ID_BIT}u
#define CAPSULE_BIT {CAPSULE_BIT}u
#define MIN_COS {:?}
#define TRIANGLE {}u
#define RECTANGLE {}u
#define CAPSULE {}u
#define INSTANCE {INSTANCE}u
",
        f64::from(MIN_COS),
        kind(ShapeKind::Triangle),
        kind(ShapeKind::Rectangle),
        kind(ShapeKind::Capsule),
    );
    text += &formulas::functions();
    text += include_str!("traversal.cl");
    if let Some(n_levels) = depths.mesh {
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
    text += &format!("#define STACK {}\n", stack(depths.world));
    text += "#define TRAVERSE search_world
#define TEST(i) test_in_world(world, ray, search, is_nearest, i)
#define FOUND(t, i) found(world, search, is_nearest, t, i, 0u)
";
    text += include_str!("level.cl");
    text += include_str!("kernels.cl");
    if let Some(functions) = paths {
        text += include_str!("functions.cl");
        text += include_str!("tables.cl");
        text += functions;
        text += include_str!("media.cl");
        text += include_str!("path.cl");
    }
    text
}
