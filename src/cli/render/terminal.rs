//! The lines that `raycost render` prints about its job.

use std::path::Path;
use std::time::{Duration, Instant};

use super::RenderArguments;
use crate::cli::hints::{self, FrameHints};
use crate::cli::progress::Bars;
use crate::cli::{json, run_summary, shell_word};
use crate::job::{
    Finished, FinishedPicture, Observer, OtherTiles, PartDone, PicturePart, Report, SeriesFiles,
    Video,
};
use crate::session::{Event, RenderError};
use base::numbers::{bytes, count, counted, duration};
use host::text::{self, shown};
use output::summary::Partial;
use render::checkpoint::PARTS;
use tracer::accel::BvhStatistics;

/// The rest of a sentence about a file of tiles beside a complete output.
pub(in crate::cli) const OF_ANOTHER_RUN: &str =
    "of an interrupted run: `--resume` with its flags continues it, or remove it";

/// Shows a job on the terminal.
pub(super) struct Terminal<'a> {
    arguments: &'a RenderArguments,
    begin: Instant,
    bars: Bars,
    hints: FrameHints,
}

impl Observer for Terminal<'_> {
    fn begin(&mut self) -> Result<(), RenderError> {
        self.arguments.prepare()
    }

    fn event(&self, event: Event) {
        self.bars.show(event);
    }

    fn finished(&mut self, finished: Finished) -> Result<(), RenderError> {
        if self.is_shown() {
            text::print(&self.lines(&finished))?;
        }
        match finished {
            Finished::Kept(folder, _) if self.arguments.json => json::print_summary(&folder)?,
            Finished::Picture(picture) => {
                if self.arguments.json {
                    json::print_summary(&picture.path)?;
                }
                if picture.frame().is_none() {
                    // The process ends: the system frees all memory at once.
                    std::mem::forget(picture);
                }
            }
            _ => {}
        }
        Ok(())
    }
}

impl<'a> Terminal<'a> {
    pub(super) fn new(arguments: &'a RenderArguments) -> Self {
        Self {
            arguments,
            begin: Instant::now(),
            bars: Bars::new(arguments.run.quiet),
            hints: FrameHints::default(),
        }
    }

    /// Returns true if standard output has lines about the job.
    fn is_shown(&self) -> bool {
        !self.arguments.run.quiet && !self.arguments.json
    }

    fn lines(&mut self, finished: &Finished) -> String {
        match finished {
            Finished::Kept(_, tiles) => other_tiles(tiles),
            Finished::Part(part, done, folder) => part_line(*part, *done, folder),
            Finished::OnlyPicture(picture) => only_picture(picture),
            Finished::Picture(picture) if picture.frame().is_some() => self.frame(picture),
            Finished::Picture(picture) => self.still(picture),
        }
    }

    fn still(&self, picture: &FinishedPicture) -> String {
        let FinishedPicture {
            rendering, written, ..
        } = picture;
        let (scene, view) = (&self.arguments.scene, rendering.view(None));
        let stages = rendering.stages();
        let text = run_summary::lines(scene, &view, rendering.look(), stages, written);
        let partial = picture.partial.map(|partial| self.partial_line(partial));
        let tiles = other_tiles(&picture.other_tiles);
        format!("{text}{tiles}{}", partial.unwrap_or_default())
    }

    fn frame(&mut self, picture: &FinishedPicture) -> String {
        let rendering = &picture.rendering;
        let view = rendering.view(None);
        let times = rendering.stages().ended.iter().map(|stage| {
            let wall = Duration::from_secs_f64(stage.wall_ms / 1e3);
            format!("{} {}", stage.name, duration(wall))
        });
        let mut times = times.collect::<Vec<_>>().join(", ");
        if let Some(partial) = picture.partial {
            times += &format!("; {partial}");
        }
        let (number, n_frames) = view.frame.map_or((0, 1), |at| (at.number, at.n_frames));
        let hierarchy = view.bvh.map(|bvh| hierarchy(bvh, picture.keeps_hierarchy));
        let hints = self.hints.lines(number, view.config, rendering.look());
        format!(
            "frame   {number} of {n_frames}: {times}{}\n{}{}",
            hierarchy.unwrap_or_default(),
            other_tiles(&picture.other_tiles),
            text::wrapped(&hints)
        )
    }

    /// Returns the line about missing tiles, and how to continue.
    fn partial_line(&self, partial: Partial) -> String {
        let what = match partial.n_missing_tiles {
            0 => format!(
                "{} of {} renderings",
                partial.n_renderings, partial.n_renderings_asked
            ),
            n => format!(
                "{} of {} tiles are missing",
                count(n),
                count(partial.n_tiles)
            ),
        };
        format!("partial {what}: {}\n", go_on(&self.arguments.scene.scene))
    }

    /// Prints the end of a job.
    pub(super) fn finish(&self, report: &Report) -> Result<(), RenderError> {
        if !self.is_shown() {
            return Ok(());
        }
        let out = self.arguments.scene.out();
        let mut lines = String::new();
        if report.is_animated {
            let rendered = counted(report.n_rendered, "frame");
            let took = duration(self.begin.elapsed());
            let kept = match report.n_kept {
                0 => String::new(),
                n => format!(", {n} complete from an earlier run"),
            };
            lines += &format!("frames  {rendered} rendered in {took}{kept}\n");
        }
        if let Some(series) = &report.series {
            lines += &series_lines(series, &out);
        }
        if self.arguments.part.is_some() {
            let out = shell_word(&out);
            lines += &format!("next    raycost merge {out}, when all parts are there\n");
        }
        Ok(text::print(&lines)?)
    }
}

/// Returns how to continue an incomplete picture of a scene.
pub(in crate::cli) fn go_on(scene: &Path) -> String {
    let scene = shell_word(scene);
    format!("go on with `raycost render {scene} --resume` and the same flags")
}

/// Returns the lines about the tiles of other runs.
fn other_tiles(tiles: &OtherTiles) -> String {
    let mut lines = String::new();
    if tiles.n_resumed > 0 {
        let n_tiles = counted(tiles.n_resumed, "tile");
        lines += &format!("resumed {n_tiles} of an interrupted run\n");
    }
    if let Some(file) = &tiles.left {
        lines += &format!("kept    {} {OF_ANOTHER_RUN}\n", shown(file));
    }
    lines
}

/// Returns the line about a part of a picture in this folder.
fn part_line(part: PicturePart, done: PartDone, folder: &Path) -> String {
    let path = shown(&folder.join(PARTS).join(part.file_name()));
    match done {
        PartDone::Rendered(n_tiles, wall) => {
            let (n_tiles, wall) = (counted(n_tiles, "tile"), duration(wall));
            format!("part    {part}: {n_tiles} in {wall}\nwrote   {path}\n")
        }
        PartDone::Partial(partial) => {
            let (n, of) = (count(partial.n_missing_tiles), count(partial.n_tiles));
            format!("part    {part}: partial, {n} of {of} tiles are missing; run it again\n")
        }
        PartDone::Kept => format!("part    {part}: complete from an earlier run, {path}\n"),
    }
}

/// Returns the lines about a picture without other files.
fn only_picture(picture: &FinishedPicture) -> String {
    let rendering = &picture.rendering;
    let view = rendering.view(None);
    let head = run_summary::head(&view, rendering.stages());
    let hints = hints::lines(view.config, rendering.look());
    let length = bytes(picture.written.iter().map(|file| file.bytes).sum());
    let path = shown(&picture.path);
    text::wrapped(&format!("{head}{hints}wrote   {path} ({length})\n")).into_owned()
}

/// Returns the words about the hierarchy of a frame.
fn hierarchy(bvh: BvhStatistics, is_kept: bool) -> String {
    let how = if is_kept {
        "kept from an earlier frame"
    } else if bvh.is_refitted {
        "refitted from frame 0"
    } else {
        "built"
    };
    format!(", hierarchy {how}, SAH cost {:.1}", bvh.sah_cost)
}

/// Returns the lines about the files that play an animation.
fn series_lines(series: &SeriesFiles, out: &Path) -> String {
    let mut lines = format!("wrote   {}: {}\n", shown(out), series.written.join(", "));
    if series.n_missing > 0 {
        let missing = counted(series.n_missing.into(), "frame");
        lines += &format!("missing {missing}: the series plays the others; no video yet\n");
    }
    match &series.video {
        None => {}
        Some(Video::Written(name)) => {
            lines += &format!("video   {}\n", shown(&out.join(name)));
        }
        Some(Video::NoFfmpeg(command)) => {
            lines += &format!("video   ffmpeg is not installed; where it is: {command}\n");
        }
        Some(Video::Failed(why, command)) => {
            let why = text::one_line(why);
            lines += &format!("video   ffmpeg failed: {why}\n        {command}\n");
        }
    }
    if let Some(strays) = &series.strays {
        lines += &format!("note    {strays}\n");
    }
    if let Some(state) = &series.state {
        let state = shell_word(&out.join(state));
        lines += &format!("next    paraview --state={state}\n");
    }
    lines
}
