//! The doc comments of keys and keywords, which a test collects from the sources.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Names with their doc comments by the type that has them; one line each: type, name and comment,
/// with tabs between them. `tests/commands/doc_comments.rs` keeps them equal to the sources.
const COLLECTED: &str = include_str!("doc_comments.tsv");

/// The names of one type and their comments; a comment may be empty.
type Documented = BTreeMap<&'static str, &'static str>;

static TYPES: LazyLock<Vec<Documented>> = LazyLock::new(|| {
    let mut types: BTreeMap<&str, Documented> = BTreeMap::new();
    for line in COLLECTED.lines() {
        let mut parts = line.splitn(3, '\t');
        if let (Some(owner), Some(name), Some(doc)) = (parts.next(), parts.next(), parts.next()) {
            types.entry(owner).or_default().insert(name, doc);
        }
    }
    types.into_values().collect()
});

/// Returns the doc comment of one of a mapping's keys, or of one of several keywords: the comment
/// in the type that has most of the names and fewest others.
pub(super) fn find(names: &[String], name: &str) -> Option<String> {
    let share = |documented: &Documented| {
        let is_in = |name: &&String| documented.contains_key(name.as_str());
        let n_common = names.iter().filter(is_in).count();
        let n_all = names.len() + documented.len() - n_common;
        1000 * n_common / n_all.max(1)
    };
    let having = TYPES.iter().filter_map(|documented| {
        let doc = documented.get(name)?;
        Some(((share(documented), !doc.is_empty()), doc))
    });
    let (_, doc) = having.max_by_key(|(likeness, _)| *likeness)?;
    Some((*doc).to_owned()).filter(|doc| !doc.is_empty())
}
