//! An array of a data set in pieces.

use super::super::{FileFault, Result};
use super::piece::Piece;
use super::{ArrayChoice, ArrayOf};

/// The numbers of an array in the pieces of a data set, some of which may lack it.
#[derive(Default)]
pub(super) struct ArrayOfPieces {
    is_found: bool,
    /// The fault of the first piece without it.
    unknown: Option<FileFault>,
}

impl ArrayOfPieces {
    /// Returns [`Piece::scalars`], or missing numbers if the piece lacks the array.
    pub(super) fn scalars(
        &mut self,
        piece: &Piece,
        choice: &ArrayChoice,
    ) -> Result<(ArrayOf, Vec<f64>)> {
        if let Err(fault) = piece.chosen(choice) {
            self.unknown.get_or_insert(fault);
            return Ok((ArrayOf::Points, vec![f64::NAN; piece.n_points()]));
        }
        self.is_found = true;
        piece.scalars(choice)
    }

    /// Checks that a piece had the array.
    ///
    /// # Errors
    /// No piece had it.
    pub(super) fn check(self) -> Result<()> {
        match self.unknown.filter(|_| !self.is_found) {
            None => Ok(()),
            Some(fault) => Err(fault),
        }
    }
}
