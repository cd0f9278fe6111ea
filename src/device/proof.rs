//! The proof of a device's arithmetic: before the first ray, it computes what the processor
//! computes, and every bit has to agree.

use std::mem::ManuallyDrop;
use std::sync::Arc;

use crate::library::{DeviceFault, LibraryDevice, compile};
use crate::program::Kernel;

/// Number of triples of numbers.
const N_TRIPLES: usize = 1 << 20;
/// The names of the results of a triple.
const RESULTS: [&str; 15] = [
    "x / y",
    "sqrt(x)",
    "x * y + z",
    "x * y - z",
    "x * y + z in double precision",
    "x * y - z in double precision",
    "x * y / z in double precision",
    "x * y in double precision, rounded",
    "comparisons of x and y",
    "floor(x)",
    "trunc(x * y) in double precision",
    "x as an integer",
    "the bits of x, an integer, as a float",
    "sqrt(x * y) in double precision",
    "x + y",
];

/// Returns the first result that the device computes differently, as text; `None` if all agree.
pub(crate) fn refute(device: &Arc<dyn LibraryDevice>) -> Result<Option<String>, DeviceFault> {
    let input: Vec<u32> = (0..3 * N_TRIPLES as u64).map(number).collect();
    let output = vec![0; RESULTS.len() * N_TRIPLES];
    let program = compile(device, include_str!("program/arithmetic.cl").to_owned())?;
    let queue = program.load(&[])?;
    // After an error, all stay.
    let mut held = ManuallyDrop::new((queue()?, input, output));
    let (queue, input, output) = &mut *held;
    queue.launch(Kernel::ARITHMETIC, input, output, N_TRIPLES)?;
    let (_, input, output) = ManuallyDrop::into_inner(held);
    let (triples, results_of_all) = (
        input.as_chunks::<3>().0,
        output.as_chunks::<{ RESULTS.len() }>().0,
    );
    for (triple, found) in triples.iter().zip(results_of_all) {
        let [x, y, z] = triple.map(f32::from_bits);
        for ((name, expected), &found) in RESULTS.iter().zip(results(x, y, z)).zip(found) {
            if expected != found {
                return Ok(Some(format!(
                    "it computes {name} as {found:#010x} for x = {x:e}, y = {y:e}, z = {z:e}, where IEEE 754 \
                     gives {expected:#010x}"
                )));
            }
        }
    }
    Ok(None)
}

/// Returns the processor's results.
fn results(x: f32, y: f32, z: f32) -> [u32; RESULTS.len()] {
    let (product, wide) = (f64::from(x) * f64::from(y), f64::from(z));
    let is_small = (-2_147_483_648.0..2_147_483_648.0).contains(&x);
    [
        bits(x / y),
        bits(x.sqrt()),
        bits(x * y + z),
        bits(x * y - z),
        folded(product + wide),
        folded(product - wide),
        folded(product / wide),
        bits(product as f32),
        u32::from(x < y) | u32::from(x <= y) << 1 | u32::from(x > y) << 2,
        bits(x.floor()),
        folded(product.trunc()),
        if is_small { x as i32 as u32 } else { 0 },
        bits(x.to_bits() as i32 as f32),
        folded(product.sqrt()),
        bits(x + y),
    ]
}

/// Returns the bits of a number; 0 for NaN, whose bits may differ.
fn bits(x: f32) -> u32 {
    if x.is_nan() { 0 } else { x.to_bits() }
}

/// Returns the halves of a number's bits as one word; 0 for NaN.
fn folded(x: f64) -> u32 {
    let bits = x.to_bits();
    if x.is_nan() {
        0
    } else {
        bits as u32 ^ (bits >> 32) as u32
    }
}

/// Returns the bits of number `i` of a sequence: every other one of any bits, with all exponents,
/// subnormals, infinities and NaN; the others between 1/16 and 16 in magnitude, whose results are
/// rarely 0 or infinite.
fn number(i: u64) -> u32 {
    let mut word = i
        .wrapping_add(0x9e37_79b9_7f4a_7c15)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9);
    word ^= word >> 31;
    let bits = (word.wrapping_mul(0x94d0_49bb_1331_11eb) >> 32) as u32;
    if (i / 3).is_multiple_of(2) {
        return bits;
    }
    let exponent = 123 + (bits >> 23) % 8;
    bits & 0x807f_ffff | exponent << 23
}
