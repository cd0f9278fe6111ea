//! The foundation of all crates: what needs neither rays nor the operating system.
//!
//! Read [`Keyword`] first, the words that select a choice in scenes and on the command line; then
//! [`numbers`], which are formatted for people and parsed, and [`stop`], the requests to end that
//! long work polls.

pub mod keyword;
mod lock;
pub mod numbers;
pub mod stop;

pub use keyword::Keyword;
pub use lock::locked;
#[cfg(feature = "schema")]
#[doc(hidden)]
pub use schemars;
#[doc(hidden)]
pub use serde;
