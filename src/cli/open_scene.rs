//! A scene of the command line and its frames.

use std::path::{Path, PathBuf};

use super::scene::SceneArguments;
use super::study;
use crate::session::{Frames, Input, scene_files};
use host::text::Diagnostic;
use output::estimate::Memory;
use scene::build::Geometries;
use scene::config::Config;
use scene::yaml::{Document, Fault, Source};

/// A scene whose text was read: a still, or all frames of an animation.
pub(super) struct OpenScene<'a> {
    arguments: &'a SceneArguments,
    document: Document,
    config: Config,
    /// `None` for a still.
    pub(super) frames: Option<Frames>,
}

impl<'a> OpenScene<'a> {
    /// Reads the text of a scene.
    ///
    /// # Errors
    /// The first mistake in it, or in a data series.
    pub(super) fn read(arguments: &'a SceneArguments) -> Result<Self, Diagnostic> {
        Self::parse(arguments, arguments.source()?)
    }

    /// Opens a scene whose text was read before.
    ///
    /// # Errors
    /// The errors of [`read`](Self::read).
    pub(super) fn parse(arguments: &'a SceneArguments, source: Source) -> Result<Self, Diagnostic> {
        study::refuse_study(&source)?;
        let document = arguments.document(source)?;
        let config: Config = document.parse()?;
        Ok(Self {
            arguments,
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
    pub(super) fn load(
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

    /// Returns the values that the command line has set, such as `image.seed=7`.
    pub(super) fn settings(&self) -> Vec<String> {
        self.document.settings().map(str::to_owned).collect()
    }

    /// Returns the time of a frame that the animation has, by default the first one; `None` for a
    /// still.
    pub(super) fn time(&self, frame: Option<u32>) -> Option<f64> {
        let frames = self.frames.as_ref()?;
        Some(frames.frame(frame.unwrap_or(0)).time)
    }

    /// Checks that the animation has a frame of this number.
    ///
    /// # Errors
    /// If it does not, or the scene is a still.
    pub(super) fn check_frame(&self, number: u32) -> Result<(), Diagnostic> {
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
    pub(super) fn files(&self) -> Result<Vec<PathBuf>, Diagnostic> {
        let (document, config) = self.at(0)?;
        Ok(scene_files(&document, &config).collect())
    }

    /// Returns the text of the scene with every value: of a frame, or with its animation.
    ///
    /// # Errors
    /// A setting that the scene does not allow.
    pub(super) fn resolved(&self, frame: Option<u32>) -> Result<String, Diagnostic> {
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
    pub(super) fn point_at(&self, fault: Fault) -> Diagnostic {
        self.document.point_at(fault)
    }

    /// Returns the scene at a frame, or the still, with the settings of the command line.
    ///
    /// # Errors
    /// The first fault in it.
    pub(super) fn at(&self, number: u32) -> Result<(Document, Config), Diagnostic> {
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
        self.arguments.override_settings(&mut config, &document)?;
        Ok((document, config))
    }
}
