//! Simulates a rendering on up to 1,024 ranks from the times of its tiles on one thread:
//! `cargo run --release --example simulate_ranks -- SCENE [TILE SIZE [THREADS]]`.
//!
//! Messages take 2 µs and 10 bytes in a nanosecond, as in a network of 100 Gbit/s.

mod cluster;

use std::error::Error;

use raycost::config::TileOrder;
use raycost::film;
use raycost::schedule::TileRun;
use raycost::{Options, Session};

use cluster::Cluster;

/// Returns the tiles of a scene in the order in which they are dealt, and the bytes of each.
fn tiles(scene: &str, size: Option<u32>) -> Result<(Vec<TileRun>, u64), Box<dyn Error>> {
    let session = Session::open_with(scene, |config| {
        config.tiles.order = TileOrder::Cost;
        config.tiles.size = size.unwrap_or(config.tiles.size);
        config.repeats = raycost::config::Repeats::ONCE;
    })?;
    let options = Options {
        threads: Some(1),
        ..Options::default()
    };
    let rendering = session.render(&options)?;
    let mut runs = rendering.schedule().runs.clone();
    runs.sort_by_key(|run| run.position);
    let config = session.config();
    // With a byte for each counter.
    let of_arrays = film::stored_bytes_per_pixel(config.cost, rendering.film().extra);
    let pixel_bytes = of_arrays + raycost::cost::Counter::ALL.len();
    Ok((
        runs,
        u64::from(config.tiles.size).pow(2) * pixel_bytes as u64,
    ))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().ok_or("which scene?")?;
    let mut number = || arguments.next().map(|number| number.parse()).transpose();
    let size = number()?;
    let n_threads = number()?.unwrap_or(1);
    let (runs, tile_bytes) = tiles(&scene, size)?;
    println!("{} tiles, {n_threads} threads a rank", runs.len());
    println!("| ranks | makespan, ms | of the ideal | load balance | communication | efficiency |");
    println!("|--:|--:|--:|--:|--:|--:|");
    for n_ranks in [1, 2, 4, 8, 16, 64, 256, 1024] {
        let cluster = Cluster {
            n_ranks,
            n_threads,
            latency_ns: 2000,
            bytes_per_ns: 10.0,
            tile_bytes,
        };
        let makespan = cluster.simulate(&runs);
        println!(
            "| {n_ranks} | {:.1} | {:.2} | {:.3} | {:.3} | {:.3} |",
            makespan.ns as f64 / 1e6,
            makespan.ns as f64 / cluster.ideal_ns(&runs) as f64,
            makespan.load_balance(),
            makespan.communication_efficiency(),
            makespan.parallel_efficiency(),
        );
    }
    Ok(())
}
