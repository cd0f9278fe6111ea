//! PPM pictures, as text (`P3`) and as bytes (`P6`), and PFM pictures (`PF`) and maps (`Pf`).
//!
//! <https://netpbm.sourceforge.net/doc/ppm.html>, <https://www.pauldebevec.com/Research/HDR/PFM/>

use super::source::{ForeignNumbers, ForeignSource};
use host::text::Diagnostic;

/// The words of a file: separated by whitespace, with comments from `#` to the end of the line.
struct NetpbmWords<'a> {
    rest: &'a [u8],
}

impl<'a> Iterator for NetpbmWords<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        loop {
            self.rest = self.rest.trim_ascii_start();
            if self.rest.first()? != &b'#' {
                break;
            }
            let line = self.rest.iter().position(|&byte| byte == b'\n')?;
            self.rest = &self.rest[line..];
        }
        let end = self.rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        std::str::from_utf8(word).ok()
    }
}

/// Reads the header after the magic number: width, height, and the word that follows.
fn header<'a>(source: &'a ForeignSource) -> Result<(&'a str, NetpbmWords<'a>), Diagnostic> {
    let mut words = NetpbmWords {
        rest: &source.bytes[2..],
    };
    let mut number = || words.next()?.parse::<u64>().ok();
    let size = number().zip(number());
    let (Some((width, height)), Some(word)) = (size, words.next()) else {
        let help = "write the type, width, height, and the greatest value or the scale";
        return Err(source.refuse("its header is damaged", help));
    };
    source.check_size([width, height])?;
    Ok((word, words))
}

/// Returns the bytes after the whitespace that ends the header.
fn raster<'a>(words: &NetpbmWords<'a>) -> &'a [u8] {
    words.rest.get(1..).unwrap_or_default()
}

/// Reads the colors of a PPM.
pub(super) fn colors(source: &ForeignSource) -> Result<Vec<[u8; 3]>, Diagnostic> {
    let (greatest, words) = header(source)?;
    if greatest != "255" {
        let problem = format!("its greatest value is {greatest}");
        return Err(source.refuse(problem, "write values from 0 to 255"));
    }
    let n_values = 3 * source.n_pixels();
    let values = if source.bytes.starts_with(b"P6") {
        let body = raster(&words);
        source.check_length(body.len(), n_values)?;
        body.to_vec()
    } else {
        texts(source, words, n_values)?
    };
    Ok(values.as_chunks().0.to_vec())
}

/// Reads the values of a PPM that is text.
fn texts(
    source: &ForeignSource,
    words: NetpbmWords,
    n_values: usize,
) -> Result<Vec<u8>, Diagnostic> {
    let mut values = Vec::with_capacity(n_values);
    for word in words.take(n_values + 1) {
        let value = word.parse().map_err(|_| {
            let what = format!("has the value `{word}`");
            source.refuse_pixel(values.len() / 3, &what, "write values from 0 to 255")
        })?;
        values.push(value);
    }
    if values.len() == n_values {
        return Ok(values);
    }
    let problem = match values.len() {
        n if n < n_values => format!("it ends early, after {n} of {n_values} values"),
        _ => "values follow its pixels".to_owned(),
    };
    Err(source.refuse(problem, "write it again, and close the file"))
}

/// Reads the numbers of a PFM, whose bottom row comes first.
pub(super) fn numbers(source: &ForeignSource) -> Result<ForeignNumbers, Diagnostic> {
    let n_channels = if source.bytes.starts_with(b"PF") {
        3
    } else {
        1
    };
    let (scale, words) = header(source)?;
    if scale.parse() != Ok(-1.0) {
        let problem = format!("its scale is {scale}");
        let help = "write little-endian numbers, not scaled, with the scale -1.0";
        return Err(source.refuse(problem, help));
    }
    let row_bytes = source.size[0] as usize * n_channels * size_of::<f32>();
    let body = raster(&words);
    source.check_length(body.len(), row_bytes * source.size[1] as usize)?;
    let top_down = body.chunks_exact(row_bytes).rev();
    let numbers = top_down.flat_map(|row| row.as_chunks().0);
    let values = numbers.map(|&bytes| f32::from_le_bytes(bytes).into());
    Ok(ForeignNumbers {
        n_channels,
        values: values.collect(),
    })
}
