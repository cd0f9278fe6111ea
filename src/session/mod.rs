//! Scene file → pixels and their cost → files: raycost as a library.
//!
//! A [`Session`] holds a checked scene. [`Session::render`] gives a [`Rendering`], whose pixels and
//! costs a program reads, and which [`Rendering::write`] writes as `raycost render` does: the
//! command line is a user of this module, too.

mod build;
mod error;
mod fingerprint;
mod frames;
mod input;
mod measure;
mod options;
mod rendering;
mod scope;
mod worker;

use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock};

use serde::Serialize;

use host::affinity;
use host::folder::OutputFolder;
use host::provenance::Checksum;
use output::estimate::{Memory, least_disk};
use output::summary::{FrameSection, OtherRuns, Threads};
use output::writers::{self, BandRows};
use scene::config::{Config, HierarchyUpdate};
use scene::yaml::{Document, Source, json_of, to_yaml};
use tracer::accel::{Accel, AccelIndex, FrameBase};
use world::scene::Scene;

#[doc(inline)]
pub use base::stop::{Cancellation, Stopped};
pub use build::this_build;
pub use error::{Kept, RenderError};
pub(crate) use fingerprint::{contents_of, scene_files, states_of};
pub(crate) use frames::Frames;
#[doc(inline)]
pub use host::folder::{WriteError, Written};
#[doc(inline)]
pub use host::text::Diagnostic;
pub(crate) use input::Input;
pub use options::{Event, Options};
pub(crate) use options::{thread_pool, without_thread};
#[doc(inline)]
pub use render::instruments::{Stage, Stages};
#[doc(inline)]
pub use render::tiles::Progress;
pub use rendering::Rendering;
pub(crate) use scope::Scope;

/// A checked scene that can be rendered.
#[derive(Debug)]
pub struct Session {
    document: Document,
    name: String,
    /// The frame of an animated scene.
    frame: Option<FrameSection>,
    config: Config,
    scene: Scene,
    /// Rows of the picture that are in memory at a time, if not all.
    band_rows: Option<u32>,
    /// The index of the acceleration structure, built by the first rendering.
    index: OnceLock<Arc<AccelIndex>>,
    /// The structure of another frame, from which this frame's structure derives.
    base: OnceLock<FrameBase>,
    /// A hash of the contents of that frame, if the structure may be refitted.
    base_contents: OnceLock<Checksum>,
    /// The stages of the first rendering, which includes the time to read the scene.
    stages: Mutex<Option<Stages>>,
}

impl Session {
    /// Reads and checks a scene file and the files that it names; for an animated scene, its first
    /// frame.
    ///
    /// # Errors
    /// The first mistake in the scene, with its line; or if the scene does not fit into memory.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Diagnostic> {
        Self::open_with(path, |_| {})
    }

    /// Opens a scene file as [`Self::open`] does, after `change` has changed settings. Values have
    /// to stay in the ranges that their descriptions state; sizes of the image and of tiles are
    /// checked.
    ///
    /// # Errors
    /// The errors of [`Self::open`].
    pub fn open_with(
        path: impl AsRef<Path>,
        change: impl FnOnce(&mut Config),
    ) -> Result<Self, Diagnostic> {
        let stages = Stages::default();
        let document = Document::new(Source::read(path.as_ref())?, Config::MERGING)?;
        let (document, mut config) = Frames::first(document)?;
        change(&mut config);
        Self::new(Input::read(document, config, Memory::estimate)?, stages)
    }

    /// Checks a scene that a program describes: any value that serializes to the same keys and
    /// values as a scene file, such as `serde_json::json!({ … })` or a [`Config`]; keys without a
    /// value are left out. `name` stands for the file in messages and in `summary.json`. Relative
    /// paths in the scene start from the current folder.
    ///
    /// # Errors
    /// The errors of [`Self::open`], with a line of the scene as YAML.
    pub fn from_value(name: &str, scene: &impl Serialize) -> Result<Self, Diagnostic> {
        let stages = Stages::default();
        let cannot = |error| Diagnostic::new(format!("cannot serialize the scene: {error}"));
        let text = to_yaml(&json_of(scene).map_err(cannot)?);
        let document = Document::new(Source::new(name, text), Config::MERGING)?;
        let (document, config) = Frames::first(document)?;
        Self::new(Input::read(document, config, Memory::estimate)?, stages)
    }

    /// Places a scene that was read. `stages` belong to the first rendering.
    ///
    /// # Errors
    /// The first value that contradicts others.
    pub(crate) fn new(input: Input, stages: Stages) -> Result<Self, Diagnostic> {
        let Input {
            document,
            config,
            geometries,
            frame,
            memory,
        } = input;
        let scene =
            scene::build::scene(&config, geometries).map_err(|fault| document.point_at(fault))?;
        let name = Path::new(document.name()).file_stem().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            document,
            frame,
            config,
            scene,
            band_rows: memory.band_rows,
            index: OnceLock::new(),
            base: OnceLock::new(),
            base_contents: OnceLock::new(),
            stages: Mutex::new(Some(stages)),
        })
    }

    /// Returns the scene's name: the stem of its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns true for a frame of an animated scene.
    pub(crate) fn is_frame(&self) -> bool {
        self.frame.is_some()
    }

    /// Returns the settings.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Returns the scene in render space.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Opens the folder that the files of a rendering will be written to; creates it if there is
    /// none. Called first, so that a long rendering does not end with files that cannot be written.
    ///
    /// # Errors
    /// If the folder cannot be written to, has too little space, or has a file of another program
    /// where raycost would write.
    pub(crate) fn folder(&self, path: &Path) -> Result<OutputFolder, WriteError> {
        let least = least_disk(&self.config, self.band_rows.is_some());
        let folder = OutputFolder::create(path, least)?;
        writers::refuse_foreign(&folder, self.bands())?;
        Ok(folder)
    }

    /// Returns the rows of the pieces in which the picture is written if it is larger than memory:
    /// then its tiles have to be kept in files.
    pub(crate) fn bands(&self) -> Option<BandRows> {
        let height = self.config.image.height;
        let rows = |n_rows| BandRows { height, n_rows };
        self.band_rows.map(rows)
    }

    /// Renders the scene and measures what its config requests. The first rendering also builds the
    /// acceleration structure.
    ///
    /// # Errors
    /// If the acceleration structure is too large, the threads cannot be started, or the rendering
    /// was canceled.
    pub fn render(&self, options: &Options) -> Result<Rendering<'_>, RenderError> {
        self.render_within(options, &Scope::default())
    }

    /// Renders as [`Self::render`] does, for a part of the picture or with the tiles of other runs.
    /// Attributes no cost to objects for a part.
    ///
    /// # Errors
    /// The errors of [`Self::render`], or if tiles cannot be read or kept.
    pub(crate) fn render_within(
        &self,
        options: &Options,
        scope: &Scope,
    ) -> Result<Rendering<'_>, RenderError> {
        let stages = self.stages.lock().ok().and_then(|mut stages| stages.take());
        let mut stages = stages.unwrap_or_default();
        let pool = options.thread_pool()?;
        stages.end("read");
        let measured = pool.install(|| self.measure(options, scope, &mut stages))?;
        Ok(Rendering {
            session: self,
            other_runs: scope.limits.checkpoint.and_then(OtherRuns::from_checkpoint),
            stages,
            threads: Threads {
                used: measured.schedule.n_threads as usize,
                available: std::thread::available_parallelism().map_or(1, usize::from),
                pin: options.pin,
                affinity: pool.install(affinity::of_threads),
            },
            measured,
            vtkhdf: options.vtkhdf,
            pool,
            survey: OnceLock::new(),
        })
    }

    /// Takes over the index of the acceleration structure over the same primitives.
    pub(crate) fn keep_index(&self, index: Arc<AccelIndex>) {
        let _ = self.index.set(index);
    }

    /// Sets the structure of another frame, from which this frame's structure derives.
    pub(crate) fn set_base(&self, base: FrameBase) {
        let _ = self.base.set(base);
    }

    /// Sets a hash of the contents of the frame whose structure may be refitted.
    pub(crate) fn set_base_contents(&self, contents: Checksum) {
        let _ = self.base_contents.set(contents);
    }

    /// Returns the acceleration structure for other frames, which derive theirs from it by
    /// `update`.
    ///
    /// # Errors
    /// If the structure is too large, or the threads cannot be started.
    pub(crate) fn frame_base(
        &self,
        options: &Options,
        update: HierarchyUpdate,
    ) -> Result<FrameBase, RenderError> {
        let accel = match self.index() {
            Some(index) => Accel::from_index(&self.scene, index),
            None => {
                let pool = options.thread_pool()?;
                pool.install(|| self.accel(options, &mut Stages::default()))?
            }
        };
        Ok(FrameBase::new(&accel, update))
    }

    /// Returns the index of the acceleration structure, once there is one.
    pub(crate) fn index(&self) -> Option<Arc<AccelIndex>> {
        self.index.get().cloned()
    }

    /// Returns the values that the command line set.
    fn settings(&self) -> Vec<String> {
        self.document.settings().map(str::to_owned).collect()
    }

    /// Returns the scene file as the user typed it.
    fn scene_file(&self) -> &str {
        self.document.name()
    }
}
