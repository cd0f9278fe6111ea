//! Sums that all threads add to.

use std::sync::atomic::{AtomicU64, Ordering};

/// Rows of `N` sums each.
pub(super) struct Tally<const N: usize> {
    rows: Vec<[AtomicU64; N]>,
}

impl<const N: usize> Tally<N> {
    /// Creates `n_rows` rows of zeros.
    pub(super) fn new(n_rows: usize) -> Self {
        let zeros = || [const { AtomicU64::new(0) }; N];
        Self {
            rows: std::iter::repeat_with(zeros).take(n_rows).collect(),
        }
    }

    /// Converts each row with `row`.
    pub(super) fn into_rows<T>(self, row: impl Fn([u64; N]) -> T) -> Vec<T> {
        let rows = self.rows.into_iter();
        rows.map(|sums| row(sums.map(AtomicU64::into_inner)))
            .collect()
    }

    fn add(&self, row: u32, amounts: [u64; N]) {
        for (sum, amount) in self.rows[row as usize].iter().zip(amounts) {
            sum.fetch_add(amount, Ordering::Relaxed);
        }
    }
}

/// Rows that a [`TallyCache`] caches.
const N_SLOTS: usize = 1 << 10;

/// A thread's write cache of a tally. It avoids contention on rows that all threads add to, such as
/// the root's row, since each ray visits the root.
pub(super) struct TallyCache<'a, const N: usize> {
    tally: &'a Tally<N>,
    slots: Vec<Slot<N>>,
}

#[derive(Clone, Copy)]
struct Slot<const N: usize> {
    row: u32,
    amounts: [u64; N],
}

impl<'a, const N: usize> TallyCache<'a, N> {
    pub(super) fn new(tally: &'a Tally<N>) -> Self {
        let empty = Slot {
            row: 0,
            amounts: [0; N],
        };
        Self {
            tally,
            slots: vec![empty; N_SLOTS],
        }
    }

    /// Adds to the sums of a row.
    pub(super) fn add(&mut self, row: u32, amounts: [u64; N]) {
        let slot = &mut self.slots[row as usize % N_SLOTS];
        if slot.row != row {
            slot.flush(self.tally);
            slot.row = row;
        }
        for (sum, amount) in slot.amounts.iter_mut().zip(amounts) {
            *sum += amount;
        }
    }
}

impl<const N: usize> Slot<N> {
    fn flush(&mut self, tally: &Tally<N>) {
        let amounts = std::mem::replace(&mut self.amounts, [0; N]);
        if amounts != [0; N] {
            tally.add(self.row, amounts);
        }
    }
}

/// Flushes all rows.
impl<const N: usize> Drop for TallyCache<'_, N> {
    fn drop(&mut self) {
        for slot in &mut self.slots {
            slot.flush(self.tally);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_all_threads_are_exact() {
        let n_rows = 3 * N_SLOTS as u32;
        let tally = Tally::<2>::new(n_rows as usize);
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let tally = &tally;
                scope.spawn(move || {
                    let mut counter = TallyCache::new(tally);
                    for i in 0..20 * n_rows {
                        // Some rows often, in an order that evicts others.
                        counter.add(i * 7 % n_rows, [1, u64::from(i % 5 + thread)]);
                        counter.add(i % 3, [1, 0]);
                    }
                });
            }
        });
        let mut expected = vec![[0_u64; 2]; n_rows as usize];
        for thread in 0..4 {
            for i in 0..20 * n_rows {
                expected[(i * 7 % n_rows) as usize][0] += 1;
                expected[(i * 7 % n_rows) as usize][1] += u64::from(i % 5 + thread);
                expected[(i % 3) as usize][0] += 1;
            }
        }
        assert!(tally.into_rows(|sums| sums) == expected);
    }
}
