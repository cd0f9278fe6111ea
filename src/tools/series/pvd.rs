//! ParaView's collections of data sets over time, `.pvd`.

use std::fmt::Write;

use super::{FRAMES, PREFIX, SeriesFrame};
use base::provenance::{RunId, stamped};

/// The endings of VTK files.
const VTK: [&str; 3] = [".vtu", ".vti", ".vtp"];

/// Returns the name of the `.pvd` of a VTK file of the frames, such as `series_hits.pvd`.
pub(super) fn name_of(file: &str) -> String {
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    format!("{PREFIX}_{stem}.pvd")
}

/// Returns a `.pvd` for each VTK file of the frames, and `series.pvd`, whose parts are all of them:
/// names and texts.
pub(super) fn collections(frames: &[SeriesFrame], run: RunId) -> Vec<(String, String)> {
    let mut names: Vec<&str> = Vec::new();
    for file in frames.iter().flat_map(|frame| &frame.files) {
        let is_new = VTK.iter().any(|ending| file.ends_with(ending)) && !names.contains(&&**file);
        if is_new {
            names.push(file);
        }
    }
    let all = (format!("{PREFIX}.pvd"), collection(frames, &names, run));
    let single = |name: &&str| (name_of(name), collection(frames, &[name], run));
    std::iter::once(all)
        .chain(names.iter().map(single))
        .collect()
}

/// Returns a collection whose parts are these files of each frame.
fn collection(frames: &[SeriesFrame], names: &[&str], run: RunId) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
         <Collection>\n"
        .to_owned();
    for frame in frames {
        let has = |name: &&&str| frame.files.iter().any(|file| file == **name);
        for (part, name) in names.iter().enumerate().filter(|(_, name)| has(name)) {
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{}\" part=\"{part}\" name=\"{}\" file=\"{FRAMES}/{:04}/{name}\"/>",
                frame.time,
                name.rsplit_once('.').map_or(*name, |(stem, _)| stem),
                frame.number,
            );
        }
    }
    stamped(&(text + "</Collection>\n</VTKFile>\n"), run)
}
