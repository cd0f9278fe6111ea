//! Finished tiles that a rendering reads from files, and a file for new ones.

use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

use super::file::{StoredTile, TileReader};
use super::writer::TileWriter;
use super::{CheckpointFile, Header, RunSpan, TileRecord};
use base::locked;
use host::folder::WriteError;

/// Interval at which finished tiles are flushed to the system.
const FLUSH_EVERY: Duration = Duration::from_millis(250);

/// Finished tiles, and the sink of new ones.
#[derive(Debug, Default)]
pub struct Checkpoint {
    sources: Vec<TileSource>,
    /// The source of each tile of each rendering.
    places: HashMap<(u8, u32), (usize, StoredTile)>,
    sink: Option<Sink>,
    failure: OnceLock<CheckpointFailure>,
}

/// A file of finished tiles, and the number of its first thread among the threads of all files.
#[derive(Debug)]
pub struct TileSource {
    /// The file.
    pub file: CheckpointFile,
    first_thread: u32,
}

/// A file for new tiles.
#[derive(Debug)]
struct Sink {
    path: PathBuf,
    writer: Mutex<TileWriter>,
    reader: TileReader,
    /// The tiles that were kept.
    kept: Mutex<HashMap<(u8, u32), StoredTile>>,
    /// Number of this run among the runs that wrote the file.
    number: u32,
    begin: OnceLock<(Instant, ProcessTime, u32)>,
}

/// Reasons why tiles could not be read or kept.
#[derive(Debug)]
pub enum CheckpointFailure {
    /// The file has changed since it was opened.
    Read(PathBuf),
    /// A file could not be written.
    Write(WriteError),
}

impl Checkpoint {
    /// Opens the tiles of all parts of a picture. Their threads are numbered in the order of the
    /// parts.
    pub fn from_parts(files: Vec<CheckpointFile>) -> Self {
        let mut this = Self::default();
        let mut n_threads = 0;
        for file in files {
            let first_thread = n_threads;
            n_threads += n_threads_of(&file);
            this.add(TileSource { file, first_thread });
        }
        this
    }

    /// Starts without tiles; new ones go to a new file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(path: &Path, header: &Header) -> Result<Self, WriteError> {
        let sink = TileWriter::create(path, header)
            .and_then(|writer| Sink::new(path, header, writer, 0))
            .map_err(|error| WriteError::new(path, error))?;
        Ok(Self {
            sink: Some(sink),
            ..Self::default()
        })
    }

    /// Opens the tiles of a file; new ones are appended to it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn resume(file: CheckpointFile) -> Result<Self, WriteError> {
        let (path, number) = (&file.path, file.sessions.len() as u32);
        let sink = TileWriter::behind(&file)
            .and_then(|writer| Sink::new(path, &file.header, writer, number))
            .map_err(|error| WriteError::new(path, error))?;
        let mut this = Self {
            sink: Some(sink),
            ..Self::default()
        };
        this.add(TileSource {
            file,
            first_thread: 0,
        });
        Ok(this)
    }

    /// Returns the files that tiles come from.
    pub fn sources(&self) -> &[TileSource] {
        &self.sources
    }

    /// Returns the number of tiles that came from files, of all renderings.
    pub fn n_restored(&self) -> usize {
        self.places.len()
    }

    /// Returns the number of tiles that another run can start from, of all renderings.
    pub fn n_kept(&self) -> usize {
        let here = self
            .sink
            .as_ref()
            .map_or(0, |sink| locked(&sink.kept).len());
        self.n_restored() + here
    }

    /// Returns a tile of a rendering, or `None` if it has to be rendered.
    pub fn restore(&self, rendering: u8, tile: u32) -> Option<TileRecord<'static>> {
        let (source, stored) = self.places.get(&(rendering, tile))?;
        let source = &self.sources[*source];
        match source.file.read(stored) {
            Ok(Some(mut record)) => {
                record.run.thread += source.first_thread;
                Some(record)
            }
            _ => {
                self.fail_to_read(&source.file.path);
                None
            }
        }
    }

    /// Returns a tile of a rendering that came from a file, or was kept and has been
    /// [flushed](Self::flush), or `None` if it is missing or cannot be read.
    pub fn tile(&self, rendering: u8, tile: u32) -> Option<TileRecord<'static>> {
        let kept = self.sink.as_ref().and_then(|sink| {
            let stored = *locked(&sink.kept).get(&(rendering, tile))?;
            Some((sink, stored))
        });
        let Some((sink, stored)) = kept else {
            return self.restore(rendering, tile);
        };
        match sink.reader.read(&stored) {
            Ok(Some(record)) => Some(record),
            _ => {
                self.fail_to_read(&sink.path);
                None
            }
        }
    }

    /// Ends the rendering because a tile cannot be read or does not fit the scene.
    pub fn refuse(&self, rendering: u8, tile: u32) {
        if let Some((source, _)) = self.places.get(&(rendering, tile)) {
            self.fail_to_read(&self.sources[*source].file.path);
        }
    }

    /// Returns the end of the last tile that already exists, in nanoseconds: new tiles are rendered
    /// after it.
    pub(crate) fn elapsed_ns(&self, rendering: u8) -> u64 {
        let tiles = self.places.iter().filter(|((of, _), _)| *of == rendering);
        let ends = tiles.map(|(_, (_, stored))| stored.end_ns);
        ends.max().unwrap_or(0)
    }

    /// Returns the number of threads of all tiles, if `n_here` threads render the new ones.
    pub fn n_threads(&self, n_here: u32) -> u32 {
        let ends = self
            .sources
            .iter()
            .map(|source| source.first_thread + n_threads_of(&source.file));
        match self.sink {
            Some(_) => ends.max().unwrap_or(0).max(n_here),
            None => ends.max().unwrap_or(n_here),
        }
    }

    /// Returns true if new tiles are kept.
    pub fn keeps(&self) -> bool {
        self.sink.is_some()
    }

    /// Starts a rendering on `n_threads` threads.
    pub fn begin(&self, n_threads: u32) {
        if let Some(sink) = &self.sink {
            let now = || (Instant::now(), ProcessTime::now(), n_threads);
            sink.begin.get_or_init(now);
        }
        // The threads are recorded before their tiles.
        self.flush();
    }

    /// Keeps a tile. A kill of the process loses at most the tiles of the last quarter of a second,
    /// each of which took no longer.
    pub fn keep(&self, record: &TileRecord) {
        self.write(|sink, writer| {
            let stored = writer.tile(record)?;
            locked(&sink.kept).insert((stored.rendering, stored.tile), stored);
            let rendered_in = Duration::from_nanos(record.run.duration_ns());
            if rendered_in.max(writer.flushed.elapsed()) < FLUSH_EVERY {
                return Ok(());
            }
            sink.flush(writer)
        });
    }

    /// Flushes all kept tiles to the system.
    pub fn flush(&self) {
        self.write(Sink::flush);
    }

    /// Returns true if a file could not be read or written: the rendering ends.
    pub fn has_failed(&self) -> bool {
        self.failure.get().is_some()
    }

    /// Returns the reason.
    pub fn failure(&self) -> Option<&CheckpointFailure> {
        self.failure.get()
    }

    /// Removes the file of new tiles, once the output has them.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(self) -> Result<(), WriteError> {
        let Some(sink) = self.sink else {
            return Ok(());
        };
        fs::remove_file(&sink.path).map_err(|error| WriteError::new(sink.path, error))
    }

    /// Marks the file of new tiles as complete, and gives it this path.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self, path: &Path, sync: bool) -> Result<(), WriteError> {
        let Some(sink) = self.sink else {
            return Ok(());
        };
        let done = locked(&sink.writer).finish(sync);
        done.and_then(|()| fs::rename(&sink.path, path))
            .map_err(|error| WriteError::new(path, error))
    }

    fn add(&mut self, source: TileSource) {
        let number = self.sources.len();
        for stored in &source.file.tiles {
            let key = (stored.rendering, stored.tile);
            self.places.insert(key, (number, *stored));
        }
        self.sources.push(source);
    }

    fn write(&self, write: impl FnOnce(&Sink, &mut TileWriter) -> io::Result<()>) {
        let Some(sink) = self.sink.as_ref().filter(|_| !self.has_failed()) else {
            return;
        };
        if let Err(error) = write(sink, &mut locked(&sink.writer)) {
            let _ = self
                .failure
                .set(CheckpointFailure::Write(WriteError::new(&sink.path, error)));
        }
    }

    fn fail_to_read(&self, path: &Path) {
        let _ = self.failure.set(CheckpointFailure::Read(path.to_owned()));
    }
}

impl TileSource {
    /// Returns the wall and CPU time of all runs that rendered these tiles, in nanoseconds.
    pub fn spent_ns(&self) -> [u64; 2] {
        let sessions = &self.file.sessions;
        let sum = |ns: fn(&RunSpan) -> u64| sessions.iter().map(ns).sum();
        [
            sum(|session| session.wall_ns),
            sum(|session| session.cpu_ns),
        ]
    }

    /// Returns the number of threads that rendered these tiles.
    pub fn n_threads(&self) -> u32 {
        n_threads_of(&self.file)
    }
}

/// Returns the number of threads that rendered the tiles of a file.
pub(super) fn n_threads_of(file: &CheckpointFile) -> u32 {
    let of_sessions = file.sessions.iter().map(|session| session.n_threads);
    of_sessions.max().unwrap_or(1)
}

impl Sink {
    fn new(path: &Path, header: &Header, writer: TileWriter, number: u32) -> io::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            writer: Mutex::new(writer),
            reader: TileReader::open(path, header.layout)?,
            kept: Mutex::default(),
            number,
            begin: OnceLock::new(),
        })
    }

    /// Flushes all tiles to the system, with the progress of this run.
    fn flush(&self, writer: &mut TileWriter) -> io::Result<()> {
        if let Some(session) = self.session() {
            writer.session(self.number, session)?;
        }
        writer.flush()
    }

    /// Returns the progress of this run; `None` before it starts.
    fn session(&self) -> Option<RunSpan> {
        let (wall, cpu, n_threads) = self.begin.get()?;
        Some(RunSpan {
            n_threads: *n_threads,
            wall_ns: wall.elapsed().as_nanos() as u64,
            cpu_ns: cpu.elapsed().as_nanos() as u64,
        })
    }
}
