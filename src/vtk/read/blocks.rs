//! The blocks of a compressed array.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use crate::vtk::compressor::{BLOCK, Compressor, table_head};

/// Most bytes of a packed block: noise takes a little more than before.
const MAX_PACKED: u64 = (BLOCK + BLOCK / 64) as u64;
/// Bytes of a number of a table.
const NUMBER_BYTES: u64 = size_of::<u64>() as u64;

/// Where the blocks of an array are.
#[derive(Debug)]
pub(super) struct Blocks {
    compressor: Compressor,
    /// Bytes before they were packed.
    n_bytes: u64,
    /// Where the first one begins in the file.
    begin: u64,
    /// Those of the packed blocks.
    lengths: Vec<u64>,
    /// Where the last one ends in the file.
    pub(super) end: u64,
}

impl Blocks {
    /// Reads the table at `begin` of an array of `n_bytes`; `None` if there is
    /// none of such an array: its blocks are too few, or so short or long that
    /// no packing makes such of so many bytes.
    ///
    /// # Errors
    /// If the file ends before it does, or what the system says.
    pub(super) fn at(
        begin: u64,
        n_bytes: u64,
        compressor: Compressor,
        mut file: &File,
    ) -> io::Result<Option<Self>> {
        file.seek(SeekFrom::Start(begin))?;
        let mut from = BufReader::new(file);
        let head = table_head(n_bytes);
        for expected in head {
            if read_number(&mut from)? != expected {
                return Ok(None);
            }
        }
        // One by one: a table that the file does not hold takes no memory.
        let lengths = (0..head[0]).map(|_| read_number(&mut from));
        let lengths = lengths.collect::<io::Result<Vec<u64>>>()?;
        let begin = begin + NUMBER_BYTES * (head.len() + lengths.len()) as u64;
        let n_packed: u64 = lengths.iter().map(|&n| n.min(MAX_PACKED + 1)).sum();
        let is_too_long = lengths.iter().any(|&n| n > MAX_PACKED);
        if is_too_long || n_packed.saturating_mul(compressor.max_ratio()) < n_bytes {
            return Ok(None);
        }
        Ok(Some(Self {
            compressor,
            n_bytes,
            begin,
            lengths,
            end: begin + n_packed,
        }))
    }

    /// Gives the array's bytes as they were before they were packed.
    pub(super) fn unpack<'a>(&'a self, mut file: &'a File) -> io::Result<Unpacked<'a>> {
        file.seek(SeekFrom::Start(self.begin))?;
        Ok(Unpacked {
            from: file,
            compressor: self.compressor,
            n_left: self.n_bytes,
            lengths: self.lengths.iter(),
            packed: Vec::new(),
            block: Vec::new(),
            n_read: 0,
        })
    }
}

fn read_number(from: &mut impl Read) -> io::Result<u64> {
    let mut bytes = [0; NUMBER_BYTES as usize];
    from.read_exact(&mut bytes)?;
    Ok(u64::from_ne_bytes(bytes))
}

/// The bytes of an array, unpacked block by block.
pub(super) struct Unpacked<'a> {
    from: &'a File,
    compressor: Compressor,
    /// Bytes of blocks that are still packed, once they are not.
    n_left: u64,
    /// Those of these blocks.
    lengths: std::slice::Iter<'a, u64>,
    packed: Vec<u8>,
    block: Vec<u8>,
    /// Bytes of the block that were given away.
    n_read: usize,
}

impl Unpacked<'_> {
    /// Unpacks the next block, or an empty one at the end.
    fn advance(&mut self) -> io::Result<()> {
        let n_bytes = self.n_left.min(BLOCK as u64);
        self.n_left -= n_bytes;
        self.n_read = 0;
        self.block.resize(n_bytes as usize, 0);
        if let Some(&length) = self.lengths.next() {
            self.packed.clear();
            self.from.take(length).read_to_end(&mut self.packed)?;
            self.compressor.unpack(&self.packed, &mut self.block)?;
        }
        Ok(())
    }
}

impl Read for Unpacked<'_> {
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
    use crate::results::Hits;
    use crate::vtk::Codec;
    use crate::vtk::appended;
    use crate::vtk::array::Array;
    use crate::vtk::header::{DataSet, Mesh};

    /// Lengths around the ends of blocks, and any others.
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

        /// Stretches of noise and of nothing come back as they were written.
        #[test]
        fn what_is_packed_is_unpacked(n in lengths(), stretch in 1..1000_usize, seed: u32) {
            let noise = |i: usize| (seed ^ i as u32).wrapping_mul(2_654_435_761) >> 24;
            let is_noise = |i: usize| (i / stretch).is_multiple_of(2);
            let bytes: Vec<u8> = (0..n).map(|i| is_noise(i) as u8 * noise(i) as u8).collect();
            for codec in [Codec::None, Codec::Lz4, Codec::Zlib] {
                let (found, points) = written_and_read(&bytes, codec);
                prop_assert!(found == bytes, "{codec:?}");
                prop_assert!(points.iter().flatten().zip(0..).all(|(&x, i)| x == i as f32));
            }
        }
    }

    /// The bytes as an array of points, and the points.
    fn written_and_read(bytes: &[u8], codec: Codec) -> (Vec<u8>, Vec<[f32; 3]>) {
        let n = bytes.len();
        let point = |i: usize| [0, 1, 2].map(|j| (3 * i + j) as f32);
        let cloud = Mesh {
            n_points: n,
            n_cells: 0,
            point_data: vec![Array::of("bytes", n, || bytes.iter().copied())],
            cell_data: Vec::new(),
            points: Array::of("Points", n, || (0..n).map(point)),
            cells: Vec::new(),
        };
        let mut file = tempfile::NamedTempFile::new().unwrap();
        appended::write(&DataSet::Grid(cloud), codec.into(), &mut file).unwrap();
        file.flush().unwrap();
        let mut hits = Hits::open(file.path()).unwrap();
        assert_eq!(hits.n_points(), n);
        let array = hits.read("bytes").unwrap();
        (array.values.bytes().to_vec(), hits.read_points().unwrap())
    }
}
