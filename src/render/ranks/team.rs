//! Rank 0 and the workers that it leads.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{Hello, Message, MessageKind, RankFailure, Ranks};
use crate::checkpoint::{Header, RecordLayout};
use base::stop;

/// Number of times that rank 0 reads the clock of a worker: the reading that took the shortest time
/// is the most accurate one.
pub(super) const N_CLOCK_READINGS: usize = 16;

/// All ranks of one picture, as rank 0 leads them.
#[derive(Debug)]
pub struct Team<'a> {
    /// The connection to the other ranks.
    pub ranks: &'a Ranks,
    /// All ranks by their numbers.
    pub members: Vec<Member>,
    /// The sizes of the tiles that workers send.
    pub layout: RecordLayout,
    failure: OnceLock<(u32, RankFailure)>,
    /// Bytes of the messages that rank 0 has sent.
    pub sent_bytes: AtomicU64,
    /// Time in which the threads of rank 0 have sent, received and stored tiles, in nanoseconds.
    communication_ns: AtomicU64,
}

/// A rank.
#[derive(Debug)]
pub struct Member {
    /// The name of the rank's machine.
    pub host: String,
    /// The CPUs on which each thread may run, such as `0-3,8`, if the system reports them.
    pub affinity: Vec<Option<String>>,
    /// Number of the first thread among the threads of all ranks.
    pub first_thread: u32,
    /// The rank's clock minus the clock of rank 0, in nanoseconds.
    pub clock_ns: i64,
    /// True if its threads wait for tiles.
    pub is_ready: AtomicBool,
}

impl Member {
    /// Returns the number of threads.
    pub fn n_threads(&self) -> u32 {
        self.affinity.len() as u32
    }
}

/// A rank's communication while it rendered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RankWork {
    /// Bytes of the messages that it sent.
    pub sent_bytes: u64,
    /// Time in which it sent, received and packed or stored tiles, in nanoseconds.
    pub communication_ns: u64,
}

impl<'a> Team<'a> {
    /// Waits until all others have read the files of the scene, and compares their renderings with
    /// rank 0's.
    ///
    /// # Errors
    /// The first rank that fails or differs, with its number and its machine.
    pub fn gather(
        ranks: &'a Ranks,
        hellos: &[Hello],
        header: &Header,
    ) -> Result<Self, (String, RankFailure)> {
        compare(ranks, hellos, header)?;
        let mut first_thread = 0;
        let members = hellos.iter().map(|hello| {
            let member = Member {
                host: hello.host.clone(),
                affinity: hello.affinity.clone(),
                first_thread,
                clock_ns: 0,
                is_ready: AtomicBool::new(false),
            };
            first_thread += hello.affinity.len() as u32;
            member
        });
        let mut team = Self {
            members: members.collect(),
            ranks,
            layout: header.layout,
            failure: OnceLock::new(),
            sent_bytes: AtomicU64::new(0),
            communication_ns: AtomicU64::new(0),
        };
        for rank in 1..team.ranks.n() {
            team.members[rank as usize].clock_ns = team.clock_of(rank);
        }
        Ok(team)
    }

    /// Measures how far a worker's clock is ahead of the clock of rank 0, in nanoseconds.
    fn clock_of(&self, rank: u32) -> i64 {
        let mut best = (u64::MAX, 0);
        for _ in 0..N_CLOCK_READINGS {
            let asked_ns = self.ranks.now_ns();
            self.ranks.send(rank, MessageKind::Clock, &[]);
            let Some(there_ns) = self.time() else {
                break;
            };
            let answered_ns = self.ranks.now_ns();
            let offset_ns = there_ns as i64 - (asked_ns + answered_ns) as i64 / 2;
            best = best.min((answered_ns - asked_ns, offset_ns));
        }
        best.1
    }

    /// Waits for the time on a worker's clock without sleeping. Returns `None` if the program is
    /// asked to end, or a rank has failed.
    fn time(&self) -> Option<u64> {
        while !stop::is_requested() && !self.has_failed() {
            match self.ranks.receive() {
                Some(message) if message.kind == MessageKind::Clock => {
                    return Some(u64::from_le_bytes(message.bytes.try_into().ok()?));
                }
                Some(message) => self.note(&message),
                None => std::thread::yield_now(),
            }
        }
        None
    }

    /// Returns the number of threads of all ranks.
    pub fn n_threads(&self) -> u32 {
        self.members.iter().map(Member::n_threads).sum()
    }

    /// Handles a message other than a tile: a worker is ready, or has failed.
    pub fn note(&self, message: &Message) {
        match message.kind {
            MessageKind::Ready => {
                let member = &self.members[message.from as usize];
                member.is_ready.store(true, Ordering::Relaxed);
            }
            MessageKind::Failure => self.fail(message.from, failure_of(message)),
            _ => {}
        }
    }

    /// Adds the time since `begin` to the time of communication.
    pub fn add_communication(&self, begin: Instant) {
        let spent_ns = begin.elapsed().as_nanos() as u64;
        self.communication_ns.fetch_add(spent_ns, Ordering::Relaxed);
    }

    /// Ends the rendering because a rank has failed.
    pub fn fail(&self, rank: u32, failure: RankFailure) {
        let _ = self.failure.set((rank, failure));
    }

    /// Returns the reason why a rank has failed, and its name, or `None` if none has failed.
    pub fn failure(&self) -> Option<(String, RankFailure)> {
        let (rank, failure) = self.failure.get()?;
        let host = &self.members[*rank as usize].host;
        Some((named(*rank, Some(host)), failure.clone()))
    }

    /// Returns true if a rank has failed.
    pub fn has_failed(&self) -> bool {
        self.failure.get().is_some()
    }

    /// Dismisses the workers. Returns the work of each rank.
    pub fn dismiss(&self) -> Vec<RankWork> {
        let mut work = vec![None; self.members.len()];
        work[0] = Some(RankWork {
            sent_bytes: self.sent_bytes.load(Ordering::Relaxed),
            communication_ns: self.communication_ns.load(Ordering::Relaxed),
        });
        for rank in 1..self.ranks.n() {
            self.ranks.send(rank, MessageKind::End, &[]);
        }
        while work.contains(&None) && !self.has_failed() {
            let Some(message) = self.ranks.wait() else {
                break;
            };
            self.note(&message);
            if message.kind == MessageKind::End {
                let of_rank = serde_json::from_slice(&message.bytes).unwrap_or_default();
                work[message.from as usize] = Some(of_rank);
            }
        }
        work.into_iter().map(Option::unwrap_or_default).collect()
    }
}

/// Waits until all others have introduced themselves to a rank 0 that would send `leader`.
pub(super) fn meet(ranks: &Ranks, leader: Hello) -> Result<Vec<Hello>, (String, RankFailure)> {
    let fault = |other: &Hello| other.fault(&leader);
    let name = |rank: u32, other: Option<&Hello>| named(rank, other.map(|other| &*other.host));
    let others = from_each(ranks, fault, name)?;
    Ok([leader].into_iter().chain(others).collect())
}

/// Waits until all others have read the files of the scene, and compares their renderings.
fn compare(ranks: &Ranks, hellos: &[Hello], header: &Header) -> Result<(), (String, RankFailure)> {
    let fault = |other: &Header| {
        let message = "the files of the scene differ from the files of rank 0";
        let is_foreign = other.foreign_to(header).is_some();
        is_foreign.then(|| RankFailure::input(message))
    };
    let name = |rank: u32, _: Option<&Header>| named(rank, Some(&hellos[rank as usize].host));
    from_each(ranks, fault, name).map(drop)
}

/// Waits for one value from each other rank, in order.
///
/// # Errors
/// The first rank that sends a failure instead, or whose value has a fault.
fn from_each<T: Clone + DeserializeOwned>(
    ranks: &Ranks,
    fault: impl Fn(&T) -> Option<RankFailure>,
    name: impl Fn(u32, Option<&T>) -> String,
) -> Result<Vec<T>, (String, RankFailure)> {
    let mut found: Vec<Option<T>> = vec![None; ranks.n() as usize - 1];
    while found.iter().any(Option::is_none) {
        // A failure after a signal is not reported.
        let ended = || ("a rank".to_owned(), RankFailure::input("it has ended"));
        let message = ranks.wait().ok_or_else(ended)?;
        let value: Option<T> = serde_json::from_slice(&message.bytes).ok();
        let fault = match &value {
            None => Some(failure_of(&message)),
            Some(value) => fault(value),
        };
        if let Some(fault) = fault {
            return Err((name(message.from, value.as_ref()), fault));
        }
        found[message.from as usize - 1] = value;
    }
    Ok(found.into_iter().flatten().collect())
}

/// Returns the failure in a message.
fn failure_of(message: &Message) -> RankFailure {
    let failure = serde_json::from_slice(&message.bytes);
    failure.unwrap_or_else(|_| RankFailure::input("it is another version of raycost"))
}

/// Returns a name such as "rank 3 on node7".
fn named(rank: u32, host: Option<&str>) -> String {
    match host {
        Some(host) => format!("rank {rank} on {host}"),
        None => format!("rank {rank}"),
    }
}
