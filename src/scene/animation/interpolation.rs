//! Interpolation between keyframes.

use base::keywords;

keywords! {
    /// The interpolation between two keyframes.
    #[derive(Default)]
    pub enum Interpolation {
        /// By the same amount in each frame.
        #[default]
        Linear = "linear",
        /// By a cubic curve that begins and ends at rest and never goes beyond the two values.
        Smooth = "smooth",
    }
}
