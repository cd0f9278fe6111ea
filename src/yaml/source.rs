//! The text of a scene file.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::string::FromUtf8Error;

use serde::de::DeserializeOwned;

use super::fault::{Fault, Spot};
use super::position::{self, Location};
use super::translate;
use crate::host::{advice, available_memory};
use crate::text::Diagnostic;

/// Longest scene file that is read, in bytes.
const MAX_BYTES: u64 = 64 << 20;
/// Most bytes of memory that the parsers need for each byte of the text:
/// `[[],[],…` has an event in every second byte.
const MEMORY_PER_BYTE: u64 = 80;
/// Bytes of memory that are asked for without a check, which reads many files of the
/// system.
const WORTH_A_CHECK: u64 = 1 << 20;

/// A YAML text and its name in messages.
#[derive(Debug, Clone)]
pub struct Source {
    name: String,
    text: String,
}

impl Source {
    /// Creates a source from a name (a path, as the user typed it) and a text,
    /// whose lines may end with LF, CR LF or CR.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let (name, mut text) = (name.into(), text.into());
        if text.contains('\r') {
            text = text.replace("\r\n", "\n").replace('\r', "\n");
        }
        Self { name, text }
    }

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is longer than 64 MiB or than the free memory
    /// allows, or is not UTF-8.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        let name = path.display().to_string();
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
            .map_err(|error| {
                let remedy = "give the path of a YAML file, such as configs/seed_sphere.yaml";
                Diagnostic::new(format!("cannot read the scene `{name}`: {error}"))
                    .with_help(advice(&error).unwrap_or(remedy))
            })?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(
                Diagnostic::new(format!("the scene `{name}` is longer than 64 MiB"))
                    .with_help("describe many objects by a generator such as `sphere_cloud`"),
            );
        }
        let needed = bytes.len() as u64 * MEMORY_PER_BYTE;
        if needed > WORTH_A_CHECK && needed > available_memory() {
            let message = format!("the scene `{name}` needs more memory than is free");
            return Err(Diagnostic::new(message)
                .with_help("describe many objects by a generator such as `sphere_cloud`"));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self::new(
                &name,
                text.strip_prefix('\u{feff}').unwrap_or(&text),
            )),
            Err(error) => Err(not_utf8(&name, &error)),
        }
    }

    /// Deserializes a `T` from the text.
    ///
    /// # Errors
    /// The first mistake found: a syntax error, a duplicate key, then what
    /// `T`'s `Deserialize` rejects.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, Diagnostic> {
        position::check(&self.text).map_err(|fault| self.point_at(fault))?;
        let mut track = serde_path_to_error::Track::new();
        let yaml = serde_yaml::Deserializer::from_str(&self.text);
        let tracked = serde_path_to_error::Deserializer::new(yaml, &mut track);
        // An enum is a mapping with one key instead of a YAML tag.
        serde_yaml::with::singleton_map_recursive::deserialize(tracked)
            .map_err(|error| self.point_at(translate::fault(&self.text, &track.path(), &error)))
    }

    /// Converts the fault to a diagnostic that shows its line.
    pub fn point_at(&self, fault: Fault) -> Diagnostic {
        let location_of = |path| position::locate(&self.text, path);
        let span = match &fault.spot {
            Spot::Value(path) => location_of(path).map(Location::value),
            Spot::Key(path) => location_of(path).map(Location::key),
            Spot::Bytes(bytes) => Some(bytes.clone()),
        };
        let (span, expected) = (span.unwrap_or(0..0), fault.expected.clone());
        let diagnostic = fault.without_place();
        diagnostic.at(&self.name, &self.text, span, &expected)
    }

    /// The name of the source in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The folder of the file, if the name is a path.
    pub fn folder(&self) -> &Path {
        Path::new(&self.name).parent().unwrap_or(Path::new(""))
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Points at the first byte that is not UTF-8.
fn not_utf8(name: &str, error: &FromUtf8Error) -> Diagnostic {
    let at = error.utf8_error().valid_up_to();
    let message = "the file is not UTF-8 text";
    let fault = Fault::of_bytes(at..at, message, "not a UTF-8 character");
    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
    // Not through `new`, which may shift the byte.
    let name = name.to_owned();
    Source { name, text }.point_at(fault.with_help("save the scene as UTF-8"))
}

/// Deserializes a `T` from `text`, as [`Source::parse`] does.
///
/// # Errors
/// The first mistake found.
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, Diagnostic> {
    Source::new("text", text).parse()
}
