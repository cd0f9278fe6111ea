//! In place of MPI where the program was built without it: no process can join.

use host::text::Diagnostic;

/// No processes: no value exists.
#[derive(Debug)]
pub(super) enum NoMpiWorld {}

impl NoMpiWorld {
    pub(super) fn join() -> Result<Self, Diagnostic> {
        let message = "several processes would render the same picture: this raycost was built \
                       without MPI";
        let help = "build with `cargo install --path . --features mpi` (on Debian, after \
                    `apt-get install libopenmpi-dev libclang-dev`), or start one process with \
                    `--threads`";
        Err(Diagnostic::new(message).with_help(help))
    }

    pub(super) fn rank(&self) -> u32 {
        match *self {}
    }

    pub(super) fn n(&self) -> u32 {
        match *self {}
    }

    pub(super) fn host(&self) -> String {
        match *self {}
    }

    pub(super) fn send(&self, _: u32, _: i32, _: &[u8]) {
        match *self {}
    }

    pub(super) fn receive(&self, _: &mut Vec<u8>) -> Option<(u32, i32)> {
        match *self {}
    }

    pub(super) fn leave(self) {
        match self {}
    }
}

/// Ends all processes that have joined: there are none.
pub fn abort(_: u8) {}
