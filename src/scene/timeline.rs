//! The frames of a scene and their times.

use crate::animation::Animation;
use crate::config::Config;
use crate::yaml::{Fault, Folders};

/// The frames of a scene that changes over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// How its values change.
    pub animation: Animation,
    /// The number of frames, at least 1.
    pub n_frames: u32,
}

/// A frame of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneFrame {
    /// Its number; that of the first is 0.
    pub number: u32,
    /// The number of all frames.
    pub n_frames: u32,
    /// Its time: in seconds of the video.
    pub time: f64,
}

impl Timeline {
    /// The timeline of a config; `None` for a still.
    ///
    /// # Errors
    /// The first mistake in the section `animation`.
    pub fn of<F: Folders + ?Sized>(config: &Config, _folders: &F) -> Result<Option<Self>, Fault> {
        let Some(animation) = &config.animation else {
            return Ok(None);
        };
        let n_frames = animation.frames.ok_or_else(|| animation.without_frames())?;
        animation.check(n_frames)?;
        Ok(Some(Self {
            animation: animation.clone(),
            n_frames,
        }))
    }

    /// A frame, whose number is less than [`n_frames`](Self::n_frames).
    pub fn frame(&self, number: u32) -> SceneFrame {
        SceneFrame {
            number,
            n_frames: self.n_frames,
            time: f64::from(number) / f64::from(self.animation.fps),
        }
    }
}
