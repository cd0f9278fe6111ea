//! The texts that the values of a scene come from.

use std::collections::BTreeMap;

use super::field_path::{FieldPath, Step};

/// The sections that several files of a scene may have, and whose entries are merged.
#[derive(Debug, Clone, Copy)]
pub struct Merging {
    /// Mappings whose entries must have different names.
    pub maps: &'static [&'static str],
    /// Lists.
    pub lists: &'static [&'static str],
}

/// The place of a value in its own text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct ValuePlace {
    /// The index of the text among the scene's texts.
    pub(super) source: usize,
    /// The path of the value in that text.
    pub(super) path: FieldPath,
}

/// The places of the values of a scene, by their paths in the scene. A value that is not listed has
/// the place of its nearest listed ancestor. In the order of paths, descendants follow a value.
#[derive(Debug, Clone, Default)]
pub(super) struct Origins(BTreeMap<Vec<Step>, ValuePlace>);

impl Origins {
    /// Sets the place of the value at `path` and of all its descendants.
    pub(super) fn replace(&mut self, path: &FieldPath, place: ValuePlace) {
        let from = self.0.range(path.0.clone()..);
        let below = from.map(|(known, _)| known);
        let below = below.take_while(|known| known.starts_with(&path.0));
        for known in below.cloned().collect::<Vec<_>>() {
            self.0.remove(&known);
        }
        self.insert(path.clone(), place);
    }

    /// Sets the place of the value at `path` and of its descendants without one.
    pub(super) fn insert(&mut self, path: FieldPath, place: ValuePlace) {
        self.0.insert(path.0, place);
    }

    /// Returns the place of the value at `path`; the first text's root if none is known.
    pub(super) fn place(&self, path: &FieldPath) -> ValuePlace {
        let (above, place) = (0..=path.0.len())
            .rev()
            .find_map(|n| Some((n, self.0.get(&path.0[..n])?)))
            .map_or((0, ValuePlace::default()), |(n, place)| (n, place.clone()));
        let below = path.0[above..].iter().cloned();
        let ValuePlace { source, mut path } = place;
        path.0.extend(below);
        ValuePlace { source, path }
    }
}
