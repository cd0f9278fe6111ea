//! A scene that was read, before it is placed.

use super::Memory;
use host::text::Diagnostic;
use output::limits;
use output::summary::FrameSection;
use scene::build::Geometries;
use scene::config::Config;
use scene::yaml::Document;

/// A scene's text, its config, and the geometries of the files that it names.
#[derive(Debug)]
pub struct Input {
    /// The scene file, with the files that it includes.
    pub document: Document,
    /// The settings, which may have been changed.
    pub config: Config,
    /// The geometries.
    pub geometries: Geometries,
    /// The frame of an animated scene.
    pub frame: Option<FrameSection>,
    /// The memory that the rendering needs.
    pub memory: Memory,
}

impl Input {
    /// Checks the config, reads the files that it names, and checks that the memory
    /// that `needed` estimates is free.
    ///
    /// # Errors
    /// The first mistake in the scene.
    pub(crate) fn read(
        document: Document,
        mut config: Config,
        needed: impl Fn(&Config, &Geometries) -> Memory,
    ) -> Result<Self, Diagnostic> {
        let point_at = |fault| document.point_at(fault);
        config.check_sizes().map_err(point_at)?;
        config.check_repeats().map_err(point_at)?;
        config
            .check_output()
            .map_err(|(_, fault)| document.point_at(fault))?;
        config.check_arrays().map_err(point_at)?;
        config.check_metrics().map_err(point_at)?;
        config.output.leave_out_without(config.acceleration);
        limits::check_limit()?;
        let available = limits::available();
        let geometries = Geometries::read(&mut config, &document, available).map_err(point_at)?;
        // The geometries are part of the need, but were not yet allocated when `available` was
        // measured.
        let memory = needed(&config, &geometries);
        memory.check(available).map_err(point_at)?;
        Ok(Self {
            memory,
            document,
            config,
            geometries,
            frame: None,
        })
    }
}
