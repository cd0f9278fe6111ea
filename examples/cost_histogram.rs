//! Prints a histogram of the node visits of pixels: `cargo run --release --example cost_histogram`.

use std::error::Error;
use std::path::Path;

use raycost::Metric;
use raycost::config::CostMode;
use raycost::{Options, Session};

/// Returns bars with one line per power of two: `   64..127  #####  1234`.
pub fn histogram(scene: &Path) -> Result<String, Box<dyn Error>> {
    let session = Session::open_with(scene, |config| config.cost = CostMode::Counters)?;
    let rendering = session.render(&Options::default())?;
    let visits = rendering.film().metric(Metric::NODE_VISITS);
    let mut bins = [0_usize; 33];
    for count in &visits {
        bins[(*count as u64 + 1).ilog2() as usize] += 1;
    }
    let mut text = String::new();
    for (bin, n_pixels) in bins.iter().enumerate().filter(|(_, n)| **n > 0) {
        let (low, high) = ((1_u64 << bin) - 1, (2_u64 << bin) - 2);
        let bar = "#".repeat((60 * n_pixels).div_ceil(visits.len()));
        text += &format!("{low:>7}..{high:<7} {bar} {n_pixels}\n");
    }
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", histogram(Path::new("configs/seed_extended.yaml"))?);
    Ok(())
}
