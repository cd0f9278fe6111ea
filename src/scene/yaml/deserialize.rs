//! serde_yaml's deserializer, extended by the path of the rejected value.

use serde::de::DeserializeOwned;

use super::field_path::FieldPath;
use super::translate;

/// The path of a rejected value, and the reason.
pub(super) type Refusal = (FieldPath, serde_yaml::Error);

/// Deserializes a text; an error comes with the path of its value.
pub(super) fn deserialize<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    let mut track = serde_path_to_error::Track::new();
    let yaml = serde_yaml::Deserializer::from_str(text);
    let tracked = serde_path_to_error::Deserializer::new(yaml, &mut track);
    // An enum is a mapping with one key instead of a YAML tag.
    serde_yaml::with::singleton_map_recursive::deserialize(tracked)
        .map_err(|error| (translate::path_of(&track.path()), error))
}
