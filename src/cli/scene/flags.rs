//! The settings of a command line as flags of another.

use std::path::Path;

use clap::Parser;
use serde_json::Value;

use super::SceneArguments;
use crate::cli::shell_word;
use host::text::Diagnostic;
use scene::yaml::json_of;

/// The arguments of a scene, parsed on their own.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct SceneCommand {
    #[command(flatten)]
    scene: SceneArguments,
}

/// A flag without its dashes, and its value.
type Flag = (String, String);

impl SceneArguments {
    /// Returns the flags that determine the pixels and the output folder, each preceded by a blank:
    /// with them, another command renders the same pixels.
    pub(in crate::cli) fn flags_of_the_picture(&self) -> Vec<String> {
        let is_of_picture = |(name, _): &Flag| match name.as_str() {
            "cost" | "repeats" | "tile-size" | "tile-order" | "compress" => false,
            // What is set may name arrays of these outputs.
            "also" => !self.set.is_empty(),
            _ => true,
        };
        let flags = self.given().into_iter().filter(is_of_picture);
        let words = flags.map(|(name, value)| (name, shell_word(Path::new(&value))));
        let out = self.out.as_deref().map(shell_word);
        let words = words.chain(out.map(|folder| ("out".to_owned(), folder)));
        words
            .map(|(name, word)| format!(" --{name} {word}"))
            .collect()
    }

    /// Returns all flags except the output folder, each as one argument: with them,
    /// [`from_flags`](Self::from_flags) gives the same settings.
    pub(in crate::cli) fn all_flags(&self) -> Vec<String> {
        let cost = self.cost();
        let flags = Self {
            cost,
            ..self.clone()
        }
        .given()
        .into_iter();
        flags
            .map(|(name, value)| format!("--{name}={value}"))
            .collect()
    }

    /// Returns the flags that have a value; the flag of a list once for each item.
    fn given(&self) -> Vec<Flag> {
        // Numbers, texts and words always have JSON.
        let flags = json_of(self).unwrap_or_default();
        let flags = flags.as_object().into_iter().flatten();
        let each = flags.flat_map(|(name, value)| {
            let values = match value {
                Value::Null => &[],
                Value::Array(items) => &items[..],
                one => std::slice::from_ref(one),
            };
            let text = |value: &Value| value.as_str().map_or(value.to_string(), str::to_owned);
            values.iter().map(move |value| (name.clone(), text(value)))
        });
        each.collect()
    }

    /// Returns the arguments of a scene with [`all_flags`](Self::all_flags) of another command, to
    /// write to a folder.
    ///
    /// # Errors
    /// If the flags do not belong to a scene.
    pub(in crate::cli) fn from_flags(
        scene: &Path,
        flags: &[String],
        out: &Path,
    ) -> Result<Self, Diagnostic> {
        let out = [Path::new("--out"), out].map(Path::as_os_str);
        let flags = flags.iter().map(std::ffi::OsStr::new);
        let scene = [std::ffi::OsStr::new("--"), scene.as_os_str()];
        let command = SceneCommand::try_parse_from(flags.chain(out).chain(scene));
        let parsed = command.map_err(|error| {
            let why = error.to_string();
            Diagnostic::new(format!("cannot use the stored flags of the scene: {why}"))
        })?;
        Ok(parsed.scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_give_the_same_settings() {
        let all = [
            "--width=7",
            "--height=8",
            "--crop=1,2,3,4",
            "--spp=3",
            "--until-noise=0.01",
            "--seed=18446744073709551615",
            "--max-depth=0",
            "--exposure=-0.1",
            "--tone-curve=agx",
            "--acceleration=brute_force",
            "--count=5",
            "--cost=time",
            "--repeats=4",
            "--tile-size=8",
            "--tile-order=hilbert",
            "--also=radiance,schedule",
            "--compress=lz4",
            "--set=camera.x='a b'",
            "--set=y=[1, 2]",
        ];
        for flags in [
            &all[..],
            &[],
            &["--no-cost"],
            &["--repeats=auto", "--cost=none"],
        ] {
            let command = flags.iter().copied().chain(["--out", "there"]);
            let given = SceneCommand::try_parse_from(command.chain(["--", "scene.yaml"]));
            let given = given.unwrap_or_else(|error| panic!("{error}")).scene;
            let stored = given.all_flags();
            let again =
                SceneArguments::from_flags(Path::new("scene.yaml"), &stored, Path::new("there"));
            let again = again.unwrap();
            assert_eq!(again.all_flags(), stored);
            // `--no-cost` is short for another flag.
            let [no_cost, none] = [
                "cost: None, no_cost: true",
                "cost: Some(None), no_cost: false",
            ];
            let given = format!("{given:?}").replace(no_cost, none);
            assert_eq!(format!("{again:?}"), given);
        }
    }
}
