//! Rank 0 deals tiles to the other ranks while its threads render.

use std::collections::HashMap;
use std::sync::atomic::Ordering;
use std::time::Instant;

use super::canvas::Canvas;
use super::tile_queue::{TileQueue, TileRuns};
use crate::checkpoint::TileRecord;
use crate::ranks::{Member, Message, MessageKind, RankFailure, Team};
use crate::schedule::{Tile, TileRun, WorkerShare, pause};

/// Deals tiles and receives them, until none is left.
struct Dealer<'a, 'f> {
    team: &'a Team<'a>,
    queue: &'a TileQueue<'a, 'f>,
    shares: Vec<WorkerShare>,
    runs: TileRuns,
    /// The rank and the position of each tile that was dealt and has not been returned.
    dealt: HashMap<u32, (u32, u32)>,
    /// Tiles that were returned before there was a canvas.
    early: Vec<(Tile, TileRun, TileRecord<'static>)>,
    /// Memory for messages.
    buffer: Vec<u8>,
}

/// Deals tiles of the queue to the workers of a team until all have returned theirs and none is
/// left. Returns the tiles that they have rendered.
pub(super) fn deal(team: &Team, queue: &TileQueue) -> TileRuns {
    let mut dealer = Dealer {
        team,
        queue,
        shares: vec![WorkerShare::default(); team.members.len()],
        runs: TileRuns::new(),
        dealt: HashMap::new(),
        early: Vec::new(),
        buffer: Vec::new(),
    };
    // Workers render while rank 0 makes its film, unless it takes over tiles first.
    if queue.pass.limits.checkpoint.is_none() {
        while dealer.is_needed() && !queue.has_target() {
            dealer.carry(None);
        }
    }
    queue.with_canvas(|canvas| {
        dealer.store_early(canvas);
        while dealer.is_needed() {
            dealer.carry(Some(canvas));
        }
    });
    dealer.runs
}

impl Dealer<'_, '_> {
    /// Takes the messages that have arrived and gives workers tiles; sleeps if there was nothing to
    /// do.
    fn carry(&mut self, canvas: Option<&Canvas>) {
        let begin = Instant::now();
        let mut is_idle = true;
        while let Some(message) = self.team.ranks.receive_into(&mut self.buffer) {
            self.take(&message, canvas);
            self.buffer = message.bytes;
            is_idle = false;
        }
        for rank in 1..self.team.ranks.n() {
            is_idle &= !self.deal_to(rank, canvas);
        }
        if is_idle {
            std::thread::sleep(pause(self.has_tiles()));
        } else {
            let spent_ns = begin.elapsed().as_nanos() as u64;
            let total = &self.team.communication_ns;
            total.fetch_add(spent_ns, Ordering::Relaxed);
        }
    }

    /// Returns true if a tile is left, or has not been returned.
    fn is_needed(&self) -> bool {
        let is_dealt = self.shares.iter().any(|share| share.n_dealt > 0);
        (is_dealt || self.queue.n_left() > 0) && !self.queue.pass.is_canceled()
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

    /// Handles a message: writes tiles to the film, and records everything else.
    fn take(&mut self, message: &Message, canvas: Option<&Canvas>) {
        self.team.note(message);
        if message.kind != MessageKind::Records {
            return;
        }
        let mut bytes = &message.bytes[..];
        while let Some((length, rest)) = bytes.split_first_chunk() {
            let length = u32::from_le_bytes(*length) as usize;
            let record = rest.split_at_checked(length).and_then(|(record, rest)| {
                bytes = rest;
                TileRecord::parse(record, &self.team.layout)
            });
            if record
                .and_then(|record| self.accept(message.from, record, canvas))
                .is_none()
            {
                return self.fail(message.from);
            }
        }
    }

    /// Takes a tile that a worker has rendered. Returns `None` if it does not fit.
    fn accept(&mut self, rank: u32, record: TileRecord, canvas: Option<&Canvas>) -> Option<()> {
        let tile = self.queue.plan.grid.tile(record.tile);
        let (_, position) = self.dealt.remove(&record.tile).filter(|to| to.0 == rank)?;
        if record.run.thread >= self.team.members[rank as usize].n_threads() {
            return None;
        }
        let run = self.on_our_clock(
            rank,
            TileRun {
                position,
                ..record.run
            },
        );
        self.shares[rank as usize].returned(run.duration_ns());
        match canvas {
            Some(canvas) => self.store(tile, run, record, canvas),
            None => {
                self.early.push((tile, run, record.into_owned()));
                Some(())
            }
        }
    }

    /// Writes a tile to the film. Returns `None` if it does not fit.
    fn store(
        &mut self,
        tile: Tile,
        run: TileRun,
        record: TileRecord,
        canvas: &Canvas,
    ) -> Option<()> {
        if !self.queue.pass.store(&tile, record, canvas) {
            return None;
        }
        self.queue.add(&mut self.runs, tile, run, canvas);
        Some(())
    }

    fn store_early(&mut self, canvas: &Canvas) {
        for (tile, run, record) in std::mem::take(&mut self.early) {
            if self.store(tile, run, record, canvas).is_none() {
                self.fail(run.rank);
            }
        }
    }

    /// Ends the rendering because of a message from a worker.
    fn fail(&self, rank: u32) {
        let failure = RankFailure {
            exit_code: 1,
            message: "it has sent a tile of another picture".to_owned(),
        };
        self.team.fail(rank, failure);
    }

    /// Returns a worker's run with the rank, the number of its thread among the threads of all
    /// ranks, and times since this rendering started.
    fn on_our_clock(&self, rank: u32, run: TileRun) -> TileRun {
        let member = &self.team.members[rank as usize];
        let begin_ns = self.queue.begin - self.team.ranks.epoch;
        let begin_ns = begin_ns.as_nanos() as i64 + member.clock_ns;
        let start_ns = (run.start_ns as i64 - begin_ns).max(0) as u64;
        self.queue.pass.after_restored(TileRun {
            rank,
            thread: member.first_thread + run.thread,
            start_ns,
            end_ns: start_ns + run.duration_ns(),
            ..run
        })
    }
}
