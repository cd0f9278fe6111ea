//! The files of all parts of a picture.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::store::n_threads_of;
use super::{CheckpointFile, Damage, Header, PicturePart};
use base::numbers::{count, counted};

/// Name of the folder of parts' files in the output folder.
pub const PARTS: &str = "parts";
/// The extension of a complete file.
const EXTENSION: &str = "tiles";

/// Greatest number of threads of all parts.
const MAX_ALL_THREADS: u64 = 1 << 22;

/// The files of parts in a folder.
#[derive(Debug)]
pub struct PartFiles {
    files: Vec<(String, Result<CheckpointFile, Damage>)>,
}

/// Problems with the parts of a picture.
#[derive(Debug, Default)]
pub struct PartFaults {
    /// One line per problem.
    pub lines: Vec<String>,
    /// The parts to be rendered again.
    pub again: BTreeSet<PicturePart>,
}

impl PartFiles {
    /// Opens and checks the files of parts of an output folder; none if the folder does not exist.
    ///
    /// # Errors
    /// If the folder cannot be read.
    pub fn open(folder: &Path) -> io::Result<Self> {
        let mut paths = Vec::new();
        match fs::read_dir(folder.join(PARTS)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
            Ok(entries) => {
                for entry in entries {
                    paths.push(entry?.path());
                }
            }
        }
        paths.retain(|path| path.extension().is_some_and(|found| found == EXTENSION));
        paths.sort();
        let open = |path: PathBuf| (name_of(&path), CheckpointFile::open(&path));
        Ok(Self {
            files: paths.into_iter().map(open).collect(),
        })
    }

    /// Returns true if there are no files.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Returns the header that most of the files share, except for their parts.
    pub fn header(&self) -> Option<&Header> {
        let headers: Vec<&Header> = self.whole().map(|file| &file.header).collect();
        let n_like = |header: &Header| {
            let like = headers
                .iter()
                .filter(|other| other.foreign_to(header).is_none());
            like.count()
        };
        // Ties go to the first.
        headers
            .iter()
            .rev()
            .max_by_key(|header| n_like(header))
            .copied()
    }

    /// Returns the files in the order of their parts, each of which exists once, with each tile of
    /// the picture in one of them.
    ///
    /// # Errors
    /// Lists missing and damaged files, and files that do not belong to the rendering that
    /// `expected` describes.
    pub fn checked(self, expected: &Header) -> Result<Vec<CheckpointFile>, PartFaults> {
        let n = self.n_parts(expected);
        let mut faults = PartFaults::default();
        let mut parts: BTreeMap<u32, CheckpointFile> = BTreeMap::new();
        for (name, opened) in self.files {
            let by_name = part_of_name(&name).filter(|part| part.of == n);
            match opened
                .map_err(|damage| damage.to_string())
                .and_then(|file| {
                    let part = part_of(&file, n, expected)?;
                    Ok((part, file))
                }) {
                Err(why) => faults.add(format!("{name}: {why}"), by_name),
                Ok((part, file)) => match parts.get(&part.number) {
                    Some(other) => {
                        let other = name_of(&other.path);
                        let why = format!("{name}: it is part {part}, as is {other}");
                        faults.add(why, None);
                    }
                    None => {
                        parts.insert(part.number, file);
                    }
                },
            }
        }
        for number in (1..=n).filter(|number| !parts.contains_key(number)) {
            let part = PicturePart { number, of: n };
            if faults.again.insert(part) {
                faults.lines.push(format!("part {part} is missing"));
            }
        }
        let n_threads = parts
            .values()
            .map(|file| u64::from(n_threads_of(file)))
            .sum();
        if n_threads > MAX_ALL_THREADS {
            let [found, most] = [n_threads, MAX_ALL_THREADS].map(count);
            let line = format!("they have {found} threads, expected at most {most}");
            faults.lines.push(line);
        }
        if faults.lines.is_empty() {
            faults.check_tiles(&parts, expected);
        }
        if faults.lines.is_empty() {
            Ok(parts.into_values().collect())
        } else {
            Err(faults)
        }
    }

    fn whole(&self) -> impl Iterator<Item = &CheckpointFile> {
        self.files.iter().filter_map(|(_, file)| file.as_ref().ok())
    }

    /// Returns the number of parts according to most files of the rendering; 0 if there are none.
    fn n_parts(&self, expected: &Header) -> u32 {
        let mut counts: HashMap<u32, usize> = HashMap::new();
        let own = self
            .whole()
            .filter(|file| file.header.foreign_to(expected).is_none());
        for part in own.filter_map(|file| file.header.part) {
            *counts.entry(part.of).or_default() += 1;
        }
        let most = counts.into_iter().max_by_key(|&(of, n)| (n, of));
        most.map_or(0, |(of, _)| of)
    }
}

impl PartFaults {
    fn add(&mut self, line: String, again: Option<PicturePart>) {
        self.lines.push(line);
        self.again.extend(again);
    }

    /// Checks that each tile of each rendering is in one part.
    fn check_tiles(&mut self, parts: &BTreeMap<u32, CheckpointFile>, expected: &Header) {
        let mut owners: HashMap<(u8, u32), u32> = HashMap::new();
        for (&number, file) in parts {
            for stored in &file.tiles {
                let key = (stored.rendering, stored.tile);
                if let Some(other) = owners.insert(key, number).filter(|other| *other != number) {
                    let [one, other] = [other, number].map(|n| name_of(&parts[&n].path));
                    let tile = stored.tile;
                    self.lines
                        .push(format!("{one} and {other} both have tile {tile}"));
                    return;
                }
            }
        }
        let mut tiles = expected.layout.tiles();
        if let Some((_, tile)) = tiles.find(|key| !owners.contains_key(key)) {
            self.lines.push(format!("no part has tile {tile}"));
        }
    }
}

/// Returns the part of a file of the rendering that `expected` describes, in `n` parts.
fn part_of(file: &CheckpointFile, n: u32, expected: &Header) -> Result<PicturePart, String> {
    if let Some(why) = file.header.foreign_to(expected) {
        return Err(why);
    }
    let Some(part) = file.header.part else {
        return Err("it is not a part of a picture".to_owned());
    };
    if part.of != n || part.number == 0 || part.number > n {
        return Err(format!("it is part {part}, and other parts are of {n}"));
    }
    if file.is_torn || !file.is_complete {
        let n_tiles = counted(file.n_tiles() as u64, "tile");
        return Err(format!("it is damaged or cut: {n_tiles} are whole"));
    }
    Ok(part)
}

/// Returns the part that a file's name says.
fn part_of_name(name: &str) -> Option<PicturePart> {
    let name = name.strip_suffix(EXTENSION)?.strip_suffix('.')?;
    let (number, of) = name.strip_prefix("part-")?.split_once("-of-")?;
    format!("{number}/{of}").parse().ok()
}

fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
