//! A config as the text of a scene file with every value.

use std::path::Path;

use serde_json::Value;

use super::Config;
use crate::yaml::{FieldPath, Folders, json_of, to_yaml};

impl Config {
    /// Returns the same scene with the values that follow from other keys, and without the list of
    /// included files. Values that follow from the content of files stay out.
    pub fn filled(&self) -> Self {
        let mut config = self.clone();
        let (image, film) = (&mut config.image, &mut config.film);
        let model = config.shading.model;
        config.include.clear();
        image.filter_radius = Some(image.filter_radius());
        film.transfer = Some(film.transfer(model));
        // Most models have a limit that only keeps sums finite, above what scene files may choose.
        let limit = film.sample_limit(model);
        film.sample_limit = (limit <= 1e15).then_some(limit);
        config
    }

    /// Returns the text of a scene file that has every value of the [filled](Self::filled) scene, for
    /// a file in `folder`: paths are relative to it, or absolute outside it. `folders` are those to
    /// which the config's paths are relative.
    ///
    /// # Errors
    /// A path is not UTF-8.
    pub fn resolved(
        &self,
        folder: &Path,
        folders: &(impl Folders + ?Sized),
    ) -> serde_json::Result<String> {
        let mut scene = json_of(&self.filled())?;
        let moved = |path: &FieldPath, file: &str| {
            let from = folders.folder_of(path);
            if from == folder {
                return file.to_owned();
            }
            let file = from.join(file);
            let inside = file.strip_prefix(folder).map(Path::to_owned);
            let moved = inside.unwrap_or_else(|_| std::path::absolute(&file).unwrap_or(file));
            moved.to_string_lossy().into_owned()
        };
        if let Value::Object(sections) = &mut scene {
            sections.shift_remove("include");
            for name in ["background", "materials", "objects"] {
                if let Some(section) = sections.get_mut(name) {
                    move_files(section, &FieldPath::default().key(name), &moved);
                }
            }
        }
        Ok(to_yaml(&scene))
    }
}

/// Replaces the value of every key `file` that has a path.
fn move_files(value: &mut Value, path: &FieldPath, moved: &impl Fn(&FieldPath, &str) -> String) {
    match value {
        Value::Object(keys) => {
            for (key, value) in keys {
                let path = path.clone().key(key);
                match value {
                    Value::String(file) if key == "file" => *file = moved(&path, file),
                    value => move_files(value, &path, moved),
                }
            }
        }
        Value::Array(list) => {
            for (index, value) in list.iter_mut().enumerate() {
                move_files(value, &path.clone().index(index), moved);
            }
        }
        _ => {}
    }
}
