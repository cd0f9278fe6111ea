//! Frames on the command line.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use super::MAX_FRAMES;

/// Frames such as `7` or `10..19`, both ends included.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameRange(pub RangeInclusive<u32>);

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<u32>().ok();
        let ends = match text.split_once("..") {
            Some((first, last)) => number(first).zip(number(last)),
            None => number(text).zip(number(text)),
        };
        match ends {
            Some((first, last)) if first <= last && last < MAX_FRAMES => Ok(Self(first..=last)),
            _ => Err("expected a frame such as 7, or a range such as 10..19".to_owned()),
        }
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.0.start(), self.0.end()) {
            (first, last) if first == last => write!(f, "{first}"),
            (first, last) => write!(f, "{first}..{last}"),
        }
    }
}
