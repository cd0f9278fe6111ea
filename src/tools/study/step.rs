//! The steps of a study: settings that add up, one step after the other.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Case, FlagFactor};
use scene::config::SimdSet;
use scene::yaml::{Fault, FieldPath};
use world::values;

/// A step of a study.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyStep {
    /// The name in tables and plots.
    #[serde(with = "values::Name")]
    pub name: String,
    /// The levels that join or replace the levels of the steps before.
    #[serde(default)]
    pub set: Case,
    /// Another program that makes only the picture of this step, in place of raycost.
    #[serde(default)]
    pub command: Option<StepCommand>,
}

/// A step that cannot be made here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOutStep {
    /// The step's name.
    pub step: String,
    /// The reason, in one line.
    pub reason: String,
}

impl StudyStep {
    /// Returns the reason why this processor cannot make the step, if there is one.
    pub fn lacks_instructions(&self) -> Option<String> {
        let level = self.set.level(FlagFactor::Simd)?;
        let simd: SimdSet = serde_json::from_value(level.clone()).ok()?;
        Some(simd.detect().err()?.message().to_owned())
    }

    /// Returns the device that renders from this step on, if it sets one.
    pub fn device(&self) -> Option<&str> {
        self.set.level(FlagFactor::Device)?.as_str()
    }

    /// Returns true if the step starts several processes.
    pub fn has_ranks(&self) -> bool {
        self.set.level(FlagFactor::Ranks).is_some()
    }
}

/// Removes each step with a reason why it cannot be made, and each that measures the same as the
/// step before, such as all threads on one processor. Returns the removed ones.
pub(super) fn leave_out(
    steps: &mut Vec<StudyStep>,
    mut why_not: impl FnMut(&StudyStep) -> Option<String>,
) -> Vec<LeftOutStep> {
    let mut left_out = Vec::new();
    let mut settings = Case::default();
    steps.retain(|step| {
        let joined = settings.joined_with(&step.set);
        let is_idle = step.command.is_none() && joined == settings;
        let idle = || is_idle.then(|| "changes nothing on this machine".to_owned());
        let Some(reason) = why_not(step).or_else(idle) else {
            settings = joined;
            return true;
        };
        let step = step.name.clone();
        left_out.push(LeftOutStep { step, reason });
        false
    });
    left_out
}

/// A command such as `python loop.py {scene} {image}`, started in the folder of the study. Its
/// words are separated by blanks.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(transparent)]
pub struct StepCommand(String);

impl StepCommand {
    /// The placeholders: the scene's file, the path of the picture to write, and the study's flags.
    const PLACES: [&str; 3] = ["{scene}", "{image}", "{flags}"];

    /// Checks that the command names a program, and has no other braces than the placeholders.
    ///
    /// # Errors
    /// If it does not.
    pub(super) fn check(&self, path: FieldPath) -> Result<(), Fault> {
        let without = |text: String, place: &str| text.replace(place, "");
        let others = Self::PLACES.into_iter().fold(self.0.clone(), without);
        if !others.trim().is_empty() && !others.contains(['{', '}']) {
            return Ok(());
        }
        let message = "`command` must name a program, and have no braces but `{scene}`, `{image}` \
                       and `{flags}`";
        let expected = "expected a command such as `python loop.py {scene} {image}`";
        Err(Fault::new(path, message, expected))
    }

    /// Returns the command as the study states it.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Returns the words of the command.
    pub fn words(&self, scene: &str, image: &str, flags: &[String]) -> Vec<String> {
        let words = self.0.split_whitespace().flat_map(|word| match word {
            "{flags}" => flags.to_vec(),
            _ => vec![word.replace("{scene}", scene).replace("{image}", image)],
        });
        words.collect()
    }
}
