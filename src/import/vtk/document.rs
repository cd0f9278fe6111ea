//! The elements of a user's VTK XML file, and the faults of their attributes.

use std::str::FromStr;

use super::super::fault::cut;
use super::super::{FileFault, Result};
use vtk::read::{Element, MAX_DEPTH, XmlFault};

/// The expectation for a file without an element or attribute.
pub(super) const AS_VTK_WRITES: &str = "a VTK file as VTK writes it";
/// Maximum number of elements of a file: VTK's files have a few for each array of each piece.
const MAX_ELEMENTS: usize = 1 << 16;
/// Maximum number of attributes of an element: VTK writes a dozen.
const MAX_ATTRIBUTES: usize = 64;

/// Parses the elements of a file; also returns its appended data: the bytes after the `_`.
///
/// # Errors
/// The file is not XML, or has too many elements.
pub(super) fn parse(bytes: &[u8]) -> Result<(Element<'_>, &[u8])> {
    vtk::read::parse(bytes, 4 * MAX_ELEMENTS, MAX_ATTRIBUTES).map_err(|fault| {
        let expected = match &fault {
            XmlFault::Damaged(why) => {
                return FileFault::new(format!("it is damaged: {why}"), AS_VTK_WRITES);
            }
            XmlFault::DamagedAttribute => "`name=\"value\"`".to_owned(),
            XmlFault::TooManyAttributes => format!("at most {MAX_ATTRIBUTES}"),
            XmlFault::TooManyElements => {
                format!("at most {MAX_ELEMENTS}, at most {MAX_DEPTH} within each other")
            }
            XmlFault::EndsEarly => "a whole file".to_owned(),
        };
        FileFault::new(fault.to_string(), expected)
    })
}

/// Returns the value of a required attribute.
///
/// # Errors
/// The attribute is missing.
pub(super) fn required<'a>(element: &'a Element, name: &str) -> Result<&'a str> {
    element.attribute(name).ok_or_else(|| {
        let problem = format!("an element `{}` has no `{name}`", cut(&element.name));
        FileFault::new(problem, AS_VTK_WRITES)
    })
}

/// Returns the value of an attribute as a number; `default` without it.
///
/// # Errors
/// The value is not a number.
pub(super) fn number_or<T: FromStr>(element: &Element, name: &str, default: T) -> Result<T> {
    match element.attribute(name) {
        None => Ok(default),
        Some(_) => numbers(element, name).map(|[number]| number),
    }
}

/// Returns the numbers in an attribute.
///
/// # Errors
/// The attribute is missing, or has other words or a different number of them.
pub(super) fn numbers<T: FromStr, const N: usize>(element: &Element, name: &str) -> Result<[T; N]> {
    let value = required(element, name)?;
    let words = value.split_ascii_whitespace().map(|word| word.parse().ok());
    let numbers = words.collect::<Option<Vec<T>>>();
    let numbers = numbers.and_then(|found| found.try_into().ok());
    numbers.ok_or_else(|| {
        let problem = format!("`{name}` is `{}`", cut(value));
        let expected = if N == 1 {
            "a number".to_owned()
        } else {
            format!("{N} numbers")
        };
        FileFault::new(problem, expected)
    })
}
