//! The scene of a job, and its frames.

use std::path::{Path, PathBuf};

use crate::session::{Frames, Input, scene_files};
use host::text::Diagnostic;
use output::estimate::Memory;
use scene::build::Geometries;
use scene::config::Config;
use scene::yaml::{Document, Fault, Source};

/// A scene to read, with changes to its settings.
pub trait SceneSource: Sync {
    /// Returns the name of the scene in messages and in `summary.json`: its file.
    fn file(&self) -> &Path;

    /// Returns the name of the scene's files.
    fn name(&self) -> String {
        let stem = self.file().file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }

    /// Reads the text.
    ///
    /// # Errors
    /// It cannot be read.
    fn read(&self) -> Result<Source, Diagnostic> {
        Source::read(self.file())
    }

    /// Returns values to set before the text is parsed, such as `image.width=100`.
    fn settings(&self) -> &[String];

    /// Changes the settings of a parsed scene or frame.
    ///
    /// # Errors
    /// A setting that the scene does not allow.
    fn change(&self, _config: &mut Config, _document: &Document) -> Result<(), Diagnostic> {
        Ok(())
    }

    /// Returns the flags of `raycost render` that make the same changes: parts of a picture with
    /// other flags are not merged.
    fn flags(&self) -> Vec<String> {
        let flag = |setting| format!("--set={setting}");
        self.settings().iter().map(flag).collect()
    }
}

/// A scene file, and values to set in it.
#[derive(Debug, Clone)]
pub struct SceneFile {
    path: PathBuf,
    settings: Vec<String>,
}

impl SceneFile {
    /// Names a scene file. It is read when a job runs.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            settings: Vec::new(),
        }
    }

    /// Sets a value, as `--set` does: `image.width=100`.
    #[must_use]
    pub fn set(mut self, setting: impl Into<String>) -> Self {
        self.settings.push(setting.into());
        self
    }
}

impl SceneSource for SceneFile {
    fn file(&self) -> &Path {
        &self.path
    }

    fn settings(&self) -> &[String] {
        &self.settings
    }
}

/// A scene whose text was read: a still, or all frames of an animation.
pub(crate) struct OpenScene<'a> {
    source: &'a dyn SceneSource,
    document: Document,
    config: Config,
    /// `None` for a still.
    pub(crate) frames: Option<Frames>,
}

impl<'a> OpenScene<'a> {
    /// Reads the text of a scene.
    ///
    /// # Errors
    /// The first mistake in it, or in a data series.
    pub(crate) fn read(source: &'a dyn SceneSource) -> Result<Self, Diagnostic> {
        Self::parse(source, source.read()?)
    }

    /// Opens a scene whose text was read before.
    ///
    /// # Errors
    /// The errors of [`read`](Self::read).
    pub(crate) fn parse(source: &'a dyn SceneSource, text: Source) -> Result<Self, Diagnostic> {
        let mut document = Document::new(text, Config::MERGING)?;
        for setting in source.settings() {
            document.set(setting)?;
        }
        let config: Config = document.parse()?;
        Ok(Self {
            source,
            frames: Frames::parse(&document, &config)?,
            document,
            config,
        })
    }

    /// Reads the files of a frame, by default the first one, or of the still; checks that the
    /// memory that a command needs is available.
    ///
    /// # Errors
    /// The first fault of the scene.
    pub(crate) fn load(
        &self,
        frame: Option<u32>,
        needed: impl Fn(&Config, &Geometries) -> Memory,
    ) -> Result<Input, Diagnostic> {
        if let Some(frame) = frame {
            self.check_frame(frame)?;
        }
        let (document, config) = self.at(frame.unwrap_or(0))?;
        Input::read(document, config, needed)
    }

    /// Returns the values that were set before parsing, such as `image.seed=7`.
    pub(crate) fn settings(&self) -> Vec<String> {
        self.document.settings().map(str::to_owned).collect()
    }

    /// Returns the time of a frame that the animation has, by default the first one; `None` for a
    /// still.
    pub(crate) fn time(&self, frame: Option<u32>) -> Option<f64> {
        let frames = self.frames.as_ref()?;
        Some(frames.frame(frame.unwrap_or(0)).time)
    }

    /// Checks that the animation has a frame of this number.
    ///
    /// # Errors
    /// If it does not, or the scene is a still.
    pub(crate) fn check_frame(&self, number: u32) -> Result<(), Diagnostic> {
        let n_frames = match &self.frames {
            Some(frames) if number < frames.n_frames() => return Ok(()),
            Some(frames) => frames.n_frames(),
            None => {
                let message = format!("there is no frame {number}: the scene is a still");
                return Err(Diagnostic::new(message)
                    .with_help("give it a section `animation`, or leave out the frame"));
            }
        };
        let message = format!("there is no frame {number}");
        let help = match n_frames {
            1 => "the scene has one frame, 0".to_owned(),
            n => format!("the scene has {n} frames, 0 to {}", n - 1),
        };
        Err(Diagnostic::new(message).with_help(help))
    }

    /// Returns the files that determine the picture of a still.
    ///
    /// # Errors
    /// A setting that the scene does not allow.
    pub(crate) fn files(&self) -> Result<Vec<PathBuf>, Diagnostic> {
        let (document, config) = self.at(0)?;
        Ok(scene_files(&document, &config).collect())
    }

    /// Returns the text of the scene with every value: of a frame, or with its animation.
    ///
    /// # Errors
    /// A setting that the scene does not allow.
    pub(crate) fn resolved(&self, frame: Option<u32>) -> Result<String, Diagnostic> {
        let (document, config) = match frame {
            Some(frame) => {
                self.check_frame(frame)?;
                let (document, mut config) = self.at(frame)?;
                config.animation = None;
                (document, config)
            }
            None => self.with_settings(self.document.clone(), self.config.clone())?,
        };
        let folder = Path::new(document.name()).parent();
        let text = config.resolved(folder.unwrap_or(Path::new("")), &document);
        text.map_err(|error| Diagnostic::new(format!("cannot write the scene: {error}")))
    }

    /// Converts the fault to a diagnostic that shows its line.
    pub(crate) fn point_at(&self, fault: Fault) -> Diagnostic {
        self.document.point_at(fault)
    }

    /// Returns the scene at a frame, or the still, with the changes to its settings.
    ///
    /// # Errors
    /// The first fault in it.
    pub(crate) fn at(&self, number: u32) -> Result<(Document, Config), Diagnostic> {
        let (document, config) = match &self.frames {
            Some(frames) => frames.at(number)?,
            None => (self.document.clone(), self.config.clone()),
        };
        self.with_settings(document, config)
    }

    fn with_settings(
        &self,
        document: Document,
        mut config: Config,
    ) -> Result<(Document, Config), Diagnostic> {
        self.source.change(&mut config, &document)?;
        Ok((document, config))
    }
}
