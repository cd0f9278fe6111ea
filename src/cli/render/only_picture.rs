//! `raycost render SCENE -o picture.png`: only a picture, no other file.

use std::path::PathBuf;
use std::str::FromStr;

use super::RenderArguments;
use crate::cli::open_scene::OpenScene;
use crate::cli::progress::Bars;
use crate::cli::scene::PictureFormat;
use crate::cli::{Failure, hints, run_summary, shown};
use crate::session::{Scope, Session};
use base::numbers::bytes;
use host::folder::{Replace, refuse_foreign_file};
use host::text::{self, Diagnostic};
use render::ranks::Team;
use render::tiles::Limits;

/// A file to which a picture is written.
#[derive(Debug, Clone)]
pub(super) struct PictureFile {
    path: PathBuf,
    /// Chosen by the file's extension.
    pub(super) format: PictureFormat,
}

impl FromStr for PictureFile {
    type Err = &'static str;

    fn from_str(path: &str) -> Result<Self, Self::Err> {
        let path = PathBuf::from(path);
        let extension = path.extension().unwrap_or_default();
        let format = match extension.to_ascii_lowercase().to_str() {
            Some("png") => PictureFormat::Png,
            Some("exr") => PictureFormat::Exr,
            _ => return Err("expected a name that ends in .png or .exr"),
        };
        Ok(Self { path, format })
    }
}

/// Renders a session's picture and writes it to a file.
pub(super) fn render(
    arguments: &RenderArguments,
    session: &Session,
    file: &PictureFile,
    team: Option<&Team>,
) -> Result<(), Failure> {
    refuse_foreign_file(&file.path, Replace::Marked)?;
    let bars = Bars::new(arguments.run.quiet);
    let on_event = |event| bars.show(event);
    let limits = Limits {
        team,
        ..Limits::default()
    };
    let scope = Scope {
        limits,
        ..Scope::default()
    };
    let mut rendering = session.render_within(&arguments.options(&on_event), &scope)?;
    let written = rendering.write_picture(&file.path)?;
    if !arguments.run.quiet {
        let head = run_summary::head(&rendering.view(None), rendering.stages());
        let hints = hints::lines(session.config(), rendering.look());
        let (path, length) = (shown(&file.path), bytes(written.bytes));
        text::print(&text::wrapped(&format!(
            "{head}{hints}wrote   {path} ({length})\n"
        )))?;
    }
    Ok(())
}

impl RenderArguments {
    /// Returns the number of the only frame to render, if one is requested or the scene has frames.
    ///
    /// # Errors
    /// Not exactly one frame of an animation is requested.
    pub(super) fn only_frame(&self, scene: &OpenScene) -> Result<Option<u32>, Diagnostic> {
        let range = self.frames.as_ref().map(|frames| &frames.0);
        match range {
            range if scene.frames.is_none() => Ok(range.map(|range| *range.start())),
            Some(range) if range.start() == range.end() => Ok(Some(*range.start())),
            _ => Err(
                Diagnostic::new("`--picture` writes one picture, and the scene has frames")
                    .with_help("choose one of them, such as `--frames 7`"),
            ),
        }
    }
}
