//! The file of machine limits beside a study's runs, `limits.json`.

use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use host::files;
use host::provenance::difference;
use host::text::Diagnostic;
use render::instruments::MachineLimits;

/// Version of the format; files of other versions are refused.
const FORMAT: u32 = 1;
/// Longest file that is read, in bytes; a typical file has a few thousand.
const MAX_BYTES: u64 = 1 << 20;

/// The content of the file.
#[derive(Serialize, Deserialize)]
pub struct LimitsFile {
    raycost_limits: u32,
    made_by: Value,
    limits: MachineLimits,
}

impl LimitsFile {
    /// Creates the file of `limits` that were measured with the provenance `made_by`.
    pub fn new(limits: MachineLimits, made_by: &Value) -> Self {
        Self {
            raycost_limits: FORMAT,
            made_by: made_by.clone(),
            limits,
        }
    }

    /// Reads the limits from the file at `path`; `None` if there is no such file.
    ///
    /// # Errors
    /// If the file cannot be read, has no limits, or was made by another program or machine than
    /// `made_by`.
    pub fn read(path: &Path, made_by: &Value) -> Result<Option<MachineLimits>, Diagnostic> {
        let remedy = "move the file away to measure anew, or give another folder by `--out`";
        let name = path.display();
        let refused = |message: String| Err(Diagnostic::new(message).with_help(remedy));
        let text = match files::read_text(path, MAX_BYTES) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return refused(format!("cannot read `{name}`: {error}")),
        };
        let Ok(file) = serde_json::from_str::<Self>(&text) else {
            return refused(format!("`{name}` holds no limits of a machine"));
        };
        if file.raycost_limits != FORMAT {
            let found = file.raycost_limits;
            return refused(format!(
                "`{name}` has format {found} of limits, this raycost has {FORMAT}"
            ));
        }
        if let Some(difference) = difference(&file.made_by, made_by) {
            return refused(format!(
                "the limits in `{name}` were measured with {difference}"
            ));
        }
        if file.limits.blocks.is_empty() {
            return refused(format!("`{name}` holds no limits of a machine"));
        }
        Ok(Some(file.limits))
    }
}
