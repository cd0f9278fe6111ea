//! An array of a data set in pieces.

use super::super::choice::rounded_note;
use super::super::{FileFault, Result};
use super::piece::Piece;
use world::material::{ArrayChoice, ArrayOf};

/// The numbers of an array in the pieces of a data set, some of which may lack it.
#[derive(Default)]
pub(super) struct ArrayOfPieces {
    is_found: bool,
    /// The fault of the first piece without it.
    unknown: Option<FileFault>,
    /// The sentence about its numbers if some are rounded.
    note: Option<String>,
}

impl ArrayOfPieces {
    /// Returns [`Piece::scalars`], or missing numbers if the piece lacks the array.
    pub(super) fn scalars(
        &mut self,
        piece: &Piece,
        choice: &ArrayChoice,
    ) -> Result<(ArrayOf, Vec<f64>)> {
        match piece.chosen(choice) {
            Err(fault) => {
                self.unknown.get_or_insert(fault);
                return Ok((ArrayOf::Points, vec![f64::NAN; piece.n_points()]));
            }
            Ok((_, numbers)) if numbers.are_rounded() => self.note = Some(rounded_note(choice)),
            Ok(_) => {}
        }
        self.is_found = true;
        piece.scalars(choice)
    }

    /// Checks that a piece had the array; returns a note if some of its numbers are rounded.
    ///
    /// # Errors
    /// No piece had it.
    pub(super) fn check(self) -> Result<Option<String>> {
        match self.unknown.filter(|_| !self.is_found) {
            None => Ok(self.note),
            Some(fault) => Err(fault),
        }
    }
}
