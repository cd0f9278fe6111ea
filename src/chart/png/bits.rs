//! Writes codes of bits.

/// Bits from the lowest to the highest of each byte.
pub(super) struct BitWriter {
    /// Zeros from `n_bytes` on.
    bytes: Vec<u8>,
    n_bytes: usize,
    pending: u64,
    /// Less than 8.
    n_pending: u32,
}

impl BitWriter {
    /// A writer of at most so many bytes.
    pub(super) fn with_capacity(n_bytes: usize) -> Self {
        Self {
            bytes: vec![0; n_bytes + size_of::<u64>()],
            n_bytes: 0,
            pending: 0,
            n_pending: 0,
        }
    }

    /// Writes the lowest `n` bits, at most 32; the others are 0.
    pub(super) fn write(&mut self, bits: u32, n: u32) {
        self.write_up_to_48(bits.into(), n);
    }

    /// Writes the lowest `n` bits, at most 48; the others are 0.
    #[inline(always)]
    pub(super) fn write_up_to_48(&mut self, bits: u64, n: u32) {
        self.pending |= bits << self.n_pending;
        self.n_pending += n;
        // Without a branch, which would be mispredicted: all whole bytes.
        let place = &mut self.bytes[self.n_bytes..][..size_of::<u64>()];
        place.copy_from_slice(&self.pending.to_le_bytes());
        let n_whole = self.n_pending / 8;
        self.n_bytes += n_whole as usize;
        self.pending >>= 8 * n_whole;
        self.n_pending %= 8;
    }

    /// Fills the last byte with zeros.
    pub(super) fn pad_byte(&mut self) {
        self.write(0, (8 - self.n_pending) % 8);
    }

    /// Returns all bytes, the last one filled with zeros.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.pad_byte();
        self.bytes.truncate(self.n_bytes);
        self.bytes
    }
}
