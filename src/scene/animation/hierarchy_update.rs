//! Rebuild or refit the BVH for each frame.

use serde::Deserialize;

/// How the hierarchy of a frame is made if its objects differ from the frame before.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "`rebuild`, `refit` or `auto`")]
pub enum HierarchyUpdate {
    /// It is built, as for a still.
    Rebuild,
    /// The hierarchy of the first frame is refitted around the moved objects, if their number and
    /// kinds are unchanged.
    Refit,
    /// Chooses the method with the lower expected cost.
    #[default]
    Auto,
}
