//! Random and quasi-random numbers that depend only on their key.
//!
//! They are hashes, not the output of a generator with state: a sample of a pixel or a sphere of a
//! cloud is the same in any order and on any thread. Pixel samples are generic over
//! [`Real`](crate::simd::Real): for one pixel, or for one per lane.

mod alias;
mod equirectangular;
mod hash;
mod sobol;
mod stratified;
mod sampler;
mod shapes;
mod filter;

pub use alias::{AliasTable, MAX_BINS};
pub use equirectangular::EquirectangularDistribution;
pub use filter::{FilterSampler, PixelFilter};
pub use hash::{uniform, uniform_of_halves};
pub use sampler::{Dimension, PixelPattern, Sampler};
pub use shapes::{Polygon, disk, hemisphere};
