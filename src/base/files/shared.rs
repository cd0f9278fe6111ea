//! Files that one of several processes reads for all.
//!
//! All read the same scene, so they ask for the same paths in the same order. The leader's
//! answer to each question is one message: a head of two lengths, what it has found, as
//! JSON, and the contents of the file. A head of two zeros ends them.

use std::cell::{Cell, RefCell};
use std::io::{self, Read};
use std::marker::PhantomData;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::regular;
use crate::host::available_memory;
use crate::stop;

/// Bytes that are broadcast at a time: the counts of MPI have 32 bits.
const CHUNK: usize = 1 << 24;
/// Bytes of memory that are taken without a check, which opens several files in `/proc`.
const WORTH_A_CHECK: u64 = 1 << 20;

/// The way from the leader to all others.
pub trait Broadcast {
    /// Whether this process is the leader.
    fn is_leader(&self) -> bool;

    /// Gives all others the leader's bytes. All processes must pass the same length; the others
    /// may have to wait long for the leader.
    fn broadcast(&self, bytes: &mut [u8]);
}

/// How a thread shares the files that it opens.
struct Sharing {
    with: Box<dyn Broadcast>,
    /// Whether the leader has sent its last message.
    has_ended: Cell<bool>,
}

thread_local! {
    /// The files that this thread shares, if any.
    static SHARING: RefCell<Option<Sharing>> = const { RefCell::new(None) };
}

/// Shares the files that this thread opens with other processes until the result is dropped,
/// all of which open the same files in the same order.
#[must_use]
pub fn share(broadcast: Box<dyn Broadcast>) -> SharedFiles {
    SHARING.set(Some(Sharing {
        with: broadcast,
        has_ended: Cell::new(false),
    }));
    SharedFiles(PhantomData)
}

/// Files are shared as long as it lives. A leader that drops it without [`end`](Self::end)
/// has failed, and has to end the others. Another process that drops it, having failed or not,
/// takes part until the leader ends, so that the leader never waits for it.
#[derive(Debug)]
pub struct SharedFiles(PhantomData<*const ()>);

impl SharedFiles {
    /// Ends the sharing: all files have been opened.
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

/// Whether this thread shares its files.
pub(super) fn is_active() -> bool {
    SHARING.with_borrow(Option::is_some)
}

/// The bytes of a shared file.
///
/// # Errors
/// The errors of the leader, or they do not fit into memory.
pub(super) fn contents(path: &Path) -> io::Result<Vec<u8>> {
    answer(path, |path| Ok(((), read_whole(path)?))).map(|((), contents)| contents)
}

/// What is found at a path: by the leader, if files are shared.
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

/// The leader's answer to a question about a path.
#[derive(Debug, Serialize, Deserialize)]
struct Finding<T> {
    path: String,
    found: Result<T, String>,
}

/// Finds something and the contents of a file at the leader, for all.
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

/// The lengths of a finding and of the contents of a file.
fn receive_head(leader: &dyn Broadcast) -> [u64; 2] {
    let mut head = [[0; 8]; 2];
    leader.broadcast(head.as_flattened_mut());
    head.map(u64::from_le_bytes)
}

impl Sharing {
    /// The next finding and the contents of its file.
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

/// Takes part in the next message without keeping it; returns whether there was one.
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

/// All bytes of a regular file.
fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    let file = regular::open(path)?;
    let length = file.metadata()?.len();
    check_room(length)?;
    let mut bytes = Vec::with_capacity(length as usize);
    // In parts, for a signal.
    loop {
        stop::check().map_err(io::Error::other)?;
        if (&file).take(CHUNK as u64).read_to_end(&mut bytes)? == 0 {
            return Ok(bytes);
        }
    }
}

/// Checks that a file fits into memory.
fn check_room(n_bytes: u64) -> io::Result<()> {
    if n_bytes > WORTH_A_CHECK && n_bytes > available_memory() {
        return Err(io::Error::other("it is longer than the free memory"));
    }
    Ok(())
}
