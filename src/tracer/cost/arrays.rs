//! The arrays of a pixel, and the choice of those that are written.

use base::{Keyword, keywords};

keywords! {
    /// An array of the cloud and the frame.
    ///
    /// ```
    /// # use raycost_tracer::cost::PixelArray;
    /// let arrays: Vec<PixelArray> = scene::yaml::from_str("[RGB, node_visits, time_ns]").unwrap();
    /// # use PixelArray::*;
    /// # assert_eq!(arrays, [Rgb, NodeVisits, TimeNs]);
    /// ```
    pub enum PixelArray {
        /// The column of the pixel, from 0
        PixelX = "pixel_x",
        /// The row of the pixel, from 0 on top
        PixelY = "pixel_y",
        /// The color in the picture
        Rgb = "RGB",
        /// The shading normal
        Normals = "Normals",
        /// The distance along the camera ray
        Distance = "distance",
        /// The size of the pixel at the hit
        Footprint = "footprint",
        /// The object
        Object = "object",
        /// The material
        Material = "material",
        /// The instance
        Instance = "instance",
        /// The number of the pixel, in the cloud
        Pixel = "pixel",
        /// 1 for a hit near the horizon, in the cloud
        Horizon = "horizon",
        /// The time of the pixel
        TimeNs = "time_ns",
        /// The spread of repeated times
        TimeMadNs = "time_mad_ns",
        /// The visited nodes of the hierarchy
        NodeVisits = "node_visits",
        /// The tests of primitives
        PrimitiveTests = "primitive_tests",
        /// All rays
        Rays = "rays",
        /// The rays to lights
        ShadowRays = "shadow_rays",
        /// The rays of mirrors
        ReflectionRays = "reflection_rays",
        /// The rays through clear media
        RefractionRays = "refraction_rays",
        /// The rays that rough surfaces scatter
        DiffuseRays = "diffuse_rays",
        /// The longest path
        Depth = "depth",
        /// The samples
        Samples = "samples",
        /// The tile
        Tile = "tile",
        /// The thread
        Thread = "thread",
        /// The linear light
        Radiance = "radiance",
        /// The standard error of the linear light
        Noise = "noise",
        /// One over variance and cost of a sample
        Efficiency = "efficiency",
        /// The rays by bounce
        RaysByBounce = "rays_by_bounce",
        /// The group that was timed as a whole
        Group = "group",
        /// The tests of the boxes of nodes
        BoxTests = "box_tests",
        /// The box tests that hit
        BoxHits = "box_hits",
        /// The primitive tests that hit
        PrimitiveHits = "primitive_hits",
        /// The visits of instances
        InstanceVisits = "instance_visits",
        /// The share of idle lanes in the warps of the rays
        IdleLanes = "idle_lanes",
        /// The cycles of the device's clock
        Cycles = "cycles",
        /// The multiprocessor of the device
        Sm = "sm",
    }
}

/// The arrays that the cloud and the frame have: all, or the chosen ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WrittenArrays {
    /// One bit per [`PixelArray`].
    left_out: u64,
}

impl WrittenArrays {
    /// Creates a set of only the chosen arrays.
    pub fn only(chosen: &[PixelArray]) -> Self {
        let others = PixelArray::KEYWORDS
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
    /// Returns true for the costs of a pixel: its time, visits, tests, rays, samples and depth.
    pub fn is_cost(self) -> bool {
        use PixelArray::*;
        match self {
            TimeNs | NodeVisits | PrimitiveTests | Rays | ShadowRays | ReflectionRays
            | RefractionRays | DiffuseRays | Depth | Samples | BoxTests | BoxHits
            | PrimitiveHits | InstanceVisits => true,
            PixelX | PixelY | Rgb | Normals | Distance | Footprint | Object | Material
            | Instance | Pixel | Horizon | TimeMadNs | Tile | Thread | Radiance | Noise
            | Efficiency | RaysByBounce | Group | IdleLanes | Cycles | Sm => false,
        }
    }

    /// Returns the names of the costs.
    pub fn cost_names() -> Vec<&'static str> {
        let costs = Self::KEYWORDS.iter().filter(|array| array.is_cost());
        costs.map(|array| array.name()).collect()
    }

    fn bit(self) -> u64 {
        1 << self as u64
    }
}
