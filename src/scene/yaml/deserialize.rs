//! serde_yaml's deserializer, extended by the path of the rejected value.

use serde::de::DeserializeOwned;

use super::field_path::FieldPath;
use super::translate;

/// The path of a rejected value, and the reason.
pub type Refusal = (FieldPath, serde_yaml::Error);

/// A kind of YAML file. Its parser is large: an implementation compiles it once, in the crate of
/// the type, and not in every crate that reads such files.
pub trait YamlFile: Sized {
    /// Parses a text: calls [`deserialize`].
    ///
    /// # Errors
    /// The first value that is rejected.
    fn from_yaml(text: &str) -> Result<Self, Refusal>;
}

/// Returns why a text is rejected; `None` if it is accepted.
pub(super) type Refuse<'a> = &'a dyn Fn(&str) -> Option<Refusal>;

/// Deserializes a text.
///
/// # Errors
/// The first value that is rejected.
pub fn deserialize<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    let mut track = serde_path_to_error::Track::new();
    let yaml = serde_yaml::Deserializer::from_str(text);
    let tracked = serde_path_to_error::Deserializer::new(yaml, &mut track);
    // An enum is a mapping with one key instead of a YAML tag.
    serde_yaml::with::singleton_map_recursive::deserialize(tracked)
        .map_err(|error| (translate::path_of(&track.path()), error))
}
