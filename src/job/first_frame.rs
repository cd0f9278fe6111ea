//! The acceleration structure of the first frame, which other frames may refit.

use super::open_scene::OpenScene;
use crate::session::{Frames, Options, RenderError, Session};
use host::provenance::Checksum;
use host::text::Diagnostic;
use output::estimate::Memory;
use render::instruments::Stages;
use scene::config::HierarchyUpdate;
use tracer::accel::FrameBase;

/// The first frame of a scene, whose hierarchy other frames may reuse.
pub(crate) struct FirstFrame {
    /// A hash of the contents of the scene and of its files.
    pub(crate) contents: Checksum,
    pub(crate) base: FrameBase,
}

impl OpenScene<'_> {
    /// Returns how other frames derive their hierarchies.
    pub(crate) fn update(&self) -> HierarchyUpdate {
        let frames = self.frames.as_ref();
        frames.map_or(HierarchyUpdate::Rebuild, Frames::update)
    }

    /// Returns the hash of all that determines the primitives of the first frame, if other frames
    /// may reuse its hierarchy.
    ///
    /// # Errors
    /// The first fault of the scene.
    pub(crate) fn first_geometry(&self) -> Result<Option<Checksum>, Diagnostic> {
        if self.update() == HierarchyUpdate::Rebuild {
            return Ok(None);
        }
        let (document, config) = self.at(0)?;
        Ok(Some(Frames::geometry(&document, &config)))
    }

    /// Returns the hierarchy of the first frame, for a frame that may reuse it, by default the
    /// first one; `None` for a frame that builds a new one.
    ///
    /// # Errors
    /// The errors of [`first_frame`](Self::first_frame).
    pub(crate) fn base_of(
        &self,
        frame: Option<u32>,
        options: &Options,
    ) -> Result<Option<FrameBase>, RenderError> {
        let Some(first) = self.first_geometry()? else {
            return Ok(None);
        };
        let (document, config) = self.at(frame.unwrap_or(0))?;
        if Frames::geometry(&document, &config) == first {
            return Ok(None);
        }
        Ok(Some(self.first_frame(options)?.base))
    }

    /// Reads the first frame and builds its hierarchy.
    ///
    /// # Errors
    /// The first fault of the scene, or if the hierarchy is too large.
    pub(crate) fn first_frame(&self, options: &Options) -> Result<FirstFrame, RenderError> {
        let session = Session::new(self.load(None, Memory::estimate_scene)?, Stages::default())?;
        FirstFrame::new(&session, options, self.update())
    }
}

impl FirstFrame {
    /// Creates the first frame; builds its hierarchy if it has none yet.
    ///
    /// # Errors
    /// If the hierarchy is too large, or a file cannot be read.
    pub(crate) fn new(
        session: &Session,
        options: &Options,
        update: HierarchyUpdate,
    ) -> Result<Self, RenderError> {
        Ok(Self {
            contents: session.contents()?,
            base: session.frame_base(options, update)?,
        })
    }
}
