//! The arguments of the command line that name a scene and override its settings.

mod crop;
mod flags;

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::cli::{keyword, shell_word, study};
use crate::job::SceneSource;
use base::Keyword;
use crop::Crop;
use host::folder::SUMMARY;
use host::text::{Diagnostic, shown};
use import::ForeignFormat;
use output::summary::Summary;
use scene::config::{
    Adaptive, Config, CostMode, FilmSettings, Image, MAX_SAMPLES, MAX_SHAPES, MAX_SIDE,
    OptionalOutput, Outputs, RatioMetrics, Repeats, Structure, TileOrder, Tiling,
};
use scene::yaml::{self, Document, Fault, Source};
use tools::series::frame_folder;
use tools::starter::{self, UpAxis};
use vtk::Codec;
use world::color::ToneCurve;

/// The name of standard input as a scene.
const STANDARD_INPUT: &str = "-";

/// The scene file and the settings that override the file's.
#[derive(Debug, Clone, Default, clap::Args, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(in crate::cli) struct SceneArguments {
    /// The scene's YAML file; `-` for standard input; or a mesh, for a scene around it
    #[serde(skip)]
    pub(in crate::cli) scene: PathBuf,

    /// Set a value of the scene, such as `camera.look_at.fov_y_deg=30` or
    /// 'objects[0].sphere.radius=0.5'; can be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,

    /// Folder to write to [default: out/<the scene file's name>; of a mesh, with its format]
    #[arg(long, value_name = "DIR")]
    #[serde(skip)]
    out: Option<PathBuf>,

    /// Columns of the picture, instead of the file's
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = side)]
    width: Option<u32>,

    /// Rows of the picture, instead of the file's
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true, value_parser = side)]
    height: Option<u32>,

    /// Only this window of the picture: its first column and row, from 0, its width and its
    /// height. Its pixels are the same as in the whole picture
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT")]
    crop: Option<Crop>,

    /// Samples per pixel, instead of the file's
    #[arg(long, alias = "samples", value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=MAX_SAMPLES as i64))]
    spp: Option<u32>,

    /// Sample each pixel until its standard error is below this share of white, 0.0001 to 1, with
    /// at most `--spp` samples, 65,536 by default: `image.adaptive` with `sampler: sobol`
    #[arg(long, value_name = "NOISE", allow_negative_numbers = true, value_parser = noise)]
    until_noise: Option<f32>,

    /// Seed of the sampling pattern, instead of the file's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    seed: Option<u64>,

    /// Longest path in bounces, instead of the file's
    #[arg(long, value_name = "BOUNCES", allow_negative_numbers = true)]
    max_depth: Option<u8>,

    /// Exposure in stops, each of which doubles the light, instead of the file's
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = stops)]
    exposure: Option<f32>,

    /// Tone curve, instead of the file's
    #[arg(long, value_name = "CURVE", value_parser = keyword::<ToneCurve>())]
    tone_curve: Option<ToneCurve>,

    /// Acceleration structure, instead of the file's
    #[arg(long, value_name = "STRUCTURE", value_parser = keyword::<Structure>())]
    acceleration: Option<Structure>,

    /// Spheres of each `sphere_cloud`, instead of the file's; their radii change
    /// so that they fill the same share of space
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_SHAPES as i64))]
    count: Option<u32>,

    /// Cost to measure for each pixel, instead of the file's
    #[arg(long, value_name = "MODE", value_parser = keyword::<CostMode>())]
    cost: Option<CostMode>,

    /// Short for `--cost none`
    #[arg(long, conflicts_with = "cost")]
    #[serde(skip)]
    no_cost: bool,

    /// Times to render the picture, 1 to 255, instead of the file's: a pixel's time
    /// becomes the median. `auto` is up to 5 within half a second [default: auto]
    #[arg(long, value_name = "N")]
    repeats: Option<Repeats>,

    /// Pixels along a tile's side, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(Tiling::MIN_SIZE as i64..=Tiling::MAX_SIZE as i64))]
    tile_size: Option<u32>,

    /// Order in which threads take tiles, instead of the file's
    #[arg(long, value_name = "ORDER", value_parser = keyword::<TileOrder>())]
    tile_order: Option<TileOrder>,

    /// Optional outputs, in addition to those that the scene requests
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = keyword::<OptionalOutput>())]
    also: Vec<OptionalOutput>,

    /// Compression of the arrays in VTK files, instead of the file's
    #[arg(long, value_name = "CODEC", value_parser = keyword::<Codec>())]
    compress: Option<Codec>,

    /// The axis of a mesh that points upward [default: z of STL and of low surfaces such as
    /// terrain, otherwise y]
    #[arg(long, value_name = "AXIS", value_parser = keyword::<UpAxis>())]
    up: Option<UpAxis>,

    /// Only the picture is wanted, in this format
    #[arg(skip)]
    #[serde(skip)]
    picture: Option<PictureFormat>,
}

/// A format of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) enum PictureFormat {
    Png,
    Exr,
}

impl SceneArguments {
    /// Requests only the picture, in this format.
    pub(in crate::cli) fn want_only_picture(&mut self, format: PictureFormat) {
        self.picture = Some(format);
    }

    /// Returns true if a setting of the command line changes the scene or its folder.
    pub(in crate::cli) fn changes_scene(&self) -> bool {
        self.out.is_some() || !self.all_flags().is_empty()
    }

    /// Returns true if the scene is read from standard input.
    pub(in crate::cli) fn is_standard_input(&self) -> bool {
        self.scene == Path::new(STANDARD_INPUT)
    }

    /// Returns the command that writes the scene of a mesh as a file; `None` for another scene.
    pub(in crate::cli) fn command_to_keep(&self) -> Option<String> {
        let mesh = import::is_geometry(&self.scene).then(|| shell_word(&self.scene))?;
        let stem = self.scene.file_stem().unwrap_or_default();
        let file = Path::new(stem).with_extension("yaml");
        let up = self
            .up
            .map_or(String::new(), |up| format!(" --up {}", up.name()));
        Some(format!(
            "raycost new --mesh {mesh}{up} {}",
            shell_word(&file)
        ))
    }

    /// Reads the text of the scene.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(in crate::cli) fn source(&self) -> Result<Source, Diagnostic> {
        if import::is_geometry(&self.scene) {
            starter::scene_beside(&self.scene, self.up)
        } else if self.up.is_some() {
            Err(Diagnostic::new("`--up` is for a mesh without a scene")
                .with_help("in a scene, `camera.look_at.up` and `transform` turn things"))
        } else if self.is_standard_input() {
            Source::read_standard_input()
        } else if let Some(format) = ForeignFormat::of(&self.scene) {
            let (name, file) = (format.name, shown(&self.scene));
            let message = format!("raycost does not read {name} files: `{file}`");
            Err(Diagnostic::new(message).with_help(format.advice))
        } else {
            Source::read(&self.scene)
        }
    }

    /// Refuses `--also`, for a command that writes only its own files.
    ///
    /// # Errors
    /// If `--also` is given.
    pub(in crate::cli) fn refuse_also(&self) -> Result<(), Diagnostic> {
        if self.also.is_empty() {
            Ok(())
        } else {
            Err(
                Diagnostic::new("this command does not write optional outputs")
                    .with_help("give `--also` to `raycost render`"),
            )
        }
    }

    /// Returns the cost mode of the command line, if given.
    fn cost(&self) -> Option<CostMode> {
        let is_unwanted = self.no_cost || (self.picture.is_some() && self.cost.is_none());
        if is_unwanted {
            Some(CostMode::None)
        } else {
            self.cost
        }
    }

    /// Sets the size, the samples and the window of the picture from the command line, if given.
    fn set_image(&self, image: &mut Image) -> Result<(), Diagnostic> {
        image.width = self.width.unwrap_or(image.width);
        image.height = self.height.unwrap_or(image.height);
        image.samples_per_pixel = self.spp.unwrap_or(image.samples_per_pixel);
        if let Some(noise) = self.until_noise {
            image.sample_until(noise);
            image.samples_per_pixel = self.spp.unwrap_or(MAX_SAMPLES);
        }
        image.seed = self.seed.unwrap_or(image.seed);
        if let Some(crop) = self.crop {
            *image = crop.apply(image)?;
        }
        Ok(())
    }

    /// Sets the outputs: only the picture if only it is wanted, and the outputs of `--also`.
    fn set_outputs(&self, config: &mut Config, document: &Document) -> Result<(), Diagnostic> {
        if let Some(format) = self.picture {
            config.output = Outputs::default();
            config.metrics = RatioMetrics::default();
            if format == PictureFormat::Exr {
                config.output.add(OptionalOutput::Exr);
            }
        }
        let by_file = config.output.clone();
        self.also
            .iter()
            .for_each(|&requested| config.output.add(requested));
        config.check_output().map_err(|(requested, fault)| {
            if by_file.has(requested) {
                document.point_at(fault)
            } else {
                fault.without_place()
            }
        })
    }

    /// Sets the config's repeats from the command line, if given.
    fn set_repeats(&self, config: &mut Config, document: &Document) -> Result<(), Diagnostic> {
        let of_file = config.repeats;
        config.repeats = self.repeats.unwrap_or(of_file);
        // A command line that disables times also disables the file's repeats.
        if self.repeats.is_none() && self.cost().is_some_and(|cost| !cost.has_time()) {
            config.repeats = Repeats::Auto;
        }
        let Err(fault) = config.check_repeats() else {
            return Ok(());
        };
        let message = "`--repeats` requires times, and none are measured";
        match (self.repeats, self.cost()) {
            (None, _) => Err(document.point_at(fault)),
            (Some(_), Some(_)) => {
                Err(Diagnostic::new(message).with_help("use `--cost time`, or omit `--repeats`"))
            }
            (Some(_), None) => Err(document.point_at(
                Fault::new(
                    yaml::FieldPath::default().key("cost"),
                    message,
                    "expected `time`",
                )
                .with_help("add `--cost time`, or leave out `--repeats`"),
            )),
        }
    }

    /// Returns the value of `--out`, if given.
    pub(in crate::cli) fn given_out(&self) -> Option<&Path> {
        self.out.as_deref()
    }

    /// Returns the folder to write to.
    pub(in crate::cli) fn out(&self) -> PathBuf {
        match &self.out {
            Some(out) => out.clone(),
            None => Path::new("out").join(self.default_folder()),
        }
    }

    /// Returns the name of the default folder: the scene's, and for a mesh its format, too.
    fn default_folder(&self) -> String {
        let name = self.name();
        match self.scene.extension() {
            Some(format) if import::is_mesh(&self.scene) => {
                format!("{name}_{}", format.to_string_lossy())
            }
            _ => name,
        }
    }

    /// Checks that the default folder does not have the output of another scene, a file that still
    /// exists.
    ///
    /// # Errors
    /// It has.
    pub(in crate::cli) fn refuse_other_output(&self) -> Result<(), Diagnostic> {
        let out = self.out();
        if self.out.is_some() || self.is_standard_input() {
            return Ok(());
        }
        let places = [out.clone(), out.join(frame_folder(0))];
        let summary = places
            .iter()
            .find_map(|place| Summary::read(&place.join(SUMMARY)).ok());
        let Some(Summary { scene: other, .. }) = summary else {
            return Ok(());
        };
        // Of a symbolic link, the file that it names.
        let files = [&self.scene, Path::new(&other.file)].map(std::fs::canonicalize);
        match files {
            [Ok(own), Ok(other_file)] if own != other_file => {
                let [shown_out, other] = [&out, Path::new(&other.file)].map(shown);
                let message = format!("`{shown_out}` has the output of another scene, `{other}`");
                let place = shell_word(&out.with_file_name(format!("{}-2", self.default_folder())));
                Err(Diagnostic::new(message)
                    .with_help(format!("name another folder, as in `--out {place}`")))
            }
            _ => Ok(()),
        }
    }
}

impl SceneSource for SceneArguments {
    fn file(&self) -> &Path {
        &self.scene
    }

    fn name(&self) -> String {
        if self.is_standard_input() {
            return "stdin".to_owned();
        }
        let stem = self.scene.file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }

    fn read(&self) -> Result<Source, Diagnostic> {
        let source = self.source()?;
        study::refuse_study(&source)?;
        Ok(source)
    }

    fn settings(&self) -> &[String] {
        &self.set
    }

    fn change(&self, config: &mut Config, document: &Document) -> Result<(), Diagnostic> {
        self.set_image(&mut config.image)?;
        config.shading.max_depth = self.max_depth.unwrap_or(config.shading.max_depth);
        let film = &mut config.film;
        film.exposure = self.exposure.unwrap_or(film.exposure);
        film.tone_curve = self.tone_curve.unwrap_or(film.tone_curve);
        config.acceleration = self.acceleration.map_or(config.acceleration, Into::into);
        if let Some(count) = self.count {
            config
                .set_count(count)
                .map_err(|fault| document.point_at(fault))?;
        }
        config.cost = self.cost().unwrap_or(config.cost);
        self.set_repeats(config, document)?;
        let tiles = &mut config.tiles;
        tiles.size = self.tile_size.unwrap_or(tiles.size);
        tiles.order = self.tile_order.unwrap_or(tiles.order);
        config.compress = self.compress.unwrap_or(config.compress);
        self.set_outputs(config, document)?;
        config
            .check_arrays()
            .and_then(|()| config.check_metrics())
            .map_err(|fault| document.point_at(fault))
    }

    fn flags(&self) -> Vec<String> {
        self.all_flags()
    }
}

/// Reads a standard error.
fn noise(text: &str) -> Result<f32, String> {
    let [least, greatest] = Adaptive::NOISE;
    let noise = text.parse().ok();
    let noise = noise.filter(|noise| (least..=greatest).contains(noise));
    let noise = noise.map(|noise: f64| noise as f32);
    noise.ok_or_else(|| format!("expected a standard error from {least} to {greatest}"))
}

/// Reads the width or the height of a picture.
fn side(text: &str) -> Result<u32, String> {
    let expected = || format!("expected a whole number from 1 to {MAX_SIDE}");
    let is_side = |side: &u32| (1..=MAX_SIDE).contains(side);
    let read = |text: &str| text.parse().ok().filter(is_side);
    let size = text
        .split_once(['x', 'X', '×'])
        .map(|(width, height)| (read(width), read(height)));
    match size {
        Some((Some(width), Some(height))) => Err(format!(
            "a size has two flags, `--width {width} --height {height}`"
        )),
        _ => read(text).ok_or_else(expected),
    }
}

/// Reads a seed.
fn seed(text: &str) -> Result<u64, String> {
    let expected = |_| format!("expected a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(expected)
}

/// Reads an exposure.
fn stops(text: &str) -> Result<f32, String> {
    let number = text.parse::<f32>().ok();
    let [least, greatest] = FilmSettings::STOPS;
    let in_range = number.filter(|&stops| (least..=greatest).contains(&stops.into()));
    in_range.ok_or_else(|| format!("expected a number from {least} to {greatest}"))
}
