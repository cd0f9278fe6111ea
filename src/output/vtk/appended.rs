//! Raw arrays behind an XML header.

use std::io::{self, Write};

use vtkio::model::ScalarType;

use super::header::DataSet;

/// Writes an array's bytes.
pub(crate) type WriteBytes<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + 'a>;

/// An array that is written when its turn comes.
pub(crate) struct Array<'a> {
    pub(crate) name: &'a str,
    pub(crate) scalar: ScalarType,
    pub(crate) n_components: usize,
    pub(crate) n_bytes: u64,
    /// Writes exactly `n_bytes`, in native byte order.
    pub(crate) write: WriteBytes<'a>,
}

/// Blanks before the arrays. VTK feeds its XML parser blocks of 4096 bytes, the
/// last one up to the opening tag of the arrays. With expat 2.6, or an older one
/// with its security fixes, many a VTK feeds it the next block too and fails, as
/// that is no XML (VTK issue 19258): ParaView 5.12.0 does, and the ParaView of
/// Debian 12 and of Ubuntu 22.04 to 24.04. Blanks pass.
const N_BLANKS: usize = 2 * 4096;

/// Writes the whole file: `data_set` describes the arrays in their order.
pub(crate) fn write(
    data_set: DataSet,
    arrays: &[&[Array]],
    out: &mut impl Write,
) -> io::Result<()> {
    let arrays: Vec<&Array> = arrays.iter().copied().flatten().collect();
    let header = data_set.xml(&offsets(&arrays))?;
    // The tags stand on lines of their own: vtk.js looks for them that way.
    write!(
        out,
        "<?xml version=\"1.0\"?>\n{header}\n<AppendedData encoding=\"raw\">\n{:N_BLANKS$}_",
        ""
    )?;
    for array in arrays {
        out.write_all(&array.n_bytes.to_ne_bytes())?;
        let mut counted = Counted { out, n_bytes: 0 };
        (array.write)(&mut counted)?;
        if counted.n_bytes != array.n_bytes {
            let (found, name) = (counted.n_bytes, array.name);
            let message = format!("{name}: {found} bytes instead of {}", array.n_bytes);
            return Err(io::Error::other(message));
        }
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

/// Where each array begins: a 64-bit length stands before each.
fn offsets(arrays: &[&Array]) -> Vec<u64> {
    let begins = |next: &mut u64, array: &&Array| {
        let begin = *next;
        *next += size_of::<u64>() as u64 + array.n_bytes;
        Some(begin)
    };
    arrays.iter().scan(0, begins).collect()
}

/// Counts what goes through: a wrong length would shift all that follows.
struct Counted<'a, W> {
    out: &'a mut W,
    n_bytes: u64,
}

impl<W: Write> Write for Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.out.write(bytes)?;
        self.n_bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(n_bytes: u64) -> Array<'static> {
        Array {
            name: "tile",
            scalar: ScalarType::I32,
            n_components: 1,
            n_bytes,
            write: Box::new(|out| out.write_all(&[1, 2, 3, 4])),
        }
    }

    #[test]
    fn offsets_count_beyond_4_gib() {
        let arrays = [array(5 << 30), array(4), array(4)];
        let xml = DataSet::image(2, 1, &arrays)
            .xml(&offsets(&arrays.iter().collect::<Vec<_>>()))
            .unwrap();
        assert!(
            xml.contains("offset=\"0\"") && xml.contains("offset=\"5368709128\""),
            "{xml}"
        );
        assert!(xml.contains("offset=\"5368709140\""), "{xml}");
    }

    #[test]
    fn the_block_that_vtk_may_read_too_many_is_blank() {
        let arrays = [array(4)];
        let data_set = DataSet::image(2, 1, &arrays);
        let mut file = Vec::new();
        write(data_set, &[&arrays], &mut file).unwrap();
        let tag = b"<AppendedData encoding=\"raw\">";
        let begin = file.windows(tag.len()).position(|bytes| bytes == tag);
        let end = begin.unwrap() + tag.len();
        let next_block = end.next_multiple_of(4096);
        assert!(file[end..next_block + 4096].trim_ascii().is_empty());
    }

    #[test]
    fn an_array_of_the_wrong_length_is_an_error() {
        let arrays = [array(8)];
        let data_set = DataSet::image(2, 1, &arrays);
        let error = write(data_set, &[&arrays], &mut Vec::new()).unwrap_err();
        assert!(
            error.to_string().contains("4 bytes instead of 8"),
            "{error}"
        );
    }
}
