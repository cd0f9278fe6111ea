//! Deflate (RFC 1951) for filtered rows: literals and runs of zeros, with a Huffman code
//! of their own for each strip.

use super::bits::BitWriter;
use super::huffman::{self, Code};

/// The symbol that ends a block.
const END: usize = 256;
/// Number of symbols of literals, of the end and of lengths.
const N_SYMBOLS: usize = 286;
/// The most bits of a symbol: those of four are written at once.
const MOST_BITS: u8 = 12;

/// Upper bound of the bytes of a strip besides its symbols: its codes, its end, and the
/// empty block behind it.
const MOST_OTHER_BYTES: usize = 1024;

/// The shortest and the longest run of zeros that one symbol repeats.
const RUNS: [usize; 2] = [3, 258];

/// Bytes that are literals, or zeros, together: so no branch depends on a single byte.
const WORD: usize = 8;
/// The order of lengths of the code that encodes the lengths of the other one.
const ORDER: [usize; 19] = [
    16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15,
];

/// Compresses a strip into blocks that end with a whole byte.
pub(super) fn compressed(bytes: &[u8], is_last: bool) -> Vec<u8> {
    let mut count = Count([0; N_SYMBOLS]);
    walk(bytes, &mut count);
    // A code has two symbols at least.
    (count.0[0], count.0[END]) = (count.0[0].max(1), 1);
    let lengths = huffman::lengths(&count.0, MOST_BITS);
    let codes = huffman::codes(&lengths);
    let n_bits = count.0.iter().zip(&lengths).enumerate();
    let n_bits = n_bits.map(|(symbol, (&n, &length))| {
        u64::from(n) * u64::from(u32::from(length) + n_extra_bits(symbol))
    });
    let n_bytes = n_bits.sum::<u64>() / 8;
    let mut out = BitWriter::with_capacity(n_bytes as usize + MOST_OTHER_BYTES);
    // The last block has a bit; 2 is a block with a code of its own.
    out.write(u32::from(is_last) | 2 << 1, 3);
    write_lengths(&lengths, &mut out);
    walk(
        bytes,
        &mut Emit {
            codes: &codes,
            out: &mut out,
        },
    );
    out.write(codes[END].bits, codes[END].n);
    if !is_last {
        // An empty block without compression begins at a whole byte.
        out.write(0, 3);
        out.pad_byte();
        out.write(0xffff_0000, 32);
    }
    out.finish()
}

/// Takes a strip in its order.
trait Visitor {
    fn literals(&mut self, bytes: &[u8; WORD]);
    fn literal(&mut self, byte: u8);
    /// Repeats the byte before, a zero, so many times; one of [`RUNS`].
    fn run(&mut self, n: usize);
}

fn walk(bytes: &[u8], visitor: &mut impl Visitor) {
    let (mut words, rest) = bytes.as_chunks::<WORD>();
    while let Some((word, others)) = words.split_first() {
        if *word != [0; WORD] {
            visitor.literals(word);
            words = others;
            continue;
        }
        let n_words = words.iter().take_while(|word| **word == [0; WORD]).count();
        words = &words[n_words..];
        // What is repeated is a literal first.
        visitor.literal(0);
        let mut n_more = n_words * WORD - 1;
        while n_more >= RUNS[0] {
            let n = n_more.min(RUNS[1]);
            visitor.run(n);
            n_more -= n;
        }
        (0..n_more).for_each(|_| visitor.literal(0));
    }
    rest.iter().for_each(|byte| visitor.literal(*byte));
}

/// How often each symbol occurs.
struct Count([u32; N_SYMBOLS]);

impl Visitor for Count {
    #[inline(always)]
    fn literals(&mut self, bytes: &[u8; WORD]) {
        for byte in bytes {
            self.0[usize::from(*byte)] += 1;
        }
    }

    fn literal(&mut self, byte: u8) {
        self.0[usize::from(byte)] += 1;
    }

    fn run(&mut self, n: usize) {
        self.0[symbol_of_run(n).0] += 1;
    }
}

/// Writes the codes of the symbols.
struct Emit<'a> {
    codes: &'a [Code],
    out: &'a mut BitWriter,
}

impl Visitor for Emit<'_> {
    #[inline(always)]
    fn literals(&mut self, bytes: &[u8; WORD]) {
        let (fours, _) = bytes.as_chunks::<4>();
        for four in fours {
            let (mut bits, mut n) = (0, 0);
            for byte in four {
                let code = self.codes[usize::from(*byte)];
                bits |= u64::from(code.bits) << n;
                n += code.n;
            }
            self.out.write_up_to_48(bits, n);
        }
    }

    fn literal(&mut self, byte: u8) {
        let Code { bits, n } = self.codes[usize::from(byte)];
        self.out.write(bits, n);
    }

    fn run(&mut self, n: usize) {
        let (symbol, extra) = symbol_of_run(n);
        let code = self.codes[symbol];
        // The distance of a run is 1, whose code is the bit 0.
        self.out
            .write(code.bits | extra.bits << code.n, code.n + extra.n + 1);
    }
}

/// The symbol of a run of one of the [`RUNS`], and its extra bits.
fn symbol_of_run(n: usize) -> (usize, Code) {
    let beyond = (n - RUNS[0]) as u32;
    match beyond {
        0..8 => (257 + beyond as usize, Code::default()),
        255 => (N_SYMBOLS - 1, Code::default()),
        _ => {
            // Four symbols for each number of extra bits.
            let n = beyond.ilog2() - 2;
            let symbol = 257 + 4 * n as usize + (beyond >> n) as usize;
            let bits = beyond & ((1 << n) - 1);
            (symbol, Code { bits, n })
        }
    }
}

/// The bits behind the code of a symbol: the rest of a length, and the distance.
fn n_extra_bits(symbol: usize) -> u32 {
    match symbol {
        0..=END => 0,
        265..285 => (symbol as u32 - 261) / 4 + 1,
        _ => 1,
    }
}

/// Writes the lengths of the codes of symbols and of one distance.
fn write_lengths(lengths: &[u8], out: &mut BitWriter) {
    let n_symbols = lengths
        .iter()
        .rposition(|&length| length > 0)
        .map_or(0, |last| last + 1);
    let lengths: Vec<u8> = lengths[..n_symbols].iter().copied().chain([1]).collect();
    // Each length, or a run of zeros with its extra bits.
    let mut steps = Vec::new();
    for run in lengths.chunk_by(|a, b| *a == 0 && *b == 0) {
        let mut n = run.len() as u32;
        while run[0] == 0 && n >= 3 {
            let (step, most, extra) = if n >= 11 {
                (18, 138, (11, 7))
            } else {
                (17, 10, (3, 3))
            };
            let (n_shortest, n_bits) = extra;
            let n_zeros = n.min(most);
            steps.push((
                step,
                Code {
                    bits: n_zeros - n_shortest,
                    n: n_bits,
                },
            ));
            n -= n_zeros;
        }
        steps.extend((0..n).map(|_| (usize::from(run[0]), Code::default())));
    }
    let mut frequencies = [0; ORDER.len()];
    // A code has two symbols at least.
    (frequencies[0], frequencies[1]) = (1, 1);
    for (step, _) in &steps {
        frequencies[*step] += 1;
    }
    let of_steps = huffman::lengths(&frequencies, 7);
    let codes = huffman::codes(&of_steps);
    let n_steps = ORDER
        .iter()
        .rposition(|&step| of_steps[step] > 0)
        .map_or(4, |last| last + 1);
    let n_steps = n_steps.max(4);
    out.write(n_symbols as u32 - 257, 5);
    out.write(0, 5);
    out.write(n_steps as u32 - 4, 4);
    for &step in &ORDER[..n_steps] {
        out.write(of_steps[step].into(), 3);
    }
    for (step, extra) in steps {
        out.write(codes[step].bits, codes[step].n);
        out.write(extra.bits, extra.n);
    }
}

#[cfg(test)]
mod tests {
    use miniz_oxide::inflate::decompress_to_vec;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn runs_of_every_length_are_restored() {
        for n in (0..600).chain([RUNS[1] * 3 + 1, 100_000]) {
            let bytes = [vec![7; n % 3], vec![0; n], vec![1; n % 2]].concat();
            assert_eq!(
                decompress_to_vec(&compressed(&bytes, true)).unwrap(),
                bytes,
                "{n}"
            );
        }
    }

    proptest! {
        #[test]
        fn strips_are_restored_in_their_order(
            strips in prop::collection::vec(
                prop::collection::vec(prop_oneof![2 => Just(0_u8), 1 => any::<u8>()], 0..300),
                1..4,
            ),
        ) {
            let last = strips.len() - 1;
            let parts = strips.iter().enumerate();
            let parts: Vec<_> = parts.map(|(i, strip)| compressed(strip, i == last)).collect();
            prop_assert_eq!(decompress_to_vec(&parts.concat()).unwrap(), strips.concat());
        }
    }
}
