//! `mpirun raycost render`: one picture by several processes.

use super::RenderArguments;
use crate::cli::open_scene::OpenScene;
use crate::cli::{Failure, thread_pool};
use crate::session::this_build;
use crate::session::{Options, RenderError, Session};
use base::files::{self, SharedFiles};
use base::stop;
use base::text::Diagnostic;
use output::memory::Memory;
use render::instruments::{HardwareCounters, Stages};
use render::ranks::{Hello, RankFailure, Ranks, SceneText, Team};
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

fn work(arguments: &RenderArguments, ranks: &Ranks) -> Result<(), Failure> {
    ranks.introduce(&hello(arguments, ranks)?);
    let Some(SceneText { name, text }) = ranks.receive_scene() else {
        return Ok(stop::check()?);
    };
    let files = files::share(ranks.broadcast());
    let scene = OpenScene::of(&arguments.scene, Source::new(name, text))?;
    let input = scene.load(None, Memory::of_part)?;
    files.end();
    let stages = Stages::start(HardwareCounters::none());
    let session = Session::new(input, stages)?;
    ranks.report(&session.header_of_rank(arguments.scene.all_flags())?);
    let options = Options {
        threads: arguments.threads,
        simd: arguments.simd,
        traversal: arguments.traversal.unwrap_or_default(),
        ..Options::default()
    };
    Ok(session.work(&options, ranks)?)
}

/// The other ranks, which rank 0 leads, before they have read the scene.
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

    /// Sends the text of the scene to the ranks, and from now on its files.
    pub(super) fn send(&self, scene: &Source) -> SharedFiles {
        self.ranks.send_scene(&SceneText {
            name: scene.name().to_owned(),
            text: scene.text().to_owned(),
        });
        files::share(self.ranks.broadcast())
    }

    /// Waits until the ranks have read the scene.
    pub(super) fn gather(
        self,
        arguments: &RenderArguments,
        session: &Session,
    ) -> Result<Team, Failure> {
        let header = session.header_of_rank(arguments.scene.all_flags())?;
        Ok(Team::gather(self.ranks, self.hellos, &header).map_err(of_rank)?)
    }
}

fn of_rank((rank, failure): (String, RankFailure)) -> RenderError {
    RenderError::of_rank(&rank, &failure)
}

/// Returns the introduction of a rank before it renders.
fn hello(arguments: &RenderArguments, ranks: &Ranks) -> Result<Hello, Failure> {
    let n_threads = thread_pool(arguments.threads)?.current_num_threads();
    Ok(Hello {
        host: ranks.host(),
        n_threads: n_threads as u32,
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

impl RenderArguments {
    /// Checks that several ranks can render what is requested.
    ///
    /// # Errors
    /// The first flag that is not allowed.
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
