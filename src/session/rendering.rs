//! A rendered scene.

use std::path::Path;
use std::sync::OnceLock;

use super::options::Options;
use super::{RenderError, Session, this_build};
use base::stop;
use host::folder::{OutputFolder, WriteError, Written};
use host::text::Diagnostic;
use math::simd::Simd;
use output::look::Look;
use output::summary::{OtherRuns, Partial, RanksSection, Threads};
use output::writers::{self, BandRows, Bands, Survey};
use render::attribution::CostAttribution;
use render::checkpoint::Checkpoint;
use render::film::Film;
use render::instruments::{Profiler, Stages};
use render::lanes::IdleLanes;
use render::schedule::Schedule;
use render::tiles::{OnProgress, Repeat, StoredPicture, least_repeats};
use scene::config::Traversal;
use tracer::accel::BvhStatistics;
use tracer::cost::{Meter, UsedDevice};

/// The pixels of a scene, their cost, and the record of their rendering.
#[derive(Debug)]
pub struct Rendering<'s> {
    pub(super) session: &'s Session,
    pub(super) measured: Measured,
    pub(super) other_runs: Option<OtherRuns>,
    pub(super) stages: Stages,
    pub(super) threads: Threads,
    pub(super) vtkhdf: bool,
    pub(super) pool: rayon::ThreadPool,
    pub(super) survey: OnceLock<Survey>,
}

/// The results of a rendering.
#[derive(Debug)]
pub(super) struct Measured {
    pub(super) bvh: Option<BvhStatistics>,
    /// The instruction set, and the way in which the rays of waves were traced.
    pub(super) kernel: (Simd, Traversal),
    /// The device, if it was not the processor alone.
    pub(super) device: Option<UsedDevice>,
    pub(super) meter: Meter,
    pub(super) film: Film,
    /// The look of the pixels so far, except for a part of a picture.
    pub(super) look: Option<Look>,
    /// Number of tiles that were to be rendered.
    pub(super) n_tiles: u32,
    pub(super) schedule: Schedule,
    pub(super) repeats: Vec<Repeat>,
    pub(super) attribution: Option<CostAttribution>,
    pub(super) lanes: Option<IdleLanes>,
    /// The ranks, if there were several.
    pub(super) ranks: Option<RanksSection>,
}

impl Rendering<'_> {
    /// Returns the color, the geometry and the cost of every pixel.
    pub fn film(&self) -> &Film {
        &self.measured.film
    }

    /// Returns the look of the picture, if it is whole; one larger than memory has to be written
    /// first.
    pub(crate) fn look(&self) -> Option<Look> {
        self.measured.look.filter(|_| self.partial().is_none())
    }

    /// Returns the time span and the thread of each tile.
    pub fn schedule(&self) -> &Schedule {
        &self.measured.schedule
    }

    /// Returns the cost of each object, material, primitive and node, if the config requests
    /// outputs that need it.
    pub fn attribution(&self) -> Option<&CostAttribution> {
        self.measured.attribution.as_ref()
    }

    /// Returns the idle lanes of warps, if the config requests them.
    pub fn idle_lanes(&self) -> Option<&IdleLanes> {
        self.measured.lanes.as_ref()
    }

    /// Returns the stages and their times, from reading the scene on.
    pub fn stages(&self) -> &Stages {
        &self.stages
    }

    /// Writes all files into a folder, as `raycost render` does; creates the folder if there is
    /// none, and replaces the files of an earlier rendering. The files take their places together
    /// at the end.
    ///
    /// # Errors
    /// If the folder or a file cannot be written; then no file has changed.
    pub fn write(&mut self, folder: impl AsRef<Path>) -> Result<Vec<Written>, WriteError> {
        let folder = self.session.folder(folder.as_ref())?;
        self.write_to(&folder, None)
    }

    /// Writes only the picture to a file: as OpenEXR if the config requests it, otherwise as PNG.
    ///
    /// # Errors
    /// If the file cannot be written; then an old one is unchanged.
    pub(crate) fn write_picture(&mut self, path: &Path) -> Result<Written, WriteError> {
        let mut stages = std::mem::take(&mut self.stages);
        let view = self.view(None);
        let written = (self.pool).install(|| writers::write_picture(&view, path));
        stages.end("write");
        self.stages = stages;
        written
    }

    /// Writes all files into an open folder; the profile, too, if there is one.
    ///
    /// # Errors
    /// If a file cannot be written; then no file has changed.
    pub(crate) fn write_to(
        &mut self,
        folder: &OutputFolder,
        profiler: Option<&Profiler>,
    ) -> Result<Vec<Written>, WriteError> {
        let mut stages = std::mem::take(&mut self.stages);
        let view = self.view(profiler);
        let written = (self.pool).install(|| writers::write(&view, folder, &mut stages));
        stages.end("commit");
        self.stages = stages;
        written
    }

    /// Writes a picture that is larger than memory from the files of its tiles.
    ///
    /// # Errors
    /// If a file cannot be written; then no file has changed. Or if a tile cannot be read, which
    /// the checkpoint records, or the rendering is canceled.
    pub(crate) fn write_stored(
        &mut self,
        folder: &OutputFolder,
        profiler: Option<&Profiler>,
        checkpoint: &Checkpoint,
        rows: BandRows,
        options: &Options,
    ) -> Result<Vec<Written>, RenderError> {
        let film = &self.measured.film;
        let n_pixels = u64::from(film.grid.width) * u64::from(film.grid.height);
        let bands = self.bands(checkpoint, rows);
        let mut look = self.measured.look;
        let survey = options.reported("survey", n_pixels, |report: OnProgress| {
            let look_at = |band: &Film| look.iter_mut().for_each(|look| look.add(band));
            self.pool.install(|| bands.survey(look_at, report))
        });
        self.measured.look = look;
        stop::check()?;
        let (survey, sums_ns) = survey.ok_or_else(unreadable)?;
        for (repeat, ns) in self.measured.repeats.iter_mut().zip(sums_ns) {
            repeat.pixels_ns = repeat.pixels_ns.map(|_| ns);
        }
        self.survey = survey.into();
        let mut stages = std::mem::take(&mut self.stages);
        stages.end("survey");
        let written = options.reported("write", n_pixels, |report: OnProgress| {
            let view = writers::RenderingView {
                bands: Some(self.bands(checkpoint, rows).reporting(report)),
                ..self.view(profiler)
            };
            (self.pool).install(|| writers::write(&view, folder, &mut stages))
        });
        stages.end("commit");
        self.stages = stages;
        written.or_else(|error| {
            stop::check()?;
            Err(if checkpoint.has_failed() {
                unreadable()
            } else {
                error.into()
            })
        })
    }

    fn bands<'a>(&'a self, checkpoint: &'a Checkpoint, rows: BandRows) -> Bands<'a> {
        let Measured { film, schedule, .. } = &self.measured;
        let picture = StoredPicture::new(self.session.scene(), film, schedule, checkpoint);
        Bands::new(picture, rows)
    }

    /// Returns the missing part of a rendering that ended at a deadline; `None` if it is complete.
    pub(crate) fn partial(&self) -> Option<Partial> {
        let Measured {
            film,
            schedule,
            n_tiles,
            ..
        } = &self.measured;
        let n_rendered = schedule.rendered().count() as u32;
        let asked = least_repeats(self.session.config());
        Partial::new([n_rendered, *n_tiles], [film.n_repeats, asked])
    }

    /// Returns statistics of all pixels together.
    fn survey(&self) -> &Survey {
        let survey = || Survey::measure(&self.measured.film);
        self.survey.get_or_init(|| self.pool.install(survey))
    }

    /// Borrows the rendering for the writers.
    pub(crate) fn view<'a>(&'a self, profiler: Option<&'a Profiler>) -> writers::RenderingView<'a> {
        let measured = &self.measured;
        writers::RenderingView {
            build: this_build(),
            scene_file: self.session.scene_file(),
            settings: self.session.settings(),
            name: self.session.name(),
            frame: self.session.frame.as_ref(),
            config: self.session.config(),
            scene: self.session.scene(),
            bvh: measured.bvh,
            simd: measured.kernel.0,
            traversal: measured.kernel.1,
            device: measured.device.as_ref(),
            meter: &measured.meter,
            film: &measured.film,
            survey: self.survey(),
            bands: None,
            schedule: &measured.schedule,
            repeats: &measured.repeats,
            partial: self.partial(),
            other_runs: self.other_runs.as_ref(),
            ranks: measured.ranks.as_ref(),
            attribution: measured.attribution.as_ref(),
            lanes: measured.lanes.as_ref(),
            vtkhdf: self.vtkhdf,
            profiler,
            threads: self.threads.clone(),
        }
    }
}

/// Returns the reason why a picture cannot be written from the files of its tiles.
fn unreadable() -> RenderError {
    let message = "the finished tiles in the output folder cannot be read again";
    let help = "leave the folder as it is while raycost runs, and render again";
    RenderError::Machine(Diagnostic::new(message).with_help(help))
}
