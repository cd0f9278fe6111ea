//! Time that one reading of the time stamp counter adds to a pixel: by RDTSC, and by RDTSCP, which
//! waits for earlier loads and also returns the CPU's number: `cargo bench --bench clock`.
//!
//! The work of a pixel is simulated by four chains of loads through a table, as rays follow nodes.
//! The variants take turns in one process. Prints medians.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "no safe wrapper")
)]

#[cfg(not(target_arch = "x86_64"))]
fn main() {
    println!("there is no time stamp counter");
}

#[cfg(target_arch = "x86_64")]
fn main() {
    x86_64::main();
}

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use std::arch::x86_64::{__rdtscp, _rdtsc};
    use std::hint::black_box;
    use std::time::Instant;

    use math::statistics::median;

    const N_ROUNDS: usize = 401;
    const N_PIXELS: u32 = 20_000;
    const TABLE_LEN: usize = 1 << 16;

    pub(super) fn main() {
        let table = table();
        let mut times_ns: [Vec<f64>; 3] = Default::default();
        for _ in 0..N_ROUNDS {
            let [none, rdtsc, rdtscp] = &mut times_ns;
            none.push(round_ns(&table, || 0));
            // SAFETY: every x86-64 CPU has RDTSC.
            rdtsc.push(round_ns(&table, || unsafe { _rdtsc() }));
            rdtscp.push(round_ns(&table, || {
                let mut cpu = 0;
                // SAFETY: all x86-64 CPUs since 2006 have RDTSCP.
                let ticks = unsafe { __rdtscp(&mut cpu) };
                ticks ^ u64::from(cpu)
            }));
        }
        println!("ns per pixel, medians of {N_ROUNDS} rounds");
        for (name, times_ns) in ["none", "rdtsc", "rdtscp"].into_iter().zip(&mut times_ns) {
            println!("{name:8} {:6.1}", median(times_ns).unwrap_or_default());
        }
    }

    /// Returns noise from the linear congruential generator of Numerical Recipes.
    fn table() -> Vec<u32> {
        let next = |state: &u32| Some(state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        let noise = std::iter::successors(Some(1_u32), next);
        noise.map(|state| state >> 8).take(TABLE_LEN).collect()
    }

    /// Returns the mean time of a pixel in nanoseconds with a reading after each.
    fn round_ns(table: &[u32], read: impl Fn() -> u64) -> f64 {
        let begin = Instant::now();
        for seed in 0..N_PIXELS {
            black_box(pixel(table, seed));
            black_box(read());
        }
        begin.elapsed().as_nanos() as f64 / f64::from(N_PIXELS)
    }

    #[inline(never)]
    fn pixel(table: &[u32], seed: u32) -> u32 {
        let mut places = [seed, seed ^ 77, seed ^ 991, seed ^ 5];
        for _ in 0..12 {
            places = places.map(|place| table[place as usize % TABLE_LEN]);
        }
        places.iter().fold(0, |sum, place| sum ^ place)
    }
}
