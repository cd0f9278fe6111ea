//! All processes of a launch, by MPI.

use std::mem::ManuallyDrop;
use std::time::Duration;

use mpi::Threading;
use mpi::datatype::Equivalence;
use mpi::environment::{self, Universe};
use mpi::point_to_point::{Destination, Source};
use mpi::request::{Request, Scope};
use mpi::topology::{Communicator, SimpleCommunicator};

use super::pauses::Pauses;
use host::text::Diagnostic;

/// Time in which the launcher forwards a message.
const FORWARDED_AFTER: Duration = Duration::from_millis(100);

/// The processes of a launch.
pub(super) struct MpiWorld {
    /// A failing process does not leave, since it does not wait for the others.
    universe: ManuallyDrop<Universe>,
}

impl MpiWorld {
    /// Joins the others of the launch.
    ///
    /// # Errors
    /// If the MPI library does not let several threads take turns.
    pub(super) fn join() -> Result<Self, Diagnostic> {
        let joined = environment::initialize_with_threading(Threading::Serialized);
        match joined {
            Some((universe, Threading::Serialized | Threading::Multiple)) => Ok(Self {
                universe: ManuallyDrop::new(universe),
            }),
            _ => {
                let message = "the library of MPI does not support several threads";
                let help = "use Open MPI or MPICH, built with threads";
                Err(Diagnostic::new(message).with_help(help))
            }
        }
    }

    pub(super) fn rank(&self) -> u32 {
        self.universe.world().rank() as u32
    }

    pub(super) fn n(&self) -> u32 {
        self.universe.world().size() as u32
    }

    pub(super) fn host(&self) -> String {
        environment::processor_name().unwrap_or_default()
    }

    /// Sends bytes; sleeps while the receiver does not take them.
    pub(super) fn send(&self, to: u32, tag: i32, bytes: &[u8]) {
        let world = self.universe.world();
        let receiver = world.process_at_rank(to as i32);
        mpi::request::scope(|scope| {
            finish(receiver.immediate_send_with_tag(scope, bytes, tag));
        });
    }

    /// Receives the next message, if one has arrived, into `bytes`. Returns the sender and the tag.
    pub(super) fn receive(&self, bytes: &mut Vec<u8>) -> Option<(u32, i32)> {
        let world = self.universe.world();
        let (message, status) = world.any_process().immediate_matched_probe()?;
        let n_bytes = status.count(u8::equivalent_datatype());
        bytes.resize(n_bytes as usize, 0);
        message.matched_receive_into(&mut bytes[..]);
        Some((status.source_rank() as u32, status.tag()))
    }

    pub(super) fn leave(self) {
        drop(ManuallyDrop::into_inner(self.universe));
    }
}

/// Waits until a request is done, sleeping meanwhile.
fn finish<'a, D: ?Sized, S: Scope<'a>>(mut request: Request<'a, D, S>) {
    let mut pauses = Pauses::new();
    while let Err(pending) = request.test() {
        request = pending;
        pauses.sleep();
    }
}

impl std::fmt::Debug for MpiWorld {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MpiWorld").finish_non_exhaustive()
    }
}

/// Ends all processes that have joined, with this exit code, unless they have left.
pub fn abort(exit_code: u8) {
    if environment::is_initialized() && !environment::is_finalized() {
        // The launcher forwards what this process has printed before it prints its own.
        std::thread::sleep(FORWARDED_AFTER);
        SimpleCommunicator::world().abort(exit_code.into());
    }
}
