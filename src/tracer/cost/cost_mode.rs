//! The cost that is measured.

use base::keywords;

keywords! {
    /// The cost measured for each pixel. All modes give the same picture, and the
    /// three modes with counters the same counters.
    ///
    /// ```
    /// # use raycost_tracer::cost::CostMode;
    /// let cost: CostMode = scene::yaml::from_str("counters").unwrap();
    /// # assert_eq!(cost, CostMode::Counters);
    /// ```
    #[derive(Default)]
    pub enum CostMode {
        /// Nothing
        None = "none",
        /// Node visits, primitive tests and rays
        Counters = "counters",
        /// Counters, and the time of each pixel; traces rays one by one
        SingleRayTime = "single_ray_time",
        /// Counters, and the times of waves of rays, split over their pixels by the
        /// counters of each stage
        #[default]
        Time = "time",
    }
}

impl CostMode {
    /// Returns true if node visits, primitive tests and rays are counted.
    pub fn has_counters(self) -> bool {
        self != Self::None
    }

    /// Returns true if each pixel has a time, measured or its share of its group's.
    pub fn has_time(self) -> bool {
        matches!(self, Self::SingleRayTime | Self::Time)
    }
}
