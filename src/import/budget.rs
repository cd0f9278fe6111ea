//! The memory that reading a file may take.

use super::{FileFault, Result};
use base::numbers::memory_sizes;
use host::available_memory;

/// The memory left for a file and its pieces, in bytes.
#[derive(Debug)]
pub(super) struct Budget(u64);

impl Budget {
    /// Creates a budget of half the free memory: the other half is for the scene's copy of the
    /// mesh.
    pub(super) fn new() -> Self {
        Self(available_memory() / 2)
    }

    /// Takes memory, before it is allocated.
    ///
    /// # Errors
    /// Too little is left.
    pub(super) fn take(&mut self, n_bytes: u64) -> Result<()> {
        let left = self.0;
        self.0 = left.checked_sub(n_bytes).ok_or_else(|| {
            let [taken, left] = memory_sizes([n_bytes, left]);
            let problem =
                format!("its arrays take {taken} of memory or more, {left} are left for them");
            FileFault::new(problem, "a smaller file")
        })?;
        Ok(())
    }

    /// Takes the memory of `n` values of a type.
    ///
    /// # Errors
    /// Too little is left.
    pub(super) fn take_of<T>(&mut self, n: usize) -> Result<()> {
        self.take((n as u64).saturating_mul(size_of::<T>() as u64))
    }
}
