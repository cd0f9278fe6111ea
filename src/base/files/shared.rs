//! Shares files among processes: one of them reads each file for all.
//!
//! All processes read the same scene, so they ask for the same paths in the same order. The leader
//! answers each request with one message: a head of two lengths, what it found, as JSON, and the
//! contents of the file. A head of two zeros ends the sharing.

use std::cell::{Cell, RefCell};
use std::io::{self, Read};
use std::marker::PhantomData;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::regular;
use crate::host::available_memory;
use crate::stop;

/// Bytes per broadcast: MPI counts have 32 bits.
const CHUNK: usize = 1 << 24;
/// Bytes that are allocated without a check: reading the available memory opens several files in
/// `/proc`.
const WORTH_A_CHECK: u64 = 1 << 20;

/// A broadcast from the leader to all other processes.
pub trait Broadcast {
    /// Returns true if this process is the leader.
    fn is_leader(&self) -> bool;

    /// Sends the leader's bytes to all other processes. All processes must pass the same length;
    /// the others may have to wait long for the leader.
    fn broadcast(&self, bytes: &mut [u8]);
}

/// The sharing of the files that one thread opens.
struct Sharing {
    with: Box<dyn Broadcast>,
    /// True if the leader has sent its last message.
    has_ended: Cell<bool>,
}

thread_local! {
    /// The files that this thread shares, if any.
    static SHARING: RefCell<Option<Sharing>> = const { RefCell::new(None) };
}

/// Shares the files that this thread opens with other processes, which must open the same files in
/// the same order, until the returned guard is dropped.
#[must_use]
pub fn share(broadcast: Box<dyn Broadcast>) -> SharedFiles {
    SHARING.set(Some(Sharing {
        with: broadcast,
        has_ended: Cell::new(false),
    }));
    SharedFiles(PhantomData)
}

/// Guard of a sharing: files are shared while it lives. A leader that drops it without
/// [`end`](Self::end) has failed, and must end the other processes. Another process that drops it,
/// failed or not, takes part until the leader ends, so that the leader never waits for it.
#[derive(Debug)]
pub struct SharedFiles(PhantomData<*const ()>);

impl SharedFiles {
    /// Ends the sharing; all files have been opened.
    pub fn end(self) {
        SHARING.with_borrow(|sharing| {
            if let Some(sharing) = sharing.as_ref().filter(|one| one.with.is_leader()) {
                send(&*sharing.with, &mut [], &mut []);
            }
        });
    }
}

impl Drop for SharedFiles {
    fn drop(&mut self) {
        let sharing = SHARING.take().filter(|one| !one.with.is_leader());
        if let Some(Sharing { with, has_ended }) = sharing {
            while !has_ended.get() {
                has_ended.set(!skip(&*with));
            }
        }
    }
}

/// Returns true if this thread shares its files.
pub(super) fn is_active() -> bool {
    SHARING.with_borrow(Option::is_some)
}

/// Returns the bytes of a shared file.
///
/// # Errors
/// The leader failed to read the file, or it does not fit into memory.
pub(super) fn contents(path: &Path) -> io::Result<Vec<u8>> {
    answer(path, |path| Ok(((), read_whole(path)?))).map(|((), contents)| contents)
}

/// Runs `find` on the path, at the leader if files are shared.
///
/// # Errors
/// The errors of `find`.
pub(super) fn found<T: Serialize + DeserializeOwned>(
    path: &Path,
    find: fn(&Path) -> io::Result<T>,
) -> io::Result<T> {
    if !is_active() {
        return find(path);
    }
    answer(path, |path| Ok((find(path)?, Vec::new()))).map(|(found, _)| found)
}

/// The leader's answer to a request for a path.
#[derive(Debug, Serialize, Deserialize)]
struct Finding<T> {
    path: String,
    found: Result<T, String>,
}

/// Runs `find` and reads the file at the leader, for all processes.
fn answer<T: Serialize + DeserializeOwned>(
    path: &Path,
    find: impl FnOnce(&Path) -> io::Result<(T, Vec<u8>)>,
) -> io::Result<(T, Vec<u8>)> {
    SHARING.with_borrow(|sharing| match sharing {
        None => find(path),
        Some(Sharing { with, .. }) if with.is_leader() => {
            let (found, mut contents) = match find(path) {
                Ok((found, contents)) => (Ok(found), contents),
                Err(error) => (Err(error), Vec::new()),
            };
            let finding = Finding {
                path: path.to_string_lossy().into_owned(),
                found: found.as_ref().map_err(ToString::to_string),
            };
            let mut finding = serde_json::to_vec(&finding)?;
            send(&**with, &mut finding, &mut contents);
            Ok((found?, contents))
        }
        Some(sharing) => {
            let (finding, contents) = sharing.receive()?;
            let finding: Finding<T> = serde_json::from_slice(&finding)?;
            if finding.path != path.to_string_lossy() {
                let other = finding.path;
                return Err(io::Error::other(format!("the leader has opened `{other}`")));
            }
            Ok((finding.found.map_err(io::Error::other)?, contents?))
        }
    })
}

fn send(others: &dyn Broadcast, finding: &mut [u8], contents: &mut [u8]) {
    let lengths = [finding.len() as u64, contents.len() as u64];
    let mut head = lengths.map(u64::to_le_bytes);
    others.broadcast(head.as_flattened_mut());
    for bytes in [finding, contents] {
        bytes
            .chunks_mut(CHUNK)
            .for_each(|chunk| others.broadcast(chunk));
    }
}

/// Receives the lengths of a finding and of the contents of a file.
fn receive_head(leader: &dyn Broadcast) -> [u64; 2] {
    let mut head = [[0; 8]; 2];
    leader.broadcast(head.as_flattened_mut());
    head.map(u64::from_le_bytes)
}

impl Sharing {
    /// Receives the next finding and the contents of its file.
    ///
    /// # Errors
    /// The leader has ended. The contents are an error if they do not fit into memory.
    fn receive(&self) -> io::Result<(Vec<u8>, io::Result<Vec<u8>>)> {
        let ended = || io::Error::other("the leader has opened all its files");
        if self.has_ended.get() {
            return Err(ended());
        }
        let [n_finding, n_contents] = receive_head(&*self.with);
        if n_finding == 0 {
            self.has_ended.set(true);
            return Err(ended());
        }
        let finding = receive_bytes(&*self.with, n_finding);
        let contents = match check_room(n_contents) {
            Ok(()) => Ok(receive_bytes(&*self.with, n_contents)),
            Err(error) => {
                skip_bytes(&*self.with, n_contents);
                Err(error)
            }
        };
        Ok((finding, contents))
    }
}

fn receive_bytes(leader: &dyn Broadcast, n: u64) -> Vec<u8> {
    let mut bytes = vec![0; n as usize];
    bytes
        .chunks_mut(CHUNK)
        .for_each(|chunk| leader.broadcast(chunk));
    bytes
}

/// Takes part in the next message and discards it; returns false if it was the last one.
fn skip(leader: &dyn Broadcast) -> bool {
    let lengths = receive_head(leader);
    lengths.iter().for_each(|&n| skip_bytes(leader, n));
    lengths[0] > 0
}

fn skip_bytes(leader: &dyn Broadcast, n: u64) {
    let mut chunk = vec![0; CHUNK.min(n as usize)];
    let mut n_left = n as usize;
    while n_left > 0 {
        let n = n_left.min(CHUNK);
        leader.broadcast(&mut chunk[..n]);
        n_left -= n;
    }
}

/// Reads a whole regular file.
fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    let file = regular::open(path)?;
    let length = file.metadata()?.len();
    check_room(length)?;
    let mut bytes = Vec::with_capacity(length as usize);
    // Block by block, so that a signal can interrupt.
    loop {
        stop::check().map_err(io::Error::other)?;
        if (&file).take(CHUNK as u64).read_to_end(&mut bytes)? == 0 {
            return Ok(bytes);
        }
    }
}

/// Returns an error if a file does not fit into memory.
fn check_room(n_bytes: u64) -> io::Result<()> {
    if n_bytes > WORTH_A_CHECK && n_bytes > available_memory() {
        return Err(io::Error::other("it is longer than the free memory"));
    }
    Ok(())
}
