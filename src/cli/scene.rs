//! A scene as the command line names and changes it.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::shell_word;
use crate::config::{
    Config, CostMode, MAX_SIDE, OptionalOutput, Repeats, Structure, TileOrder, Tiling,
};
use crate::memory::{self, Memory};
use crate::scene::Geometries;
use crate::text::Diagnostic;
use crate::vtk::Codec;
use crate::yaml::{self, Fault, Source};

/// What names a scene and changes it.
#[derive(Debug, clap::Args)]
pub(super) struct SceneArguments {
    /// The scene's YAML file
    pub(super) scene: PathBuf,

    /// Folder to write to [default: out/<the scene file's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Columns of the picture, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE as i64))]
    width: Option<u32>,

    /// Rows of the picture, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE as i64))]
    height: Option<u32>,

    /// Samples per pixel, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    spp: Option<u32>,

    /// Seed of the sampling pattern, instead of the file's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Longest path in bounces, instead of the file's
    #[arg(long, value_name = "BOUNCES")]
    max_depth: Option<u8>,

    /// How hits are found, instead of the file's
    #[arg(long, value_name = "STRUCTURE")]
    acceleration: Option<Structure>,

    /// Spheres of each `sphere_cloud`, instead of the file's; their radii change
    /// so that they fill the same share of space
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    count: Option<u32>,

    /// What is measured of each pixel, instead of the file's
    #[arg(long, value_name = "MODE")]
    cost: Option<CostMode>,

    /// Short for `--cost none`
    #[arg(long, conflicts_with = "cost")]
    no_cost: bool,

    /// Times to render the picture, 1 to 255, instead of the file's: a pixel's time
    /// becomes the median. `auto` is up to 5 within half a second [default: auto]
    #[arg(long, value_name = "N")]
    repeats: Option<Repeats>,

    /// Pixels along a tile's side, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(Tiling::MIN_SIZE as i64..=Tiling::MAX_SIZE as i64))]
    tile_size: Option<u32>,

    /// In which order threads take tiles, instead of the file's
    #[arg(long, value_name = "ORDER")]
    tile_order: Option<TileOrder>,

    /// Files to write beside those of every run, and those that the scene asks for
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    also: Vec<OptionalOutput>,

    /// How the arrays of VTK files are compressed, instead of the file's
    #[arg(long, value_name = "CODEC")]
    compress: Option<Codec>,
}

/// A scene file, what it says, and what the files hold that it names.
pub(super) struct Loaded {
    pub(super) source: Source,
    pub(super) config: Config,
    pub(super) geometries: Geometries,
}

impl SceneArguments {
    /// Reads the scene and makes sure that it fits into memory with its film.
    pub(super) fn load(&self) -> Result<Loaded, Diagnostic> {
        self.load_for(Memory::of)
    }

    /// Reads the scene and makes sure that what is done with it fits into memory.
    pub(super) fn load_for(
        &self,
        needed: impl Fn(&Config, &Geometries) -> Memory,
    ) -> Result<Loaded, Diagnostic> {
        let source = Source::read(&self.scene)?;
        let mut config: Config = source.parse()?;
        let image = &mut config.image;
        image.width = self.width.unwrap_or(image.width);
        image.height = self.height.unwrap_or(image.height);
        image.samples_per_pixel = self.spp.unwrap_or(image.samples_per_pixel);
        image.seed = self.seed.unwrap_or(image.seed);
        config.shading.max_depth = self.max_depth.unwrap_or(config.shading.max_depth);
        config.acceleration = self.acceleration.map_or(config.acceleration, Into::into);
        if let Some(count) = self.count {
            config
                .set_count(count)
                .map_err(|fault| source.point_at(fault))?;
        }
        config.cost = self.cost().unwrap_or(config.cost);
        self.set_repeats(&mut config, &source)?;
        let tiles = &mut config.tiles;
        tiles.size = self.tile_size.unwrap_or(tiles.size);
        tiles.order = self.tile_order.unwrap_or(tiles.order);
        config.compress = self.compress.unwrap_or(config.compress);
        let by_file = config.output.clone();
        self.also
            .iter()
            .for_each(|&requested| config.output.add(requested));
        config.check_output().map_err(|(requested, fault)| {
            if by_file.has(requested) {
                source.point_at(fault)
            } else {
                fault.without_place()
            }
        })?;
        let available = memory::available();
        let geometries = Geometries::read(&config, source.folder(), available)
            .map_err(|fault| source.point_at(fault))?;
        // What was read is part of the need, and no longer of what is free.
        needed(&config, &geometries)
            .check(available)
            .map_err(|fault| source.point_at(fault))?;
        Ok(Loaded {
            source,
            config,
            geometries,
        })
    }

    /// For a command that has its own files: makes sure that no others are
    /// asked for.
    pub(super) fn refuse_also(&self) -> Result<(), Diagnostic> {
        if self.also.is_empty() {
            Ok(())
        } else {
            Err(
                Diagnostic::new("this command does not write optional outputs")
                    .with_help("give `--also` to `raycost render`"),
            )
        }
    }

    /// What the command line says of the cost, if anything.
    fn cost(&self) -> Option<CostMode> {
        if self.no_cost {
            Some(CostMode::None)
        } else {
            self.cost
        }
    }

    /// Makes the config's repeats those of the command line.
    fn set_repeats(&self, config: &mut Config, source: &Source) -> Result<(), Diagnostic> {
        let of_file = config.repeats;
        config.repeats = self.repeats.unwrap_or(of_file);
        // What the command line alone turns off, it turns off as a whole.
        if self.repeats.is_none() && self.cost().is_some_and(|cost| !cost.has_time()) {
            config.repeats = Repeats::Auto;
        }
        let Err(fault) = config.check_repeats() else {
            return Ok(());
        };
        let message = "`--repeats` requires times, and none are measured";
        match (self.repeats, self.cost()) {
            (None, _) => Err(source.point_at(fault)),
            (Some(_), Some(_)) => {
                Err(Diagnostic::new(message).with_help("use `--cost time`, or omit `--repeats`"))
            }
            (Some(_), None) => Err(source.point_at(
                Fault::new(
                    yaml::Path::default().key("cost"),
                    message,
                    "expected `time`",
                )
                .with_help("add `--cost time`, or leave out `--repeats`"),
            )),
        }
    }

    /// The flags that change the picture or where its files go, each with a blank
    /// before it: with them, another command sees the same pixels.
    pub(super) fn flags_of_the_picture(&self) -> Vec<String> {
        let flag = |name: &str, value: Option<String>| value.map(|v| format!(" --{name} {v}"));
        let number = |n: Option<u32>| n.map(|n| n.to_string());
        let structure = self.acceleration.and_then(|s| s.to_possible_value());
        let flags = [
            flag("width", number(self.width)),
            flag("height", number(self.height)),
            flag("spp", number(self.spp)),
            flag("seed", self.seed.map(|seed| seed.to_string())),
            flag("max-depth", self.max_depth.map(|n| n.to_string())),
            flag("acceleration", structure.map(|s| s.get_name().to_owned())),
            flag("count", number(self.count)),
            flag("out", self.out.as_deref().map(shell_word)),
        ];
        flags.into_iter().flatten().collect()
    }

    /// The folder to write to.
    pub(super) fn out(&self) -> PathBuf {
        match &self.out {
            Some(out) => out.clone(),
            None => Path::new("out").join(self.name()),
        }
    }

    /// The scene's name.
    pub(super) fn name(&self) -> String {
        let stem = self.scene.file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }
}
