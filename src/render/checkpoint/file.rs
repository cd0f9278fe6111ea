//! A file of finished tiles: checked as a whole, then read tile by tile; or appended to.

use std::fmt;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::block::{self, BlockKind, PREFIX};
use super::record::{Bytes, MAX_THREADS, TileRecord};
use super::{Header, RecordLayout};
use base::locked;
use host::files;

/// The first bytes of a file; the number is the version of the format.
pub(super) const MAGIC: &[u8; 16] = b"raycost tiles 5\n";
/// Number of these bytes that is the same for every format.
const N_OF_ALL_FORMATS: usize = 14;
/// Greatest number of bytes of a header.
const MAX_HEADER: usize = 1 << 20;

/// A file whose blocks were checked.
#[derive(Debug)]
pub struct CheckpointFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Header of the file.
    pub header: Header,
    /// The runs that wrote the file.
    pub sessions: Vec<RunSpan>,
    /// The tiles in their order.
    pub(super) tiles: Vec<StoredTile>,
    /// True if the last block says that no tile is missing.
    pub is_complete: bool,
    /// True if something follows the last whole block.
    pub is_torn: bool,
    reader: TileReader,
    /// Bytes and blocks up to the last whole block.
    pub(super) n_bytes: u64,
    pub(super) n_blocks: u64,
}

/// A run that rendered tiles of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunSpan {
    /// Number of threads.
    pub n_threads: u32,
    /// Wall time since the rendering started, in nanoseconds.
    pub wall_ns: u64,
    /// CPU time of all threads since then, in nanoseconds.
    pub cpu_ns: u64,
}

/// Location of a tile in a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct StoredTile {
    pub(super) rendering: u8,
    pub(super) tile: u32,
    pub(super) end_ns: u64,
    /// Number of its block, its position, and the bytes in it.
    pub(super) block: u64,
    pub(super) position: u64,
    pub(super) n_bytes: u32,
}

/// Reads tiles from any place of a file.
#[derive(Debug)]
pub(super) struct TileReader {
    file: Mutex<File>,
    layout: RecordLayout,
}

impl TileReader {
    /// Opens a file of tiles with this layout.
    pub(super) fn open(path: &Path, layout: RecordLayout) -> io::Result<Self> {
        let file = Mutex::new(files::open(path)?);
        Ok(Self { file, layout })
    }

    /// Reads a tile. Returns `None` if its bytes have changed since it was written.
    pub(super) fn read(&self, stored: &StoredTile) -> io::Result<Option<TileRecord<'static>>> {
        let mut block = vec![0; PREFIX + stored.n_bytes as usize];
        {
            let mut file = locked(&self.file);
            file.seek(SeekFrom::Start(stored.position))?;
            file.read_exact(&mut block)?;
        }
        let (layout, mut content) = (&self.layout, Vec::new());
        let max_bytes = TileRecord::max_bytes(layout);
        let kind = block::read(&mut &block[..], stored.block, max_bytes, &mut content)?;
        let tile = kind.filter(|&kind| kind == BlockKind::Tile);
        let record = tile.and_then(|_| TileRecord::parse(&content, layout));
        Ok(record.map(TileRecord::into_owned))
    }

    fn n_bytes(&self) -> io::Result<u64> {
        let file = locked(&self.file);
        Ok(file.metadata()?.len())
    }
}

/// Reasons why a file cannot be read.
#[derive(Debug)]
pub enum Damage {
    /// An error of the system.
    System(io::Error),
    /// Not a file of tiles.
    Foreign,
    /// Written by a raycost with another format of these files.
    OtherFormat,
    /// The header is damaged or incomplete.
    NoHeader,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::System(error) => error.fmt(f),
            Self::Foreign => f.write_str("raycost did not write it"),
            Self::OtherFormat => f.write_str("another version of raycost wrote it"),
            Self::NoHeader => f.write_str("it is damaged"),
        }
    }
}

impl From<io::Error> for Damage {
    fn from(error: io::Error) -> Self {
        Self::System(error)
    }
}

impl CheckpointFile {
    /// Opens a file and checks all blocks, up to the first that is not whole.
    ///
    /// # Errors
    /// If there is no header, or an error of the system.
    pub fn open(path: &Path) -> Result<Self, Damage> {
        let mut reader = BufReader::with_capacity(1 << 18, files::open(path)?);
        let mut magic = Vec::new();
        (&mut reader)
            .take(MAGIC.len() as u64)
            .read_to_end(&mut magic)?;
        if magic != *MAGIC {
            let is_other = magic.starts_with(&MAGIC[..N_OF_ALL_FORMATS]);
            return Err(if is_other {
                Damage::OtherFormat
            } else {
                Damage::Foreign
            });
        }
        let mut content = Vec::new();
        let kind = block::read(&mut reader, 0, MAX_HEADER, &mut content)?;
        let header = kind.filter(|&kind| kind == BlockKind::Header);
        let header = header.and_then(|_| serde_json::from_slice::<Header>(&content).ok());
        let header = header.filter(|header| header.layout.is_possible());
        let header = header.ok_or(Damage::NoHeader)?;
        let mut this = Self {
            path: path.to_owned(),
            reader: TileReader::open(path, header.layout)?,
            header,
            sessions: Vec::new(),
            tiles: Vec::new(),
            is_complete: false,
            is_torn: false,
            n_bytes: (MAGIC.len() + PREFIX + content.len()) as u64,
            n_blocks: 1,
        };
        this.read_blocks(&mut reader, content)?;
        Ok(this)
    }

    /// Returns the number of tiles, of all renderings.
    pub fn n_tiles(&self) -> usize {
        self.tiles.len()
    }

    /// Returns true if the file has each tile of each rendering of the picture.
    pub fn has_all_tiles(&self) -> bool {
        self.n_tiles() == self.header.layout.tiles().count()
    }

    /// Reads a tile again.
    pub(super) fn read(&self, stored: &StoredTile) -> io::Result<Option<TileRecord<'static>>> {
        self.reader.read(stored)
    }

    /// Reads the blocks after the header; `content` is a buffer.
    fn read_blocks(&mut self, reader: &mut impl Read, mut content: Vec<u8>) -> io::Result<()> {
        let layout = self.header.layout;
        let max_bytes = TileRecord::max_bytes(&layout);
        loop {
            let kind = block::read(reader, self.n_blocks, max_bytes, &mut content)?;
            let is_good = !self.is_complete
                && match kind {
                    Some(BlockKind::Tile) => self.add_tile(&content, &layout),
                    Some(BlockKind::Run) => self.add_session(&content),
                    Some(BlockKind::End) => {
                        self.is_complete = content.is_empty();
                        self.is_complete
                    }
                    Some(BlockKind::Header) | None => false,
                };
            if !is_good {
                self.is_torn = self.reader.n_bytes()? != self.n_bytes;
                return Ok(());
            }
            self.n_bytes += (PREFIX + content.len()) as u64;
            self.n_blocks += 1;
        }
    }

    fn add_tile(&mut self, content: &[u8], layout: &RecordLayout) -> bool {
        let Some(record) = TileRecord::parse(content, layout) else {
            return false;
        };
        let n_threads = self.sessions.iter().map(|session| session.n_threads).max();
        if record.run.thread >= n_threads.unwrap_or(0) {
            return false;
        }
        self.tiles.push(StoredTile {
            rendering: record.rendering,
            tile: record.tile,
            end_ns: record.run.end_ns,
            block: self.n_blocks,
            position: self.n_bytes,
            n_bytes: content.len() as u32,
        });
        true
    }

    /// Adds a run, or its progress.
    fn add_session(&mut self, content: &[u8]) -> bool {
        let Some((number, session)) = RunSpan::parse(content) else {
            return false;
        };
        let number = number as usize;
        match self.sessions.len() {
            n if number < n => self.sessions[number] = session,
            n if number == n => self.sessions.push(session),
            _ => return false,
        }
        true
    }
}

impl RunSpan {
    fn parse(bytes: &[u8]) -> Option<(u32, Self)> {
        let mut bytes = Bytes(bytes);
        let (number, n_threads) = (bytes.u32()?, bytes.u32()?);
        let session = Self {
            n_threads: Some(n_threads).filter(|n| (1..=MAX_THREADS).contains(n))?,
            wall_ns: bytes.time()?,
            cpu_ns: bytes.time()?,
        };
        bytes.0.is_empty().then_some((number, session))
    }
}
