//! Keys one level too high or too low: `{ center: …, radius: … }` without its `sphere:`, or a
//! `material` within it.
//!
//! This module does not know the keys of scenes: it moves keys and reads the scene again.

use super::deserialize::Refuse;
use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::translate;
use super::tree::{Keys, Tree};

/// The place where unknown keys of a mapping belong.
#[derive(Debug)]
pub(super) enum MisplacedKeys {
    /// Under one of these keys, which is missing.
    Under {
        choices: Vec<String>,
        keys: Vec<String>,
        /// A key whose value names the choice, as in `type: sphere`.
        by_word: Option<String>,
    },
    /// Next to the mapping, which is the value of a key.
    Beside { key: String },
}

/// Finds the place where the unknown key at `path` and its siblings belong; `None` if nowhere else,
/// or for another error.
pub(super) fn keys(
    tree: &Tree,
    path: &FieldPath,
    error: &serde_yaml::Error,
    refuse: Refuse,
) -> Option<MisplacedKeys> {
    let (word, choices) = translate::unknown_key_of(error)?;
    let (last, above) = path.0.split_last()?;
    let mut tree = tree.clone();
    let Some(Tree::Map(map)) = tree.at(above) else {
        return None;
    };
    if *last != Step::Key(word) {
        return None;
    }
    let (own, strange): (Keys, Keys) = std::mem::take(map)
        .into_iter()
        .partition(|(key, _)| choices.contains(key));
    under(&mut tree, above, &own, &strange, &choices, refuse)
        .or_else(|| beside(&mut tree, above, own, strange, refuse))
}

/// Returns the missing keys under each of which the strange keys are accepted.
fn under(
    tree: &mut Tree,
    above: &[Step],
    own: &Keys,
    strange: &Keys,
    choices: &[String],
    refuse: Refuse,
) -> Option<MisplacedKeys> {
    let mut strange = strange.clone();
    let by_word = strange.iter().find_map(|(key, value)| match value {
        Tree::Scalar { text, .. } if choices.contains(text) => Some((key.clone(), text.clone())),
        _ => None,
    });
    if let Some((key, _)) = &by_word {
        strange.shift_remove(key);
    }
    let is_named = |choice: &String| by_word.as_ref().is_none_or(|(_, word)| word == choice);
    let choices = choices.iter().filter(|choice| is_named(choice));
    let accepts = |choice: &&String| {
        let mut moved = own.clone();
        moved.insert((*choice).clone(), Tree::Map(strange.clone()));
        is_accepted(tree, above, moved, refuse)
    };
    let choices: Vec<String> = choices
        .filter(|choice| !own.contains_key(*choice))
        .filter(accepts)
        .cloned()
        .collect();
    (!choices.is_empty()).then(|| MisplacedKeys::Under {
        choices,
        keys: strange.into_keys().collect(),
        by_word: by_word.map(|(key, _)| key),
    })
}

/// Returns true if the strange keys are accepted next to the mapping.
fn beside(
    tree: &mut Tree,
    above: &[Step],
    own: Keys,
    strange: Keys,
    refuse: Refuse,
) -> Option<MisplacedKeys> {
    let (Step::Key(key), outer) = above.split_last()? else {
        return None;
    };
    let Some(Tree::Map(map)) = tree.at(outer) else {
        return None;
    };
    let mut moved = std::mem::take(map);
    moved.insert(key.clone(), Tree::Map(own));
    for (key, value) in strange {
        if moved.insert(key, value).is_some() {
            return None;
        }
    }
    is_accepted(tree, outer, moved, refuse).then(|| MisplacedKeys::Beside { key: key.clone() })
}

/// Returns true if the mapping at `path` may have these keys: then the whole tree is accepted, or
/// rejected elsewhere.
fn is_accepted(tree: &mut Tree, path: &[Step], keys: Keys, refuse: Refuse) -> bool {
    let Some(place) = tree.at(path) else {
        return false;
    };
    *place = Tree::Map(keys);
    refuse(&tree.text()).is_none_or(|(refused, _)| !refused.0.starts_with(path))
}

impl MisplacedKeys {
    /// Returns the fault of the first key, which is at `path`.
    pub(super) fn fault(&self, path: FieldPath) -> Fault {
        let mut above = path.clone();
        let word = match above.0.pop() {
            Some(Step::Key(key)) => key,
            _ => String::new(),
        };
        match self {
            Self::Under {
                choices,
                keys,
                by_word,
            } => {
                let inside: Vec<String> = keys.iter().map(|key| format!("{key}: …")).collect();
                let inside = inside.join(", ");
                let written = |choice: &String| format!("`{choice}: {{ {inside} }}`");
                let written: Vec<String> = choices.iter().map(written).collect();
                let message = format!("{} lacks {}", translate::subject(&above), one_of(choices));
                let key = by_word
                    .as_ref()
                    .map_or(String::new(), |key| format!(" without `{key}`"));
                Fault::at_key(path, message, "belongs below that key")
                    .with_help(format!("write {}{key}", written.join(" or ")))
            }
            Self::Beside { key } => {
                let message = format!("`{word}` belongs beside `{key}`, not into it");
                Fault::at_key(path, message, "one level too deep").with_help(format!(
                    "indent `{word}` as far as `{key}`, or close the `}}` before it"
                ))
            }
        }
    }
}

/// Formats "`a:`", or "one of `a:` and `b:`".
fn one_of(choices: &[String]) -> String {
    let quoted: Vec<String> = choices
        .iter()
        .map(|choice| format!("`{choice}:`"))
        .collect();
    match quoted.as_slice() {
        [one] => format!("its {one}"),
        _ => format!("one of {}", quoted.join(", ")),
    }
}
