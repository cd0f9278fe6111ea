//! A scene in one or more texts.

use std::path::Path;

use indexmap::IndexMap;
use serde::de::DeserializeOwned;

use super::deserialize::{Refuse, YamlFile, deserialize};
use super::fault::{Fault, Spot};
use super::field_path::{FieldPath, Step};
use super::include;
use super::mistakes::{self, Explain};
use super::origins::{Merging, Origins, ValuePlace};
use super::setting::SettingText;
use super::source::Source;
use super::translate;
use super::tree::Tree;
use host::text::{Diagnostic, did_you_mean};

/// A scene file, the files that it includes, and the settings of a command line: one tree of
/// values; messages show each value in its own text.
#[derive(Debug, Clone)]
pub struct Document {
    /// The scene file, the included files, and the settings.
    sources: Vec<Source>,
    merging: Merging,
    /// The values of all texts; `None` if there is only the scene file.
    composition: Option<Composition>,
}

/// The folders to which paths of files in a scene are relative.
pub trait Folders {
    /// Returns the folder for the value at `path`.
    fn folder_of(&self, path: &FieldPath) -> &Path;
}

/// The same folder for all values.
impl Folders for Path {
    fn folder_of(&self, _: &FieldPath) -> &Path {
        self
    }
}

/// The folder of the text that contains the value.
impl Folders for Document {
    fn folder_of(&self, path: &FieldPath) -> &Path {
        let source = match &self.composition {
            Some(composition) => composition.origins.place(path).source,
            None => 0,
        };
        self.sources[source].folder()
    }
}

/// The values of several texts.
#[derive(Debug, Clone)]
struct Composition {
    tree: Tree,
    origins: Origins,
    /// Settings of values that the scene did not have: the index of the source, and the number of
    /// steps up to and including the first new key.
    additions: Vec<(usize, usize)>,
}

impl Document {
    /// Creates a scene, with the files that it includes.
    ///
    /// # Errors
    /// A file cannot be included, or has a syntax error.
    pub fn new(source: Source, merging: Merging) -> Result<Self, Diagnostic> {
        let mut document = Self {
            sources: vec![source],
            merging,
            composition: None,
        };
        let source = &document.sources[0];
        if source.text().contains(include::KEY) {
            source.check()?;
            if Tree::parse(source.text()).get(include::KEY).is_some() {
                let (tree, origins) = include::compose(&mut document.sources, merging)?;
                document.composition = Some(Composition::new(tree, origins));
            }
        }
        Ok(document)
    }

    /// Sets a value, as in `camera.look_at.fov_y_deg=30`.
    ///
    /// # Errors
    /// The text is not a setting, or the scene has no such value.
    pub fn set(&mut self, setting: &str) -> Result<(), Diagnostic> {
        self.set_source(Source::setting(setting)?)
    }

    /// Sets the value at `path`, in YAML, as [`set`](Self::set) does, on behalf of the scene's key
    /// `by`: messages point at it.
    ///
    /// # Errors
    /// The path is not valid, or the scene has no such value.
    pub fn set_for(&mut self, path: &str, value: &str, by: FieldPath) -> Result<(), Diagnostic> {
        let source = Source::setting_by(path, value, by);
        self.set_source(source.map_err(|fault| self.point_at(fault))?)
    }

    /// Returns the value at a path; `None` if there is none of this type.
    pub fn value_at<T: DeserializeOwned>(&self, path: &FieldPath) -> Option<T> {
        let of_source;
        let tree = match &self.composition {
            Some(composition) => &composition.tree,
            None => {
                of_source = Tree::parse(self.sources[0].text());
                &of_source
            }
        };
        deserialize(&tree.find(&path.0)?.text()).ok()
    }

    /// Returns the scene without a section; messages still find its keys.
    ///
    /// # Errors
    /// The text has a mistake.
    pub fn without(mut self, key: &str) -> Result<Self, Diagnostic> {
        if let Tree::Map(sections) = &mut self.composition()?.tree {
            sections.shift_remove(key);
        }
        Ok(self)
    }

    /// Returns the values of all texts.
    fn composition(&mut self) -> Result<&mut Composition, Diagnostic> {
        match &mut self.composition {
            Some(composition) => Ok(composition),
            none => {
                self.sources[0].check()?;
                let tree = Tree::parse(self.sources[0].text());
                Ok(none.insert(Composition::new(tree, Origins::default())))
            }
        }
    }

    fn set_source(&mut self, source: Source) -> Result<(), Diagnostic> {
        let (n_sources, merging) = (self.sources.len(), self.merging);
        let composition = self.composition()?;
        if let Some(text) = source.as_setting() {
            let value = text.tree(source.text());
            composition
                .set(text, value, n_sources, merging)
                .map_err(|fault| self.diagnose(&source, fault))?;
        }
        self.sources.push(source);
        Ok(())
    }

    /// Shows the line of a fault in a source, or the key on whose behalf it was set.
    fn diagnose(&self, source: &Source, fault: Fault) -> Diagnostic {
        match source.set_by() {
            Some(key) => self.point_at(Fault {
                spot: Spot::Key(key.clone()),
                ..fault
            }),
            None => source.point_at(fault),
        }
    }

    /// Returns the settings of the command line.
    pub fn settings(&self) -> impl Iterator<Item = &str> {
        let settings = self
            .sources
            .iter()
            .filter(|source| source.as_setting().is_some() && source.set_by().is_none());
        settings.map(Source::text)
    }

    /// Returns the names of the scene file and of the files that it includes.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        let sources = self.sources.iter();
        let files = sources.filter(|source| source.as_setting().is_none());
        files.map(Source::name)
    }

    /// Deserializes a `T`, as [`Source::parse`] does.
    ///
    /// # Errors
    /// As [`Source::parse`].
    pub fn parse<T: YamlFile>(&self) -> Result<T, Diagnostic> {
        let Some(composition) = &self.composition else {
            return self.sources[0].parse();
        };
        let text = composition.tree.text();
        T::from_yaml(&text).map_err(|first| {
            let refuse = |text: &str| T::from_yaml(text).err();
            if !translate::is_unknown_key(&first.1)
                && let Some(misnamed) = self.misnamed(composition, &first.0, &refuse)
            {
                return misnamed;
            }
            let refused = |path: FieldPath, error: &serde_yaml::Error| {
                let ValuePlace { source, path } = composition.origins.place(&path);
                let source = &self.sources[source];
                self.diagnose(source, translate::fault(&source.located(), path, error))
            };
            let explain = Explain {
                refuse: &refuse,
                is_written: &|path| {
                    let ValuePlace { source, path } = composition.origins.place(path);
                    self.sources[source].located().has(&path)
                },
                refused: &refused,
                fault: &|fault| self.point_at(fault),
            };
            mistakes::find(&text, || composition.tree.clone(), first, &explain)
        })
    }

    /// Returns the fault of a setting that adds a key without which the scene would be valid; the
    /// scene was rejected at `path`.
    fn misnamed(
        &self,
        composition: &Composition,
        path: &FieldPath,
        refuse: Refuse,
    ) -> Option<Diagnostic> {
        let mut additions = composition.additions.iter();
        additions.find_map(|&(source, n_steps)| {
            let source = &self.sources[source];
            let setting = source.as_setting()?;
            if setting.path.0.len() <= path.0.len() || !setting.path.0.starts_with(&path.0) {
                return None;
            }
            let mut tree = composition.tree.clone();
            let (last, above) = setting.path.0[..n_steps].split_last()?;
            let (Tree::Map(siblings), Step::Key(key)) = (tree.at(above)?, last) else {
                return None;
            };
            // A known key is parsed: another value of it is a mistake within it.
            siblings.insert(
                key.clone(),
                Tree::Map(IndexMap::from([(key.clone(), Tree::Map(IndexMap::new()))])),
            );
            let text = tree.text();
            let is_known =
                refuse(&text).is_some_and(|(at, _)| at.0.starts_with(&setting.path.0[..n_steps]));
            let Tree::Map(siblings) = tree.at(above)? else {
                return None;
            };
            siblings.shift_remove(key);
            let fault = no_such_key(setting, n_steps, siblings.keys());
            let is_fine = refuse(&tree.text()).is_none();
            (is_fine && !is_known).then(|| self.diagnose(source, fault))
        })
    }

    /// Converts the fault to a diagnostic that shows its line.
    pub fn point_at(&self, fault: Fault) -> Diagnostic {
        let place = |path: FieldPath| match &self.composition {
            Some(composition) => composition.origins.place(&path),
            None => ValuePlace { source: 0, path },
        };
        let (source, spot) = match fault.spot {
            Spot::Value(path) => {
                let ValuePlace { source, path } = place(path);
                (source, Spot::Value(path))
            }
            Spot::Key(path) => {
                let ValuePlace { source, path } = place(path);
                (source, Spot::Key(path))
            }
            bytes => (0, bytes),
        };
        self.diagnose(&self.sources[source], Fault { spot, ..fault })
    }

    /// Returns the name of the scene file in messages.
    pub fn name(&self) -> &str {
        self.sources[0].name()
    }
}

impl Composition {
    fn new(tree: Tree, origins: Origins) -> Self {
        Self {
            tree,
            origins,
            additions: Vec::new(),
        }
    }

    /// Sets the value of the setting in the source with this index.
    fn set(
        &mut self,
        setting: &SettingText,
        value: Tree,
        source: usize,
        merging: Merging,
    ) -> Result<(), Fault> {
        let path = &setting.path;
        if path.0[0] == Step::Key(include::KEY.to_owned()) {
            let message = "a setting cannot include files";
            let expected = "expected the key of another section";
            return Err(Fault::at_bytes(setting.steps(1), message, expected));
        }
        // Walk down the path, and create missing keys.
        let mut tree = &mut self.tree;
        let mut first_new = None;
        for (depth, step) in path.0.iter().enumerate() {
            if tree.is_empty() && matches!(step, Step::Key(_)) {
                *tree = Tree::Map(IndexMap::new());
            }
            if let (Tree::Map(map), Step::Key(key)) = (&mut *tree, step)
                && !map.contains_key(key)
            {
                let is_name = |maps: &[&str]| matches!(&path.0[0], Step::Key(key) if maps.contains(&key.as_str()));
                if depth == 1 && is_name(merging.maps) {
                    return Err(no_such_key(setting, depth + 1, map.keys()));
                }
                first_new.get_or_insert(depth + 1);
                map.insert(key.clone(), Tree::Map(IndexMap::new()));
            }
            let fault = no_such_value(setting, depth, tree);
            tree = tree.child(step).ok_or(fault)?;
        }
        // Replace the value, and record the setting as its origin.
        *tree = value;
        let path = path.clone();
        let place = ValuePlace {
            source,
            path: path.clone(),
        };
        self.origins.replace(&path, place);
        if let Some(n_steps) = first_new {
            self.additions.push((source, n_steps));
            for n in n_steps..path.0.len() {
                let path = FieldPath(path.0[..n].to_vec());
                let place = ValuePlace {
                    source,
                    path: path.clone(),
                };
                self.origins.insert(path, place);
            }
        }
        Ok(())
    }
}

/// Returns the fault of a setting whose key number `n_steps` does not exist.
fn no_such_key<'k>(
    setting: &SettingText,
    n_steps: usize,
    keys: impl Iterator<Item = &'k String>,
) -> Fault {
    let path = FieldPath(setting.path.0[..n_steps].to_vec());
    let message = format!("the scene has no `{path}`");
    let fault = Fault::at_bytes(setting.steps(n_steps), message, "no such key in the scene");
    let keys: Vec<&str> = keys.map(String::as_str).collect();
    let Some(Step::Key(key)) = path.0.last() else {
        return fault;
    };
    let list = match keys.as_slice() {
        [] => return fault,
        [one] => format!("the only key there is `{one}`"),
        many => format!("the keys there are `{}`", many.join("`, `")),
    };
    fault.with_help(match did_you_mean(key, keys) {
        Some(suggestion) => format!("{suggestion} ({list})"),
        None => list,
    })
}

/// Returns the fault of a setting whose step number `depth` does not fit the value above it.
fn no_such_value(setting: &SettingText, depth: usize, above: &Tree) -> Fault {
    let [above_path, path] = [depth, depth + 1].map(|n| FieldPath(setting.path.0[..n].to_vec()));
    let step = setting.steps(depth + 1);
    let fault =
        |message: String, expected: String| Fault::at_bytes(step.clone(), message, expected);
    match (above, &setting.path.0[depth]) {
        (Tree::List(list), Step::Index(_)) if list.is_empty() => {
            let message = format!("the scene has no `{path}`");
            fault(message, "the list is empty".to_owned())
        }
        (Tree::List(list), Step::Index(_)) => {
            let message = format!("the scene has no `{path}`");
            fault(message, format!("expected [0] to [{}]", list.len() - 1))
        }
        (Tree::List(_), Step::Key(_)) => {
            let message = format!("`{above_path}` is a list");
            fault(
                message,
                "expected the number of an item, such as [0]".to_owned(),
            )
        }
        (_, Step::Index(_)) => fault(
            format!("`{above_path}` is not a list"),
            "expected `.` and a key, or `=`".to_owned(),
        ),
        (Tree::Scalar { text, .. }, Step::Key(_)) => {
            let message = format!("`{above_path}` is `{text}`, which has no keys");
            fault(message, "no such key in the scene".to_owned())
                .with_help(format!("set it as a whole: `--set '{above_path}={{ … }}'`"))
        }
        // Missing keys are created before; to list all at each step would take long.
        (Tree::Map(_), Step::Key(_)) => {
            let message = format!("the scene has no `{path}`");
            fault(message, "no such key in the scene".to_owned())
        }
    }
}
