//! `mpirun raycost render`: one picture by several processes.

use super::RenderArguments;
use crate::cli::open_scene::OpenScene;
use crate::cli::{Failure, thread_pool};
use crate::instruments::{HardwareCounters, Stages};
use crate::memory::Memory;
use crate::ranks::{Hello, RankFailure, Ranks, SceneText, Team};
use crate::session::{Options, RenderError, Session};
use crate::stop;
use crate::text::Diagnostic;
use crate::yaml::Source;

/// Renders what rank 0 deals to this rank. It writes no file and prints nothing: rank 0
/// prints why it fails.
pub(super) fn help(arguments: &RenderArguments, ranks: Ranks) -> Result<(), Failure> {
    let done = work(arguments, &ranks);
    if let Err(failure) = &done {
        ranks.fail(&failure_of(failure));
    } else {
        ranks.leave();
    }
    done
}

fn work(arguments: &RenderArguments, ranks: &Ranks) -> Result<(), Failure> {
    let Some(SceneText { name, text }) = ranks.receive_scene() else {
        return Ok(stop::check()?);
    };
    let scene = OpenScene::of(&arguments.scene, Source::new(name, text))?;
    let stages = Stages::start(HardwareCounters::none());
    let session = Session::new(scene.load(None, Memory::of_part)?, stages)?;
    ranks.introduce(&hello(arguments, &session, ranks)?);
    let options = Options {
        threads: arguments.threads,
        ..Options::default()
    };
    Ok(session.work(&options, ranks)?)
}

/// Waits for the other ranks, which rank 0 leads.
pub(super) fn gather(
    arguments: &RenderArguments,
    session: &Session,
    ranks: Ranks,
) -> Result<Team, Failure> {
    let hello = hello(arguments, session, &ranks)?;
    let gathered = Team::gather(ranks, &hello);
    Ok(gathered.map_err(|(rank, failure)| RenderError::of_rank(&rank, &failure))?)
}

/// What a rank is about to render.
fn hello(arguments: &RenderArguments, session: &Session, ranks: &Ranks) -> Result<Hello, Failure> {
    let n_threads = thread_pool(arguments.threads)?.current_num_threads();
    Ok(Hello {
        host: ranks.host(),
        n_threads: n_threads as u32,
        scene: arguments.scene.scene.to_string_lossy().into_owned(),
        header: session.header(arguments.scene.all_flags(), None)?,
    })
}

/// A failure as rank 0 prints it.
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

impl RenderArguments {
    /// Checks that several ranks can render what is asked for.
    ///
    /// # Errors
    /// The first flag that they cannot have.
    pub(super) fn check_ranks(&self, is_animation: bool) -> Result<(), Diagnostic> {
        let alone = "start one process without `mpirun`";
        let refused = [
            (self.measure_overhead, "`--measure-overhead`", alone),
            (
                self.frames.is_some() || is_animation,
                "an animation",
                "render its frames as an array of jobs: `--frames 10..19` without `mpirun`",
            ),
        ];
        let found = refused.into_iter().find(|(is_given, ..)| *is_given);
        let Some((_, what, help)) = found else {
            return Ok(());
        };
        let message = format!("several ranks render one picture, and not {what}");
        Err(Diagnostic::new(message).with_help(help))
    }
}
