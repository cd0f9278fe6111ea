//! A worker, which renders the tiles that rank 0 deals to it.

use std::io;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Instant;

use super::canvas::Canvas;
use super::tile_batch;
use super::{TilePlan, TileRenderer, View, render_tile, renderer};
use crate::checkpoint::TileRecord;
use crate::film::Film;
use crate::ranks::{MessageKind, RankWork, Ranks};
use crate::schedule::{TileRun, pause};
use base::{locked, stop};
use host::start_in_scope;
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Greatest number of bytes of tiles in a message, which one thread of rank 0 stores.
const MAX_BYTES: usize = 1 << 18;

/// Bytes of a tile in a message: the numbers of its rendering and of the tile.
const DEALT_BYTES: usize = size_of::<u8>() + size_of::<u32>();

/// The numbers of a rendering and of a tile.
type DealtTile = (u8, u32);

/// Renders the tiles that rank 0 deals on all threads of the current rayon pool, each pixel
/// measured with the `meter`, and sends them back, until rank 0 has no more. After a request to
/// stop ([`stop`]) it ends at once.
///
/// # Errors
/// The system refuses the thread that sends and receives.
pub fn work(ranks: &Ranks, tracer: Tracer, plan: &TilePlan, meter: &Meter) -> io::Result<()> {
    let film = &plan.film_without_rows(tracer.scene, meter.mode());
    let view = View::new(tracer, &plan.sensor);
    let (to_threads, dealt) = mpsc::channel();
    let (to_rank_0, rendered) = mpsc::channel();
    let dealt = DealtTiles {
        tiles: Mutex::new(dealt),
        n: AtomicUsize::new(0),
    };
    let post = Post {
        ranks,
        dealt: &dealt,
        rendered,
        work: RankWork::default(),
    };
    std::thread::scope(|scope| {
        start_in_scope(scope, || post.carry(to_threads))?;
        rayon::broadcast(|context| {
            let thread = context.index() as u32;
            let film = film.empty_tile();
            let renderer = &mut *renderer(view, meter, plan);
            render_some(thread, renderer, ranks, plan, film, &dealt, &to_rank_0);
        });
        Ok(())
    })
}

/// Renders tiles on the calling thread until there are no more.
fn render_some(
    thread: u32,
    renderer: &mut dyn TileRenderer,
    ranks: &Ranks,
    plan: &TilePlan,
    mut film: Film,
    dealt: &DealtTiles,
    to_rank_0: &Sender<TileRecord<'static>>,
) {
    while let Some((rendering, number)) = dealt.next() {
        let grid = plan.grid.for_rendering(rendering, film.cost);
        let tile = grid.tile(number);
        let canvas = &Canvas::one_tile(&mut film, grid);
        let run = render_tile(renderer, plan, &tile, canvas, ranks.epoch);
        let run = TileRun { thread, ..run };
        let record = canvas.record(&tile, rendering, run);
        // A tile that was stopped is not whole.
        if stop::is_requested() || to_rank_0.send(record).is_err() {
            return;
        }
    }
}

/// The tiles that no thread of a worker has started.
struct DealtTiles {
    tiles: Mutex<Receiver<DealtTile>>,
    n: AtomicUsize,
}

impl DealtTiles {
    /// Waits for the next tile. Returns `None` if there will be no more.
    fn next(&self) -> Option<DealtTile> {
        let tiles = locked(&self.tiles);
        let next = tiles.recv().ok()?;
        self.n.fetch_sub(1, Ordering::Relaxed);
        Some(next)
    }

    /// Gives the tiles of a message to the threads.
    fn add(&self, bytes: &[u8], to_threads: &Sender<DealtTile>) {
        let (tiles, _) = bytes.as_chunks::<DEALT_BYTES>();
        self.n.fetch_add(tiles.len(), Ordering::Relaxed);
        for &[rendering, number @ ..] in tiles {
            // The threads end after the sender.
            let _ = to_threads.send((rendering, u32::from_le_bytes(number)));
        }
    }

    /// Returns true if there are any tiles.
    fn are_some(&self) -> bool {
        self.n.load(Ordering::Relaxed) > 0
    }
}

/// Carries tiles between rank 0 and the threads of a worker.
struct Post<'a> {
    ranks: &'a Ranks,
    dealt: &'a DealtTiles,
    rendered: Receiver<TileRecord<'static>>,
    work: RankWork,
}

impl Post<'_> {
    /// Carries tiles until rank 0 has no more; then the threads end, since `to_threads` is dropped.
    fn carry(mut self, to_threads: Sender<DealtTile>) {
        self.ranks.send(0, MessageKind::Ready, &[]);
        while !stop::is_requested() {
            let begin = Instant::now();
            let mut is_idle = true;
            while let Some(message) = self.ranks.receive() {
                is_idle = false;
                match message.kind {
                    MessageKind::Tiles => self.dealt.add(&message.bytes, &to_threads),
                    MessageKind::End => {
                        return self.ranks.send_value(0, MessageKind::End, &self.work);
                    }
                    _ => {}
                }
            }
            is_idle &= !self.send_rendered();
            if is_idle {
                std::thread::sleep(pause(self.dealt.are_some()));
            } else {
                self.work.communication_ns += begin.elapsed().as_nanos() as u64;
            }
        }
    }

    /// Sends the tiles that the threads have rendered. Returns false if there are none.
    fn send_rendered(&mut self) -> bool {
        let mut bytes = Vec::new();
        while let Some(record) = self.next_rendered(bytes.len()) {
            tile_batch::append(&mut bytes, &record);
        }
        if !bytes.is_empty() {
            self.ranks.send(0, MessageKind::Records, &bytes);
            self.work.sent_bytes += bytes.len() as u64;
        }
        !bytes.is_empty()
    }

    /// Returns a rendered tile for a message that already has `n_bytes` bytes.
    fn next_rendered(&self, n_bytes: usize) -> Option<TileRecord<'static>> {
        if n_bytes < MAX_BYTES {
            self.rendered.try_recv().ok()
        } else {
            None
        }
    }
}
