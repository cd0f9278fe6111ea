//! Rectangles of pixels on the command line.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use host::text::Diagnostic;
use scene::config::Image;

/// A rectangle of pixels, row 0 on top, such as `3,4`, `10..19,4` or `10..19,0..9`; both ends are
/// inclusive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PixelRectangle {
    columns: RangeInclusive<u32>,
    rows: RangeInclusive<u32>,
}

impl PixelRectangle {
    /// Checks that the rectangle lies in the picture.
    ///
    /// # Errors
    /// The rectangle, and the picture's size.
    pub(super) fn check(&self, image: &Image) -> Result<(), Diagnostic> {
        if *self.columns.end() < image.width && *self.rows.end() < image.height {
            return Ok(());
        }
        let message = format!("there is no pixel {self} in the picture");
        let [right, bottom] = [image.width - 1, image.height - 1];
        Err(Diagnostic::new(message).with_help(format!(
            "it has {} x {} pixels, from 0,0 on the top left to {right},{bottom}",
            image.width, image.height
        )))
    }

    /// Returns the number of pixels.
    pub(super) fn n_pixels(&self) -> u64 {
        let n = |range: &RangeInclusive<u32>| u64::from(range.end() - range.start()) + 1;
        n(&self.columns) * n(&self.rows)
    }

    /// Returns the pixels of all rectangles, each once, row by row of each rectangle.
    pub(super) fn pixels(rectangles: &[Self]) -> impl Iterator<Item = (u32, u32)> + '_ {
        rectangles
            .iter()
            .enumerate()
            .flat_map(move |(i, rectangle)| {
                let Self { columns, rows } = rectangle.clone();
                let all = rows.flat_map(move |y| columns.clone().map(move |x| (x, y)));
                all.filter(move |&(x, y)| !rectangles[..i].iter().any(|other| other.has(x, y)))
            })
    }

    fn has(&self, x: u32, y: u32) -> bool {
        self.columns.contains(&x) && self.rows.contains(&y)
    }
}

impl FromStr for PixelRectangle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (x, y) = text.split_once(',')?;
            Some(Self {
                columns: range(x)?,
                rows: range(y)?,
            })
        };
        parse().ok_or_else(|| {
            "expected a pixel such as 120,80, or ranges such as 120..129,80..89".to_owned()
        })
    }
}

/// Parses a number or a range `first..last` with `first <= last`.
fn range(text: &str) -> Option<RangeInclusive<u32>> {
    let number = |text: &str| text.trim().parse::<u32>().ok();
    let (first, last) = match text.split_once("..") {
        Some((first, last)) => (number(first)?, number(last)?),
        None => (number(text)?, number(text)?),
    };
    (first <= last).then_some(first..=last)
}

impl fmt::Display for PixelRectangle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = |range: &RangeInclusive<u32>| match (range.start(), range.end()) {
            (first, last) if first == last => first.to_string(),
            (first, last) => format!("{first}..{last}"),
        };
        write!(f, "{},{}", side(&self.columns), side(&self.rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parsing_inverts_formatting() {
        for text in ["3,4", "10..19,4", "0,7..8", "10..19,0..9"] {
            assert_eq!(text.parse::<PixelRectangle>().unwrap().to_string(), text);
        }
        assert_eq!(
            "5..5, 1".parse::<PixelRectangle>().unwrap().to_string(),
            "5,1"
        );
    }

    #[test]
    fn malformed_rectangles_are_refused() {
        for text in [
            "",
            "3",
            "3,",
            ",3",
            "3;4",
            "3,4,5",
            "-1,4",
            "1.5,2",
            "9..3,4",
            "1...3,4",
            "4294967296,0",
        ] {
            assert!(text.parse::<PixelRectangle>().is_err(), "{text}");
        }
    }

    #[test]
    fn overlapping_rectangles_give_each_pixel_once() {
        let rectangles = ["1..2,1..2", "2..3,2"].map(|text| text.parse().unwrap());
        let pixels: Vec<_> = PixelRectangle::pixels(&rectangles).collect();
        assert_eq!(pixels, [(1, 1), (2, 1), (1, 2), (2, 2), (3, 2)]);
        assert_eq!(rectangles.map(|rectangle| rectangle.n_pixels()), [4, 2]);
    }
}
