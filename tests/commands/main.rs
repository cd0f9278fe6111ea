//! What a user types and what comes back; the examples and the shape of the source.

#[path = "../common/mod.rs"]
mod common;

mod architecture;
mod benches;
mod book;
mod configs;
mod cost_law;
mod diff;
mod errors;
mod exit_codes;
mod figures;
mod fuzz;
mod limits;
mod mutations;
mod roofline;
mod study;
mod terminal;
mod trace;
