//! Rank 0 deals tiles to the other ranks while its threads render.
//!
//! One thread sends and receives. The pixels that it receives are written to the film by itself, if it
//! has nothing else to do, and by the threads that render, between two tiles of their own: one thread
//! could not write the pixels of many ranks.

use std::collections::HashMap;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{SyncSender, TrySendError};
use std::time::Instant;

use super::canvas::Canvas;
use super::tile_batch::{self, TileBatch};
use super::tile_queue::{TileQueue, TileRuns};
use crate::checkpoint::TileRecord;
use crate::ranks::{Member, Message, MessageKind, RankFailure, Team};
use crate::schedule::{WorkerShare, pause};

/// Greatest number of batches of tiles that wait for a thread: with as many, the one that receives
/// them stores the next one before it goes on.
pub(super) const MAX_BATCHES: usize = 64;

/// Deals tiles and receives them, until none is left.
struct Dealer<'a, 'f> {
    team: &'a Team<'a>,
    queue: &'a TileQueue<'a, 'f>,
    /// To the threads that store tiles.
    to_threads: SyncSender<TileBatch>,
    shares: Vec<WorkerShare>,
    runs: TileRuns,
    /// The rank and the position of each tile that was dealt and has not been returned.
    dealt: HashMap<u32, (u32, u32)>,
}

/// Deals tiles of the queue to the workers of a team until all have returned theirs and none is
/// left. Returns the tiles that this thread has taken over or stored.
pub(super) fn deal(team: &Team, queue: &TileQueue, to_threads: SyncSender<TileBatch>) -> TileRuns {
    let mut dealer = Dealer {
        team,
        queue,
        to_threads,
        shares: vec![WorkerShare::default(); team.members.len()],
        runs: TileRuns::new(),
        dealt: HashMap::new(),
    };
    match queue.pass.limits.checkpoint {
        Some(_) => queue.with_canvas(|canvas| dealer.deal_all(Some(canvas))),
        // Without tiles to take over, workers render while rank 0 makes its film.
        None => dealer.deal_all(None),
    }
    dealer.runs
}

impl Dealer<'_, '_> {
    /// Receives and deals tiles until none is left; meanwhile stores tiles, or sleeps if there is
    /// nothing to do.
    fn deal_all(&mut self, canvas: Option<&Canvas>) {
        while self.is_needed() {
            let begin = Instant::now();
            let mut is_idle = true;
            while let Some(message) = self.team.ranks.receive() {
                self.take(message);
                is_idle = false;
            }
            for rank in 1..self.team.ranks.n() {
                is_idle &= !self.deal_to(rank, canvas);
            }
            if is_idle && !self.queue.store_next(&mut self.runs) {
                std::thread::sleep(pause(self.has_tiles()));
            } else {
                self.team.add_communication(begin);
            }
        }
    }

    /// Returns true if a tile is left, or has not been returned.
    fn is_needed(&self) -> bool {
        (!self.dealt.is_empty() || self.queue.n_left() > 0) && !self.queue.pass.is_canceled()
    }

    /// Returns true if all threads have tiles to render, as far as rank 0 knows.
    fn has_tiles(&self) -> bool {
        let others = &self.team.members[1..];
        let are_ready = |member: &Member| member.is_ready.load(Ordering::Relaxed);
        self.queue.n_left() > 0 && others.iter().all(are_ready)
    }

    /// Gives a worker the tiles that it needs. Returns false if it needs none.
    fn deal_to(&mut self, rank: u32, canvas: Option<&Canvas>) -> bool {
        let member = &self.team.members[rank as usize];
        if !member.is_ready.load(Ordering::Relaxed) {
            return false;
        }
        let [n_left, n_ranks] = [self.queue.n_left(), self.team.ranks.n()].map(u64::from);
        let share = &self.shares[rank as usize];
        let wanted = share.n_wanted(member.n_threads().into(), n_left, n_ranks);
        let mut bytes = Vec::new();
        for _ in 0..wanted {
            let Some((position, tile)) = self.queue.next(&mut self.runs, canvas) else {
                break;
            };
            self.dealt.insert(tile.number, (rank, position));
            bytes.push(self.queue.pass.number);
            bytes.extend(tile.number.to_le_bytes());
            self.shares[rank as usize].n_dealt += 1;
        }
        if bytes.is_empty() {
            return false;
        }
        self.send(rank, &bytes);
        true
    }

    fn send(&self, rank: u32, bytes: &[u8]) {
        self.team.ranks.send(rank, MessageKind::Tiles, bytes);
        let n_bytes = bytes.len() as u64;
        self.team.sent_bytes.fetch_add(n_bytes, Ordering::Relaxed);
    }

    /// Handles a message: gives tiles to the threads, and records everything else.
    fn take(&mut self, message: Message) {
        self.team.note(&message);
        if message.kind != MessageKind::Records {
            return;
        }
        let Message { from, bytes, .. } = message;
        let positions: Option<Vec<u32>> = tile_batch::split(&bytes)
            .map(|record| self.accept(from, record?))
            .collect();
        let Some(positions) = positions else {
            return self.team.fail(from, RankFailure::foreign_tile());
        };
        let batch = TileBatch {
            rank: from,
            positions,
            bytes,
        };
        if let Err(TrySendError::Full(batch)) = self.to_threads.try_send(batch) {
            let queue = self.queue;
            queue.with_canvas(|canvas| queue.store(&batch, &mut self.runs, canvas));
        }
    }

    /// Notes that a worker has returned a tile. Returns its position, or `None` if it was not dealt
    /// to it.
    fn accept(&mut self, rank: u32, record: &[u8]) -> Option<u32> {
        let record = TileRecord::parse_head(record, &self.team.layout)?;
        let (_, position) = self.dealt.remove(&record.tile).filter(|to| to.0 == rank)?;
        if record.run.thread >= self.team.members[rank as usize].n_threads() {
            return None;
        }
        self.shares[rank as usize].returned(record.run.duration_ns());
        Some(position)
    }
}
