//! Lists of files over time, `.pvd`.

use super::super::{FileFault, Result};
use super::document::parse;

/// Returns the name and the time of each file of a `.pvd`.
pub(in crate::import) fn read(bytes: &[u8]) -> Result<Vec<(String, f64)>> {
    let (root, _) = parse(bytes)?;
    let collection = root.child("Collection").ok_or_else(|| {
        FileFault::new(
            "it is not a collection of files",
            "a `.pvd` as ParaView writes it",
        )
    })?;
    let mut steps: Vec<(String, f64)> = Vec::new();
    let entries = collection.children.iter();
    for entry in entries.filter(|entry| entry.name == "DataSet") {
        let file = entry.required("file")?.to_owned();
        let [time] = entry.numbers("timestep")?;
        if steps.last().is_some_and(|(_, before)| *before == time) {
            let problem = format!("time {time} has several parts");
            return Err(FileFault::new(
                problem,
                "one file for each time, such as a `.vtm`",
            ));
        }
        steps.push((file, time));
    }
    Ok(steps)
}
