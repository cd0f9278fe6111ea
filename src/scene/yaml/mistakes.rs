//! Finds all mistakes of a text once the first one is known.
//!
//! A deserializer stops at the first value that it rejects. That value is removed from the tree,
//! and the rest is read again. An error that is only due to a removed value is not reported.

use super::deserialize::{Refusal, Refuse};
use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::misplaced;
use super::translate;
use super::tree::Tree;
use host::text::{Diagnostic, did_you_mean};

/// Maximum number of mistakes reported at a time.
const MOST: usize = 10;
/// Maximum number of removed values.
const MOST_REMOVED: usize = 100;
/// Maximum length of a text that is read more than once, in bytes.
const MAX_BYTES: usize = 1 << 20;

/// Functions that find the mistakes of a text and turn them into messages.
pub(super) struct Explain<'a> {
    /// Reads the text again without the values that were rejected.
    pub(super) refuse: Refuse<'a>,
    /// True if a value is in the text itself, not copied from an anchor.
    pub(super) is_written: &'a dyn Fn(&FieldPath) -> bool,
    /// The message for a value that the deserializer rejected.
    pub(super) refused: &'a dyn Fn(FieldPath, &serde_yaml::Error) -> Diagnostic,
    /// The message for any other fault.
    pub(super) fault: &'a dyn Fn(Fault) -> Diagnostic,
}

/// Returns the messages for all mistakes of a text, given the first; `tree` parses the text.
pub(super) fn find(
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
    if left.is_of_another_kind(&first.0, &first.1) {
        return (explain.refused)(first.0, &first.1);
    }
    // Report one mistake after the other, each found without the values before it.
    let mut found = Vec::new();
    let mut refusal = Some(first);
    while let Some((mut path, error)) = refusal.filter(|_| left.removed.len() < MOST_REMOVED) {
        let original = left.original(&path);
        let is_shown = found.is_empty() || (explain.is_written)(&original);
        if is_shown && !left.is_consequence(&original, &error) {
            if found.len() == MOST {
                found.push(Diagnostic::new("there are more mistakes, in what follows"));
                break;
            }
            found.push(
                match misplaced::keys(&left.tree, &path, &error, explain.refuse) {
                    Some(keys) => {
                        // Its sibling keys are misplaced, too.
                        path.0.pop();
                        (explain.fault)(keys.fault(original))
                    }
                    None => (explain.refused)(original, &error),
                },
            );
        }
        if !left.remove(&path) {
            break;
        }
        refusal = (explain.refuse)(&left.tree.text());
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
    /// The removed values, by their paths in the whole tree.
    removed: Vec<FieldPath>,
}

impl Remains {
    /// Returns the path in the whole tree of a remaining value.
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

    /// Returns the index in the whole list of a remaining item.
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

    /// Returns true if none of the text's keys is known: it is not a scene with mistakes.
    fn is_of_another_kind(&self, path: &FieldPath, error: &serde_yaml::Error) -> bool {
        let known = translate::unknown_key_of(error).filter(|_| path.0.len() == 1);
        match (known, &self.tree) {
            (Some((_, known)), Tree::Map(keys)) => !keys.keys().any(|key| known.contains(key)),
            _ => false,
        }
    }

    /// Returns true if an error at this path of the whole tree is due to a value that was removed
    /// from there: for a section that is missing, this section, or one of a similar name.
    fn is_consequence(&self, path: &FieldPath, error: &serde_yaml::Error) -> bool {
        let mut removed = self.removed.iter();
        match translate::missing_key_of(error).filter(|_| path.0.is_empty()) {
            Some(missing) => removed.any(|removed| match removed.0.first() {
                Some(Step::Key(key)) => *key == missing || did_you_mean(key, [&*missing]).is_some(),
                _ => true,
            }),
            None => removed.any(|removed| removed.0.starts_with(&path.0)),
        }
    }

    /// Removes the value at a path of the rest, or an enclosing one that is equally wrong: a list
    /// of numbers or lists, or the mapping of an empty value. Returns true if there was one.
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
