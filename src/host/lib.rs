//! The operating system: its files, memory, threads, signals and terminal.
//!
//! In: paths, bytes and requests of the system. Out: text for people, files that are read
//! whole or refused, and a folder of output whose files appear together or not at all.
//!
//! Read [`text`] first, whose [`Diagnostic`](text::Diagnostic) is the error of every crate below;
//! then [`files`], [`provenance`] and [`folder`], which read and write. [`signals`] set the requests
//! of [`base::stop`]; the other modules are the machine.

mod advice;
pub mod affinity;
mod allocator;
#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod heap;
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
mod no_gnu_heap;
mod cgroup;
mod memory;
mod threads;
pub mod signals;
pub mod text;
pub mod files;
pub mod provenance;
pub mod folder;

pub use advice::advice;
pub use allocator::{Allocator, may_fail};
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub use heap::{ask_for_huge_pages, configure_heap, grow_heap};
pub use memory::{available_memory, bytes_of_status, limit_memory, memory_limit, resident_memory};
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub use no_gnu_heap::{ask_for_huge_pages, configure_heap, grow_heap};
pub use threads::{default_threads, start_detached, start_in_scope, start_threads};
