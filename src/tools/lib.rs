//! Finished renderings → pages, comparisons, studies and series.
//!
//! In: folders of output, read by [`results`](output::results), and study files. Out: files and
//! tables about them. Nothing here renders: a study runs the program.
//!
//! The modules do not build on each other. [`view`] makes a page for browsers, [`diff`] compares
//! two outputs, [`budget`] holds the totals that a later rendering may not exceed, [`study`] varies factors and plots, [`series`] joins the frames of an animation;
//! [`schema`] describes scene files to editors, [`starter`] has scenes to start from.

pub mod view;
pub mod diff;
pub mod budget;
pub mod study;
pub mod series;
pub mod schema;
pub mod starter;
