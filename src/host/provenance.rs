//! The ID of a run and the checksums of its files.
//!
//! Each file contains the ID of the run that wrote it: VTK files in the attribute `raycost_run` of
//! their root, PNGs in a text chunk, states, pages and profiles in an XML comment, JSON files in a
//! key. CSV has no place that all readers ignore: a table is identified only by its checksum in
//! `summary.json`, which lists every file.

use std::fmt;
use std::io::{self, Write};
use std::str::FromStr;

use serde::Serialize;
use serde_json::Value;
use twox_hash::XxHash3_128;

/// The key, attribute or keyword of a run's ID.
pub const KEY: &str = "raycost_run";

/// Formats a program's name with its version and its commit.
pub fn program(version: &str, commit: Option<&str>) -> String {
    match commit {
        Some(commit) => format!("raycost {version} ({commit})"),
        None => format!("raycost {version}"),
    }
}

/// A hash of the settings and the results of a run: runs that write the same bytes
/// have the same ID.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunId(u128);

/// A 128-bit XXH3 checksum of a file, as `xxh128sum` prints it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Checksum(u128);

/// Computes the checksum of these bytes.
pub fn checksum(bytes: &[u8]) -> Checksum {
    Checksum(XxHash3_128::oneshot(bytes))
}

/// Computes a checksum incrementally.
#[derive(Clone, Default)]
pub struct Hasher(XxHash3_128);

impl Hasher {
    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }

    /// Adds a value by its JSON, up to the first path that is not UTF-8.
    pub fn add_value(&mut self, value: &impl Serialize) {
        if let Err(error) = serde_json::to_writer(&mut *self, value) {
            self.add(error.to_string().as_bytes());
        }
    }

    /// Returns the checksum of all bytes so far.
    pub fn checksum(&self) -> Checksum {
        Checksum(self.0.finish_128())
    }
}

impl Write for Hasher {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl fmt::Debug for Hasher {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Hasher")
    }
}

impl Checksum {
    /// Returns the 128 bits.
    pub fn bits(self) -> u128 {
        self.0
    }
}

impl From<Checksum> for RunId {
    fn from(checksum: Checksum) -> Self {
        Self(checksum.0)
    }
}

impl RunId {
    /// Returns the ID as an XML comment on a separate line.
    pub fn comment(self) -> String {
        format!("<!-- {KEY}={self} -->\n")
    }
}

/// Returns an XML text with the run's ID in a comment before its root.
pub fn stamped(xml: &str, run: RunId) -> String {
    // A declaration must come first.
    let begin = if xml.starts_with("<?xml") {
        xml.find("?>\n").map_or(0, |at| at + 3)
    } else {
        0
    };
    format!("{}{}{}", &xml[..begin], run.comment(), &xml[begin..])
}

/// Returns the first difference between two provenances, such as "another machine"; `None` if
/// `before` has all values of `now`.
pub fn difference(before: &Value, now: &Value) -> Option<String> {
    let (key, before, now) = first_different(before, now)?;
    Some(match key {
        "flags" => "other flags".to_owned(),
        "n_threads" => "another number of threads".to_owned(),
        "no_hardware_counters" => "other hardware counters".to_owned(),
        "no_energy" => "other meters of energy".to_owned(),
        "scenes" => match first_different(before, now) {
            Some((name, Value::Null, _)) => format!("other scenes, without `{name}`"),
            Some((name, ..)) => {
                format!("another content of the scene `{name}` or of a file that it names")
            }
            None => "other scenes".to_owned(),
        },
        key => format!("another {key}"),
    })
}

/// Returns the first key of `now` whose value differs, with the values before and now.
fn first_different<'a>(
    before: &'a Value,
    now: &'a Value,
) -> Option<(&'a str, &'a Value, &'a Value)> {
    now.as_object()?.iter().find_map(|(key, now)| {
        let before = &before[key.as_str()];
        (before != now).then_some((key.as_str(), before, now))
    })
}

/// Makes a type print as, and parse from, 32 hexadecimal digits.
macro_rules! as_digits {
    ($kind:ident) => {
        impl fmt::Display for $kind {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{:032x}", self.0)
            }
        }

        impl FromStr for $kind {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                let is_digit = |c: char| matches!(c, '0'..='9' | 'a'..='f');
                if text.len() != 32 || !text.chars().all(is_digit) {
                    return Err("expected 32 hexadecimal digits".to_owned());
                }
                let digits = u128::from_str_radix(text, 16);
                digits.map(Self).map_err(|error| error.to_string())
            }
        }

        impl serde::Serialize for $kind {
            fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
                s.collect_str(self)
            }
        }

        impl<'de> serde::Deserialize<'de> for $kind {
            fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
                let text = String::deserialize(d)?;
                text.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}

as_digits!(RunId);
as_digits!(Checksum);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checksum_is_that_of_xxh128sum() {
        // xxh128sum of xxHash 0.8, of no bytes and of "raycost\n".
        assert_eq!(
            checksum(b"").to_string(),
            "99aa06d3014798d86001c324468d497f"
        );
        let mut hasher = Hasher::default();
        hasher.add(b"ray");
        hasher.add(b"cost\n");
        assert_eq!(hasher.checksum(), checksum(b"raycost\n"));
        let text = hasher.checksum().to_string();
        assert_eq!(text.parse(), Ok(hasher.checksum()));
        assert!(text[1..].parse::<Checksum>().is_err());
        assert!(text.to_uppercase().parse::<Checksum>().is_err());
    }

    #[test]
    fn a_stamp_follows_the_xml_declaration() {
        let run = RunId(7);
        let stamp = run.comment();
        assert_eq!(stamped("<a/>", run), format!("{stamp}<a/>"));
        let declared = "<?xml version=\"1.0\"?>\n<a/>";
        assert_eq!(
            stamped(declared, run),
            format!("<?xml version=\"1.0\"?>\n{stamp}<a/>")
        );
    }
}
