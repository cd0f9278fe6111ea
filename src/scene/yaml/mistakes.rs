//! All mistakes of a text, once the first one is known.
//!
//! A deserializer stops at the first value that it refuses. That value is taken out of the
//! tree, and the rest is read again. What is refused then for lack of the removed value is
//! not a mistake of its own.

use serde::de::DeserializeOwned;

use super::deserialize::{Refusal, deserialize};
use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::misplaced;
use super::translate;
use super::tree::Tree;
use base::text::Diagnostic;

/// Most mistakes that are reported at a time.
const MOST: usize = 10;
/// Most values that are removed.
const MOST_REMOVED: usize = 100;
/// Longest text that is read more than once, in bytes.
const MAX_BYTES: usize = 1 << 20;

/// How the mistakes of a text are shown.
pub(super) struct Explain<'a> {
    /// Whether a value is in the text itself, and not in that of an anchor.
    pub(super) is_written: &'a dyn Fn(&FieldPath) -> bool,
    /// The message of a value that the deserializer refused.
    pub(super) refused: &'a dyn Fn(FieldPath, &serde_yaml::Error) -> Diagnostic,
    /// The message of another fault.
    pub(super) fault: &'a dyn Fn(Fault) -> Diagnostic,
}

/// The messages of all mistakes of a text that is no `T`, the first of which is known. `tree`
/// makes its tree.
pub(super) fn of<T: DeserializeOwned>(
    text: &str,
    tree: impl FnOnce() -> Tree,
    first: Refusal,
    explain: &Explain,
) -> Diagnostic {
    if text.len() > MAX_BYTES {
        return (explain.refused)(first.0, &first.1);
    }
    let mut left = Remains {
        tree: tree(),
        removed: Vec::new(),
    };
    if left.is_of_another_kind(&first) {
        return (explain.refused)(first.0, &first.1);
    }
    let mut found = Vec::new();
    let mut refusal = Some(first);
    while let Some((mut path, error)) = refusal.filter(|_| left.removed.len() < MOST_REMOVED) {
        let original = left.original(&path);
        let is_shown = found.is_empty() || (explain.is_written)(&original);
        if is_shown && !left.is_consequence(&original) {
            if found.len() == MOST {
                found.push(Diagnostic::new("there are more mistakes, in what follows"));
                break;
            }
            found.push(match misplaced::keys::<T>(&left.tree, &path, &error) {
                Some(keys) => {
                    // The keys beside it are misplaced, too.
                    path.0.pop();
                    (explain.fault)(keys.fault(original))
                }
                None => (explain.refused)(original, &error),
            });
        }
        if !left.remove(&path) {
            break;
        }
        refusal = deserialize::<T>(&left.tree.text()).err();
    }
    let mut found = found.into_iter();
    let first = found
        .next()
        .unwrap_or_else(|| Diagnostic::new("not a scene"));
    first.with_others(found.collect())
}

/// The rest of a tree.
struct Remains {
    tree: Tree,
    /// What was removed, by its path in the whole tree.
    removed: Vec<FieldPath>,
}

impl Remains {
    /// The path in the whole tree of a value that is left.
    fn original(&self, path: &FieldPath) -> FieldPath {
        let mut original = FieldPath::default();
        for step in &path.0 {
            let step = match step {
                Step::Index(index) => Step::Index(self.original_index(&original, *index)),
                key => key.clone(),
            };
            original.0.push(step);
        }
        original
    }

    /// The number in the whole list of an item that is left.
    fn original_index(&self, list: &FieldPath, mut index: usize) -> usize {
        let item_of = |removed: &FieldPath| match removed.0.split_last() {
            Some((Step::Index(item), above)) if above == list.0 => Some(*item),
            _ => None,
        };
        let mut gone: Vec<usize> = self.removed.iter().filter_map(item_of).collect();
        gone.sort_unstable();
        for item in gone {
            index += usize::from(item <= index);
        }
        index
    }

    /// Whether not a key of the text is known: it is no scene with mistakes.
    fn is_of_another_kind(&self, (path, error): &Refusal) -> bool {
        let known = translate::unknown_key_of(error).filter(|_| path.0.len() == 1);
        match (known, &self.tree) {
            (Some((_, known)), Tree::Map(keys)) => !keys.keys().any(|key| known.contains(key)),
            _ => false,
        }
    }

    /// Whether something was removed from the value at a path of the whole tree.
    fn is_consequence(&self, path: &FieldPath) -> bool {
        let mut removed = self.removed.iter();
        removed.any(|removed| removed.0.starts_with(&path.0))
    }

    /// Removes the value at a path of what is left, or one around it if that is as wrong: a
    /// list of numbers or lists, or the mapping of an empty value. Returns whether there was
    /// one.
    fn remove(&mut self, path: &FieldPath) -> bool {
        let mut path = path.clone();
        let is_whole = |value: &Tree| matches!(value, Tree::Map(_));
        while let Some(last) = path.0.last()
            && self.tree.at(&path.0).is_some_and(|value| match last {
                Step::Index(_) => !is_whole(value),
                Step::Key(_) => value.is_empty(),
            })
        {
            path.0.pop();
        }
        let path = &path;
        let original = self.original(path);
        let is_removed = self.tree.remove(&path.0);
        self.removed.push(original);
        is_removed
    }
}
