//! One combination of scene and factor levels.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use super::{Factor, FactorLevel, FlagFactor};

/// A scene and a level of each factor.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyPoint {
    /// The scene's file, relative to the study's folder.
    pub scene: PathBuf,
    /// The flags of `raycost render` that select the levels.
    pub flags: Vec<String>,
    /// The scene's name and the value of each factor, by factor name.
    pub values: Map<String, Value>,
}

impl StudyPoint {
    /// The scene as its file states it.
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
    pub(super) fn with(&self, factor: &Factor, level: &FactorLevel) -> Self {
        let mut point = self.clone();
        point.flags.extend(level.flags.iter().cloned());
        point
            .values
            .insert(factor.name().to_owned(), level.value.clone());
        point
    }

    /// The number of ranks, where that is a factor.
    pub fn ranks(&self) -> Option<u64> {
        self.values.get(FlagFactor::Ranks.name())?.as_u64()
    }

    /// The label in messages: "scene seed_extended, threads 2".
    pub fn label(&self) -> String {
        label_of(&self.values)
    }
}

/// The values of a point as text: "scene seed_extended, threads 2".
pub fn label_of(values: &Map<String, Value>) -> String {
    let named = |(factor, value): (&String, &Value)| format!("{factor} {}", text_of(value));
    values.iter().map(named).collect::<Vec<_>>().join(", ")
}

/// A level's value as text, without quotes.
pub(super) fn text_of(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}
