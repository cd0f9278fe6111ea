//! Stand-ins for other C libraries, whose heap stays as it is.

/// Does nothing.
pub fn configure_heap() {}

/// Does nothing.
pub fn grow_heap(_n_bytes: usize) {}

/// Does nothing.
pub fn ask_for_huge_pages(_begin: usize, _n_bytes: usize) {}
