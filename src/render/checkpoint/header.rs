//! Identification of the rendering that the tiles of a file belong to.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::RecordLayout;
use host::provenance::{Checksum, program};

/// The first block of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// The version of raycost that renders.
    pub raycost: String,
    /// The commit, if the build was given one.
    pub commit: Option<String>,
    /// `little` or `big`: the order of the bytes of a number in the pixels.
    pub byte_order: String,
    /// The scene file as the user typed it.
    pub scene: String,
    /// The flags that change its settings.
    pub flags: Vec<String>,
    /// The folder that the path of the scene starts from.
    pub folder: String,
    /// The frame of an animated scene.
    pub frame: Option<u32>,
    /// A hash of the settings and of the contents of the files that the scene names: equal where
    /// the pixels are equal.
    pub fingerprint: Checksum,
    /// The part of the picture; `None` for the whole.
    pub part: Option<PicturePart>,
    /// The sizes of the records.
    pub layout: RecordLayout,
}

/// One of several parts of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct PicturePart {
    /// Number of the part, from 1.
    pub number: u32,
    /// Number of parts.
    pub of: u32,
}

impl PicturePart {
    /// Greatest number of parts of a picture.
    pub const MAX: u32 = 65_535;

    /// Returns the name of the part's file: numbers have as many digits as the number of parts.
    pub fn file_name(self) -> String {
        let n_digits = self.of.to_string().len();
        format!("part-{:0n_digits$}-of-{}.tiles", self.number, self.of)
    }
}

impl FromStr for PicturePart {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<u32>().ok();
        let numbers = text.split_once('/');
        let numbers = numbers.and_then(|(part, of)| number(part).zip(number(of)));
        match numbers {
            None => Err("expected a part such as 3/16".to_owned()),
            Some((_, of)) if of == 0 || of > Self::MAX => {
                Err(format!("expected 1 to {} parts", Self::MAX))
            }
            Some((number, of)) if number == 0 || number > of => {
                Err(format!("the parts are 1/{of} to {of}/{of}"))
            }
            Some((number, of)) => Ok(Self { number, of }),
        }
    }
}

impl fmt::Display for PicturePart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl Header {
    /// The order of bytes of this machine.
    pub const BYTE_ORDER: &'static str = if cfg!(target_endian = "little") {
        "little"
    } else {
        "big"
    };

    /// Returns the reason why tiles of `self` do not belong to the rendering of `other`, whatever
    /// their parts are, or `None` if they do.
    pub fn foreign_to(&self, other: &Self) -> Option<String> {
        let program_of = |header: &Self| program(&header.raycost, header.commit.as_deref());
        let [found, expected] = [program_of(self), program_of(other)];
        if found != expected {
            return Some(format!("{found} rendered it, and not {expected}"));
        }
        if self.byte_order != other.byte_order {
            return Some("a machine with another order of bytes rendered it".to_owned());
        }
        if self.frame != other.frame {
            return Some("it is of another frame".to_owned());
        }
        let is_same = self.fingerprint == other.fingerprint && self.layout == other.layout;
        (!is_same).then(|| "it is of another scene, or of other settings or files".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_numbered_from_1() {
        let part: PicturePart = "3/16".parse().unwrap();
        assert_eq!(part, PicturePart { number: 3, of: 16 });
        assert_eq!(part.to_string(), "3/16");
        assert_eq!(part.file_name(), "part-03-of-16.tiles");
        for wrong in [
            "", "3", "0/4", "17/16", "1/0", "-1/4", "1/65536", "a/b", "1/2/3",
        ] {
            assert!(wrong.parse::<PicturePart>().is_err(), "{wrong}");
        }
    }
}
