//! Windows of pictures on the command line.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use host::text::Diagnostic;
use scene::config::Image;

/// A window of a picture: its first column and row, its width and its height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crop([u32; 4]);

impl Crop {
    /// Returns the window of an image.
    ///
    /// # Errors
    /// If it reaches beyond the image.
    pub(super) fn apply(self, image: &Image) -> Result<Image, Diagnostic> {
        image.cropped(self.0).ok_or_else(|| {
            let message = format!("the window `--crop {self}` is not within the picture");
            let [width, height] = [image.width, image.height];
            Diagnostic::new(message).with_help(format!("the picture has {width} x {height} pixels"))
        })
    }
}

impl FromStr for Crop {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "expected X,Y,WIDTH,HEIGHT in pixels, such as 100,50,32,32";
        let numbers: Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
        let numbers = numbers.map_err(|_| expected)?;
        let window = <[u32; 4]>::try_from(numbers).map_err(|_| expected)?;
        let is_empty = window[2] == 0 || window[3] == 0;
        if is_empty {
            Err(expected)
        } else {
            Ok(Self(window))
        }
    }
}

impl Serialize for Crop {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.collect_str(self)
    }
}

impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, width, height] = self.0;
        write!(f, "{x},{y},{width},{height}")
    }
}
