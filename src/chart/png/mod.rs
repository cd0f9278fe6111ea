//! Writes a picture as a PNG on all threads, fast rather than small.
//!
//! A PNG is a zlib stream of filtered rows (ISO/IEC 15948). Strips of rows are filtered
//! and compressed independently of each other into deflate blocks that end with a whole
//! byte, so that the stream is the sequence of all strips: the file has the same bytes on
//! any number of threads.

mod bits;
mod deflate;
mod filter;
mod huffman;

use std::io::{self, Write};

use rayon::prelude::*;

/// Bytes of rows in a strip: enough that its Huffman code takes little of it.
const STRIP: usize = 1 << 18;

const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// Deflate with a window of 32 KiB, the fastest level.
const ZLIB_HEADER: [u8; 2] = [0x78, 0x01];

/// Writes a picture of `width * height` pixels from its rows, row 0 on top. A pixel has
/// three bytes, or six for 16 bits per channel, the high byte first.
/// `texts` are text chunks, keyword and ASCII text. Compresses on the current rayon pool.
pub(crate) fn write(
    [width, height]: [u32; 2],
    rows: &[&[u8]],
    texts: &[(&str, &str)],
    out: &mut impl Write,
) -> io::Result<()> {
    let row_bytes = rows.first().map_or(0, |row| row.len());
    let mut png = PngWriter::begin([width, height], row_bytes / width as usize, texts, out)?;
    png.add(rows)
}

/// Writes a picture some rows at a time. The file is the same whatever their numbers are.
pub(crate) struct PngWriter<'a, W> {
    out: &'a mut W,
    height: usize,
    pixel_bytes: usize,
    /// Rows of a strip.
    n_rows: usize,
    /// Rows that were written.
    n_written: usize,
    /// The last of them, and those behind it that do not fill a strip yet.
    last_written: Vec<u8>,
    pending: Vec<Vec<u8>>,
    checksum: u32,
}

impl<'a, W: Write> PngWriter<'a, W> {
    /// Begins a picture of `width * height` pixels of so many bytes.
    pub(crate) fn begin(
        [width, height]: [u32; 2],
        pixel_bytes: usize,
        texts: &[(&str, &str)],
        out: &'a mut W,
    ) -> io::Result<Self> {
        out.write_all(&SIGNATURE)?;
        // Bits per channel; red, green and blue; deflate, filters by row, not interlaced.
        let kind = [8 * pixel_bytes as u8 / 3, 2, 0, 0, 0];
        let [width_bytes, height_bytes] = [width, height].map(u32::to_be_bytes);
        write_chunk(b"IHDR", &[&width_bytes, &height_bytes, &kind], out)?;
        for (keyword, text) in texts {
            write_chunk(b"tEXt", &[keyword.as_bytes(), &[0], text.as_bytes()], out)?;
        }
        let row_bytes = pixel_bytes * width as usize;
        Ok(Self {
            out,
            height: height as usize,
            pixel_bytes,
            n_rows: (STRIP / row_bytes.max(1)).max(1),
            n_written: 0,
            last_written: Vec::new(),
            pending: Vec::new(),
            checksum: 1,
        })
    }

    /// Adds the next rows; the last ones end the picture.
    pub(crate) fn add(&mut self, rows: &[&[u8]]) -> io::Result<()> {
        let pending = std::mem::take(&mut self.pending);
        let rows: Vec<&[u8]> = pending
            .iter()
            .map(Vec::as_slice)
            .chain(rows.iter().copied())
            .collect();
        let is_end = self.n_written + rows.len() == self.height;
        let n_whole = if is_end {
            rows.len()
        } else {
            rows.len() - rows.len() % self.n_rows
        };
        let (whole, rest) = rows.split_at(n_whole);
        self.write_strips(whole)?;
        self.pending = rest.iter().map(|row| row.to_vec()).collect();
        if is_end {
            write_chunk(b"IEND", &[], self.out)?;
        }
        Ok(())
    }

    /// Writes rows that fill strips, or are the last ones.
    fn write_strips(&mut self, rows: &[&[u8]]) -> io::Result<()> {
        let above = (self.n_written > 0).then_some(&self.last_written[..]);
        let is_end = self.n_written + rows.len() == self.height;
        let strips = strips(above, rows, self.pixel_bytes, self.n_rows, is_end);
        let last = strips.len().saturating_sub(1);
        for (i, strip) in strips.iter().enumerate() {
            self.checksum = joined(self.checksum, strip);
            let is_first = self.n_written == 0 && i == 0;
            let header: &[u8] = if is_first { &ZLIB_HEADER } else { &[] };
            let checksum_bytes = self.checksum.to_be_bytes();
            let trailer: &[u8] = if is_end && i == last {
                &checksum_bytes
            } else {
                &[]
            };
            write_chunk(b"IDAT", &[header, &strip.compressed, trailer], self.out)?;
        }
        self.n_written += rows.len();
        if let Some(last) = rows.last() {
            self.last_written = last.to_vec();
        }
        Ok(())
    }
}

/// Filtered and compressed rows.
struct CompressedRows {
    compressed: Vec<u8>,
    /// Bytes of the filtered rows, and their Adler-32 checksum.
    n_bytes: usize,
    checksum: u32,
}

/// Compresses rows below `above` in strips of `n_rows`; the last one ends the stream if
/// `is_end`.
fn strips(
    above: Option<&[u8]>,
    rows: &[&[u8]],
    pixel_bytes: usize,
    n_rows: usize,
    is_end: bool,
) -> Vec<CompressedRows> {
    let n_strips = rows.len().div_ceil(n_rows);
    let strip = |i: usize| {
        let first = i * n_rows;
        let above = first
            .checked_sub(1)
            .map_or(above, |above| Some(rows[above]));
        let rows = &rows[first..rows.len().min(first + n_rows)];
        let filtered = filter::filtered(above, rows, pixel_bytes);
        CompressedRows {
            compressed: deflate::compressed(&filtered, is_end && i + 1 == n_strips),
            n_bytes: filtered.len(),
            checksum: simd_adler32::adler32(&&filtered[..]),
        }
    };
    (0..n_strips).into_par_iter().map(strip).collect()
}

/// The Adler-32 checksum of a stream with this checksum and of a strip behind it
/// (RFC 1950).
fn joined(checksum: u32, strip: &CompressedRows) -> u32 {
    const PRIME: u64 = 65_521;
    let halves = |checksum: u32| [checksum & 0xffff, checksum >> 16].map(u64::from);
    let ([a, b], [a_strip, b_strip]) = (halves(checksum), halves(strip.checksum));
    // Each checksum begins with 1: the strip's would have begun with `a`.
    let excess = a + PRIME - 1;
    let n_bytes = strip.n_bytes as u64 % PRIME;
    let [a, b] = [a_strip + excess, b + b_strip + n_bytes * excess].map(|sum| sum % PRIME);
    (b << 16 | a) as u32
}

/// Writes a chunk: length, type, content and CRC-32.
fn write_chunk(kind: &[u8; 4], parts: &[&[u8]], out: &mut impl Write) -> io::Result<()> {
    let n_bytes: usize = parts.iter().map(|part| part.len()).sum();
    let n_bytes = u32::try_from(n_bytes).map_err(io::Error::other)?;
    out.write_all(&n_bytes.to_be_bytes())?;
    let mut checksum = crc32fast::Hasher::new();
    for part in [&kind[..]].iter().chain(parts) {
        checksum.update(part);
        out.write_all(part)?;
    }
    out.write_all(&checksum.finalize().to_be_bytes())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The pixels and the texts of a PNG, by another implementation.
    fn decoded(file: &[u8]) -> (Vec<u8>, Vec<(String, String)>) {
        let mut reader = png::Decoder::new(io::Cursor::new(file))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        reader.finish().unwrap();
        let texts = reader.info().uncompressed_latin1_text.iter();
        let texts = texts.map(|chunk| (chunk.keyword.clone(), chunk.text.clone()));
        (pixels, texts.collect())
    }

    fn encoded(size: [u32; 2], pixels: &[u8], texts: &[(&str, &str)]) -> Vec<u8> {
        let rows: Vec<&[u8]> = pixels
            .chunks_exact(pixels.len() / size[1] as usize)
            .collect();
        let mut file = Vec::new();
        write(size, &rows, texts, &mut file).unwrap();
        file
    }

    /// Pixels between flat and random ones.
    fn pixels([width, height]: [u32; 2], noise: u32) -> Vec<u8> {
        let pixel = |i: u32| {
            let (x, y) = (i % width, i / width);
            let random = i.wrapping_mul(2_654_435_761) >> 24;
            [x / 3, y / 5, x + y].map(|channel| (channel + random % noise) as u8)
        };
        (0..width * height).flat_map(pixel).collect()
    }

    #[test]
    fn a_picture_of_many_strips_is_read_by_others() {
        for noise in [1, 2, 256] {
            let size = [300, 700];
            let pixels = pixels(size, noise);
            let texts = [("raycost_run", "7"), ("ParaViewState", "<a/>")];
            let file = encoded(size, &pixels, &texts);
            let (found, found_texts) = decoded(&file);
            assert!(found == pixels);
            let expected = texts.map(|(keyword, text)| (keyword.to_owned(), text.to_owned()));
            assert_eq!(found_texts, expected);
        }
    }

    #[test]
    fn rows_that_come_in_parts_make_the_same_file() {
        for (size, parts) in [
            ([300, 700], [1, 290, 301, 302]),
            ([50_000, 9], [2, 3, 4, 8]),
        ] {
            let pixels = pixels(size, 5);
            let rows: Vec<&[u8]> = pixels.chunks_exact(3 * size[0] as usize).collect();
            let mut file = Vec::new();
            let mut png = PngWriter::begin(size, 3, &[("a", "b")], &mut file).unwrap();
            let mut begin = 0;
            for end in parts.into_iter().chain([rows.len()]) {
                png.add(&rows[begin..end]).unwrap();
                begin = end;
            }
            assert!(file == encoded(size, &pixels, &[("a", "b")]));
        }
    }

    #[test]
    fn pixels_of_six_bytes_have_16_bits_per_channel() {
        let pixels = pixels([300, 700], 3);
        let file = encoded([150, 700], &pixels, &[]);
        let reader = png::Decoder::new(io::Cursor::new(&file)).read_info();
        assert_eq!(reader.unwrap().info().bit_depth, png::BitDepth::Sixteen);
        assert!(decoded(&file).0 == pixels);
    }

    #[test]
    fn threads_change_no_byte() {
        let size = [200, 900];
        let pixels = pixels(size, 7);
        let on = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
            (pool.build().unwrap()).install(|| encoded(size, &pixels, &[]))
        };
        assert!(on(1) == on(3));
    }

    proptest! {
        #[test]
        fn small_pictures_are_read_by_others(
            width in 1..20_u32,
            bytes in prop::collection::vec(prop_oneof![3 => Just(0_u8), 1 => any::<u8>()], 60..400),
        ) {
            let height = bytes.len() as u32 / (3 * width);
            prop_assume!(height > 0);
            let pixels = &bytes[..(3 * width * height) as usize];
            let file = encoded([width, height], pixels, &[]);
            prop_assert_eq!(decoded(&file).0, pixels);
        }
    }
}
