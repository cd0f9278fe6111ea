//! The most expensive pixels of a rendering, and the command that traces them.

use std::path::Path;

use serde_json::{Value, json};

use super::frame::ShownPixels;
use host::text::Diagnostic;
use host::text::shell_word;
use output::results::{FrameFile, FramePiece};
use output::summary::Summary;
use render::film::{HotPixel, Times, highest_counts};
use tracer::cost::Metric;
use vtk::ArrayValues;

/// Greatest number of pixels listed for each metric.
const MAX_PIXELS_LISTED: usize = 3;

/// Returns the most expensive pixels by time and by node visits, each if measured. A pixel has its
/// column and its row in the whole picture, its value, and its index among the shown pixels, or null if it is not shown.
///
/// # Errors
/// If the frame is damaged.
pub(super) fn json(
    summary: &Summary,
    frame: &FrameFile,
    pixels: &ShownPixels,
) -> Result<Value, Diagnostic> {
    let mut found = Vec::new();
    if let Some(Metric { name, .. }) = Metric::measured_by(summary.cost.mode) {
        found.push((name, by_time(name, summary, frame)?));
    }
    found.push(("node_visits", by_count(frame, "node_visits")?));
    let width = u64::from(frame.width());
    let [left, top] = summary.image.place().origin;
    let pixel = |HotPixel { place, value }: &HotPixel| {
        let (x, y) = *place;
        let shown_at = pixels.index(u64::from(y) * width + u64::from(x));
        json!({ "x": left + x, "y": top + y, "value": value, "index": shown_at })
    };
    let by_array = |(array, found): &(&str, Vec<HotPixel>)| json!({ "array": array, "pixels": found.iter().map(pixel).collect::<Vec<_>>() });
    let is_found = |(_, found): &&(&str, Vec<HotPixel>)| !found.is_empty();
    Ok(found.iter().filter(is_found).map(by_array).collect())
}

/// Returns the command that traces pixels of this rendering, without `--pixel`; of a window, pixels
/// of the whole picture.
pub(super) fn trace_command(summary: &Summary) -> String {
    let image = &summary.image;
    let [width, height] = image.place().picture;
    let frame = summary.frame.as_ref();
    let frame = frame.map_or(String::new(), |frame| format!(" --frame {}", frame.number));
    format!(
        "raycost trace {}{frame} --width {width} --height {height} --spp {} --seed {}",
        shell_word(Path::new(&summary.scene.file)),
        image.samples_per_pixel,
        image.seed,
    )
}

fn by_time(name: &str, summary: &Summary, frame: &FrameFile) -> Result<Vec<HotPixel>, Diagnostic> {
    let width = frame.width() as usize;
    let n_repeats = summary.repeats.as_ref().map_or(1, |repeats| repeats.n);
    hottest_of(frame, |piece| {
        let read = |name: &str| {
            if piece.has(name) {
                piece.read(name).map(|array| Some(array.values))
            } else {
                Ok(None)
            }
        };
        let [ns, mad_ns] = [name, "time_mad_ns"].map(read);
        let (ns, mad_ns) = (ns?, mad_ns?);
        let times = Times {
            ns: rows_of_f32(ns.as_ref(), width),
            mad_ns: rows_of_f32(mad_ns.as_ref(), width),
            n_repeats: n_repeats.try_into().unwrap_or(u8::MAX),
        };
        Ok(times.hottest(MAX_PIXELS_LISTED))
    })
}

/// Returns the most expensive pixels of all pieces, given the pixels of each piece with rows
/// counted from its first row.
fn hottest_of(
    frame: &FrameFile,
    of_piece: impl Fn(&FramePiece) -> Result<Vec<HotPixel>, Diagnostic>,
) -> Result<Vec<HotPixel>, Diagnostic> {
    let mut hottest = Vec::new();
    for piece in frame.pieces() {
        let pixels = of_piece(piece)?.into_iter();
        hottest.extend(pixels.map(
            |HotPixel {
                 place: (x, y),
                 value,
             }| HotPixel {
                place: (x, y + piece.first_row()),
                value,
            },
        ));
    }
    hottest.sort_by(|a, b| b.value.total_cmp(&a.value));
    hottest.truncate(MAX_PIXELS_LISTED);
    Ok(hottest)
}

fn rows_of_f32(values: Option<&ArrayValues>, width: usize) -> Vec<&[f32]> {
    match values {
        Some(ArrayValues::F32(all)) => all.chunks_exact(width).collect(),
        _ => Vec::new(),
    }
}

fn by_count(frame: &FrameFile, name: &str) -> Result<Vec<HotPixel>, Diagnostic> {
    if !frame.has(name) {
        return Ok(Vec::new());
    }
    let width = frame.width() as usize;
    hottest_of(frame, |piece| {
        Ok(match piece.read(name)?.values {
            ArrayValues::U32(all) => {
                let rows = all.chunks_exact(width);
                highest_counts(rows, MAX_PIXELS_LISTED)
            }
            _ => Vec::new(),
        })
    })
}
