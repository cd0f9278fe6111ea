//! The foundation of all crates, independent of rays.
//!
//! In: paths, bytes and requests of the operating system. Out: text for people, files that are read
//! whole or refused, and a folder of output whose files appear together or not at all.
//!
//! Read [`text`] first, whose [`Diagnostic`](text::Diagnostic) is the error of every crate; then
//! [`files`], [`provenance`] and [`folder`], which read and write. [`stop`] and [`host`] are the
//! signals and the machine.

pub mod keyword;
pub mod host;
pub mod stop;
pub mod text;
pub mod files;
pub mod provenance;
pub mod folder;

pub use keyword::Keyword;
#[doc(hidden)]
pub use serde;
