//! The arrays of a pixel, and the choice of those that are written.

use clap::ValueEnum;

use base::serde_keywords;
use base::text::keyword_name;

/// An array of the cloud and the frame.
///
/// ```
/// # use tracer::cost::PixelArray;
/// let arrays: Vec<PixelArray> = scene::yaml::from_str("[RGB, node_visits, time_ns]").unwrap();
/// # use PixelArray::*;
/// # assert_eq!(arrays, [Rgb, NodeVisits, TimeNs]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum PixelArray {
    /// The column of the pixel, from 0
    PixelX,
    /// The row of the pixel, from 0 on top
    PixelY,
    /// The color in the picture
    #[value(name = "RGB")]
    Rgb,
    /// The shading normal
    #[value(name = "Normals")]
    Normals,
    /// The distance along the camera ray
    Distance,
    /// The size of the pixel at the hit
    Footprint,
    /// The object
    Object,
    /// The material
    Material,
    /// The instance
    Instance,
    /// The number of the pixel, in the cloud
    Pixel,
    /// 1 for a hit near the horizon, in the cloud
    Horizon,
    /// The time of the pixel
    TimeNs,
    /// The spread of repeated times
    TimeMadNs,
    /// The visited nodes of the hierarchy
    NodeVisits,
    /// The tests of primitives
    PrimitiveTests,
    /// All rays
    Rays,
    /// The rays to lights
    ShadowRays,
    /// The rays of mirrors
    ReflectionRays,
    /// The rays through clear media
    RefractionRays,
    /// The rays that rough surfaces scatter
    DiffuseRays,
    /// The longest path
    Depth,
    /// The samples
    Samples,
    /// The tile
    Tile,
    /// The thread
    Thread,
    /// The linear light
    Radiance,
    /// The rays by bounce
    RaysByBounce,
    /// The group that was timed as a whole
    Group,
    /// The tests of the boxes of nodes
    BoxTests,
    /// The box tests that hit
    BoxHits,
    /// The primitive tests that hit
    PrimitiveHits,
    /// The visits of instances
    InstanceVisits,
}

/// The arrays that the cloud and the frame have: all, or the chosen ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WrittenArrays {
    /// One bit per [`PixelArray`].
    left_out: u32,
}

impl WrittenArrays {
    /// Creates a set of only the chosen arrays.
    pub fn only(chosen: &[PixelArray]) -> Self {
        let others = PixelArray::value_variants()
            .iter()
            .filter(|array| !chosen.contains(array));
        Self {
            left_out: others.fold(0, |bits, array| bits | array.bit()),
        }
    }

    /// Returns true if an array of this name is written.
    pub fn has(self, name: &str) -> bool {
        let array = PixelArray::from_name(name);
        array.is_none_or(|array| self.left_out & array.bit() == 0)
    }

    /// Returns true if arrays of all these names are written.
    pub fn has_all(self, names: &[&str]) -> bool {
        names.iter().all(|name| self.has(name))
    }
}

impl PixelArray {
    /// Returns the array with this name in files.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::value_variants()
            .iter()
            .copied()
            .find(|array| array.name() == name)
    }

    /// Returns the name in files.
    pub fn name(self) -> String {
        keyword_name(&self)
    }

    /// Returns true for the costs of a pixel: its time, visits, tests, rays, samples and depth.
    pub fn is_cost(self) -> bool {
        use PixelArray::*;
        match self {
            TimeNs | NodeVisits | PrimitiveTests | Rays | ShadowRays | ReflectionRays
            | RefractionRays | DiffuseRays | Depth | Samples | BoxTests | BoxHits
            | PrimitiveHits | InstanceVisits => true,
            PixelX | PixelY | Rgb | Normals | Distance | Footprint | Object | Material
            | Instance | Pixel | Horizon | TimeMadNs | Tile | Thread | Radiance | RaysByBounce
            | Group => false,
        }
    }

    fn bit(self) -> u32 {
        1 << self as u32
    }
}

serde_keywords!(PixelArray);
