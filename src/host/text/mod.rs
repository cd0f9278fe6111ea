//! Text for people: error messages, tables, and escapes for the terminal.

mod cell;
mod diagnostic;
mod suggestion;
mod missing;
mod terminal;

pub use cell::{text_cell, text_of_cell};
pub use diagnostic::Diagnostic;
pub use diagnostic::{line_start, shortened};
pub use missing::why_missing;
pub use suggestion::did_you_mean;
pub use suggestion::number_meant;
pub use terminal::{one_line, print, print_error, print_styled, shell_word, shown};
pub use terminal::{visible, visible_json, wrapped};
