//! One combination of scene and factor levels.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use super::factor_level::text_of;
use super::{Case, Factor, FlagFactor, StepCommand, StudyStep};

/// A scene and a level of each factor.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyPoint {
    /// The scene's file, relative to the study's folder.
    pub scene: PathBuf,
    /// The flags of `raycost render` that select the levels.
    pub flags: Vec<String>,
    /// The number of ranks, where that is a factor.
    pub ranks: Option<u64>,
    /// Another program that makes the picture.
    pub command: Option<StepCommand>,
    /// The scene's name and the value of each factor, by factor name; or the name of the step and
    /// all of its settings.
    pub values: Map<String, Value>,
}

/// The names of a step and its settings in the values of a point.
pub(super) const STEP: &str = "step";
pub(super) const SETTINGS: &str = "settings";

impl StudyPoint {
    /// Creates the point of a scene, with the values of its file.
    pub(super) fn from_scene(scene: &Path, name: String) -> Self {
        let values = [("scene".to_owned(), Value::from(name))];
        Self {
            scene: scene.to_owned(),
            flags: Vec::new(),
            ranks: None,
            command: None,
            values: values.into_iter().collect(),
        }
    }

    /// Returns the point with a level of one more factor.
    pub(super) fn with(&self, factor: &Factor, level: &Value) -> Self {
        let mut point = self.clone();
        point.add(factor, level);
        let name = factor.name().to_owned();
        point.values.insert(name, level.clone());
        point
    }

    /// Returns the point at a step with all of its settings.
    pub(super) fn at_step(&self, step: &StudyStep, settings: &Case) -> Self {
        let mut point = self.clone();
        let texts = match &step.command {
            Some(command) => vec![command.text().to_owned()],
            None => {
                let levels = settings
                    .0
                    .iter()
                    .inspect(|(factor, level)| point.add(factor, level));
                let text = |(factor, level): (&Factor, &Value)| {
                    format!("{} {}", factor.name(), text_of(level))
                };
                levels.map(text).collect()
            }
        };
        point.command = step.command.clone();
        for (key, text) in [(STEP, step.name.clone()), (SETTINGS, texts.join(", "))] {
            point.values.insert(key.to_owned(), text.into());
        }
        point
    }

    fn add(&mut self, factor: &Factor, level: &Value) {
        self.flags.extend(factor.flags(level));
        if *factor == Factor::Flag(FlagFactor::Ranks) {
            self.ranks = level.as_u64();
        }
    }

    /// Returns the name of the step.
    pub fn step(&self) -> Option<&str> {
        self.values.get(STEP)?.as_str()
    }

    /// Returns the name of the picture that a step leaves in the folder of the study.
    pub fn picture(&self) -> Option<String> {
        let name = format!("{}-{}", self.values.get("scene")?.as_str()?, self.step()?);
        Some(format!(
            "step-{}.png",
            name.replace(|c: char| c.is_control() || "/\\:\" ".contains(c), "-")
        ))
    }

    /// Returns the label in messages: "scene seed_extended, threads 2".
    pub fn label(&self) -> String {
        label_of(&self.values)
    }
}

/// Returns the names of scenes: the stems of their files, preceded by folders where needed to
/// distinguish them.
pub(super) fn scene_names(scenes: &[PathBuf]) -> impl Iterator<Item = String> {
    let name = |scene: &Path, n_parts: usize| {
        let bare = scene.with_extension("");
        let parts: Vec<_> = bare.iter().map(|part| part.to_string_lossy()).collect();
        parts[parts.len().saturating_sub(n_parts)..].join("/")
    };
    let mut names = HashMap::new();
    let mut unnamed: HashSet<&PathBuf> = scenes.iter().collect();
    let most = scenes.iter().map(|scene| scene.iter().count()).max();
    for n_parts in 1..=most.unwrap_or(1) {
        let mut by_name: HashMap<String, Vec<&PathBuf>> = HashMap::new();
        for scene in unnamed.drain() {
            let scenes = by_name.entry(name(scene, n_parts));
            scenes.or_default().push(scene);
        }
        for (name, scenes) in by_name {
            match scenes[..] {
                [own] => drop(names.insert(own, name)),
                _ => unnamed.extend(scenes),
            }
        }
    }
    scenes.iter().map(move |scene| {
        let name = names.get(scene).cloned();
        name.unwrap_or_else(|| scene.to_string_lossy().into_owned())
    })
}

/// Returns the values of a point as text: "scene seed_extended, threads 2".
pub fn label_of(values: &Map<String, Value>) -> String {
    let named = |(factor, value): (&String, &Value)| format!("{factor} {}", text_of(value));
    // The name of a step stands for its settings.
    let shown = values.iter().filter(|(factor, _)| *factor != SETTINGS);
    shown.map(named).collect::<Vec<_>>().join(", ")
}
