//! ParaView's collections of data sets over time, `.pvd`.

use std::fmt::Write;

use super::{FRAMES, PREFIX, SeriesFrame};
use host::provenance::{RunId, stamped};

/// The endings of VTK files.
const VTK: [&str; 3] = [".vtu", ".vti", ".vtp"];

/// The start of a line that names a data set.
const ENTRY: &str = "<DataSet";
/// The name of the collection of all files.
pub(super) const ALL: &str = "series.pvd";
/// The start of the comment with the number of frames of the animation.
const N_FRAMES: &str = "<!-- frames of the animation: ";

/// Returns the number of frames of the animation that a collection belongs to.
pub(super) fn n_frames_in(text: &str) -> Option<u32> {
    let (number, _) = text.split_once(N_FRAMES)?.1.split_once(' ')?;
    number.parse().ok()
}

/// Returns the name of the `.pvd` of a VTK file of the frames, such as `series_hits.pvd`.
pub(super) fn name_of(file: &str) -> String {
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    format!("{PREFIX}_{stem}.pvd")
}

/// Returns a `.pvd` for each VTK file of the frames of an animation of `n_frames`, and
/// `series.pvd`, whose parts are all of them: names and texts.
pub(super) fn collections(
    frames: &[SeriesFrame],
    n_frames: u32,
    run: RunId,
) -> Vec<(String, String)> {
    let mut names: Vec<&str> = Vec::new();
    for file in frames.iter().flat_map(|frame| &frame.files) {
        let is_new = VTK.iter().any(|ending| file.ends_with(ending)) && !names.contains(&&**file);
        if is_new {
            names.push(file);
        }
    }
    let text_of = |names: &[&str]| stamped(&collection(frames, n_frames, names), run);
    let single = |name: &&str| (name_of(name), text_of(&[name]));
    std::iter::once((ALL.to_owned(), text_of(&names)))
        .chain(names.iter().map(single))
        .collect()
}

/// Returns true if a line names a data set.
pub(super) fn is_entry(line: &str) -> bool {
    line.starts_with(ENTRY)
}

/// Returns a collection whose parts are these files of each frame.
fn collection(frames: &[SeriesFrame], n_frames: u32, names: &[&str]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n{N_FRAMES}{n_frames} -->\n\
         <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
         <Collection>\n"
    );
    for frame in frames {
        let has = |name: &&&str| frame.files.iter().any(|file| file == **name);
        for (part, name) in names.iter().enumerate().filter(|(_, name)| has(name)) {
            let _ = writeln!(
                text,
                "{ENTRY} timestep=\"{}\" part=\"{part}\" name=\"{}\" file=\"{FRAMES}/{:04}/{name}\"/>",
                frame.time,
                name.rsplit_once('.').map_or(*name, |(stem, _)| stem),
                frame.number,
            );
        }
    }
    text + "</Collection>\n</VTKFile>\n"
}
