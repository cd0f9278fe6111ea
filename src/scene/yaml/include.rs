//! The section `include`: files whose sections become part of a scene.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use indexmap::IndexMap;
use indexmap::map::Entry;

use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::origins::{Merging, Origins, ValuePlace};
use super::source::{MAX_BYTES, Source};
use super::tree::Tree;
use host::text::Diagnostic;

/// The key of the section.
pub(super) const KEY: &str = "include";
/// Maximum number of files that a scene includes.
const MAX_FILES: usize = 256;

/// Reads the files that the first source includes, recursively; returns all sections as one tree.
/// Appends the files to `sources`. The first source must have been checked.
///
/// # Errors
/// A file cannot be read, has a syntax error, includes itself, or repeats a value of another file.
pub(super) fn compose(
    sources: &mut Vec<Source>,
    merging: Merging,
) -> Result<(Tree, Origins), Diagnostic> {
    let canonical = Path::new(sources[0].name()).canonicalize().ok();
    let mut files = Files {
        n_bytes: sources[0].text().len() as u64,
        sources,
        merging,
        open: canonical.iter().cloned().collect(),
        known: canonical.into_iter().collect(),
    };
    Ok(files.sections(0)?.assemble())
}

/// A value and its origin.
type PlacedTree = (Tree, ValuePlace);

/// A section of a scene.
enum Section {
    /// A section that is not merged.
    Whole(PlacedTree),
    /// A mapping among [`Merging::maps`].
    Map(ValuePlace, IndexMap<String, PlacedTree>),
    /// A list among [`Merging::lists`].
    List(ValuePlace, Vec<PlacedTree>),
}

/// Sections by their keys.
#[derive(Default)]
struct Sections(IndexMap<String, Section>);

/// The places of two values for the same key.
struct Conflict([ValuePlace; 2]);

/// The files of a scene.
struct Files<'s> {
    sources: &'s mut Vec<Source>,
    merging: Merging,
    n_bytes: u64,
    /// The files that are being read, each included by the one before.
    open: Vec<PathBuf>,
    /// All files so far.
    known: HashSet<PathBuf>,
}

impl Files<'_> {
    /// Returns the sections of a source and of the files that it includes.
    fn sections(&mut self, source: usize) -> Result<Sections, Diagnostic> {
        let tree = Tree::parse(self.sources[source].text());
        let own = Sections::parse(&tree, source, self.merging);
        let mut all = Sections::default();
        let own = own.map_err(|fault| self.sources[source].point_at(fault))?;
        for (path, name) in included(&tree).map_err(|fault| self.sources[source].point_at(fault))? {
            let point_at = |fault| self.sources[source].point_at(fault);
            let file = self.sources[source].folder().join(name);
            let canonical = self.canonical(&file, name, &path).map_err(point_at)?;
            if !self.known.insert(canonical.clone()) {
                continue;
            }
            let included = Source::read(&file)?;
            included.check()?;
            self.n_bytes += included.text().len() as u64;
            if self.n_bytes > MAX_BYTES {
                let message = "the scene and its files are longer than 64 MiB";
                return Err(point_at(Fault::new(path, message, "up to this file")));
            }
            self.sources.push(included);
            self.open.push(canonical);
            let sections = self.sections(self.sources.len() - 1)?;
            self.open.pop();
            all.add(sections)
                .map_err(|Conflict(places)| self.conflict(places))?;
        }
        all.replace(own, source > 0);
        Ok(all)
    }

    /// Returns the canonical path of a file that may be included at `path`.
    fn canonical(&self, file: &Path, name: &str, path: &FieldPath) -> Result<PathBuf, Fault> {
        let fault = |message: String, expected: &str| Fault::new(path.clone(), message, expected);
        let ending = file.extension().unwrap_or_default();
        if ending != "yaml" && ending != "yml" {
            let message = format!("`{name}` is not a YAML file");
            return Err(fault(message, "expected a file that ends in .yaml or .yml"));
        }
        let canonical = file.canonicalize();
        let reason = match &canonical {
            Ok(found) if found.is_file() => None,
            Ok(_) => Some("it is not a file".to_owned()),
            Err(error) => Some(error.to_string()),
        };
        let (Ok(canonical), None) = (canonical, &reason) else {
            let message = format!(
                "cannot read `{}`: {}",
                file.display(),
                reason.unwrap_or_default()
            );
            return Err(fault(message, "expected a file that can be read")
                .with_help("the path starts from the folder of the file that includes it"));
        };
        if self.open.contains(&canonical) {
            let message = format!("`{}` includes itself", file.display());
            return Err(fault(message, "the circle closes here"));
        }
        if self.known.len() > MAX_FILES {
            let message = format!("the scene includes more than {MAX_FILES} files");
            return Err(fault(message, "from here on"));
        }
        Ok(canonical)
    }

    fn conflict(&self, [first, second]: [ValuePlace; 2]) -> Diagnostic {
        let name = self.sources[first.source].name();
        let message = format!("`{}` is given twice", second.path);
        let fault = Fault::at_key(second.path, message, "the second one");
        let help = format!("`{name}` gives it, too: remove one of them");
        self.sources[second.source].point_at(fault.with_help(help))
    }
}

/// Returns the files that a tree includes, with their paths in the tree.
fn included(tree: &Tree) -> Result<Vec<(FieldPath, &str)>, Fault> {
    let path = FieldPath::default().key(KEY);
    let fault = |path| {
        let message = format!("`{path}` cannot be read");
        Fault::new(
            path,
            message,
            "expected a list of files, such as [materials.yaml]",
        )
    };
    let files = match tree.get(KEY) {
        None => return Ok(Vec::new()),
        Some(Tree::List(files)) => files,
        Some(_) => return Err(fault(path)),
    };
    let mut found = Vec::with_capacity(files.len());
    for (i, file) in files.iter().enumerate() {
        let path = path.clone().index(i);
        match file {
            Tree::Scalar { text, .. } if !text.is_empty() => found.push((path, text.as_str())),
            _ => return Err(fault(path)),
        }
    }
    Ok(found)
}

impl Sections {
    /// Returns the sections of a source.
    fn parse(tree: &Tree, source: usize, merging: Merging) -> Result<Self, Fault> {
        let Tree::Map(sections) = tree else {
            let message = "an included file must have sections";
            let expected = "expected sections such as `materials: { … }`";
            return Err(Fault::new(FieldPath::default(), message, expected));
        };
        let section = |(key, section): (&String, &Tree)| {
            let path = FieldPath::default().key(key);
            let place = ValuePlace { source, path };
            let below = |step: Step| {
                let mut place = place.clone();
                place.path.0.push(step);
                place
            };
            let section = match section.clone() {
                Tree::Map(map) if merging.maps.contains(&key.as_str()) => {
                    let placed = |(name, value): (String, Tree)| {
                        let place = below(Step::Key(name.clone()));
                        (name, (value, place))
                    };
                    Section::Map(place.clone(), map.into_iter().map(placed).collect())
                }
                Tree::List(list) if merging.lists.contains(&key.as_str()) => {
                    let items = list.into_iter().enumerate();
                    let placed = items.map(|(i, value)| (value, below(Step::Index(i))));
                    Section::List(place.clone(), placed.collect())
                }
                whole => Section::Whole((whole, place)),
            };
            (key.clone(), section)
        };
        Ok(Self(sections.iter().map(section).collect()))
    }

    /// Adds the sections of a file that is included next to others.
    fn add(&mut self, sections: Self) -> Result<(), Conflict> {
        for (key, section) in sections.0 {
            match (self.0.get_mut(&key), section) {
                (None, section) => {
                    self.0.insert(key, section);
                }
                (Some(Section::Map(_, known)), Section::Map(_, map)) => {
                    for (name, value) in map {
                        match known.entry(name) {
                            Entry::Vacant(entry) => {
                                entry.insert(value);
                            }
                            Entry::Occupied(entry) => {
                                return Err(Conflict([entry.get().1.clone(), value.1]));
                            }
                        }
                    }
                }
                (Some(Section::List(_, known)), Section::List(_, list)) => known.extend(list),
                (Some(known), section) => {
                    return Err(Conflict([known.place(), section.place()]));
                }
            }
        }
        Ok(())
    }

    /// Adds the sections of the file that includes these; they replace sections of the same key and
    /// entries of the same name.
    fn replace(&mut self, own: Self, is_included: bool) {
        for (key, section) in own.0 {
            match (self.0.get_mut(&key), section) {
                // The scene file's `include` is checked with its other sections.
                _ if key == KEY && is_included => {}
                (Some(Section::Map(place, known)), Section::Map(own, map)) => {
                    *place = own;
                    known.extend(map);
                }
                (Some(Section::List(place, known)), Section::List(own, list)) => {
                    *place = own;
                    known.extend(list);
                }
                (_, section) => {
                    self.0.insert(key, section);
                }
            }
        }
    }

    /// Returns all sections as one tree, with the places of their values.
    fn assemble(self) -> (Tree, Origins) {
        let mut origins = Origins::default();
        let mut tree = IndexMap::new();
        for (key, section) in self.0 {
            let path = FieldPath::default().key(&key);
            origins.insert(path.clone(), section.place());
            let value = match section {
                Section::Whole((value, _)) => value,
                Section::Map(_, map) => {
                    let value = |(name, (value, place)): (String, PlacedTree)| {
                        origins.insert(path.clone().key(&name), place);
                        (name, value)
                    };
                    Tree::Map(map.into_iter().map(value).collect())
                }
                Section::List(_, list) => {
                    let value = |(i, (value, place)): (usize, PlacedTree)| {
                        origins.insert(path.clone().index(i), place);
                        value
                    };
                    Tree::List(list.into_iter().enumerate().map(value).collect())
                }
            };
            tree.insert(key, value);
        }
        (Tree::Map(tree), origins)
    }
}

impl Section {
    fn place(&self) -> ValuePlace {
        match self {
            Self::Whole((_, place)) | Self::Map(place, _) | Self::List(place, _) => place.clone(),
        }
    }
}
