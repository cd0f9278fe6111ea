//! Writes an array in blocks, compressed in parallel.

use std::io::{self, Seek, SeekFrom, Write};

use rayon::prelude::*;

use crate::array::Array;
use crate::codec::{BLOCK, Compressor};
use crate::windows::{self, N_WINDOWS};

/// Bytes that are compressed at a time: enough blocks for many threads, and little memory compared
/// with a film.
const WINDOW: usize = 16 * BLOCK;

/// Two files are compressed at a time, by all threads: two threads have no time left to generate more.
const LEAST_THREADS: usize = 3;

/// Memory to compress an array, in bytes: windows of blocks, and the blocks of one, compressed to
/// half.
pub const BYTES_PER_ARRAY: u64 = (2 * N_WINDOWS + 1) as u64 * WINDOW as u64 / 2;

/// Returns the numbers before the lengths of an array's compressed blocks: the number of blocks,
/// the size of a block, and the size of the last block if it is shorter, else 0.
pub(super) fn table_head(n_bytes: u64) -> [u64; 3] {
    let block = BLOCK as u64;
    [n_bytes.div_ceil(block), block, n_bytes % block]
}

/// Writes an array at the end of `out`: a table of its blocks' compressed lengths, then the blocks.
/// The bytes do not depend on the number of threads.
pub(super) fn write(
    array: &Array,
    compressor: &dyn Compressor,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let begin = out.stream_position()?;
    let mut table = table_head(array.n_bytes).to_vec();
    let n_blocks = table[0] as usize;
    // Placeholders: the lengths are known after the blocks are written.
    table.resize(table.len() + n_blocks, 0);
    out.write_all(bytemuck::cast_slice(&table))?;

    let mut lengths: Vec<u64> = Vec::with_capacity(n_blocks);
    windows::for_each(array, WINDOW, LEAST_THREADS, |window| {
        let blocks = window.par_chunks(BLOCK);
        let packed: Vec<Vec<u8>> = blocks.map(|block| compressor.compress(block)).collect();
        for block in &packed {
            lengths.push(block.len() as u64);
            out.write_all(block)?;
        }
        Ok(())
    })?;

    // Go back and fill in the table.
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(begin + size_of_val(&table_head(0)) as u64))?;
    out.write_all(bytemuck::cast_slice(&lengths))?;
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::codec::{Codec, compressors};

    #[test]
    fn heads_count_the_last_block() {
        let block = BLOCK as u64;
        assert_eq!(table_head(0), [0, block, 0]);
        assert_eq!(table_head(1), [1, block, 1]);
        assert_eq!(table_head(block), [1, block, 0]);
        assert_eq!(table_head(5 * block + 7), [6, block, 7]);
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bytes() {
        let n = 2 * WINDOW / 4 + 1;
        let written = |compressor: &'static dyn Compressor, n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
            pool.build().unwrap().install(|| {
                let numbers = Array::new("numbers", n, || (0..n as u32).map(|i| i / 3));
                let mut out = Cursor::new(Vec::new());
                out.write_all(b"_").unwrap();
                write(&numbers, compressor, &mut out).unwrap();
                assert_eq!(out.position(), out.get_ref().len() as u64);
                out.into_inner()
            })
        };
        for compressor in compressors() {
            let one = written(compressor, 1);
            assert!(one.len() < 4 * n);
            assert!(one == written(compressor, 3));
        }
    }

    /// Noise is the worst case of compression.
    #[test]
    fn noise_takes_little_more_than_the_expected_memory() {
        let noise = |i: u32| i.wrapping_mul(2_654_435_761).rotate_left(i % 32);
        let noise: Vec<u32> = (0..BLOCK as u32 / 4).map(noise).collect();
        for compressor in compressors() {
            let packed = compressor.compress(bytemuck::cast_slice(&noise));
            let n_bytes = N_WINDOWS * WINDOW + WINDOW / BLOCK * packed.capacity();
            assert!(n_bytes as u64 <= BYTES_PER_ARRAY / 5 * 8, "{compressor:?}");
        }
    }

    #[test]
    fn an_array_of_the_wrong_length_is_an_error() {
        let array = Array {
            n_bytes: 8,
            ..Array::new("short", 1, || [1_u32].into_iter())
        };
        let error = write(
            &array,
            Codec::Lz4.compressor().unwrap(),
            &mut Cursor::new(Vec::new()),
        )
        .unwrap_err();
        assert!(
            error.to_string().contains("4 bytes instead of 8"),
            "{error}"
        );
    }
}
