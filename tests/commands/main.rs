//! The command line and its messages; the examples, the book and the architecture.

#[path = "../common/mod.rs"]
mod common;

#[cfg(unix)]
mod action;
mod architecture;
mod beginners;
mod benches;
mod book;
mod budget;
mod choices;
mod configs;
mod cost_law;
mod course;
mod diff;
mod errors;
mod examples;
mod exit_codes;
mod figures;
mod fuzz;
mod gallery;
mod include;
mod json;
mod limits;
mod mutations;
mod new;
mod package;
mod pinning;
mod prediction;
mod reference;
mod resolved;
mod roofline;
mod schema;
mod settings;
mod study;
mod terminal;
mod trace;
mod version;
