//! A study file → many runs of `raycost render` → statistics.
//!
//! Takes a [`Plan`]: scenes, what to vary, how often. Each run is a process of
//! its own, so that none leaves memory, caches or threads to the next, and what
//! is measured is what users run. The runs of all points are shuffled round by
//! round: what drifts in the machine falls on all alike (Hoefler and Belli,
//! "Scientific Benchmarking of Parallel Computing Systems", SC15, rules 4 and
//! 9). Every run is appended to [`Results`] when it ends, and never made again.

mod factor;
mod plan;
mod point;
mod results;
mod metrics;
mod table;
mod fit;
mod limits;
mod sweep;
mod bound;
mod apart;
mod figure;
mod roofline;
mod ink;
mod axis;
mod label;
mod ceiling;
mod legend;
mod plot;

pub use bound::{Bound, Standing, standings, verdict};
pub use factor::{Factor, Level};
pub use figure::{Ceiling, Figure, Mark, Plot, Scale, Series};
pub use fit::{CostLaw, PowerLaw, Sample};
pub use limits::{Block, Cache, Limits, MemoryLevel};
pub use metrics::Metrics;
pub use plan::{Case, Plan, Quick, Turn, Vary};
pub use point::Point;
pub use results::{Results, Run};
pub use table::{Row, rows, write_csv};
