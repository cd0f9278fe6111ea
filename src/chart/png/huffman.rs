//! Huffman codes of limited length, in the form of deflate (RFC 1951, 3.2.2).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Bits of a symbol, in the order in which they are written, from the lowest on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Code {
    pub(super) bits: u32,
    pub(super) n: u32,
}

/// The number of bits of each symbol, at most `most`; 0 for symbols that do not
/// occur. At least two occur.
pub(super) fn lengths(frequencies: &[u32], most: u8) -> Vec<u8> {
    let mut frequencies = frequencies.to_vec();
    // A symbol this rare has about the longest code.
    let mut least = (frequencies.iter().sum::<u32>() >> most) + 1;
    loop {
        for frequency in frequencies.iter_mut().filter(|frequency| **frequency > 0) {
            *frequency = least.max(*frequency);
        }
        let lengths = unlimited(&frequencies);
        if lengths.iter().all(|&length| length <= most) {
            return lengths;
        }
        // In the end all are equal, and so are the lengths.
        least *= 2;
    }
}

/// Joins the two rarest trees until there is one (Huffman 1952).
fn unlimited(frequencies: &[u32]) -> Vec<u8> {
    let leaves = frequencies.iter().enumerate().filter(|(_, n)| **n > 0);
    let mut trees: BinaryHeap<_> = leaves.map(|(i, &n)| Reverse((u64::from(n), i))).collect();
    let mut parents = vec![0; frequencies.len()];
    while let (Some(Reverse((n, one))), Some(Reverse((m, other)))) = (trees.pop(), trees.pop()) {
        let joined = parents.len();
        parents.push(0);
        (parents[one], parents[other]) = (joined, joined);
        trees.push(Reverse((n + m, joined)));
    }
    // A parent comes after its children; the root is the last one.
    let mut depths = vec![0_u8; parents.len()];
    for i in (0..parents.len() - 1).rev() {
        if parents[i] > 0 {
            depths[i] = depths[parents[i]] + 1;
        }
    }
    depths.truncate(frequencies.len());
    depths
}

/// The codes of symbols with these lengths: of equal lengths in the order of the
/// symbols, shorter ones before longer ones.
pub(super) fn codes(lengths: &[u8]) -> Vec<Code> {
    let mut codes = vec![Code::default(); lengths.len()];
    let mut next = 0_u32;
    for n in 1..=15 {
        next <<= 1;
        for (code, _) in codes
            .iter_mut()
            .zip(lengths)
            .filter(|(_, length)| **length == n)
        {
            let n = u32::from(n);
            // Codes are written from their highest bit on.
            *code = Code {
                bits: next.reverse_bits() >> (32 - n),
                n,
            };
            next += 1;
        }
    }
    codes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rare_symbols_have_long_codes() {
        assert_eq!(lengths(&[8, 0, 1, 1, 2], 15), [1, 0, 3, 3, 2]);
        let code = |bits, n| Code { bits, n };
        let expected = [
            code(0, 1),
            code(0, 0),
            code(0b011, 3),
            code(0b111, 3),
            code(0b01, 2),
        ];
        assert_eq!(codes(&[1, 0, 3, 3, 2]), expected);
    }

    #[test]
    fn codes_of_limited_length_are_complete() {
        let steep: Vec<u32> = (0..30).map(|i| 1 << i).collect();
        for (frequencies, most) in [(&steep[..], 15), (&steep[..19], 7), (&[1; 286], 15)] {
            let lengths = lengths(frequencies, most);
            assert!(lengths.iter().all(|length| (1..=most).contains(length)));
            let share = |&length: &u8| 2_f64.powi(-i32::from(length));
            assert_eq!(lengths.iter().map(share).sum::<f64>(), 1.0);
        }
    }
}
