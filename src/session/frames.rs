//! The frames of an animated scene, each of which is a scene.

use super::fingerprint;
use host::provenance::Checksum;
use host::text::Diagnostic;
use output::limits;
use output::summary::FrameSection;
use scene::animation;
use scene::build::{SceneFrame, Timeline};
use scene::config::{Config, HierarchyUpdate};
use scene::yaml::Document;

/// A scene that changes over time.
#[derive(Debug)]
pub(crate) struct Frames {
    /// The scene without its animation.
    document: Document,
    timeline: Timeline,
}

impl Frames {
    /// Returns the frames of a scene; `None` for a still.
    ///
    /// # Errors
    /// The first mistake in the section `animation`.
    pub(crate) fn parse(document: &Document, config: &Config) -> Result<Option<Self>, Diagnostic> {
        let point_at = |fault| document.point_at(fault);
        let Some(mut timeline) = Timeline::parse(config, document).map_err(point_at)? else {
            return Ok(None);
        };
        let found = timeline.find_ranges(config, document, limits::available());
        found.map_err(point_at)?;
        Ok(Some(Self {
            document: document.clone().without(animation::KEY)?,
            timeline,
        }))
    }

    /// Returns the first frame of a scene, which may be a still.
    ///
    /// # Errors
    /// The first mistake in the scene.
    pub(crate) fn first(document: Document) -> Result<(Document, Config), Diagnostic> {
        let config: Config = document.parse()?;
        match Self::parse(&document, &config)? {
            None => Ok((document, config)),
            Some(frames) => frames.at(0),
        }
    }

    /// Returns the number of frames, at least 1.
    pub(crate) fn n_frames(&self) -> u32 {
        self.timeline.n_frames
    }

    /// Returns the frames per second of a video.
    pub(crate) fn fps(&self) -> f32 {
        self.timeline.animation.fps
    }

    /// Returns how frames get their hierarchies: rebuilt or refitted.
    pub(crate) fn update(&self) -> HierarchyUpdate {
        self.timeline.animation.hierarchy
    }

    /// Returns the number and the time of a frame.
    pub(crate) fn frame(&self, number: u32) -> SceneFrame {
        self.timeline.frame(number)
    }

    /// Returns the section of a frame in its summary, for the scene that [`at`](Self::at) returned.
    /// `flags` are the flags of the command line that change its files, besides flags that change
    /// the config.
    pub(crate) fn section(
        &self,
        number: u32,
        document: &Document,
        config: &Config,
        flags: &str,
    ) -> FrameSection {
        fingerprint::section_of(document, config, self.frame(number), flags)
    }

    /// Returns a hash of all that determines the primitives of a frame and the acceleration
    /// structure over them.
    pub(crate) fn geometry(document: &Document, config: &Config) -> Checksum {
        fingerprint::hash_geometry(document, config)
    }

    /// Returns the scene at a frame: a still.
    ///
    /// # Errors
    /// If a keyframe has a path that the scene does not have, or a value that is not allowed.
    pub(crate) fn at(&self, number: u32) -> Result<(Document, Config), Diagnostic> {
        let (animation, n_frames) = (&self.timeline.animation, self.timeline.n_frames);
        let document = animation.at_frame(&self.document, number, n_frames)?;
        let mut config: Config = document.parse()?;
        self.timeline.make_still(&mut config, number);
        Ok((document, config))
    }
}
