//! The proof of a device's arithmetic: before the first ray, it computes what the processor
//! computes, and every bit has to agree.

use std::mem::ManuallyDrop;

use crate::library::{DeviceFault, LibraryDevice};
use crate::program::Kernel;

/// Number of triples of numbers.
const N_TRIPLES: usize = 1 << 19;
/// Results of a triple, and their names.
const RESULTS: [&str; 8] = [
    "x / y",
    "sqrt(x)",
    "x * y + z",
    "x * y - z",
    "x * y + z in double precision",
    "x * y / z in double precision",
    "comparisons of x and y",
    "x + y",
];

/// Returns the first result that the device computes differently, as text; `None` if all agree.
pub(crate) fn refute(device: &dyn LibraryDevice) -> Result<Option<String>, DeviceFault> {
    let input: Vec<u32> = (0..3 * N_TRIPLES as u64).map(number).collect();
    let output = vec![0; RESULTS.len() * N_TRIPLES];
    let program = device.compile(include_str!("program/arithmetic.cl"))?;
    // After an error, both stay.
    let mut held = ManuallyDrop::new((program.load(&[])?.queue()?, output));
    let (queue, output) = &mut *held;
    queue.launch(Kernel::ARITHMETIC, &input, output, N_TRIPLES)?;
    let (_, output) = ManuallyDrop::into_inner(held);
    let (triples, results_of_all) = (input.as_chunks::<3>().0, output.as_chunks::<8>().0);
    for (triple, found) in triples.iter().zip(results_of_all) {
        let [x, y, z] = triple.map(f32::from_bits);
        for ((name, expected), &found) in RESULTS.iter().zip(results(x, y, z)).zip(found) {
            if !is_same(expected, found) {
                let found = f32::from_bits(found);
                return Ok(Some(format!(
                    "it computes {name} as {found:e} for x = {x:e}, y = {y:e}, z = {z:e}, where IEEE 754 \
                     gives {:e}",
                    f32::from_bits(expected)
                )));
            }
        }
    }
    Ok(None)
}

/// The bits of a NaN may differ.
fn is_same(expected: u32, found: u32) -> bool {
    expected == found || f32::from_bits(expected).is_nan() && f32::from_bits(found).is_nan()
}

/// Returns the processor's results.
fn results(x: f32, y: f32, z: f32) -> [u32; 8] {
    let product = f64::from(x) * f64::from(y);
    let comparisons = u32::from(x < y) | u32::from(x <= y) << 1 | u32::from(x > y) << 2;
    [
        (x / y).to_bits(),
        x.sqrt().to_bits(),
        (x * y + z).to_bits(),
        (x * y - z).to_bits(),
        ((product + f64::from(z)) as f32).to_bits(),
        ((product / f64::from(z)) as f32).to_bits(),
        comparisons,
        (x + y).to_bits(),
    ]
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
