//! The bytes of a file of another program.

use std::path::Path;

use host::files;
use host::text::Diagnostic;

/// Upper bound of the length of a file: a picture of many layers, not compressed.
const BYTES_PER_PIXEL: u64 = 256;
/// Upper bound of the length of a file's header.
const HEADER_BYTES: u64 = 1 << 20;

/// The bytes of a file, and the size that its picture must have.
pub(super) struct ForeignSource<'a> {
    pub(super) path: &'a Path,
    pub(super) size: [u32; 2],
    pub(super) bytes: Vec<u8>,
}

/// ForeignNumbers of the pixels, row-major, row 0 on top.
pub(super) struct ForeignNumbers {
    /// One or three.
    pub(super) n_channels: usize,
    pub(super) values: Vec<f64>,
}

impl<'a> ForeignSource<'a> {
    pub(super) fn read(path: &'a Path, size: [u32; 2]) -> Result<Self, Diagnostic> {
        let n_pixels = u64::from(size[0]) * u64::from(size[1]);
        let bytes = files::read(path, HEADER_BYTES + BYTES_PER_PIXEL * n_pixels);
        let bytes = bytes.map_err(|error| {
            let [width, height] = size;
            Diagnostic::new(format!("cannot read `{}`: {error}", path.display()))
                .with_help(format!("give a file of {width} x {height} pixels"))
        })?;
        Ok(Self { path, size, bytes })
    }

    pub(super) fn n_pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Creates the error for a file that cannot be compared.
    pub(super) fn refuse(&self, problem: impl AsRef<str>, help: impl Into<String>) -> Diagnostic {
        let path = self.path.display();
        Diagnostic::new(format!("`{path}`: {}", problem.as_ref())).with_help(help)
    }

    /// Checks the numbers of columns and rows in a header.
    pub(super) fn check_size(&self, found: [u64; 2]) -> Result<(), Diagnostic> {
        let [width, height] = self.size;
        if found == self.size.map(u64::from) {
            return Ok(());
        }
        let problem = format!(
            "it has {} x {} pixels, the output {width} x {height}",
            found[0], found[1]
        );
        let help = format!(
            "write it with {width} x {height} pixels, or render with `--width {} --height {}`",
            found[0], found[1]
        );
        Err(self.refuse(problem, help))
    }

    /// Checks the number of bytes that follow the header.
    pub(super) fn check_length(&self, found: usize, expected: usize) -> Result<(), Diagnostic> {
        let problem = match found {
            _ if found == expected => return Ok(()),
            _ if found < expected => format!("it ends early, after {found} of {expected} bytes"),
            _ => format!("{} bytes follow its pixels", found - expected),
        };
        Err(self.refuse(problem, "write it again, and close the file"))
    }

    /// Creates the error for a pixel, by its index.
    pub(super) fn refuse_pixel(&self, pixel: usize, what: &str, help: &str) -> Diagnostic {
        let width = self.size[0] as usize;
        let (x, y) = (pixel % width, pixel / width);
        self.refuse(format!("the pixel {x},{y} {what}"), help)
    }
}
