//! The text of a scene file.

use std::io::{self, Read};
use std::path::Path;
use std::string::FromUtf8Error;
use std::sync::Arc;

use serde::de::DeserializeOwned;

use super::deserialize::{Refusal, YamlFile, deserialize};
use super::fault::{Fault, Spot};
use super::field_path::FieldPath;
use super::mistakes::{self, Explain};
use super::position::{self, Location};
use super::setting::{LocatedText, SettingText};
use super::translate;
use super::tree::Tree;
use host::files;
use host::text::{Diagnostic, why_missing};
use host::{advice, available_memory};

/// Maximum length of a scene file in bytes.
pub(super) const MAX_BYTES: u64 = 64 << 20;
/// Maximum number of bytes of memory that the parsers need per byte of the text: `[[],[],…` has an
/// event in every second byte.
const MEMORY_PER_BYTE: u64 = 80;
/// Bytes of memory that are used without a check: reading the available memory opens several files
/// in `/proc`.
const WORTH_A_CHECK: u64 = 1 << 20;

/// A YAML text and its name in messages.
#[derive(Debug, Clone)]
pub struct Source {
    name: String,
    /// The text, shared by the copies of the source.
    text: Arc<str>,
    /// The path and the value of the text if it is a setting.
    setting: Option<SettingText>,
    /// The scene's key on whose behalf it was set; `None` for the command line.
    set_by: Option<FieldPath>,
}

impl Source {
    /// Creates a source from a name (a path as typed by the user) and a text, whose lines may end
    /// with LF, CR LF or CR.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let (name, mut text) = (name.into(), text.into());
        if text.contains('\r') {
            text = text.replace("\r\n", "\n").replace('\r', "\n");
        }
        Self {
            name,
            text: text.into(),
            setting: None,
            set_by: None,
        }
    }

    /// Creates a setting of the command line, such as `image.seed=7`.
    ///
    /// # Errors
    /// The path or the value is not valid.
    pub(super) fn setting(text: &str) -> Result<Self, Diagnostic> {
        let mut source = Self::new("--set", text);
        let setting = SettingText::parse(&source.text);
        source.setting = Some(setting.map_err(|fault| source.point_at(fault))?);
        Ok(source)
    }

    /// Creates a setting of the value at `path`, on behalf of the scene's key `by`.
    ///
    /// # Errors
    /// The path is not valid: a fault at that key.
    pub(super) fn setting_by(path: &str, value: &str, by: FieldPath) -> Result<Self, Fault> {
        let mut source = Self::new("keyframes", format!("{path}={value}"));
        let setting = SettingText::parse(&source.text).map_err(|fault| Fault {
            spot: Spot::Key(by.clone()),
            help: Some("write the path of a value, such as `objects[0].sphere.radius`".to_owned()),
            ..fault
        })?;
        source.setting = Some(setting);
        source.set_by = Some(by);
        Ok(source)
    }

    /// Reads standard input to its end.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_standard_input() -> Result<Self, Diagnostic> {
        Self::read_from("stdin", |bytes| {
            let input = std::io::stdin().lock();
            input.take(MAX_BYTES + 1).read_to_end(bytes)
        })
    }

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is longer than 64 MiB or than the free memory
    /// allows, is a pointer of Git LFS, or is not UTF-8.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        Self::read_from(&path.display().to_string(), |bytes| {
            files::open(path)?.take(MAX_BYTES + 1).read_to_end(bytes)
        })
    }

    /// Fills a source with this name from a function that reads bytes.
    fn read_from(
        name: &str,
        read: impl FnOnce(&mut Vec<u8>) -> io::Result<usize>,
    ) -> Result<Self, Diagnostic> {
        let mut bytes = Vec::new();
        read(&mut bytes).map_err(|error| {
            let remedy = match error.kind() {
                io::ErrorKind::IsADirectory => {
                    "give the path of a YAML file in it; `raycost check` also takes a folder that \
                     `raycost render` wrote"
                }
                _ => "give the path of a YAML file, such as configs/seed_sphere.yaml",
            };
            let help = advice(&error).map(str::to_owned);
            let help = help.or_else(|| why_missing(Path::new(name)));
            Diagnostic::new(format!("cannot read the scene `{name}`: {error}"))
                .with_help(help.unwrap_or_else(|| remedy.to_owned()))
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
        if bytes.starts_with(files::GIT_LFS) {
            let message = format!("`{name}` is a pointer of Git LFS, not the file itself");
            return Err(Diagnostic::new(message).with_help("fetch the file by `git lfs pull`"));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self::new(
                name,
                text.strip_prefix('\u{feff}').unwrap_or(&text),
            )),
            Err(error) => Err(not_utf8(name, &error)),
        }
    }

    /// Deserializes a `T` from the text.
    ///
    /// # Errors
    /// The first syntax error or duplicate key; otherwise all values that `T`'s `Deserialize`
    /// rejects, up to ten.
    pub fn parse<T: YamlFile>(&self) -> Result<T, Diagnostic> {
        self.parse_with(T::from_yaml)
    }

    fn parse_with<T>(&self, read: fn(&str) -> Result<T, Refusal>) -> Result<T, Diagnostic> {
        self.check()?;
        read(&self.text).map_err(|first| {
            let refused = |path, error: &serde_yaml::Error| {
                self.point_at(translate::fault(&self.located(), path, error))
            };
            let explain = Explain {
                refuse: &|text| read(text).err(),
                is_written: &|path| self.located().has(path),
                refused: &refused,
                fault: &|fault| self.point_at(fault),
            };
            mistakes::find(&self.text, || Tree::parse(&self.text), first, &explain)
        })
    }

    /// Returns true if the text has this key at its top; false if it has a syntax error.
    pub fn has_key(&self, key: &str) -> bool {
        let may_have = self.text.contains(key) && self.check().is_ok();
        may_have && Tree::parse(&self.text).get(key).is_some()
    }

    /// Checks the rules that the deserializer does not check.
    ///
    /// # Errors
    /// The first mistake.
    pub(super) fn check(&self) -> Result<(), Diagnostic> {
        position::check(&self.text, 0).map_err(|fault| self.point_at(fault))
    }

    /// Locates the value at `path`, or its nearest ancestor in the text.
    pub(super) fn locate(&self, path: &FieldPath) -> Option<Location> {
        self.located().locate(path)
    }

    /// Returns the text for messages about it.
    pub(super) fn located(&self) -> LocatedText<'_> {
        LocatedText {
            text: &self.text,
            setting: self.setting.as_ref(),
        }
    }

    /// Returns the path and the value if the source is a setting.
    pub(super) fn as_setting(&self) -> Option<&SettingText> {
        self.setting.as_ref()
    }

    /// Returns the scene's key on whose behalf it was set.
    pub(super) fn set_by(&self) -> Option<&FieldPath> {
        self.set_by.as_ref()
    }

    /// Converts the fault to a diagnostic that shows its line.
    pub fn point_at(&self, fault: Fault) -> Diagnostic {
        let location_of = |path| self.locate(path);
        let span = match &fault.spot {
            Spot::Value(path) => location_of(path).map(Location::value),
            Spot::Key(path) => location_of(path).map(Location::key),
            Spot::Bytes(bytes) => Some(bytes.clone()),
        };
        let (span, expected) = (span.unwrap_or(0..0), fault.expected.clone());
        let diagnostic = fault.without_place();
        diagnostic.at(&self.name, &self.text, span, &expected)
    }

    /// Returns the name of the source in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the folder of the file, if the name is a path.
    pub fn folder(&self) -> &Path {
        Path::new(&self.name).parent().unwrap_or(Path::new(""))
    }

    /// Returns the whole text.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Points at the first byte that is not UTF-8.
fn not_utf8(name: &str, error: &FromUtf8Error) -> Diagnostic {
    let at = error.utf8_error().valid_up_to();
    let message = "the file is not UTF-8 text";
    let fault = Fault::at_bytes(at..at, message, "not a UTF-8 character");
    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
    // Not through `new`, which may shift the byte.
    let source = Source {
        name: name.to_owned(),
        text: text.into(),
        setting: None,
        set_by: None,
    };
    source.point_at(fault.with_help("save the scene as UTF-8"))
}

/// Deserializes a `T` from `text`, as [`Source::parse`] does.
///
/// # Errors
/// The first mistake found.
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, Diagnostic> {
    Source::new("text", text).parse_with(deserialize)
}
