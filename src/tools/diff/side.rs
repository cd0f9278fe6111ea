//! One of the two outputs that a diff compares.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::Metric;
use host::text::Diagnostic;
use output::results::{FrameFile, LoadedArray, ObjectsTable, Results};
use output::summary::{self, Summary};
use render::film::Column;
use scene::config::PictureWindow;
use vtk::Scalar;

/// The pixels of a band, unless one row has more.
const BAND_PIXELS: u32 = 1 << 20;

/// An output folder, A or B, and the pixels of it that are compared.
#[derive(Debug)]
pub struct Side {
    results: Results,
    frame: FrameFile,
    label: String,
    /// Columns and rows of the compared pixels.
    size: [u32; 2],
    /// Column and row of the first compared pixel in the whole picture.
    origin: [u32; 2],
}

impl Side {
    /// Opens two folders, A and B. If they show different windows of the picture, the pixels that
    /// both show are compared; if there are none, their sizes or origins differ.
    ///
    /// # Errors
    /// If a folder does not hold an output, or its files cannot be read.
    pub fn open([a, b]: [&Path; 2]) -> Result<[Self; 2], Diagnostic> {
        let labels = distinct_suffixes([a, b]);
        let [label_a, label_b] = labels;
        let mut sides = [Self::new(a, label_a)?, Self::new(b, label_b)?];
        if let Some((origin, size)) = common_window(&sides) {
            for side in &mut sides {
                (side.origin, side.size) = (origin, size);
            }
        }
        Ok(sides)
    }

    /// Opens the only folder that is compared.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn alone(folder: &Path) -> Result<Self, Diagnostic> {
        let [label, _] = distinct_suffixes([folder; 2]);
        Self::new(folder, label)
    }

    fn new(folder: &Path, label: String) -> Result<Self, Diagnostic> {
        let results = Results::open(folder)?;
        let frame = results.frame()?;
        Ok(Self {
            size: [frame.width(), frame.height()],
            origin: results.summary.image.place().origin,
            frame,
            results,
            label,
        })
    }

    /// Returns the folder's path as the user typed it.
    pub fn name(&self) -> String {
        self.results.folder().display().to_string()
    }

    /// Returns a short name that differs from the other side's.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Returns the number of compared columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns column and row of the first compared pixel in the whole picture.
    pub(super) fn origin(&self) -> [u32; 2] {
        self.origin
    }

    /// Returns column and row of the first compared pixel in the frame.
    fn start(&self) -> [u32; 2] {
        let first = self.window().origin;
        [0, 1].map(|axis| self.origin[axis] - first[axis])
    }

    fn frame_size(&self) -> [u32; 2] {
        [self.frame.width(), self.frame.height()]
    }

    /// Returns true if the output has pixels that are not compared.
    pub(super) fn is_cut(&self) -> bool {
        self.size != self.frame_size()
    }

    /// Returns the position in the picture.
    pub(super) fn window(&self) -> PictureWindow {
        self.summary().image.place()
    }

    /// Returns "40 x 30", and of a window " at 7,5 of 80 x 60".
    pub(super) fn place(&self) -> String {
        let ([width, height], PictureWindow { origin, picture }) = (self.size, self.window());
        let mut place = format!("{width} x {height}");
        if self.size != picture {
            let ([x, y], [width, height]) = (origin, picture);
            place += &format!(" at {x},{y} of {width} x {height}");
        }
        place
    }

    /// Returns the contents of `summary.json`.
    pub fn summary(&self) -> &Summary {
        &self.results.summary
    }

    /// Checks that the output has these arrays of the pixels.
    ///
    /// # Errors
    /// If some are missing; the message says which setting writes them.
    pub(super) fn require(&self, arrays: &[&str]) -> Result<(), Diagnostic> {
        self.frame.require(arrays)
    }

    /// Opens `objects.csv`; `None` if the folder has none, or if it holds the cost of pixels that
    /// are not compared.
    pub(super) fn objects(&self) -> Result<Option<ObjectsTable<'_>>, Diagnostic> {
        if self.is_cut() {
            return Ok(None);
        }
        self.results.objects()
    }

    /// Returns the error for an unusable `objects.csv`.
    pub(super) fn no_table(&self, why: &str) -> Diagnostic {
        self.results.no_table(why)
    }

    /// Returns the path of a file in the folder.
    pub(super) fn path_of(&self, file: &str) -> PathBuf {
        self.results.folder().join(file)
    }

    /// Returns true if the output has this metric.
    pub fn has(&self, metric: Metric) -> bool {
        self.has_array(metric.name)
    }

    /// Returns true if the output has this array of the pixels.
    pub(super) fn has_array(&self, name: &str) -> bool {
        self.frame.has(name)
    }

    /// Returns the compared rows, row 0 on top.
    pub(super) fn rows(&self) -> Range<u32> {
        0..self.size[1]
    }

    /// Returns the compared rows in bands that are read one after the other, so that no array of
    /// all pixels is in memory.
    pub(super) fn bands(&self) -> impl DoubleEndedIterator<Item = Range<u32>> + use<> {
        let [width, height] = self.size;
        let n_rows = (BAND_PIXELS / width).max(1);
        let starts = (0..height).step_by(n_rows as usize);
        starts.map(move |start| start..height.min(start + n_rows))
    }

    /// Reads a metric of the pixels in `rows`, row-major.
    pub(super) fn costs(&self, metric: Metric, rows: Range<u32>) -> Result<Vec<f64>, Diagnostic> {
        let array = self.read(metric.name, 1, rows)?;
        let costs: Vec<f64> = array.values.iter().collect();
        Ok(self.compared(costs, 1))
    }

    /// Reads an array of IDs of the pixels in `rows`, row-major.
    pub(super) fn ids(&self, name: &str, rows: Range<u32>) -> Result<Vec<i32>, Diagnostic> {
        self.numbers(name, 1, rows)
    }

    /// Returns the columns (`axis` 0) or rows (`axis` 1) of the pixels in `rows` in the frame,
    /// row-major.
    pub(super) fn coordinates(&self, axis: usize, rows: Range<u32>) -> Vec<u16> {
        let ([x, y], [width, _]) = (self.start(), self.size);
        let at = |row| (0..width).map(move |column| [x + column, y + row][axis] as u16);
        rows.flat_map(at).collect()
    }

    /// Reads the colors of the pixels in `rows`, row-major.
    pub(super) fn colors(&self, rows: Range<u32>) -> Result<Vec<[u8; 3]>, Diagnostic> {
        let channels: Vec<u8> = self.numbers("RGB", 3, rows)?;
        Ok(channels.as_chunks().0.to_vec())
    }

    /// Reads the radiance of the pixels in `rows`, row-major, three channels each.
    pub(super) fn radiance(&self, rows: Range<u32>) -> Result<Vec<f32>, Diagnostic> {
        self.numbers(Column::RADIANCE.name, 3, rows)
    }

    /// Reads the standard errors of the pixels in `rows`, row-major.
    pub(super) fn noise(&self, rows: Range<u32>) -> Result<Vec<f32>, Diagnostic> {
        self.numbers(Column::NOISE.name, 1, rows)
    }

    fn numbers<T: Scalar>(
        &self,
        name: &str,
        n_components: usize,
        rows: Range<u32>,
    ) -> Result<Vec<T>, Diagnostic> {
        let array = self.read(name, n_components, rows)?;
        let numbers: &[T] = array.values.as_slice().ok_or_else(|| self.foreign(name))?;
        Ok(self.compared(numbers.to_vec(), n_components))
    }

    /// Reads an array of all pixels of the frame in the compared `rows`.
    fn read(
        &self,
        name: &str,
        n_components: usize,
        rows: Range<u32>,
    ) -> Result<LoadedArray, Diagnostic> {
        let [_, above] = self.start();
        let rows = rows.start + above..rows.end + above;
        let array = self.frame.read_rows(name, rows)?;
        if array.n_components == n_components {
            Ok(array)
        } else {
            Err(self.foreign(name))
        }
    }

    /// Returns the numbers of the compared pixels out of the numbers of rows of the frame.
    fn compared<T: Copy>(&self, numbers: Vec<T>, n_components: usize) -> Vec<T> {
        let [width, frame_width] = [self.size[0], self.frame.width()].map(|n| n as usize);
        if width == frame_width {
            return numbers;
        }
        let x = self.start()[0] as usize;
        let columns = x * n_components..(x + width) * n_components;
        let rows = numbers.chunks_exact(frame_width * n_components);
        rows.flat_map(|row| &row[columns.clone()])
            .copied()
            .collect()
    }

    /// Reads the summed time of all pixels in each repeat, in nanoseconds; empty if the run was not
    /// repeated.
    ///
    /// # Errors
    /// If a time is not positive.
    pub(super) fn repeats(&self) -> Result<Vec<f64>, Diagnostic> {
        let repeats = self.results.summary.repeats.as_ref();
        let times = repeats.map_or(&[][..], |repeats| &repeats.busy_ns);
        if times.iter().all(|time| *time > 0.0) {
            return Ok(times.to_vec());
        }
        let path = self.path_of(summary::FILE);
        let message = format!("`{}`: the time of a repeat is not positive", path.display());
        Err(Diagnostic::new(message).with_help("render the scene again"))
    }

    /// Returns the label of an object: its name, or its kind and its index in the scene file.
    pub(super) fn object_name(&self, id: i32) -> String {
        let objects = &self.results.summary.objects;
        let object = usize::try_from(id)
            .ok()
            .and_then(|index| objects.get(index));
        match object {
            _ if id < 0 => "nothing".to_owned(),
            None => format!("object {id}"),
            Some(object) => match &object.name {
                Some(name) => name.clone(),
                None => format!("{} (object {id})", object.kind),
            },
        }
    }

    /// Returns the folder, the scene and the version of raycost, as one line.
    pub(super) fn sentence(&self) -> String {
        let summary = self.summary();
        let (name, scene) = (self.name(), &summary.scene.file);
        let partial = summary
            .partial
            .map_or(String::new(), |it| format!(", {it}"));
        format!("{name}: {scene}, raycost {}{partial}", summary.raycost)
    }

    /// Refuses a picture that lacks tiles or renderings: its cost is lower for less work.
    ///
    /// # Errors
    /// The picture is partial.
    pub fn require_whole(&self) -> Result<(), Diagnostic> {
        let Some(partial) = &self.summary().partial else {
            return Ok(());
        };
        let message = format!("`{}` cannot pass or fail: {partial}", self.name());
        Err(Diagnostic::new(message).with_help("finish it by `raycost render --resume`"))
    }

    fn foreign(&self, array: &str) -> Diagnostic {
        let path = self.path_of(self.results.frame_name());
        let message = format!(
            "`{}`: `{array}` does not have the type that raycost writes",
            path.display()
        );
        Diagnostic::new(message).with_help("render the scene again")
    }
}

/// Returns the first pixel, and columns and rows, of the pixels of one picture that both outputs
/// show; `None` if there are none.
fn common_window([a, b]: &[Side; 2]) -> Option<([u32; 2], [u32; 2])> {
    if a.window().picture != b.window().picture {
        return None;
    }
    let origin = [0, 1].map(|axis| a.origin[axis].max(b.origin[axis]));
    let end = |side: &Side, axis: usize| side.origin[axis].saturating_add(side.frame_size()[axis]);
    let ends = [0, 1].map(|axis| end(a, axis).min(end(b, axis)));
    let is_empty = (0..2).any(|axis| ends[axis] <= origin[axis]);
    (!is_empty).then(|| (origin, [0, 1].map(|axis| ends[axis] - origin[axis])))
}

/// Returns the shortest suffixes of two paths that differ: `fast` and `high`, but `before/spot` and
/// `after/spot`.
fn distinct_suffixes(paths: [&Path; 2]) -> [String; 2] {
    let names = paths.map(|path| {
        // `.` has a name only after it is resolved.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let names = path.iter().map(|name| name.to_string_lossy().into_owned());
        names.collect::<Vec<_>>()
    });
    let end = |names: &[String], n: usize| names[names.len().saturating_sub(n)..].join("/");
    let longest = names.iter().map(Vec::len).max().unwrap_or(0);
    let differ = |n: &usize| end(&names[0], *n) != end(&names[1], *n);
    let n = (1..=longest).find(differ).unwrap_or(1);
    names.each_ref().map(|names| end(names, n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_different_folders_differ() {
        let suffixes = |a: &str, b: &str| distinct_suffixes([a, b].map(Path::new));
        assert_eq!(suffixes("/no/fast", "/no/high"), ["fast", "high"]);
        assert_eq!(suffixes("/no/a/spot", "/no/b/spot"), ["a/spot", "b/spot"]);
        assert_eq!(suffixes("/no/spot", "/no/spot"), ["spot", "spot"]);
    }
}
