//! The text of a summary, sealed by a checksum.

use std::io::{self, Write};

use super::Summary;
use host::provenance::checksum;

/// The key of the checksum of all bytes before the key.
const SEAL: &str = "checksum";

impl Summary {
    /// Writes the summary as indented JSON, its own checksum last.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        // Convert to values first, which hold an `f32` as the `f64` that equals it.
        let values = serde_json::to_value(self)?;
        let text = serde_json::to_string_pretty(&values)?;
        out.write_all(sealed(&text).as_bytes())
    }
}

/// Appends the checksum as the last key of an object.
fn sealed(object: &str) -> String {
    let begin = object.trim_end_matches(['\n', '}']);
    let checksum = checksum(format!("{begin},\n").as_bytes());
    format!("{begin},\n  \"{SEAL}\": \"{checksum}\"\n}}\n")
}

/// Returns true if a summary's text matches its checksum; `None` without a checksum.
pub fn is_whole(text: &str) -> Option<bool> {
    let (begin, seal) = text.rsplit_once(&format!("  \"{SEAL}\": \""))?;
    let seal = seal.strip_suffix("\"\n}\n");
    Some(seal == Some(&checksum(begin.as_bytes()).to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seal_notices_every_change() {
        let text = sealed("{\n  \"a\": 1\n}");
        assert_eq!(is_whole(&text), Some(true));
        assert_eq!(is_whole(&text.replace('1', "2")), Some(false));
        assert_eq!(is_whole(text.trim_end()), Some(false));
        assert_eq!(is_whole("{\n  \"a\": 1\n}"), None);
    }
}
