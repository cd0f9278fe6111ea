//! Text for people: error messages, tables, and escapes for the terminal.

mod cell;
mod diagnostic;
mod suggestion;
mod terminal;

pub use cell::{text_cell, text_of_cell};
pub use diagnostic::Diagnostic;
pub use diagnostic::{line_start, shortened, truncated};
pub use suggestion::{did_you_mean, number_meant, why_missing};
pub use terminal::{one_line, print, print_error, print_styled, shell_word, shown};
pub use terminal::{visible, visible_json, wrapped};
