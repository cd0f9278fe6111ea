//! The frames that a run renders, and their acceleration structures.
//!
//! A frame has the same structure whether another one came before it or not, so that job arrays
//! write the bytes of a whole run: the same primitives have the same structure, and other
//! structures derive only from the first frame.

use std::sync::Arc;

use super::first_frame::FirstFrame;
use super::open_scene::OpenScene;
use crate::session::{Frames, Input, Options, RenderError, Session};
use host::provenance::Checksum;
use output::estimate::Memory;
use output::summary::FrameSection;
use render::instruments::Stages;
use scene::build::Geometries;
use scene::config::Config;
use scene::yaml::Document;
use tracer::accel::{AccelIndex, FrameBase};

/// A frame whose files have not been read.
pub(super) struct FrameInput {
    document: Document,
    config: Config,
    /// Its section of the summary.
    pub(super) section: FrameSection,
}

impl FrameInput {
    /// Returns a frame of an animated scene. `flags` are those that change its files, besides flags
    /// that change the config.
    ///
    /// # Errors
    /// The first fault in it.
    pub(super) fn new(
        scene: &OpenScene,
        frames: &Frames,
        number: u32,
        flags: &str,
    ) -> Result<Self, RenderError> {
        let (document, config) = scene.at(number)?;
        let section = frames.section(number, &document, &config, flags);
        Ok(Self {
            document,
            config,
            section,
        })
    }
}

/// A frame whose files were read.
pub(super) struct OpenFrame {
    pub(super) session: Session,
    /// The hash of its geometry.
    geometry: Checksum,
    /// True if it keeps the hierarchy of an earlier frame.
    pub(super) keeps_hierarchy: bool,
}

/// The structures that the frames so far leave for later ones.
pub(super) struct FrameHierarchies<'a> {
    scene: &'a OpenScene<'a>,
    /// The hash of the last frame's geometry, and its index.
    last: Option<(Checksum, Arc<AccelIndex>)>,
    /// The hash of the first frame's geometry, if others may reuse its hierarchy.
    first_geometry: Option<Checksum>,
    /// The first frame, once another one may reuse its hierarchy.
    first: Option<FirstFrame>,
}

impl<'a> FrameHierarchies<'a> {
    /// Starts before the first frame of a run.
    ///
    /// # Errors
    /// The first fault of the scene.
    pub(super) fn new(scene: &'a OpenScene) -> Result<Self, RenderError> {
        Ok(Self {
            scene,
            last: None,
            first_geometry: scene.first_geometry()?,
            first: None,
        })
    }

    /// Returns the flags that determine the hierarchies of frames besides their geometry.
    pub(super) fn flags(&self) -> String {
        let first = self.first_geometry;
        first.map_or(String::new(), |first| {
            format!("{:?}", (self.scene.update(), first))
        })
    }

    /// Reads the files of a frame, and gives it the structure that it keeps, or another one that it
    /// can start from.
    ///
    /// # Errors
    /// The first fault of the frame, or of the first frame.
    pub(super) fn open(
        &mut self,
        frame: FrameInput,
        needed: fn(&Config, &Geometries) -> Memory,
        stages: Stages,
        options: &Options,
    ) -> Result<OpenFrame, RenderError> {
        let FrameInput {
            document,
            config,
            section,
        } = frame;
        let geometry = Frames::geometry(&document, &config);
        let input = Input {
            frame: Some(section),
            ..Input::read(document, config, needed)?
        };
        let session = Session::new(input, stages)?;
        Ok(OpenFrame {
            keeps_hierarchy: self.give_to(&session, geometry, options)?,
            session,
            geometry,
        })
    }

    /// Gives the session of a frame of this geometry the structure that it keeps, or another one
    /// that it can start from. Returns true if it keeps one.
    ///
    /// # Errors
    /// If the first frame cannot be read or built.
    fn give_to(
        &mut self,
        session: &Session,
        geometry: Checksum,
        options: &Options,
    ) -> Result<bool, RenderError> {
        let is_first = self.first_geometry == Some(geometry);
        if self.first_geometry.is_some() && !is_first {
            let first = match &mut self.first {
                Some(first) => first,
                none => none.insert(self.scene.first_frame(options)?),
            };
            session.set_base_contents(first.contents);
            session.set_base(first.base.clone());
        }
        let first = self.first.as_ref().filter(|_| is_first);
        let of_first = first.and_then(|first| first.base.first_index());
        let kept = match (of_first, self.last.take()) {
            (Some(index), _) => index,
            (None, Some((known, index))) if known == geometry => index,
            (None, Some((_, index))) => {
                // Only the first base counts.
                session.set_base(FrameBase::from_meshes(&index));
                return Ok(false);
            }
            (None, None) => return Ok(false),
        };
        session.keep_index(kept);
        Ok(true)
    }

    /// Takes over the structure of a frame that was rendered.
    ///
    /// # Errors
    /// If a file of the first frame cannot be read.
    pub(super) fn take_from(&mut self, frame: &OpenFrame) -> Result<(), RenderError> {
        let OpenFrame {
            session, geometry, ..
        } = frame;
        let geometry = *geometry;
        let Some(index) = session.index() else {
            return Ok(());
        };
        if self.first_geometry == Some(geometry) && self.first.is_none() {
            let (options, update) = (Options::default(), self.scene.update());
            self.first = Some(FirstFrame::new(session, &options, update)?);
        }
        self.last = Some((geometry, index));
        Ok(())
    }
}
