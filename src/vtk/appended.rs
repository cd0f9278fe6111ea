//! Writes a file: an XML header, then the arrays as appended data, raw or in
//! compressed blocks.

use std::io::{self, Seek, SeekFrom, Write};

use crate::array::Array;
use crate::codec::Compressor;
use crate::compressed;
use crate::data_set::DataSet;
use crate::encoding::Encoding;
use crate::header::{LabeledDataSet, Offsets};
use crate::windows::{self, N_WINDOWS};

/// Blanks before the arrays. VTK feeds its XML parser blocks of 4096 bytes, the last one up to the
/// opening tag of the arrays. With expat 2.6, or an older one with its security fixes, many
/// versions of VTK also feed it the next block and fail, since that is not XML (VTK issue 19258):
/// among them ParaView 5.12.0 and the ParaView of Debian 12 and of Ubuntu 22.04 to 24.04. Blanks
/// are accepted.
const N_BLANKS: usize = 2 * 4096;

/// Bytes of a raw array that are generated while others are written: with less, the threads wait for
/// each other more often than the cache saves.
const WINDOW: usize = 1 << 20;

/// Memory to write a raw array, in bytes.
pub const BYTES_PER_ARRAY: u64 = (N_WINDOWS * WINDOW) as u64;

/// Writes a whole file to `out`, which must be empty.
///
/// # Errors
/// An array has the wrong length, or `out` fails.
pub fn write(
    data_set: &DataSet,
    encoding: Encoding,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let labeled = LabeledDataSet::new(data_set, &encoding);
    match encoding.codec.compressor() {
        None => write_raw(&labeled, out),
        Some(compressor) => write_compressed(&labeled, compressor, out),
    }
}

fn write_raw(labeled: &LabeledDataSet, out: &mut impl Write) -> io::Result<()> {
    let arrays = labeled.arrays();
    write_head(&labeled.xml(&Offsets::OfRaw(offsets(&arrays)))?, out)?;
    for array in arrays {
        out.write_all(&array.n_bytes.to_ne_bytes())?;
        windows::for_each(array, WINDOW, 2, |window| out.write_all(window))?;
    }
    write_tail(out)
}

/// Writes compressed arrays. The offset of an array is known only after the arrays before it are
/// compressed, so the header is written again at the end, with the same length.
fn write_compressed(
    labeled: &LabeledDataSet,
    compressor: &dyn Compressor,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let arrays = labeled.arrays();
    let head = |offsets| labeled.xml(&Offsets::OfCompressed(compressor, offsets));
    write_head(&head(vec![0; arrays.len()])?, out)?;
    let begin = out.stream_position()?;
    let mut offsets = Vec::with_capacity(arrays.len());
    for array in arrays {
        offsets.push(out.stream_position()? - begin);
        compressed::write(array, compressor, out)?;
    }
    write_tail(out)?;
    out.rewind()?;
    write_head(&head(offsets)?, out)?;
    out.seek(SeekFrom::End(0))?;
    Ok(())
}

/// Writes everything before the arrays.
fn write_head(xml: &str, out: &mut impl Write) -> io::Result<()> {
    // vtk.js expects the tags on separate lines.
    write!(
        out,
        "<?xml version=\"1.0\"?>\n{xml}\n<AppendedData encoding=\"raw\">\n{:N_BLANKS$}_",
        ""
    )
}

fn write_tail(out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

/// Returns the offset of each raw array, which begins with its 64-bit length.
fn offsets(arrays: &[&Array]) -> Vec<u64> {
    let begins = |next: &mut u64, array: &&Array| {
        let begin = *next;
        *next += size_of::<u64>() as u64 + array.n_bytes;
        Some(begin)
    };
    arrays.iter().scan(0, begins).collect()
}

#[cfg(test)]
mod tests {
    use vtkio::model::ScalarType;

    use super::*;
    use crate::Codec;
    use crate::data_set::Extent;

    fn image(arrays: &[u64]) -> DataSet<'static> {
        let array = |&n_bytes| Array {
            name: "tile",
            scalar: ScalarType::I32,
            n_components: 1,
            n_bytes,
            unit: None,
            write: Box::new(|out| out.write_all(&[1, 2, 3, 4])),
        };
        DataSet::Image {
            extent: Extent::of_size([2, 1]),
            point_data: arrays.iter().map(array).collect(),
        }
    }

    #[test]
    fn offsets_count_beyond_4_gib() {
        let data_set = image(&[5 << 30, 4, 4]);
        let encoding = Codec::None.into();
        let labeled = LabeledDataSet::new(&data_set, &encoding);
        let offsets = Offsets::OfRaw(offsets(&labeled.arrays()));
        let xml = labeled.xml(&offsets).unwrap();
        assert!(
            xml.contains("offset=\"0\"") && xml.contains("offset=\"5368709128\""),
            "{xml}"
        );
        assert!(xml.contains("offset=\"5368709140\""), "{xml}");
    }

    #[test]
    fn the_block_that_vtk_may_read_too_many_is_blank() {
        let mut file = Vec::new();
        let data_set = image(&[4]);
        let encoding = Codec::None.into();
        let labeled = LabeledDataSet::new(&data_set, &encoding);
        write_raw(&labeled, &mut file).unwrap();
        let tag = b"<AppendedData encoding=\"raw\">";
        let begin = file.windows(tag.len()).position(|bytes| bytes == tag);
        let end = begin.unwrap() + tag.len();
        let next_block = end.next_multiple_of(4096);
        assert!(file[end..next_block + 4096].trim_ascii().is_empty());
    }

    #[test]
    fn an_array_of_the_wrong_length_is_an_error() {
        let data_set = image(&[8]);
        let encoding = Codec::None.into();
        let labeled = LabeledDataSet::new(&data_set, &encoding);
        let error = write_raw(&labeled, &mut Vec::new()).unwrap_err();
        assert!(
            error.to_string().contains("4 bytes instead of 8"),
            "{error}"
        );
    }
}
