//! `raycost merge`.

pub(super) use super::render::{MergeArguments, run_merge as run};
