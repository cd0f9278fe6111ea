//! Finished renderings -> pages, comparisons, studies and series.

pub mod view;
pub mod diff;
pub mod study;
pub mod series;
pub mod schema;
pub mod starter;
