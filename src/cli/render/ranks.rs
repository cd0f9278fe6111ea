//! `mpirun raycost render`: each picture by several processes.

use super::RenderArguments;
use super::hierarchies::{FrameHierarchies, FrameInput};
use crate::cli::Failure;
use crate::cli::open_scene::OpenScene;
use crate::session::this_build;
use crate::session::{Options, RenderError, Session};
use base::stop;
use host::affinity;
use output::estimate::Memory;
use render::instruments::{HardwareCounters, Stages};
use render::ranks::{Hello, Order, RankFailure, Ranks, SceneText, Team};
use scene::yaml::Source;

/// Renders the tiles that rank 0 deals to this rank. It writes no file and prints nothing: rank 0
/// prints the reason if it fails.
pub(super) fn help(arguments: &RenderArguments, ranks: Ranks) -> Result<(), Failure> {
    let done = work(arguments, &ranks);
    if let Err(failure) = &done {
        ranks.fail(&failure_of(failure));
    } else {
        ranks.leave();
    }
    done
}

/// Renders tiles of each picture that rank 0 orders, until it dismisses this rank.
fn work(arguments: &RenderArguments, ranks: &Ranks) -> Result<(), Failure> {
    ranks.introduce(&hello(arguments, ranks)?);
    let Some(SceneText { name, text }) = ranks.receive_scene() else {
        return Ok(stop::check()?);
    };
    let scene = OpenScene::parse(&arguments.scene, Source::new(name, text))?;
    let options = Options {
        threads: arguments.run.threads,
        pin: arguments.pin,
        simd: arguments.simd,
        traversal: arguments.traversal.unwrap_or_default(),
        ..Options::default()
    };
    let flags = arguments.scene.all_flags();
    let work_on = |session: &Session| -> Result<(), Failure> {
        ranks.report(&session.header(flags.clone(), None)?);
        Ok(session.work(&options, ranks)?)
    };
    let mut hierarchies = FrameHierarchies::new(&scene)?;
    loop {
        let stages = Stages::start(HardwareCounters::none());
        match (ranks.receive_order(), &scene.frames) {
            (Some(Order::Still(frame)), _) => {
                let input = scene.load(frame, Memory::of_part)?;
                work_on(&Session::new(input, stages)?)?;
            }
            (Some(Order::Frame(number)), Some(frames)) => {
                let input = FrameInput::new(&scene, frames, number, "")?;
                let frame = hierarchies.open(input, Memory::of_part, stages, &options)?;
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
    pub(super) fn meet(arguments: &RenderArguments, ranks: Ranks) -> Result<Self, Failure> {
        let hellos = ranks.meet(hello(arguments, &ranks)?).map_err(of_rank)?;
        Ok(Self { ranks, hellos })
    }

    /// Sends the text of the scene to the ranks.
    pub(super) fn send_scene(&self, scene: &Source) {
        self.ranks.send_scene(&SceneText {
            name: scene.name().to_owned(),
            text: scene.text().to_owned(),
        });
    }

    /// Lets the ranks read the files of a picture.
    pub(super) fn begin(&self, picture: Order) {
        self.ranks.send_order(picture);
    }

    /// Waits until the ranks have read the files of the picture, and compares them with a session.
    pub(super) fn gather(
        &self,
        arguments: &RenderArguments,
        session: &Session,
    ) -> Result<Team<'_>, Failure> {
        let header = session.header(arguments.scene.all_flags(), None)?;
        Ok(Team::gather(&self.ranks, &self.hellos, &header).map_err(of_rank)?)
    }

    /// Dismisses the ranks.
    pub(super) fn leave(self) {
        self.ranks.send_order(Order::Leave);
        self.ranks.leave();
    }
}

fn of_rank((rank, failure): (String, RankFailure)) -> RenderError {
    RenderError::of_rank(&rank, &failure)
}

/// Returns the introduction of a rank before it renders.
fn hello(arguments: &RenderArguments, ranks: &Ranks) -> Result<Hello, Failure> {
    let pool = arguments.options(&|_| {}).thread_pool()?;
    Ok(Hello {
        host: ranks.host(),
        affinity: pool.install(affinity::of_threads),
        scene: arguments.scene.scene.to_string_lossy().into_owned(),
        program: this_build().title(),
        flags: arguments.scene.all_flags(),
    })
}

/// Returns a failure in the form that rank 0 prints.
fn failure_of(failure: &Failure) -> RankFailure {
    RankFailure {
        exit_code: failure.exit_code(),
        message: failure.text().unwrap_or_default(),
    }
}

/// Reports a failure of this process to rank 0, which prints it, if it is another rank.
pub(in crate::cli) fn fail_on_a_rank(failure: &Failure) {
    let ranks = Ranks::join().ok().flatten();
    if let Some(ranks) = ranks.filter(|ranks| ranks.rank() > 0) {
        ranks.fail(&failure_of(failure));
    }
}
