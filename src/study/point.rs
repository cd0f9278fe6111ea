//! One combination of what a study varies.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use super::{Factor, Level};

/// A scene and a level of each factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The scene's file, relative to the study's folder.
    pub scene: PathBuf,
    /// The flags of its levels.
    pub flags: Vec<String>,
    /// The scene's name and the value of each factor, by their names.
    pub values: Map<String, Value>,
}

impl Point {
    /// A scene as its file has it.
    pub(super) fn of_scene(scene: &Path) -> Self {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy();
        let values = [("scene".to_owned(), Value::from(name.into_owned()))];
        Self {
            scene: scene.to_owned(),
            flags: Vec::new(),
            values: values.into_iter().collect(),
        }
    }

    /// The point with a level of one more factor.
    pub(super) fn with(&self, factor: Factor, level: &Level) -> Self {
        let mut point = self.clone();
        point.flags.extend(level.flags.iter().cloned());
        point
            .values
            .insert(factor.name().to_owned(), level.value.clone());
        point
    }

    /// "scene seed_extended, threads 2": as it is told.
    pub fn label(&self) -> String {
        let named = |(name, value): (&String, &Value)| match value {
            Value::String(text) => format!("{name} {text}"),
            number => format!("{name} {number}"),
        };
        self.values.iter().map(named).collect::<Vec<_>>().join(", ")
    }
}
