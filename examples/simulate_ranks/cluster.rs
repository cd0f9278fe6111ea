//! A rendering on many ranks, simulated from the times of its tiles.
//!
//! Rank 0 deals tiles in their order to its own threads and, by messages, to the other ranks, as
//! [`render::ranks`] does with MPI: both ends of a message poll for the next one from time to time
//! ([`pause`]), and workers have some milliseconds of tiles ahead. The threads of rank 0 store the
//! tiles of the others between two of their own, and so does the one that deals. The simulation covers the times of tiles, messages
//! and the film of rank 0, but not that the threads of a machine, and messages, slow each other down.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use raycost::schedule::{TileRun, WorkerShare, pause};

/// Ranks with equal threads, and the network between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cluster {
    /// Number of ranks, at least 1.
    pub n_ranks: u32,
    /// Number of threads of each rank, at least 1.
    pub n_threads: u32,
    /// Time of a message without bytes, in nanoseconds.
    pub latency_ns: u64,
    /// Bytes of a message per nanosecond.
    pub bytes_per_ns: f64,
    /// Bytes of a tile in a message.
    pub tile_bytes: u64,
}

/// The times of a simulated rendering.
#[derive(Debug, Clone, PartialEq)]
pub struct Makespan {
    /// Time from the start of the first tile until rank 0 has all, in nanoseconds.
    pub ns: u64,
    /// The time of the tiles of each thread, in nanoseconds, rank by rank.
    pub busy_ns: Vec<u64>,
}

impl Makespan {
    /// Returns the mean busy time of the threads over the longest: the load balance of the POP
    /// metrics (pop-coe.eu), from 0 to 1.
    pub fn load_balance(&self) -> f64 {
        self.total_ns() / (self.busy_ns.len() as f64 * self.longest_ns())
    }

    /// Returns the longest busy time of a thread over the duration: the communication efficiency of
    /// the POP metrics, from 0 to 1.
    pub fn communication_efficiency(&self) -> f64 {
        self.longest_ns() / self.ns as f64
    }

    /// Returns the mean busy time over the duration: the product of both.
    pub fn parallel_efficiency(&self) -> f64 {
        self.load_balance() * self.communication_efficiency()
    }

    fn total_ns(&self) -> f64 {
        self.busy_ns.iter().sum::<u64>() as f64
    }

    fn longest_ns(&self) -> f64 {
        self.busy_ns.iter().copied().max().unwrap_or(0).max(1) as f64
    }
}

impl Cluster {
    /// Returns the shortest possible makespan of these tiles, in nanoseconds: each thread has the
    /// same work, or the longest tile has a thread to itself.
    pub fn ideal_ns(&self, runs: &[TileRun]) -> u64 {
        let durations = || runs.iter().map(TileRun::duration_ns);
        let n_threads = u64::from(self.n_ranks) * u64::from(self.n_threads);
        let even = durations().sum::<u64>().div_ceil(n_threads);
        durations().max().unwrap_or(0).max(even)
    }

    /// Simulates a rendering of these tiles, which are dealt in this order.
    pub fn simulate(&self, runs: &[TileRun]) -> Makespan {
        let mut simulation = Simulation::new(*self, runs);
        simulation.run();
        let threads = simulation.ranks.iter().flat_map(|rank| &rank.busy_ns);
        Makespan {
            ns: simulation.stored_ns,
            busy_ns: threads.copied().collect(),
        }
    }
}

/// The next event on a rank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    /// Thread `.1` of rank `.0` has no tile.
    Idle(u32, u32),
    /// Rank 0 receives, deals or stores.
    Lead,
    /// A worker receives and sends.
    Carry(u32),
}

/// A simulated rank.
#[derive(Debug, Default)]
struct SimulatedRank {
    /// Tiles that no thread has started; of rank 0 the tiles of others that it has not stored.
    queue: VecDeque<usize>,
    /// The threads that wait for tiles.
    idle: Vec<u32>,
    busy_ns: Vec<u64>,
    /// Rendered tiles, and the time when each was rendered.
    rendered: VecDeque<(u64, usize)>,
    /// Tiles on the way to this rank, and the time when they arrive.
    dealt: VecDeque<(u64, usize)>,
    share: WorkerShare,
}

struct Simulation<'a> {
    cluster: Cluster,
    runs: &'a [TileRun],
    /// The next tile.
    next: usize,
    ranks: Vec<SimulatedRank>,
    events: BinaryHeap<Reverse<(u64, Next)>>,
    /// Tiles on the way to rank 0: the time when they arrive, the rank and the tile.
    returned: BinaryHeap<Reverse<(u64, u32, usize)>>,
    n_stored: usize,
    /// The time when the last tile was stored.
    stored_ns: u64,
}

impl<'a> Simulation<'a> {
    fn new(cluster: Cluster, runs: &'a [TileRun]) -> Self {
        let rank = || SimulatedRank {
            busy_ns: vec![0; cluster.n_threads as usize],
            ..SimulatedRank::default()
        };
        let threads = (0..cluster.n_threads).map(|thread| Reverse((0, Next::Idle(0, thread))));
        let mut events: BinaryHeap<_> = threads.collect();
        events.push(Reverse((0, Next::Lead)));
        let mut ranks: Vec<SimulatedRank> = (0..cluster.n_ranks).map(|_| rank()).collect();
        for (rank, number) in ranks.iter_mut().zip(0..).skip(1) {
            rank.idle.extend(0..cluster.n_threads);
            // The ranks do not poll for messages at the same moments.
            let offset = pause_ns(false) * number / u64::from(cluster.n_ranks);
            events.push(Reverse((offset, Next::Carry(number as u32))));
        }
        Self {
            cluster,
            runs,
            next: 0,
            ranks,
            events,
            returned: BinaryHeap::new(),
            n_stored: 0,
            stored_ns: 0,
        }
    }

    fn run(&mut self) {
        while self.n_stored < self.runs.len() {
            let Some(Reverse((now, next))) = self.events.pop() else {
                return;
            };
            match next {
                Next::Idle(rank, thread) => self.begin_tile(now, rank, thread),
                Next::Lead => self.lead(now),
                Next::Carry(rank) => self.carry(now, rank),
            }
        }
    }

    /// Starts the next tile of a rank on a thread.
    fn begin_tile(&mut self, now: u64, number: u32, thread: u32) {
        let waiting = self.ranks[number as usize].queue.pop_front();
        if let Some(tile) = waiting.filter(|_| number == 0) {
            let end = now + self.runs[tile].film_ns;
            self.store(end);
            self.events.push(Reverse((end, Next::Idle(number, thread))));
            return;
        }
        let tile = match number {
            0 => self.take_tile(),
            _ => waiting,
        };
        let rank = &mut self.ranks[number as usize];
        let Some(tile) = tile else {
            rank.idle.push(thread);
            return;
        };
        let duration_ns = self.runs[tile].busy_ns();
        let end = now + duration_ns;
        rank.busy_ns[thread as usize] += duration_ns;
        if number == 0 {
            self.store(end);
        } else {
            let rank = &mut self.ranks[number as usize];
            let at = rank.rendered.partition_point(|&(before, _)| before <= end);
            rank.rendered.insert(at, (end, tile));
        }
        self.events.push(Reverse((end, Next::Idle(number, thread))));
    }

    fn take_tile(&mut self) -> Option<usize> {
        let tile = Some(self.next).filter(|&tile| tile < self.runs.len())?;
        self.next += 1;
        Some(tile)
    }

    /// Counts a tile as stored at this time.
    fn store(&mut self, end: u64) {
        self.n_stored += 1;
        self.stored_ns = self.stored_ns.max(end);
    }

    /// Lets rank 0 give its threads the tiles that have arrived, and deal others; or store one.
    fn lead(&mut self, now: u64) {
        let mut end = now;
        while let Some(&Reverse((arrival, rank, tile))) = self.returned.peek()
            && arrival <= now
        {
            self.returned.pop();
            let share = &mut self.ranks[rank as usize].share;
            share.returned(self.runs[tile].busy_ns());
            self.ranks[0].queue.push_back(tile);
            if let Some(thread) = self.ranks[0].idle.pop() {
                self.events.push(Reverse((now, Next::Idle(0, thread))));
            }
        }
        for rank in 1..self.cluster.n_ranks {
            end += self.deal_to(end, rank);
        }
        if end == now
            && let Some(tile) = self.ranks[0].queue.pop_front()
        {
            end += self.runs[tile].film_ns;
            self.store(end);
        }
        let has_tiles = self.next < self.runs.len();
        let next = next_look(now, end, has_tiles);
        self.events.push(Reverse((next, Next::Lead)));
    }

    /// Sends a worker the tiles that it needs. Returns the time that this takes.
    fn deal_to(&mut self, now: u64, number: u32) -> u64 {
        let n_left = (self.runs.len() - self.next) as u64;
        let [n_threads, n_ranks] = [self.cluster.n_threads, self.cluster.n_ranks].map(u64::from);
        let share = &self.ranks[number as usize].share;
        let wanted = share.n_wanted(n_threads, n_left, n_ranks);
        let arrival = now + self.cluster.latency_ns;
        let mut n_sent = 0;
        while n_sent < wanted
            && let Some(tile) = self.take_tile()
        {
            self.ranks[number as usize].dealt.push_back((arrival, tile));
            n_sent += 1;
        }
        self.ranks[number as usize].share.n_dealt += n_sent;
        if n_sent > 0 {
            self.cluster.latency_ns
        } else {
            0
        }
    }

    /// Lets a worker give its threads the tiles that have arrived, and send what they rendered.
    fn carry(&mut self, now: u64, number: u32) {
        let rank = &mut self.ranks[number as usize];
        while let Some(&(arrival, tile)) = rank.dealt.front()
            && arrival <= now
        {
            rank.dealt.pop_front();
            rank.queue.push_back(tile);
            if let Some(thread) = rank.idle.pop() {
                self.events.push(Reverse((now, Next::Idle(number, thread))));
            }
        }
        let mut end = now;
        while let Some(&(rendered, tile)) = rank.rendered.front()
            && rendered <= now
        {
            rank.rendered.pop_front();
            // It is read from the film as fast as it was written.
            end += self.runs[tile].film_ns;
            let way_ns = self.cluster.tile_bytes as f64 / self.cluster.bytes_per_ns;
            let arrival = end + self.cluster.latency_ns + way_ns as u64;
            self.returned.push(Reverse((arrival, number, tile)));
        }
        let has_tiles = !rank.queue.is_empty();
        let next = next_look(now, end, has_tiles);
        self.events.push(Reverse((next, Next::Carry(number))));
    }
}

/// Returns the time when a rank that was busy with messages until `end` polls again: at once, or
/// after a pause if it had nothing to do.
fn next_look(now: u64, end: u64, has_tiles: bool) -> u64 {
    if end > now {
        end
    } else {
        now + pause_ns(has_tiles)
    }
}

/// Returns the [`pause`] in nanoseconds.
fn pause_ns(has_tiles: bool) -> u64 {
    pause(has_tiles).as_nanos() as u64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn runs(durations_ns: impl IntoIterator<Item = u64>) -> Vec<TileRun> {
        let run = |end_ns| TileRun {
            end_ns,
            ..TileRun::default()
        };
        durations_ns.into_iter().map(run).collect()
    }

    fn cluster(n_ranks: u32, n_threads: u32) -> Cluster {
        Cluster {
            n_ranks,
            n_threads,
            latency_ns: 2000,
            bytes_per_ns: 10.0,
            tile_bytes: 60_000,
        }
    }

    #[test]
    fn a_rank_alone_deals_from_a_list() {
        // 5 and 1 on the first thread, 4 and 3 on the second.
        let makespan = cluster(1, 2).simulate(&runs([5, 4, 3, 1]));
        assert_eq!((makespan.ns, &*makespan.busy_ns), (7, &[6, 7][..]));
        assert_eq!(makespan.load_balance(), 13.0 / 14.0);
        assert_eq!(makespan.communication_efficiency(), 1.0);
    }

    #[test]
    fn long_tiles_hide_messages_and_short_ones_do_not() {
        let efficiency = |tile_ns| {
            let makespan = cluster(16, 4).simulate(&runs(vec![tile_ns; 6400]));
            makespan.parallel_efficiency()
        };
        let [long, short] = [efficiency(20_000_000), efficiency(1000)];
        assert!(long > 0.98, "{long}");
        assert!(short < 0.2, "{short}");
    }

    proptest! {
        #[test]
        fn a_makespan_lies_between_its_bounds(
            durations in prop::collection::vec(0_u64..50_000_000, 1..300),
            n_ranks in 1_u32..40,
            n_threads in 1_u32..5,
        ) {
            let cluster = cluster(n_ranks, n_threads);
            let runs = runs(durations);
            let makespan = cluster.simulate(&runs);
            let sum: u64 = runs.iter().map(TileRun::duration_ns).sum();
            prop_assert_eq!(makespan.busy_ns.iter().sum::<u64>(), sum);
            prop_assert!(makespan.ns >= cluster.ideal_ns(&runs));
            // By itself, rank 0 would end no later, except for the way of the last messages.
            let longest = runs.iter().map(TileRun::duration_ns).max().unwrap_or(0);
            let slack = 8 * pause_ns(true) + 3 * longest * (1 + u64::from(n_threads));
            prop_assert!(makespan.ns <= sum / u64::from(n_threads) + slack);
        }
    }
}
