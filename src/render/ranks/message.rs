//! Messages between ranks.

use serde::{Deserialize, Serialize};

/// The kind of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageKind {
    /// A value that the other side waits for: introductions, the scene, orders, headers.
    Value,
    /// From rank 0: a request for the time on the worker's clock. From a worker: the time.
    Clock,
    /// From a worker: its threads are waiting for tiles.
    Ready,
    /// From rank 0: tiles to render.
    Tiles,
    /// From a worker: finished tiles.
    Records,
    /// From a worker: it cannot render.
    Failure,
    /// From rank 0: all tiles of the picture are dealt. From a worker: its work on the picture.
    End,
}

/// A message that has arrived.
#[derive(Debug)]
pub struct Message {
    /// The rank that has sent it.
    pub from: u32,
    /// Kind of the message.
    pub kind: MessageKind,
    /// Content of the message.
    pub bytes: Vec<u8>,
}

/// Reason why a rank cannot render.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RankFailure {
    /// The exit code of its process.
    pub exit_code: u8,
    /// The message to the user.
    pub message: String,
}

impl RankFailure {
    /// Returns the failure of a rank whose input does not fit rank 0's.
    pub(super) fn input(message: impl Into<String>) -> Self {
        Self {
            exit_code: 2,
            message: message.into(),
        }
    }

    /// Returns the failure of a rank that has sent a tile that was not dealt to it.
    pub(crate) fn foreign_tile() -> Self {
        Self {
            exit_code: 1,
            message: "it has sent a tile of another picture".to_owned(),
        }
    }
}

impl MessageKind {
    const ALL: [Self; 7] = [
        Self::Value,
        Self::Clock,
        Self::Ready,
        Self::Tiles,
        Self::Records,
        Self::Failure,
        Self::End,
    ];

    pub(super) fn tag(self) -> i32 {
        self as i32
    }

    pub(super) fn from_tag(tag: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.tag() == tag)
    }
}
