//! Batches of finished tiles: messages from a worker to rank 0.

use std::sync::Mutex;
use std::sync::mpsc::Receiver;

use crate::checkpoint::TileRecord;
use base::locked;

/// Finished tiles of a worker.
pub(super) struct TileBatch {
    /// The rank that has rendered them.
    pub(super) rank: u32,
    /// The position of each in the order of tiles.
    pub(super) positions: Vec<u32>,
    /// The records, each after its length.
    pub(super) bytes: Vec<u8>,
}

/// Bytes of the length before a record.
const LENGTH_BYTES: usize = size_of::<u32>();

/// Appends a record to the bytes of a batch.
pub(super) fn append(bytes: &mut Vec<u8>, record: &TileRecord) {
    let begin = bytes.len();
    bytes.extend([0; LENGTH_BYTES]);
    record.append_to(bytes);
    let length = (bytes.len() - begin - LENGTH_BYTES) as u32;
    bytes[begin..begin + LENGTH_BYTES].copy_from_slice(&length.to_le_bytes());
}

/// Returns the bytes of each record of a batch; the last one is `None` if it is cut.
pub(super) fn split(mut bytes: &[u8]) -> impl Iterator<Item = Option<&[u8]>> {
    std::iter::from_fn(move || {
        if bytes.is_empty() {
            return None;
        }
        let record = bytes.split_first_chunk().and_then(|(length, rest)| {
            let (record, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
            bytes = rest;
            Some(record)
        });
        if record.is_none() {
            bytes = &[];
        }
        Some(record)
    })
}

/// The batches that rank 0 has received and no thread has stored.
pub(super) struct TileBatches(pub(super) Mutex<Receiver<TileBatch>>);

impl TileBatches {
    /// Returns the next batch, or `None` if there is none now, or another thread is taking it.
    pub(super) fn take(&self) -> Option<TileBatch> {
        self.0.try_lock().ok()?.try_recv().ok()
    }

    /// Waits for the next batch. Returns `None` if there will be no more.
    pub(super) fn wait(&self) -> Option<TileBatch> {
        let batches = locked(&self.0);
        batches.recv().ok()
    }
}
