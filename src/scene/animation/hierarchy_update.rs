//! Rebuild or refit the BVH for each frame.

use serde::Deserialize;

/// How the hierarchy of a frame comes about whose objects are others than those of the frame
/// before.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "`rebuild`, `refit` or `auto`")]
pub enum HierarchyUpdate {
    /// It is built, as that of a still.
    Rebuild,
    /// It is that of the first frame, with boxes around the moved objects, where these are as
    /// many and of the same kinds.
    Refit,
    /// Whichever of both is expected to cost less.
    #[default]
    Auto,
}
