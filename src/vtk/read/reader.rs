//! Opens a VTK file and reads its arrays.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use vtkio::model::ScalarType;

use super::blocks::CompressedBlocks;
use super::encoded::ArrayEncoding;
use super::header::{DataArrayElement, VtkHeader};
use super::values::scalar_of;
use crate::codec::Compressor;
use base::numbers::count;
use host::files;
use host::text::Diagnostic;

/// Maximum number of bytes of a header; raycost's headers have a few thousand, and the names of
/// objects and materials.
const MAX_HEADER: u64 = 1 << 21;
/// Bytes of a header that are read at a time.
const HEAD_STEP: u64 = 1 << 16;
/// The element that holds the arrays.
const APPENDED: &[u8] = b"<AppendedData encoding=\"raw\">";

/// An open VTK file.
#[derive(Debug)]
pub struct VtkReader {
    /// The file's path, for messages.
    pub path: PathBuf,
    pub(super) file: File,
    n_bytes: u64,
    /// The position in the file that array offsets are relative to.
    begin: u64,
    /// The id of the run that wrote the file, if the file has one.
    pub run: Option<String>,
    pub(super) encoding: ArrayEncoding,
}

/// The location of an array in the file.
#[derive(Debug)]
pub struct ArrayLocation {
    pub(super) name: String,
    /// The type of its numbers.
    pub scalar: ScalarType,
    pub(super) n_numbers: u64,
    pub(super) n_bytes: u64,
    pub(super) storage: Storage,
    /// Byte range in the file.
    span: [u64; 2],
}

/// How the file stores the bytes of an array.
#[derive(Debug)]
pub(super) enum Storage {
    /// Uncompressed, after their length at this position.
    Raw(u64),
    /// In compressed blocks.
    Compressed(CompressedBlocks),
}

/// Reads the bytes up to the appended data and some more, or as many as a header may have.
fn read_head(file: &File) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    loop {
        let n_before = head.len();
        file.take(HEAD_STEP).read_to_end(&mut head)?;
        // The element may begin in the step before.
        let unseen = &head[n_before.saturating_sub(APPENDED.len())..];
        let is_whole = unseen.windows(APPENDED.len()).any(|at| at == APPENDED);
        if is_whole || head.len() == n_before || head.len() as u64 >= MAX_HEADER {
            return Ok(head);
        }
    }
}

impl VtkReader {
    /// Opens a file and reads its header.
    pub fn open(path: &Path) -> Result<(Self, VtkHeader), Diagnostic> {
        let failure = |error: io::Error| cannot_read(path, &error);
        let file = files::open(path).map_err(failure)?;
        let n_bytes = file.metadata().map_err(failure)?.len();
        let head = read_head(&file).map_err(failure)?;
        let mut this = Self {
            path: path.to_owned(),
            file,
            n_bytes,
            begin: 0,
            run: None,
            encoding: ArrayEncoding::RAW,
        };
        let header = this.header(&head)?;
        this.run.clone_from(&header.run);
        this.encoding = header.encoding;
        Ok((this, header))
    }

    fn header(&mut self, head: &[u8]) -> Result<VtkHeader, Diagnostic> {
        if !head.starts_with(b"<?xml") && !head.starts_with(b"<VTKFile") {
            return Err(self.foreign("it does not begin as VTK's XML files do"));
        }
        // Find the underscore after which the arrays begin.
        let tag = head.windows(APPENDED.len()).position(|at| at == APPENDED);
        let Some(tag) = tag else {
            let why = if self.n_bytes < MAX_HEADER {
                "it has no appended data, or is truncated before them"
            } else {
                "it has no appended data after its header"
            };
            return Err(self.foreign(why));
        };
        let (xml, rest) = head.split_at(tag);
        let blanks = &rest[APPENDED.len()..];
        let underscore = blanks.iter().position(|byte| !byte.is_ascii_whitespace());
        match underscore.map(|at| (at, blanks[at])) {
            Some((at, b'_')) => self.begin = (tag + APPENDED.len() + at + 1) as u64,
            Some(_) => return Err(self.foreign("there is no `_` before its arrays")),
            None => return Err(self.truncated("its header")),
        }
        VtkHeader::read(xml).map_err(|why| self.foreign(&why))
    }

    /// Locates an array of `n_tuples` and checks that the file contains all of it.
    pub fn place(
        &self,
        array: &DataArrayElement,
        n_tuples: u64,
    ) -> Result<ArrayLocation, Diagnostic> {
        let DataArrayElement { scalar, name, .. } = array;
        // Raycost writes no signed numbers of 8 or 16 bits.
        let written = |scalar: &ScalarType| !matches!(scalar, ScalarType::I8 | ScalarType::I16);
        let Some(scalar) = scalar_of(scalar).filter(written) else {
            let why = format!("`{name}` has numbers of the type `{scalar}`");
            return Err(self.foreign(&why));
        };
        let Some(offset) = array.offset else {
            return Err(self.foreign(&format!("`{name}` is not in its appended data")));
        };
        let n_numbers = n_tuples.checked_mul(array.n_components.into());
        let n_bytes = n_numbers.and_then(|n| n.checked_mul(scalar.size() as u64));
        let begin = self.begin.checked_add(offset);
        let endless = || self.foreign(&format!("no file is as long as its array `{name}`"));
        let (Some(n_numbers), Some(n_bytes), Some(begin)) = (n_numbers, n_bytes, begin) else {
            return Err(endless());
        };
        let (storage, end) = match self.encoding.compressor {
            None => {
                let end = begin.checked_add(self.encoding.length_bytes as u64);
                let end = end.and_then(|begin| begin.checked_add(n_bytes));
                (Storage::Raw(begin), end.ok_or_else(endless)?)
            }
            Some(compressor) => {
                let blocks = self.blocks(name, begin, n_bytes, compressor)?;
                let end = blocks.end;
                (Storage::Compressed(blocks), end)
            }
        };
        if end > self.n_bytes {
            return Err(self.truncated(&format!("`{name}`, which ends at byte {},", count(end))));
        }
        Ok(ArrayLocation {
            name: name.clone(),
            scalar,
            n_numbers,
            n_bytes,
            storage,
            span: [begin, end],
        })
    }

    /// Checks that no two arrays share bytes of the file: otherwise a small file could claim any
    /// number of large arrays.
    pub fn check_overlap(&self, places: &[ArrayLocation]) -> Result<(), Diagnostic> {
        let mut spans: Vec<(&[u64; 2], &str)> = places
            .iter()
            .map(|place| (&place.span, place.name.as_str()))
            .collect();
        spans.sort();
        let overlap = spans.windows(2).find(|pair| pair[0].0[1] > pair[1].0[0]);
        match overlap {
            None => Ok(()),
            Some(pair) => {
                let why = format!("`{}` and `{}` share bytes of it", pair[0].1, pair[1].1);
                Err(self.foreign(&why))
            }
        }
    }

    /// Reads the block table of a compressed array at `begin`.
    fn blocks(
        &self,
        name: &str,
        begin: u64,
        n_bytes: u64,
        compressor: &'static dyn Compressor,
    ) -> Result<CompressedBlocks, Diagnostic> {
        let encoding = &self.encoding;
        let blocks = CompressedBlocks::at(begin, n_bytes, encoding, compressor, &self.file);
        let blocks = blocks.map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => self.truncated(&format!("`{name}`")),
            _ => cannot_read(&self.path, &error),
        })?;
        let n_bytes = count(n_bytes);
        let foreign = || {
            self.foreign(&format!(
                "the blocks of `{name}` do not hold {n_bytes} bytes"
            ))
        };
        blocks.ok_or_else(foreign)
    }

    /// Returns the error for a file that raycost did not write.
    pub fn foreign(&self, why: &str) -> Diagnostic {
        let shown = self.path.display();
        Diagnostic::new(format!("`{shown}` is not as raycost writes it: {why}"))
            .with_help("render the scene again; files that other programs saved are not read")
    }

    /// Returns the error for a file that ends before `of` is complete.
    fn truncated(&self, of: &str) -> Diagnostic {
        let shown = self.path.display();
        let n_bytes = count(self.n_bytes);
        Diagnostic::new(format!(
            "`{shown}` is truncated: its {n_bytes} bytes end before {of} does"
        ))
        .with_help("copy the file again, or render the scene again")
    }

    /// Returns the error for a block that cannot be decompressed.
    pub(super) fn damaged(&self, name: &str) -> Diagnostic {
        let shown = self.path.display();
        Diagnostic::new(format!(
            "`{shown}` is damaged: a block of `{name}` cannot be decompressed"
        ))
        .with_help("copy the file again, or render the scene again")
    }
}

/// Returns the error for a file that the system cannot read.
pub(super) fn cannot_read(path: &Path, error: &io::Error) -> Diagnostic {
    Diagnostic::new(format!("cannot read `{}`: {error}", path.display()))
}
