//! Plots: rows of statistics → [`Figure`] → SVG and PNG.

mod figure;
mod series_factors;
mod symbols;
mod axis;
mod roofline;
mod plane;
mod ceilings;
mod labels;
mod legend;
mod bars;
mod drawing;

pub use figure::{Ceiling, Figure, PlotPoint, Series};
