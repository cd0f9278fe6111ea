//! Blocks of a file: a kind, a length, a checksum, and the content.

use std::io::{self, Read};

use host::provenance::Hasher;

/// The kind of content of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BlockKind {
    /// The header as JSON; the first block.
    Header = 1,
    /// A tile.
    Tile = 2,
    /// The threads of a run, and the time it has taken so far.
    Run = 3,
    /// Nothing: the last block of a file that is complete.
    End = 4,
}

/// Bytes before the content of a block: kind, length and checksum.
pub(super) const PREFIX: usize = 4 + 4 + 16;

impl BlockKind {
    fn from_number(number: u32) -> Option<Self> {
        let kinds = [Self::Header, Self::Tile, Self::Run, Self::End];
        kinds.into_iter().find(|&kind| kind as u32 == number)
    }
}

/// Appends a block whose content `append` writes. Blocks are numbered from 0 in their file: the
/// checksum includes the number, so none can be left out.
pub(super) fn append(
    bytes: &mut Vec<u8>,
    kind: BlockKind,
    number: u64,
    append: impl FnOnce(&mut Vec<u8>),
) {
    let begin = bytes.len();
    bytes.resize(begin + PREFIX, 0);
    append(bytes);
    let (prefix, content) = bytes[begin..].split_at_mut(PREFIX);
    let length = content.len() as u32;
    prefix[..4].copy_from_slice(&(kind as u32).to_le_bytes());
    prefix[4..8].copy_from_slice(&length.to_le_bytes());
    let checksum = hash_block(&prefix[..8], number, content);
    prefix[8..].copy_from_slice(&checksum);
}

/// Reads the next block of a file, which has this number, into `content`; at most `max_bytes` of
/// it. Returns its kind, or `None` if there is no whole block.
///
/// # Errors
/// An error of the system.
pub(super) fn read(
    file: &mut impl Read,
    number: u64,
    max_bytes: usize,
    content: &mut Vec<u8>,
) -> io::Result<Option<BlockKind>> {
    let mut prefix = [0; PREFIX];
    if !fill(file, &mut prefix)? {
        return Ok(None);
    }
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| prefix[at + i]));
    let (kind, length) = (BlockKind::from_number(word(0)), word(4) as usize);
    let Some(kind) = kind.filter(|_| length <= max_bytes) else {
        return Ok(None);
    };
    content.resize(length, 0);
    if !fill(file, content)? {
        return Ok(None);
    }
    let is_whole = hash_block(&prefix[..8], number, content) == prefix[8..];
    Ok(is_whole.then_some(kind))
}

/// Fills a buffer. Returns false if there are too few bytes.
fn fill(file: &mut impl Read, buffer: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(buffer) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}

fn hash_block(kind_and_length: &[u8], number: u64, content: &[u8]) -> [u8; 16] {
    let mut hasher = Hasher::default();
    hasher.add(kind_and_length);
    hasher.add(&number.to_le_bytes());
    hasher.add(content);
    hasher.checksum().bits().to_le_bytes()
}
