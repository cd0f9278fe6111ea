//! The processes that render pictures together: the ranks of MPI.
//!
//! [`Ranks`] sends and receives bytes; rank 0 leads a [`Team`] of all others, and a worker answers
//! it. Rank 0 compares versions and flags before it reads the scene, whose text it sends. Then it
//! gives [`Order`]s: for each picture, all ranks read the files of the scene and compare their
//! contents. The messages of tiles are handled in [`crate::tiles`]. MPI is the system's library,
//! behind the cargo feature `mpi`; without it, no process can join, and several processes of one
//! launch are refused.
//!
//! One thread of a process sends and receives at a time (`MPI_THREAD_SERIALIZED`): the main thread
//! until the rendering starts and after it has ended, and a dedicated thread in between.

mod pauses;
mod launch;
mod message;
mod hello;
mod team;
#[cfg(feature = "mpi")]
mod mpi_world;
#[cfg(not(feature = "mpi"))]
mod no_mpi_world;

use std::time::Instant;

#[cfg(feature = "mpi")]
use mpi_world::MpiWorld;
#[cfg(not(feature = "mpi"))]
use no_mpi_world::NoMpiWorld as MpiWorld;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::checkpoint::Header;
use base::stop;
use host::text::Diagnostic;
use pauses::Pauses;

pub use hello::{Hello, Order, SceneText};
pub use launch::{local_rank, n_launched};
pub use message::{Message, MessageKind, RankFailure};
#[cfg(feature = "mpi")]
pub use mpi_world::abort;
#[cfg(not(feature = "mpi"))]
pub use no_mpi_world::abort;
pub use team::{Member, RankWork, Team};

/// True if this program can be one of several ranks.
pub const IS_BUILT: bool = cfg!(feature = "mpi");

/// This process among all that were launched together.
#[derive(Debug)]
pub struct Ranks {
    world: MpiWorld,
    /// The moment when this process's clock was 0.
    pub epoch: Instant,
}

impl Ranks {
    /// Joins the other processes of the launch. Returns `None` if this process was launched by
    /// itself.
    ///
    /// # Errors
    /// If this program was built without MPI, or the library has no threads.
    pub fn join() -> Result<Option<Self>, Diagnostic> {
        if n_launched().is_none_or(|n| n == 1) {
            return Ok(None);
        }
        let world = MpiWorld::join()?;
        let epoch = Instant::now();
        Ok(Some(Self { world, epoch }).filter(|ranks| ranks.n() > 1))
    }

    /// Returns the number of this process, from 0.
    pub fn rank(&self) -> u32 {
        self.world.rank()
    }

    /// Returns the number of processes.
    pub fn n(&self) -> u32 {
        self.world.n()
    }

    /// Returns the name of this machine.
    pub fn host(&self) -> String {
        self.world.host()
    }

    /// Returns the nanoseconds on this process's clock.
    pub fn now_ns(&self) -> u64 {
        self.epoch.elapsed().as_nanos() as u64
    }

    /// Sends a message; returns when its bytes are no longer needed.
    pub fn send(&self, to: u32, kind: MessageKind, bytes: &[u8]) {
        self.world.send(to, kind.tag(), bytes);
    }

    /// Sends a value, as a message of this kind.
    pub fn send_value(&self, to: u32, kind: MessageKind, value: &impl Serialize) {
        self.send(to, kind, &serde_json::to_vec(value).unwrap_or_default());
    }

    /// Sends a value to all others, which wait for it ([`Self::receive_value`]).
    pub fn send_to_all(&self, value: &impl Serialize) {
        (1..self.n()).for_each(|rank| self.send_value(rank, MessageKind::Value, value));
    }

    /// Waits for a value from rank 0. Returns `None` if the program is asked to end.
    pub fn receive_value<T: DeserializeOwned>(&self) -> Option<T> {
        serde_json::from_slice(&self.wait()?.bytes).ok()
    }

    /// Returns the next message, if one has arrived.
    pub fn receive(&self) -> Option<Message> {
        let mut bytes = Vec::new();
        let (from, tag) = self.world.receive(&mut bytes)?;
        let kind = MessageKind::from_tag(tag)?;
        Some(Message { from, kind, bytes })
    }

    /// Waits for the next message. Returns `None` if the program is asked to end.
    pub fn wait(&self) -> Option<Message> {
        let mut pauses = Pauses::new();
        while !stop::is_requested() {
            if let Some(message) = self.receive() {
                return Some(message);
            }
            pauses.sleep();
        }
        None
    }

    /// Leaves the other processes, which all have to leave, too; no message can be sent afterwards.
    pub fn leave(self) {
        self.world.leave();
    }

    /// Reports to rank 0 that this worker cannot render, and waits until rank 0 ends the job.
    pub fn fail(&self, failure: &RankFailure) {
        self.send_value(0, MessageKind::Failure, failure);
        while self.wait().is_some() {}
    }

    /// Waits until all others have introduced themselves. Returns them, after rank 0 itself.
    ///
    /// # Errors
    /// The first rank that fails or differs, with its number and its machine.
    pub fn meet(&self, leader: Hello) -> Result<Vec<Hello>, (String, RankFailure)> {
        team::meet(self, leader)
    }

    /// Reports to rank 0 what this worker is about to render, and lets it read this worker's clock.
    pub fn report(&self, header: &Header) {
        self.send_value(0, MessageKind::Value, header);
        let Some(mut message) = self.wait() else {
            return;
        };
        for n_read in 1..=team::N_CLOCK_READINGS {
            debug_assert_eq!(message.kind, MessageKind::Clock);
            self.send(0, MessageKind::Clock, &self.now_ns().to_le_bytes());
            if n_read == team::N_CLOCK_READINGS {
                return;
            }
            // Without sleeping: the time between two readings is only the time of the messages.
            message = loop {
                match self.receive() {
                    Some(message) => break message,
                    None if stop::is_requested() => return,
                    None => std::thread::yield_now(),
                }
            };
        }
    }
}
