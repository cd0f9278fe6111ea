//! The names in groups and the values of attributes.

use hdf5_metno::types::{FixedAscii, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5_metno::{Group, H5Type, Location};

use super::super::super::{FileFault, Result};
use super::rows::{damaged, missing};

/// Longest text of an attribute.
const TEXT: usize = 64;

/// Returns the names of a group's datasets.
pub(super) fn members(group: &Group, name: &str) -> Result<Vec<String>> {
    group.member_names().map_err(|error| damaged(name, &error))
}

/// Returns the numbers of an attribute.
pub(super) fn numbers<T: H5Type + Copy, const N: usize>(at: &Group, name: &str) -> Result<[T; N]> {
    let attribute = at.attr(name).map_err(|error| damaged(name, &error))?;
    if attribute.size() != N {
        let problem = format!("the attribute `{name}` has {} numbers", attribute.size());
        return Err(FileFault::new(problem, N.to_string()));
    }
    let found = attribute.read_raw::<T>();
    let found = found.map_err(|error| damaged(name, &error))?;
    <[T; N]>::try_from(found).map_err(|_| missing(name))
}

/// Returns the text of an attribute.
pub(super) fn text(at: &Location, name: &str) -> Result<String> {
    let read = || {
        let attribute = at.attr(name)?;
        Ok(match attribute.dtype()?.to_descriptor()? {
            TypeDescriptor::VarLenAscii => attribute.read_scalar::<VarLenAscii>()?.to_string(),
            TypeDescriptor::VarLenUnicode => attribute.read_scalar::<VarLenUnicode>()?.to_string(),
            _ => attribute.read_scalar::<FixedAscii<TEXT>>()?.to_string(),
        })
    };
    read().map_err(|error: hdf5_metno::Error| damaged(name, &error))
}
