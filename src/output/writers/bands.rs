//! Writes a picture larger than memory in pieces of several rows.
//!
//! The pixels are read twice: once to survey them, and once to write the pieces and the picture.

use std::fmt;
use std::io;
use std::ops::Range;

use super::file::{FileContent, OutputFile, WriterInput};
use super::survey::{Survey, Surveyor};
use super::{frame, hits, picture};
use base::stop;
use host::folder::{Staging, WriteError, Written};
use render::film::Film;
use render::tiles::{OnProgress, Progress, StoredPicture};
use vtk::data_set::DataSet;
use vtk::parallel::{self, PieceFiles};

/// The list of the frame's pieces.
pub const FRAME: OutputFile = OutputFile {
    name: "frame.pvti",
    is_wanted: |request| request.is_stored,
    content: FileContent::Written(|job, out| {
        let (Some(bands), film) = (job.rendering.bands, job.rendering.film) else {
            return Ok(());
        };
        let pieces = bands.rows.ranges().enumerate().map(|(i, rows)| {
            let overlapping = rows.start.saturating_sub(1)..rows.end;
            (
                bands.rows.name(i, FRAME_PIECE),
                frame::extent(film, &overlapping),
            )
        });
        let pieces = PieceFiles::Image {
            size: [film.grid.width, film.grid.height],
            files: pieces.collect(),
        };
        match frame::image(film, 0..0) {
            DataSet::Image { point_data, .. } => {
                parallel::write(&pieces, &point_data, job.run, out)
            }
            _ => Ok(()),
        }
    }),
};

/// The list of the cloud's pieces.
pub const HITS: OutputFile = OutputFile {
    name: "hits.pvtu",
    is_wanted: |request| request.is_stored,
    content: FileContent::Written(|job, out| {
        let (Some(bands), film) = (job.rendering.bands, job.rendering.film) else {
            return Ok(());
        };
        let files = (0..bands.rows.ranges().len()).map(|i| bands.rows.name(i, HITS_PIECE));
        let pieces = PieceFiles::Grids {
            files: files.collect(),
        };
        let distances = &job.rendering.survey.distances;
        hits::with_cloud(film, 0..0, distances, |cloud| match cloud {
            DataSet::Grid(mesh) => parallel::write(&pieces, &mesh.point_data, job.run, out),
            _ => Ok(()),
        })
    }),
};

/// The names of pieces, before and after the number.
const FRAME_PIECE: [&str; 2] = ["frame_", ".vti"];
const HITS_PIECE: [&str; 2] = ["hits_", ".vtu"];

/// Returns true if this is the name of a piece.
pub fn is_piece(name: &str) -> bool {
    [FRAME_PIECE, HITS_PIECE].iter().any(|[begin, end]| {
        let number = name
            .strip_prefix(begin)
            .and_then(|name| name.strip_suffix(end));
        number
            .is_some_and(|number| !number.is_empty() && number.bytes().all(|c| c.is_ascii_digit()))
    })
}

/// The rows of the pieces of a picture.
#[derive(Debug, Clone, Copy)]
pub struct BandRows {
    /// Rows of the picture.
    pub height: u32,
    /// Rows of each piece except the last: a multiple of the [unit](StoredPicture::row_unit).
    pub n_rows: u32,
}

impl BandRows {
    /// Returns the rows of the pieces, from top to bottom.
    fn ranges(&self) -> impl ExactSizeIterator<Item = Range<u32>> + use<> {
        let Self { height, n_rows } = *self;
        let range = move |first: u32| first..height.min(first.saturating_add(n_rows));
        (0..height).step_by(n_rows as usize).map(range)
    }

    /// Returns the file name of a piece; all numbers have as many digits as the last one.
    fn name(&self, i: usize, [begin, end]: [&str; 2]) -> String {
        let n_digits = (self.ranges().len() - 1).to_string().len();
        format!("{begin}{i:0n_digits$}{end}")
    }

    /// Returns the names of all pieces.
    pub(super) fn names(&self) -> Vec<String> {
        let names = |i| [FRAME_PIECE, HITS_PIECE].map(|piece| self.name(i, piece));
        (0..self.ranges().len()).flat_map(names).collect()
    }
}

/// A picture and its pieces.
#[derive(Clone, Copy)]
pub struct Bands<'a> {
    picture: StoredPicture<'a>,
    pub(super) rows: BandRows,
    /// Called after each written piece.
    report: OnProgress<'a>,
}

impl fmt::Debug for Bands<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { picture, rows, .. } = self;
        let mut debug = f.debug_struct("Bands");
        debug
            .field("picture", picture)
            .field("rows", rows)
            .finish_non_exhaustive()
    }
}

impl<'a> Bands<'a> {
    /// Creates a picture in pieces of these rows.
    pub fn new(picture: StoredPicture<'a>, rows: BandRows) -> Self {
        let report = &|_| {};
        Self {
            picture,
            rows,
            report,
        }
    }

    /// Returns the same, with `report` called after each written piece.
    pub fn reporting(self, report: OnProgress<'a>) -> Self {
        Self { report, ..self }
    }

    /// Surveys all pixels on the current rayon pool, and calls `look_at` with each band; `None` if
    /// they cannot be read again, or after a request to stop. Also returns the sum of the times of
    /// each rendering, in nanoseconds.
    pub fn survey(
        &self,
        mut look_at: impl FnMut(&Film),
        report: OnProgress,
    ) -> Option<(Survey, Vec<f64>)> {
        let mut surveyor = Surveyor::new(self.picture.film);
        let mut sums_ns = vec![0.0; self.picture.film.n_repeats.into()];
        for rows in self.rows.ranges() {
            let (band, more_ns) = self.band(&rows).ok()?;
            for (sum, ns) in sums_ns.iter_mut().zip(more_ns) {
                *sum += ns;
            }
            surveyor.add(&band);
            look_at(&band);
            report(self.progress(&rows));
        }
        Some((surveyor.finish(), sums_ns))
    }

    /// Writes the picture and all pieces.
    pub(super) fn stage(
        &self,
        job: &WriterInput,
        staging: &Staging,
    ) -> Result<Vec<Written>, WriteError> {
        let mut pieces = Vec::new();
        let mut failure = None;
        let staged = staging.stage(picture::NAME, |out| {
            picture::write_bands(job, out, |take| {
                for (i, rows) in self.rows.ranges().enumerate() {
                    let (band, _) = self.band(&self.with_row_above(&rows))?;
                    take(&band, rows.clone())?;
                    let progress = self.progress(&rows);
                    match self.stage_pieces(i, rows, &band, job, staging) {
                        Ok(staged) => pieces.extend(staged),
                        Err(error) => {
                            failure = Some(error);
                            return Err(io::Error::other("a piece cannot be written"));
                        }
                    }
                    (self.report)(progress);
                }
                Ok(())
            })
        });
        if let Some(failure) = failure {
            return Err(failure);
        }
        pieces.insert(0, staged?);
        Ok(pieces)
    }

    fn stage_pieces(
        &self,
        i: usize,
        rows: Range<u32>,
        band: &Film,
        job: &WriterInput,
        staging: &Staging,
    ) -> Result<[Written; 2], WriteError> {
        let encoding = job.encoding_of_pixels();
        // Adjacent pieces of an image share a row of points.
        let overlapping = rows.start.saturating_sub(1)..rows.end;
        let (frame, hits) = rayon::join(
            || {
                staging.stage(self.rows.name(i, FRAME_PIECE), |out| {
                    frame::write_rows(band, overlapping, encoding.clone(), out)
                })
            },
            || {
                staging.stage(self.rows.name(i, HITS_PIECE), |out| {
                    let distances = &job.rendering.survey.distances;
                    hits::write_rows(band, rows, distances, encoding.clone(), out)
                })
            },
        );
        Ok([frame?, hits?])
    }

    /// Returns the rows of a piece, extended by the rows above it that are read together with its
    /// first.
    fn with_row_above(&self, rows: &Range<u32>) -> Range<u32> {
        let unit = StoredPicture::row_unit(&self.picture.film.grid);
        rows.start.saturating_sub(unit)..rows.end
    }

    fn band(&self, rows: &Range<u32>) -> io::Result<(Film, Vec<f64>)> {
        if stop::is_requested() {
            return Err(io::ErrorKind::Interrupted.into());
        }
        let band = self.picture.band(rows.clone());
        band.ok_or_else(|| io::Error::other("the finished tiles cannot be read again"))
    }

    fn progress(&self, rows: &Range<u32>) -> Progress {
        let width = u64::from(self.picture.film.grid.width);
        Progress::from_pixels(width * rows.len() as u64, 0)
    }
}
