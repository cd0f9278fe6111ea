//! `mpirun raycost render`: each picture by several processes.

use super::hierarchies::{FrameHierarchies, FrameInput};
use super::{Job, OpenScene, Report};
use crate::session::{RenderError, Session, this_build};
use base::stop;
use host::affinity;
use output::estimate::Memory;
use render::instruments::{HardwareCounters, Stages};
use render::ranks::{Hello, MessageKind, Order, RankFailure, Ranks, SceneText, Team};
use scene::yaml::Source;

/// Renders the tiles that rank 0 deals to this rank. It writes no file and prints nothing: rank 0
/// prints the reason if it fails.
pub(super) fn work(job: &Job, ranks: Ranks) -> Result<Report, RenderError> {
    match follow(job, &ranks) {
        Ok(()) => {
            ranks.leave();
            Ok(Report::default())
        }
        Err(error) => {
            ranks.fail(&error.to_failure());
            Err(error)
        }
    }
}

/// Renders tiles of each picture that rank 0 orders, until it dismisses this rank.
fn follow(job: &Job, ranks: &Ranks) -> Result<(), RenderError> {
    ranks.send_value(0, MessageKind::Value, &hello(job, ranks)?);
    let Some(SceneText { name, text }) = ranks.receive_value() else {
        return Ok(stop::check()?);
    };
    let scene = OpenScene::parse(job.scene, Source::new(name, text))?;
    let work_on = |session: &Session| -> Result<(), RenderError> {
        ranks.report(&session.header(job.scene.flags(), None)?);
        session.work(&job.options, ranks)
    };
    let mut hierarchies = FrameHierarchies::new(&scene)?;
    loop {
        let stages = Stages::start(HardwareCounters::none());
        match (ranks.receive_value(), &scene.frames) {
            (Some(Order::Still(frame)), _) => {
                let input = scene.load(frame, Memory::estimate_part)?;
                work_on(&Session::new(input, stages)?)?;
            }
            (Some(Order::Frame(number)), Some(frames)) => {
                let input = FrameInput::new(&scene, frames, number, "")?;
                let frame = hierarchies.open(input, Memory::estimate_part, stages, &job.options)?;
                work_on(&frame.session)?;
                hierarchies.take_from(&frame)?;
            }
            // Dismissed: a still has no frames.
            (Some(Order::Leave | Order::Frame(_)), _) => return Ok(()),
            (None, _) => return Ok(stop::check()?),
        }
    }
}

/// The other ranks, which rank 0 leads.
pub(super) struct Crew {
    ranks: Ranks,
    hellos: Vec<Hello>,
}

impl Crew {
    /// Waits for the other ranks, and compares their programs and flags.
    pub(super) fn meet(job: &Job, ranks: Ranks) -> Result<Self, RenderError> {
        let hellos = (ranks.meet(hello(job, &ranks)?))
            .map_err(|(rank, failure)| RenderError::from_rank(&rank, &failure))?;
        Ok(Self { ranks, hellos })
    }

    /// Sends the text of the scene to the ranks.
    pub(super) fn send_scene(&self, scene: &Source) {
        self.ranks.send_to_all(&SceneText {
            name: scene.name().to_owned(),
            text: scene.text().to_owned(),
        });
    }

    /// Lets the ranks read the files of a picture.
    pub(super) fn begin(&self, picture: Order) {
        self.ranks.send_to_all(&picture);
    }

    /// Waits until the ranks have read the files of the picture, and compares them with a session.
    pub(super) fn gather(&self, job: &Job, session: &Session) -> Result<Team<'_>, RenderError> {
        let header = session.header(job.scene.flags(), None)?;
        Team::gather(&self.ranks, &self.hellos, &header)
            .map_err(|(rank, failure)| RenderError::from_rank(&rank, &failure))
    }

    /// Dismisses the ranks.
    pub(super) fn leave(self) {
        self.ranks.send_to_all(&Order::Leave);
        self.ranks.leave();
    }
}

/// Returns the introduction of a rank before it renders.
fn hello(job: &Job, ranks: &Ranks) -> Result<Hello, RenderError> {
    let pool = job.options.thread_pool()?;
    Ok(Hello {
        host: ranks.host(),
        affinity: pool.install(affinity::of_threads),
        scene: job.scene.file().to_string_lossy().into_owned(),
        program: this_build().title(),
        flags: job.scene.flags(),
    })
}

/// Reports a failure of this process before its job to rank 0, which prints it, if it is another
/// rank.
pub(crate) fn fail_on_a_rank(failure: &RankFailure) {
    let ranks = Ranks::join().ok().flatten();
    if let Some(ranks) = ranks.filter(|ranks| ranks.rank() > 0) {
        ranks.fail(failure);
    }
}
