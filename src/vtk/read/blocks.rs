//! Decompresses the blocks of an array.

use std::fs::File;
use std::io::{self, BufReader, Read};

use super::encoded::ArrayEncoding;
use super::values::Skip;
use crate::codec::{BLOCK, Compressor};
use crate::compressed::table_head;
use host::files::PositionedReader;

/// Maximum number of bytes of a compressed block: noise grows a little under compression.
const MAX_COMPRESSED: u64 = (BLOCK + BLOCK / 64) as u64;

/// The compressed blocks of an array in a file that raycost wrote.
#[derive(Debug)]
pub(super) struct CompressedBlocks {
    compressor: &'static dyn Compressor,
    /// Bytes of the array, uncompressed.
    n_bytes: u64,
    /// Offset of the first block in the file.
    begin: u64,
    /// Bytes of each compressed block.
    lengths: Vec<u64>,
    /// Offset of the end of the last block in the file.
    pub(super) end: u64,
}

impl CompressedBlocks {
    /// Reads the block table at offset `begin` of an array of `n_bytes`; `None` if the table does
    /// not match such an array: the number of blocks is wrong, or the compression ratio is
    /// impossible.
    ///
    /// # Errors
    /// The file ends before the table does, or cannot be read.
    pub(super) fn at(
        begin: u64,
        n_bytes: u64,
        encoding: &ArrayEncoding,
        compressor: &'static dyn Compressor,
        file: &File,
    ) -> io::Result<Option<Self>> {
        let position = begin;
        let mut from = BufReader::new(PositionedReader { file, position });
        let head = encoding.table_head(&mut from)?;
        if head != table_head(n_bytes) {
            return Ok(None);
        }
        let lengths = encoding.table(head, &mut from)?;
        let begin = begin + (encoding.length_bytes * (head.len() + lengths.len())) as u64;
        let n_compressed: u64 = lengths.iter().map(|&n| n.min(MAX_COMPRESSED + 1)).sum();
        let is_too_long = lengths.iter().any(|&n| n > MAX_COMPRESSED);
        if is_too_long || n_compressed.saturating_mul(compressor.max_ratio()) < n_bytes {
            return Ok(None);
        }
        Ok(Some(Self {
            compressor,
            n_bytes,
            begin,
            lengths,
            end: begin + n_compressed,
        }))
    }

    /// Returns a reader of the array's uncompressed bytes from `first`.
    pub(super) fn decompress<'a>(
        &'a self,
        file: &'a File,
        first: u64,
    ) -> io::Result<Decompressed<'a>> {
        let n_blocks = (first / BLOCK as u64).min(self.lengths.len() as u64);
        let (before, lengths) = self.lengths.split_at(n_blocks as usize);
        let position = self.begin + before.iter().sum::<u64>();
        let mut decompressed = Decompressed {
            from: PositionedReader { file, position },
            compressor: self.compressor,
            n_left: self.n_bytes - n_blocks * BLOCK as u64,
            lengths: lengths.iter(),
            compressed: Vec::new(),
            block: Vec::new(),
            n_read: 0,
        };
        let n_skipped = first - n_blocks * BLOCK as u64;
        if n_skipped > 0 {
            decompressed.advance()?;
            decompressed.n_read = n_skipped as usize;
        }
        Ok(decompressed)
    }
}

/// Reads the bytes of an array, decompressing one block at a time.
pub(super) struct Decompressed<'a> {
    from: PositionedReader<'a>,
    compressor: &'static dyn Compressor,
    /// Uncompressed bytes of the blocks not yet read.
    n_left: u64,
    /// Compressed bytes of the blocks not yet read.
    lengths: std::slice::Iter<'a, u64>,
    compressed: Vec<u8>,
    block: Vec<u8>,
    /// Bytes of `block` already returned.
    n_read: usize,
}

impl Decompressed<'_> {
    /// Decompresses the next block; at the end `block` is empty.
    fn advance(&mut self) -> io::Result<()> {
        let n_bytes = self.n_left.min(BLOCK as u64);
        self.n_left -= n_bytes;
        self.n_read = 0;
        self.block.resize(n_bytes as usize, 0);
        if let Some(&length) = self.lengths.next() {
            let (compressed, block) = (&mut self.compressed, &mut self.block);
            self.compressor
                .decompress_from(&mut self.from, length, compressed, block)?;
        }
        Ok(())
    }
}

impl Skip for Decompressed<'_> {
    fn skip(&mut self, mut n: u64) -> io::Result<()> {
        loop {
            let rest = (self.block.len() - self.n_read) as u64;
            if n <= rest {
                self.n_read += n as usize;
                return Ok(());
            }
            n -= rest;
            match self.lengths.as_slice() {
                [] => return Err(io::ErrorKind::UnexpectedEof.into()),
                // Nothing of the next block is wanted.
                [length, _, ..] if n >= BLOCK as u64 => {
                    self.lengths.next();
                    self.from.position += length;
                    self.n_left -= BLOCK as u64;
                    self.n_read = self.block.len();
                    n -= BLOCK as u64;
                }
                _ => self.advance()?,
            }
        }
    }
}

impl Read for Decompressed<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if self.n_read == self.block.len() {
            self.advance()?;
        }
        let n = (&self.block[self.n_read..]).read(into)?;
        self.n_read += n;
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use proptest::prelude::*;

    use super::*;
    use crate::Codec;
    use crate::appended;
    use crate::array::Array;
    use crate::data_set::{CellMesh, DataSet};
    use crate::read::{DataArrayElement, Selection, VtkReader};

    /// Lengths around multiples of the block size, and any others.
    fn lengths() -> impl Strategy<Value = usize> {
        let blocks = prop::sample::select(vec![0, 1, 2, 15, 16, 17, 32]);
        let near = (blocks, -1..=1_isize);
        prop_oneof![
            near.prop_map(|(n, more)| (n * BLOCK).saturating_add_signed(more)),
            0..3 * BLOCK,
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Runs of noise and of zeros survive compression, and rows can be left out.
        #[test]
        fn decompression_inverts_compression(
            n in lengths(),
            stretch in 1..1000_usize,
            seed: u32,
            width in 1..9000_usize,
            step in 1..200_usize,
        ) {
            let noise = |i: usize| (seed ^ i as u32).wrapping_mul(2_654_435_761) >> 24;
            let is_noise = |i: usize| (i / stretch).is_multiple_of(2);
            let bytes: Vec<u8> = (0..n).map(|i| is_noise(i) as u8 * noise(i) as u8).collect();
            // As an image, whose bottom row comes first.
            let bytes = &bytes[..n - n % width];
            let size = [width, n / width];
            let rows: Vec<u32> = (0..size[1] as u32).step_by(step).collect();
            let last = [width as u32 - 1];
            let last_of_rows: Vec<u8> = rows.iter().map(|&y| bytes[(size[1] - y as usize) * width - 1]).collect();
            let selection = Selection { size, n_components: 1, columns: &last, rows: &rows };
            for codec in [Codec::None, Codec::Lz4, Codec::Zlib] {
                let (found, points, selected) = written_and_read(bytes, codec, &selection);
                prop_assert!(found == bytes, "{codec:?}");
                prop_assert!(points.iter().flatten().zip(0..).all(|(&x, i)| x == i as f32));
                prop_assert!(selected == last_of_rows, "{codec:?}");
            }
        }
    }

    /// Writes and reads the bytes as a point array; also returns the points, and the selected bytes.
    fn written_and_read(
        bytes: &[u8],
        codec: Codec,
        selection: &Selection,
    ) -> (Vec<u8>, Vec<[f32; 3]>, Vec<u8>) {
        let n = bytes.len();
        let point = |i: usize| [0, 1, 2].map(|j| (3 * i + j) as f32);
        let cloud = CellMesh {
            n_points: n,
            n_cells: 0,
            point_data: vec![Array::new("bytes", n, || bytes.iter().copied())],
            cell_data: Vec::new(),
            points: Array::new("Points", n, || (0..n).map(point)),
            cells: Vec::new(),
        };
        let mut file = tempfile::NamedTempFile::new().unwrap();
        appended::write(&DataSet::Grid(cloud), codec.into(), &mut file).unwrap();
        file.flush().unwrap();
        let (file, header) = VtkReader::open(file.path()).unwrap();
        let piece = header.grid.unwrap();
        assert_eq!(piece.n_points, n as u64);
        let read = |arrays: &[DataArrayElement]| {
            let location = file.place(&arrays[0], n as u64).unwrap();
            file.read(&location).unwrap()
        };
        let points = read(&piece.points);
        let points = points.as_slice::<f32>().unwrap().as_chunks().0.to_vec();
        let location = file.place(&piece.point_data[0], n as u64).unwrap();
        let selected = file.read_selected(&location, selection).unwrap();
        let selected = selected.bytes().to_vec();
        (read(&piece.point_data).bytes().to_vec(), points, selected)
    }
}
