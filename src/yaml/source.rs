//! A scene file's text and the way from it to a value.

use std::fs::File;
use std::io::Read;

use serde::de::DeserializeOwned;

use super::diagnostic::{Diagnostic, Fault};
use super::position;
use super::translate;

/// Longest scene file that is read, in bytes: longer ones are data, not text.
const MAX_BYTES: u64 = 256 << 20;

/// A YAML text and the name to call it in messages.
#[derive(Debug, Clone)]
pub struct Source {
    name: String,
    text: String,
}

impl Source {
    /// A source named `name` (a path, as the user typed it) that holds `text`.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            text: text.into(),
        }
    }

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// A diagnostic when the file cannot be read, is longer than 256 MiB or is
    /// not UTF-8.
    pub fn read(path: &std::path::Path) -> Result<Self, Diagnostic> {
        let name = path.display().to_string();
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
            .map_err(|error| {
                Diagnostic::new(format!("cannot read the scene `{name}`: {error}"))
                    .with_help("give the path of a YAML file, such as configs/seed_sphere.yaml")
            })?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(
                Diagnostic::new(format!("the scene `{name}` is longer than 256 MiB"))
                    .with_help("describe many objects by a generator such as `sphere_cloud`"),
            );
        }
        String::from_utf8(bytes)
            .map(|text| Self::new(&name, text.strip_prefix('\u{feff}').unwrap_or(&text)))
            .map_err(|error| {
                let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
                let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
                Diagnostic::new(format!("{name}:{line}: the file is not UTF-8 text"))
                    .with_help("save the scene as UTF-8")
            })
    }

    /// Reads the text as a `T`.
    ///
    /// # Errors
    /// The first mistake found: syntax, a duplicate key, then whatever `T`'s
    /// `Deserialize` refuses.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, Diagnostic> {
        position::check(&self.text).map_err(|fault| self.point_at(fault))?;
        let mut track = serde_path_to_error::Track::new();
        let yaml = serde_yaml::Deserializer::from_str(&self.text);
        let tracked = serde_path_to_error::Deserializer::new(yaml, &mut track);
        // Enums as mappings of one key instead of YAML tags.
        serde_yaml::with::singleton_map_recursive::deserialize(tracked)
            .map_err(|error| self.point_at(translate::fault(&self.text, &track.path(), &error)))
    }

    /// The fault as a message that shows its line.
    pub fn point_at(&self, fault: Fault) -> Diagnostic {
        let span = fault
            .span
            .clone()
            .or_else(|| position::locate(&self.text, &fault.path, fault.at_key));
        Diagnostic::at(self, span.unwrap_or(0..0), fault)
    }

    /// The name to call the source in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Reads `text` as a `T`, as [`Source::parse`] does.
///
/// # Errors
/// The first mistake found.
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, Diagnostic> {
    Source::new("text", text).parse()
}
