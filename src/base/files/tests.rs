use std::collections::VecDeque;
use std::fs;
use std::io;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::*;

/// A broadcast to a single receiver: the leader never waits for it.
enum Queue {
    Leader(Sender<Vec<u8>>),
    Other(Mutex<VecDeque<Vec<u8>>>),
}

impl Broadcast for Queue {
    fn is_leader(&self) -> bool {
        matches!(self, Self::Leader(_))
    }

    fn broadcast(&self, bytes: &mut [u8]) {
        match self {
            Self::Leader(other) => other.send(bytes.to_vec()).unwrap(),
            Self::Other(sent) => {
                let next = sent
                    .lock()
                    .unwrap()
                    .pop_front()
                    .expect("the leader is behind");
                bytes.copy_from_slice(&next);
            }
        }
    }
}

/// Runs `work` as the leader, removes its folder, and returns the messages that were sent.
fn sent_by(work: impl FnOnce(&Path)) -> (PathBuf, Queue) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a"), b"first").unwrap();
    // More than one chunk.
    fs::write(folder.path().join("b"), vec![7; (1 << 24) + 3]).unwrap();
    let (to, from): (_, Receiver<Vec<u8>>) = channel();
    let files = share(Box::new(Queue::Leader(to)));
    work(folder.path());
    files.end();
    (
        folder.path().to_owned(),
        Queue::Other(Mutex::new(from.into_iter().collect())),
    )
}

fn bytes_of(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    InputFile::open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[test]
fn others_need_no_file() {
    let read = |folder: &Path| {
        assert_eq!(bytes_of(&folder.join("a")).unwrap(), b"first");
        assert!(!is_file(folder) && is_file(&folder.join("a")));
        assert!(bytes_of(&folder.join("c")).is_err());
        assert!(bytes_of(folder).is_err());
        let path = folder.join("b");
        assert_eq!(length_of(&path).unwrap(), Some((1 << 24) + 3));
        assert!(canonical(&path).unwrap().ends_with("b"));
        assert_eq!(bytes_of(&path).unwrap(), vec![7; (1 << 24) + 3]);
        let file = InputFile::open(&path).unwrap();
        assert_eq!(file.length().unwrap(), (1 << 24) + 3);
    };
    let (folder, sent) = sent_by(read);
    assert!(!is_file(&folder.join("a")));
    let files = share(Box::new(sent));
    read(&folder);
    files.end();
    assert!(bytes_of(&folder.join("a")).is_err());
}

/// The queue would panic if it were empty too early.
#[test]
fn one_that_fails_takes_part_to_the_end() {
    let (folder, sent) = sent_by(|folder| {
        bytes_of(&folder.join("a")).unwrap();
        bytes_of(&folder.join("b")).unwrap();
        bytes_of(&folder.join("c")).unwrap_err();
    });
    let files = share(Box::new(sent));
    bytes_of(&folder.join("a")).unwrap();
    drop(files);
    assert!(!shared::is_active());
}

#[test]
fn another_file_than_that_of_the_leader_is_refused() {
    let (folder, sent) = sent_by(|folder| {
        bytes_of(&folder.join("a")).unwrap();
    });
    let files = share(Box::new(sent));
    let error = bytes_of(&folder.join("b")).unwrap_err().to_string();
    assert!(error.starts_with("the leader has opened `"), "{error}");
    files.end();
    let (folder, sent) = sent_by(|_| {});
    let files = share(Box::new(sent));
    let error = bytes_of(&folder.join("b")).unwrap_err().to_string();
    assert!(error.contains("all its files"), "{error}");
    files.end();
}
