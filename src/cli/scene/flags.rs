//! The settings of a command line as flags of another.

use std::path::Path;

use clap::Parser;

use super::SceneArguments;
use crate::cli::shell_word;
use base::Keyword;
use host::text::Diagnostic;
use scene::config::CostMode;

/// The arguments of a scene, parsed on their own.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct SceneCommand {
    #[command(flatten)]
    scene: SceneArguments,
}

/// A flag without its dashes, and its value.
type Flag = (&'static str, String);

impl SceneArguments {
    /// Returns the flags that determine the pixels and the output folder, each preceded by a blank:
    /// with them, another command renders the same pixels.
    pub(in crate::cli) fn flags_of_the_picture(&self) -> Vec<String> {
        let out = self.out.as_deref().map(shell_word);
        let picture = self.picture().into_iter();
        // What is set may name arrays of these outputs.
        let also = self.also().filter(|_| !self.set.is_empty());
        let flags = picture.chain(flag("out", out)).chain(flag("also", also));
        let set = self.set.iter().map(Path::new).map(shell_word);
        let set = set.map(|setting| format!(" --set {setting}"));
        let shown = flags.map(|(name, value)| format!(" --{name} {value}"));
        shown.chain(set).collect()
    }

    /// Returns the value of `--also`, if it is given.
    fn also(&self) -> Option<String> {
        let names: Vec<&str> = self.also.iter().map(|output| output.name()).collect();
        (!names.is_empty()).then(|| names.join(","))
    }

    /// Returns all flags except the output folder, each as one argument: with them,
    /// [`from_flags`](Self::from_flags) gives the same settings.
    pub(in crate::cli) fn all_flags(&self) -> Vec<String> {
        let cost = if self.no_cost {
            Some(CostMode::None)
        } else {
            self.cost
        };
        let measured = [
            flag("cost", name(cost)),
            flag("repeats", self.repeats.map(|n| n.to_string())),
            flag("tile-size", self.tile_size.map(|n| n.to_string())),
            flag("tile-order", name(self.tile_order)),
            flag("also", self.also()),
            flag("compress", name(self.compress)),
        ];
        let set = self.set.iter().map(|setting| ("set", setting.clone()));
        let flags = self
            .picture()
            .into_iter()
            .chain(measured.into_iter().flatten());
        flags
            .chain(set)
            .map(|(name, value)| format!("--{name}={value}"))
            .collect()
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

    /// Returns the flags that determine the pixels, besides `--set`.
    fn picture(&self) -> Vec<Flag> {
        let number = |n: Option<u32>| n.map(|n| n.to_string());
        let flags = [
            flag("up", name(self.up)),
            flag("width", number(self.width)),
            flag("height", number(self.height)),
            flag("crop", self.crop.map(|crop| crop.to_string())),
            flag("spp", number(self.spp)),
            flag("seed", self.seed.map(|seed| seed.to_string())),
            flag("max-depth", self.max_depth.map(|n| n.to_string())),
            flag("exposure", self.exposure.map(|stops| stops.to_string())),
            flag("tone-curve", name(self.tone_curve)),
            flag("acceleration", name(self.acceleration)),
            flag("count", number(self.count)),
        ];
        flags.into_iter().flatten().collect()
    }
}

fn name(keyword: Option<impl Keyword>) -> Option<String> {
    keyword.map(|keyword| keyword.name().to_owned())
}

fn flag(name: &'static str, value: Option<String>) -> Option<Flag> {
    value.map(|value| (name, value))
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
