//! Appends finished tiles to a file.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::Instant;

use super::block::{self, BlockKind, PREFIX};
use super::file::{CheckpointFile, MAGIC, RunSpan, StoredTile};
use super::{Header, TileRecord};
use host::files;
use host::folder::Lock;

/// Appends blocks to a file.
#[derive(Debug)]
pub(super) struct TileWriter {
    file: BufWriter<File>,
    n_blocks: u64,
    n_bytes: u64,
    block: Vec<u8>,
    /// The last flush to the system.
    pub(super) flushed: Instant,
    /// The lock on the file, which ends after the file is written.
    _lock: Lock,
}

impl TileWriter {
    /// Creates a file with this header, replacing an older file.
    pub(super) fn create(path: &Path, header: &Header) -> io::Result<Self> {
        // Not truncated before it is locked: another run may be writing it.
        let mut options = OpenOptions::new();
        options.write(true).create(true).truncate(false);
        let file = files::open_to_change(&mut options, path)?;
        let lock = lock(path, &file)?;
        file.set_len(0)?;
        let mut this = Self::new(file, lock, [0, MAGIC.len() as u64]);
        this.file.write_all(MAGIC)?;
        let header = serde_json::to_vec(header)?;
        this.append(BlockKind::Header, |bytes| bytes.extend(&header))?;
        this.flush()?;
        Ok(this)
    }

    /// Continues after the last whole block of a file.
    pub(super) fn behind(found: &CheckpointFile) -> io::Result<Self> {
        let mut file = files::open_to_change(OpenOptions::new().write(true), &found.path)?;
        let lock = lock(&found.path, &file)?;
        file.set_len(found.n_bytes)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Self::new(file, lock, [found.n_blocks, found.n_bytes]))
    }

    fn new(file: File, lock: Lock, [n_blocks, n_bytes]: [u64; 2]) -> Self {
        Self {
            file: BufWriter::with_capacity(1 << 18, file),
            n_blocks,
            n_bytes,
            block: Vec::new(),
            _lock: lock,
            flushed: Instant::now(),
        }
    }

    /// Appends a tile. Returns its location.
    pub(super) fn tile(&mut self, record: &TileRecord) -> io::Result<StoredTile> {
        let (block, position) = (self.n_blocks, self.n_bytes);
        self.append(BlockKind::Tile, |bytes| record.append_to(bytes))?;
        Ok(StoredTile {
            rendering: record.rendering,
            tile: record.tile,
            end_ns: record.run.end_ns,
            block,
            position,
            n_bytes: (self.block.len() - PREFIX) as u32,
        })
    }

    /// Appends the progress of the run with this number.
    pub(super) fn session(&mut self, number: u32, session: RunSpan) -> io::Result<()> {
        self.append(BlockKind::Run, |bytes| {
            bytes.extend(number.to_le_bytes());
            bytes.extend(session.n_threads.to_le_bytes());
            bytes.extend(session.wall_ns.to_le_bytes());
            bytes.extend(session.cpu_ns.to_le_bytes());
        })
    }

    /// Appends the end block and flushes to the system; to the disk if `sync`.
    pub(super) fn finish(&mut self, sync: bool) -> io::Result<()> {
        self.append(BlockKind::End, |_| {})?;
        self.flush()?;
        if sync {
            self.file.get_ref().sync_all()
        } else {
            Ok(())
        }
    }

    /// Flushes all blocks to the system, so that they survive the end of the process.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.flushed = Instant::now();
        self.file.flush()
    }

    fn append(&mut self, kind: BlockKind, append: impl FnOnce(&mut Vec<u8>)) -> io::Result<()> {
        self.block.clear();
        block::append(&mut self.block, kind, self.n_blocks, append);
        self.n_blocks += 1;
        self.n_bytes += self.block.len() as u64;
        self.file.write_all(&self.block)
    }
}

/// Locks a file that was opened at this path.
fn lock(path: &Path, file: &File) -> io::Result<Lock> {
    let lock = Lock::take_at(path, file.try_clone()?)?;
    lock.ok_or_else(|| io::Error::other("another run is writing it"))
}
