//! Reads the numbers of an array from an open VTK file.

use std::io::{self, BufRead, BufReader};
use std::ops::Range;

use super::reader::{ArrayLocation, Storage, VtkReader, cannot_read};
use super::values::{ArrayValues, Selection, Skip};
use base::numbers::{self, count};
use host::files::PositionedReader;
use host::text::Diagnostic;
use host::{available_memory, may_fail};

impl Skip for BufReader<PositionedReader<'_>> {
    fn skip(&mut self, n: u64) -> io::Result<()> {
        let n_buffered = n.min(self.buffer().len() as u64);
        self.consume(n_buffered as usize);
        self.get_mut().position += n - n_buffered;
        Ok(())
    }
}

impl VtkReader {
    /// Reads an array, in the file's order.
    pub fn read(&self, place: &ArrayLocation) -> Result<ArrayValues, Diagnostic> {
        self.read_rows(place, 1, 0..1)
    }

    /// Reads `rows` of an array that the file stores in `n_rows` equal rows, bottom row first;
    /// returns the upper row first. Reads no other rows, and decompresses only the blocks of these.
    pub fn read_rows(
        &self,
        place: &ArrayLocation,
        n_rows: usize,
        rows: Range<usize>,
    ) -> Result<ArrayValues, Diagnostic> {
        let [numbers_per_row, row_bytes] =
            [place.n_numbers, place.n_bytes].map(|n| n / (n_rows as u64).max(1));
        let first = (n_rows - rows.end) as u64 * row_bytes;
        let fill = |values: &mut ArrayValues, from: &mut dyn Skip| {
            values.read_rows(row_bytes as usize, from)
        };
        self.read_by(place, rows.len() as u64 * numbers_per_row, first, fill)
    }

    /// Reads the selected pixels of an array of an image. Reads no other rows, and decompresses only
    /// the blocks of these.
    pub fn read_selected(
        &self,
        place: &ArrayLocation,
        selection: &Selection,
    ) -> Result<ArrayValues, Diagnostic> {
        let fill =
            |values: &mut ArrayValues, from: &mut dyn Skip| values.read_selected(selection, from);
        self.read_by(place, selection.n_numbers(), 0, fill)
    }

    /// Allocates `n_numbers` zeros and calls `fill` with them and a reader of the array's bytes from
    /// `first`.
    fn read_by(
        &self,
        place: &ArrayLocation,
        n_numbers: u64,
        first: u64,
        fill: impl FnOnce(&mut ArrayValues, &mut dyn Skip) -> io::Result<()>,
    ) -> Result<ArrayValues, Diagnostic> {
        let name = &place.name;
        let mut values = self.zeros(place, n_numbers)?;
        let filled = match &place.storage {
            Storage::Raw(begin) => self.length_at(*begin).and_then(|length| {
                if length != place.n_bytes {
                    return Ok(Some(length));
                }
                let begin = begin + self.encoding.length_bytes as u64;
                let mut from = BufReader::new(self.from(begin + first));
                fill(&mut values, &mut from).map(|()| None)
            }),
            Storage::Compressed(blocks) => blocks
                .decompress(&self.file, first)
                .and_then(|mut from| fill(&mut values, &mut from).map(|()| None)),
        };
        match filled {
            Ok(None) => Ok(values),
            Ok(Some(length)) => {
                let [length, n_bytes] = [length, place.n_bytes].map(count);
                Err(self.foreign(&format!("`{name}` has {length} bytes instead of {n_bytes}")))
            }
            Err(error) if error.kind() == io::ErrorKind::InvalidData => Err(self.damaged(name)),
            Err(error) => Err(cannot_read(&self.path, &error)),
        }
    }

    /// Allocates zeros for an array, if they fit into memory.
    fn zeros(&self, place: &ArrayLocation, n_numbers: u64) -> Result<ArrayValues, Diagnostic> {
        let name = &place.name;
        let n_bytes = n_numbers.saturating_mul(place.n_bytes / place.n_numbers.max(1));
        // The other half of the free memory is for the caller's results.
        let n = usize::try_from(n_numbers).ok();
        let n = n.filter(|_| n_bytes <= available_memory() / 2);
        let values = n.map(|n| may_fail(|| ArrayValues::zeros(place.scalar, n)));
        match values {
            Some(Ok(values)) => Ok(values),
            Some(Err(_)) | None => {
                let (shown, n_bytes) = (self.path.display(), numbers::bytes(n_bytes));
                Err(Diagnostic::new(format!(
                    "not enough memory: the array `{name}` of `{shown}` takes {n_bytes}"
                )))
            }
        }
    }

    fn length_at(&self, begin: u64) -> io::Result<u64> {
        self.encoding.length(&mut self.from(begin))
    }

    fn from(&self, position: u64) -> PositionedReader<'_> {
        let file = &self.file;
        PositionedReader { file, position }
    }
}
