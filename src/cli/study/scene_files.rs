//! The files of a study's scenes: runs are comparable only while these do not change.

use std::path::{Path, PathBuf};

use indexmap::{IndexMap, IndexSet};
use serde_json::{Value, json};

use crate::session::{contents_of, states_of};
use host::provenance::Checksum;
use host::text::Diagnostic;
use tools::study::StudyPoint;

/// The files of all scenes of a study, by the names of the scenes.
pub(super) struct SceneFiles(IndexMap<String, FileSet>);

/// Files as they were when the study was checked.
struct FileSet {
    files: IndexSet<PathBuf>,
    states: Checksum,
    contents: Checksum,
}

impl SceneFiles {
    /// Reads the files of these points, which `files_of` names.
    ///
    /// # Errors
    /// The errors of `files_of`, or if a file cannot be read.
    pub(super) fn read<E: From<Diagnostic>>(
        points: &[StudyPoint],
        files_of: impl Fn(&StudyPoint) -> Result<Vec<PathBuf>, E>,
    ) -> Result<Self, E> {
        let mut scenes: IndexMap<String, IndexSet<PathBuf>> = IndexMap::new();
        for point in points {
            let files = files_of(point)?;
            scenes.entry(name_of(point)).or_default().extend(files);
        }
        let read = |(name, files): (String, IndexSet<PathBuf>)| {
            let (states, contents) = (states_of(files.iter()), contents_of(files.iter())?);
            let files = FileSet {
                files,
                states,
                contents,
            };
            Ok((name, files))
        };
        Ok(Self(
            scenes.into_iter().map(read).collect::<Result<_, E>>()?,
        ))
    }

    /// Returns the names of the scenes.
    pub(super) fn names(&self) -> Vec<&str> {
        self.0.keys().map(String::as_str).collect()
    }

    /// Returns a hash of the contents of each scene's files, by the name of the scene.
    pub(super) fn hashes(&self) -> Value {
        let hashes = self.0.iter();
        let hashes = hashes.map(|(name, files)| (name.clone(), json!(files.contents)));
        Value::Object(hashes.collect())
    }

    /// Checks that the scene of a point has not changed since it was read. `out` is the folder of
    /// the runs.
    ///
    /// # Errors
    /// If it has changed, or it cannot be read.
    pub(super) fn check(&self, point: &StudyPoint, out: &Path) -> Result<(), Diagnostic> {
        let name = name_of(point);
        let Some(of_scene) = self.0.get(&name) else {
            return Ok(());
        };
        let files = || of_scene.files.iter();
        if states_of(files()) == of_scene.states || contents_of(files())? == of_scene.contents {
            return Ok(());
        }
        let message =
            format!("the scene `{name}`, or a file that it names, changed during the study");
        Err(Diagnostic::new(message).with_help(format!(
            "change it back to continue, or delete `{}` to measure anew",
            out.display()
        )))
    }
}

/// Returns the name of a point's scene.
fn name_of(point: &StudyPoint) -> String {
    let name = point.values.get("scene").and_then(Value::as_str);
    name.unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use scene::yaml;
    use tools::study::StudyPlan;

    #[test]
    fn a_scene_that_changes_during_a_study_stops_it() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = folder.path().join("mesh.ply");
        fs::write(&mesh, "ply").unwrap();
        let plan: StudyPlan = yaml::from_str("{ title: T, scenes: [s.yaml, t.yaml] }").unwrap();
        let points = plan.points();
        let files_of = |point: &StudyPoint| {
            let is_first = point.scene == Path::new("s.yaml");
            Ok::<_, Diagnostic>(is_first.then(|| mesh.clone()).into_iter().collect())
        };
        let files = SceneFiles::read(&points, files_of).unwrap();
        let out = Path::new("out");
        fs::write(&mesh, "ply").unwrap();
        assert!(files.check(&points[0], out).is_ok(), "written again");
        fs::write(&mesh, "ply 2").unwrap();
        let error = files.check(&points[0], out).unwrap_err().to_string();
        assert!(
            error.contains("the scene `s`, or a file that it names, changed"),
            "{error}"
        );
        assert!(error.contains("delete `out`"), "{error}");
        assert!(files.check(&points[1], out).is_ok(), "another scene");
    }
}
