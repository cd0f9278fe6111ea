//! A VTK file: its header, and where its arrays begin.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::blocks::Blocks;
use super::header::{DataArray, Header};
use super::values::{Pick, Values, n_bytes};
use crate::host::{available_memory, may_fail};
use crate::text::Diagnostic;
use crate::text::numbers::{self, count};
use crate::vtk::compressor::Compressor;

/// Longest header that is read, in bytes; raycost's have a few thousand.
const MAX_HEADER: u64 = 1 << 16;
/// The element that holds the arrays.
const APPENDED: &[u8] = b"<AppendedData encoding=\"raw\">";
/// What stands before each raw array: its length.
const LENGTH_BYTES: u64 = size_of::<u64>() as u64;

/// An open file.
#[derive(Debug)]
pub(crate) struct VtkFile {
    path: PathBuf,
    file: File,
    n_bytes: u64,
    /// Where the offsets count from.
    begin: u64,
    /// The run that wrote it, where it says so.
    pub(crate) run: Option<String>,
    /// What its arrays are compressed by; raw ones by nothing.
    compressor: Option<Compressor>,
}

/// An array's place in a file.
#[derive(Debug)]
pub(crate) struct Place {
    name: String,
    vtk_type: String,
    n_numbers: u64,
    n_bytes: u64,
    content: Content,
    /// Where it begins and ends in the file.
    span: [u64; 2],
}

/// How an array's bytes are there.
#[derive(Debug)]
enum Content {
    /// As they are, behind their length, which begins here in the file.
    Raw(u64),
    Compressed(Blocks),
}

impl VtkFile {
    /// Opens a file and reads its header.
    pub(crate) fn open(path: &Path) -> Result<(Self, Header), Diagnostic> {
        let cannot = |error: io::Error| cannot_read(path, &error);
        let file = File::open(path).map_err(cannot)?;
        let n_bytes = file.metadata().map_err(cannot)?.len();
        let mut head = Vec::new();
        (&file)
            .take(MAX_HEADER)
            .read_to_end(&mut head)
            .map_err(cannot)?;
        let mut this = Self {
            path: path.to_owned(),
            file,
            n_bytes,
            begin: 0,
            run: None,
            compressor: None,
        };
        let header = this.header(&head)?;
        this.run.clone_from(&header.run);
        Ok((this, header))
    }

    fn header(&mut self, head: &[u8]) -> Result<Header, Diagnostic> {
        if !head.starts_with(b"<?xml") && !head.starts_with(b"<VTKFile") {
            return Err(self.foreign("it does not begin as VTK's XML files do"));
        }
        let tag = head.windows(APPENDED.len()).position(|at| at == APPENDED);
        let Some(tag) = tag else {
            return Err(match self.n_bytes < MAX_HEADER {
                true => self.foreign("it has no raw arrays, or was cut short before them"),
                false => self.foreign("it has no raw arrays behind its header"),
            });
        };
        let (xml, rest) = head.split_at(tag);
        let blanks = &rest[APPENDED.len()..];
        let underscore = blanks.iter().position(|byte| !byte.is_ascii_whitespace());
        match underscore.map(|at| (at, blanks[at])) {
            Some((at, b'_')) => self.begin = (tag + APPENDED.len() + at + 1) as u64,
            Some(_) => return Err(self.foreign("no `_` stands before its arrays")),
            None => return Err(self.cut_short("its header")),
        }
        let header = Header::read(xml).map_err(|why| self.foreign(&why))?;
        let native = match cfg!(target_endian = "little") {
            true => "LittleEndian",
            false => "BigEndian",
        };
        if header.byte_order != native {
            return Err(self.foreign("its bytes are in the order of another machine"));
        }
        if header.header_type.as_deref() != Some("UInt64") {
            return Err(self.foreign("its arrays' lengths are no UInt64"));
        }
        if let Some(name) = &header.compressor {
            self.compressor = Compressor::of_vtk_class(name);
            if self.compressor.is_none() {
                return Err(self.foreign(&format!("its arrays are compressed by `{name}`")));
            }
        }
        Ok(header)
    }

    /// Where an array of `n_tuples` is; makes sure that the file holds it.
    pub(crate) fn place(&self, array: &DataArray, n_tuples: u64) -> Result<Place, Diagnostic> {
        let DataArray { scalar, name, .. } = array;
        let Some(width) = n_bytes(scalar) else {
            let why = format!("`{name}` has numbers of the type `{scalar}`");
            return Err(self.foreign(&why));
        };
        let Some(offset) = array.offset else {
            return Err(self.foreign(&format!("`{name}` is not among its raw arrays")));
        };
        let n_numbers = n_tuples.checked_mul(array.n_components.into());
        let n_bytes = n_numbers.and_then(|n| n.checked_mul(width));
        let begin = self.begin.checked_add(offset);
        let endless = || self.foreign(&format!("no file is as long as its array `{name}`"));
        let (Some(n_numbers), Some(n_bytes), Some(begin)) = (n_numbers, n_bytes, begin) else {
            return Err(endless());
        };
        let (content, end) = match self.compressor {
            None => {
                let end = begin.checked_add(LENGTH_BYTES);
                let end = end.and_then(|begin| begin.checked_add(n_bytes));
                (Content::Raw(begin), end.ok_or_else(endless)?)
            }
            Some(compressor) => {
                let blocks = self.blocks(name, begin, n_bytes, compressor)?;
                let end = blocks.end;
                (Content::Compressed(blocks), end)
            }
        };
        match end <= self.n_bytes {
            true => Ok(Place {
                name: name.clone(),
                vtk_type: scalar.clone(),
                n_numbers,
                n_bytes,
                content,
                span: [begin, end],
            }),
            false => Err(self.cut_short(&format!("`{name}`, which ends at byte {},", count(end)))),
        }
    }

    /// Makes sure that no byte of the file stands for two arrays: with that, a
    /// few bytes could stand for any number of them.
    pub(crate) fn check_overlap(&self, places: &[Place]) -> Result<(), Diagnostic> {
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

    /// The blocks of a compressed array, whose table begins at `begin`.
    fn blocks(
        &self,
        name: &str,
        begin: u64,
        n_bytes: u64,
        compressor: Compressor,
    ) -> Result<Blocks, Diagnostic> {
        let blocks = Blocks::at(begin, n_bytes, compressor, &self.file);
        let blocks = blocks.map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => self.cut_short(&format!("`{name}`")),
            _ => cannot_read(&self.path, &error),
        })?;
        let n_bytes = count(n_bytes);
        let foreign = || self.foreign(&format!("the blocks of `{name}` hold no {n_bytes} bytes"));
        blocks.ok_or_else(foreign)
    }

    /// Reads an array that stands there in `n_rows` equal rows, last row first.
    pub(crate) fn read(&self, place: &Place, n_rows: usize) -> Result<Values, Diagnostic> {
        let fill = |values: &mut Values, from: &mut dyn Read| values.read_rows(n_rows, from);
        self.read_by(place, place.n_numbers, fill)
    }

    /// Reads some numbers of an array that stands there as `read` has it.
    pub(crate) fn read_picked(&self, place: &Place, pick: &Pick) -> Result<Values, Diagnostic> {
        let fill = |values: &mut Values, from: &mut dyn Read| values.read_picked(pick, from);
        self.read_by(place, pick.n_numbers(), fill)
    }

    /// Makes `n_numbers` zeros, and has them filled from the array's bytes.
    fn read_by(
        &self,
        place: &Place,
        n_numbers: u64,
        fill: impl FnOnce(&mut Values, &mut dyn Read) -> io::Result<()>,
    ) -> Result<Values, Diagnostic> {
        let name = &place.name;
        let mut values = self.zeros(place, n_numbers)?;
        let filled = match &place.content {
            Content::Raw(begin) => self.raw(*begin).and_then(|(length, mut from)| {
                if length != place.n_bytes {
                    return Ok(Some(length));
                }
                fill(&mut values, &mut from).map(|()| None)
            }),
            Content::Compressed(blocks) => blocks
                .unpack(&self.file)
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

    /// So many zeros for an array, if they fit into memory.
    fn zeros(&self, place: &Place, n_numbers: u64) -> Result<Values, Diagnostic> {
        let name = &place.name;
        let n_bytes = n_numbers.saturating_mul(place.n_bytes / place.n_numbers.max(1));
        // Half of what is free: something is made of what is read.
        let n = usize::try_from(n_numbers).ok();
        let n = n.filter(|_| n_bytes <= available_memory() / 2);
        let values = n.map(|n| may_fail(|| Values::zeros(&place.vtk_type, n)));
        match values {
            Some(Ok(Some(values))) => Ok(values),
            Some(Ok(None)) => {
                Err(self.foreign(&format!("`{name}` has numbers of an unknown type")))
            }
            Some(Err(_)) | None => {
                let (shown, n_bytes) = (self.path.display(), numbers::bytes(n_bytes));
                Err(Diagnostic::new(format!(
                    "the array `{name}` of `{shown}` takes {n_bytes}: memory does not suffice"
                )))
            }
        }
    }

    /// The length that stands at `begin`, and the bytes behind it.
    fn raw(&self, begin: u64) -> io::Result<(u64, BufReader<&File>)> {
        (&self.file).seek(SeekFrom::Start(begin))?;
        let mut from = BufReader::new(&self.file);
        let mut length = [0; LENGTH_BYTES as usize];
        from.read_exact(&mut length)?;
        Ok((u64::from_ne_bytes(length), from))
    }

    /// The file is none of raycost's.
    pub(crate) fn foreign(&self, why: &str) -> Diagnostic {
        let shown = self.path.display();
        Diagnostic::new(format!("`{shown}` is not as raycost writes it: {why}"))
            .with_help("render the scene again; files that other programs saved are not read")
    }

    fn cut_short(&self, of: &str) -> Diagnostic {
        let shown = self.path.display();
        let n_bytes = count(self.n_bytes);
        Diagnostic::new(format!(
            "`{shown}` was cut short: its {n_bytes} bytes end before {of} does"
        ))
        .with_help("copy the file again, or render the scene again")
    }

    fn damaged(&self, name: &str) -> Diagnostic {
        let shown = self.path.display();
        Diagnostic::new(format!(
            "`{shown}` is damaged: a block of `{name}` cannot be decompressed"
        ))
        .with_help("copy the file again, or render the scene again")
    }

    /// The path as it was given.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

fn cannot_read(path: &Path, error: &io::Error) -> Diagnostic {
    Diagnostic::new(format!("cannot read `{}`: {error}", path.display()))
}
