//! The numbers of a glTF file's accessors.

use gltf_json::accessor::{Accessor, ComponentType, sparse};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root, buffer};

use super::buffers::Buffers;
use crate::budget::Budget;
use crate::{FileFault, Result};

/// The accessors of a file.
#[derive(Clone, Copy)]
pub(super) struct Accessors<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: &'a Buffers<'a>,
}

/// Elements in the bytes of a view.
struct Elements<'a> {
    /// The bytes from the first element on.
    bytes: &'a [u8],
    /// Bytes from one element to the next.
    stride: usize,
    component: ComponentType,
    /// True if whole numbers represent fractions of the largest one.
    normalized: bool,
}

impl Accessors<'_> {
    /// Returns the first `N` numbers of each element, with 0 for missing ones, and 1 for a missing
    /// fourth one, the opacity of a color.
    ///
    /// # Errors
    /// The accessor exceeds its view, or needs too much memory.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: Index<Accessor>,
        budget: &mut Budget,
    ) -> Result<Vec<[f32; N]>> {
        let (accessor, n) = self.shape(index, budget, size_of::<[f32; N]>())?;
        let used = n_components(accessor).min(N);
        let mut without = [0.0; N];
        if let Some(fourth) = without[used..].get_mut(3 - used.min(3)) {
            *fourth = 1.0;
        }
        let mut found = vec![without; n];
        if let Some(elements) = self.elements(index, accessor)? {
            for (i, vector) in found.iter_mut().enumerate() {
                for (k, number) in vector[..used].iter_mut().enumerate() {
                    *number = elements.number(i, k);
                }
            }
        }
        self.replace(index, accessor, |i, values, from| {
            let Some(vector) = found.get_mut(i) else {
                return false;
            };
            for (k, number) in vector[..used].iter_mut().enumerate() {
                *number = values.number(from, k);
            }
            true
        })?;
        Ok(found)
    }

    /// Returns the whole numbers of an accessor of indices.
    ///
    /// # Errors
    /// As [`vectors`](Self::vectors), or a number is not whole.
    pub(super) fn indices(&self, index: Index<Accessor>, budget: &mut Budget) -> Result<Vec<u32>> {
        let (accessor, n) = self.shape(index, budget, size_of::<u32>())?;
        let is_whole = matches!(
            type_of_components(accessor),
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        );
        if !is_whole || n_components(accessor) != 1 {
            let problem = format!("`accessors[{}]` has no indices", index.value());
            return Err(FileFault::new(
                problem,
                "whole numbers without a sign, one by one",
            ));
        }
        let mut found = vec![0; n];
        if let Some(elements) = self.elements(index, accessor)? {
            for (i, number) in found.iter_mut().enumerate() {
                *number = elements.index(i);
            }
        }
        self.replace(index, accessor, |i, values, from| {
            let number = found.get_mut(i);
            number.map(|number| *number = values.index(from)).is_some()
        })?;
        Ok(found)
    }

    /// Returns the number of elements.
    pub(super) fn count(&self, index: Index<Accessor>) -> u64 {
        self.root.get(index).map_or(0, |accessor| accessor.count.0)
    }

    /// Returns an accessor and the number of its elements, whose memory is taken from the budget.
    fn shape(
        &self,
        index: Index<Accessor>,
        budget: &mut Budget,
        n_bytes: usize,
    ) -> Result<(&Accessor, usize)> {
        let accessor = self.root.get(index).ok_or_else(|| outside(index))?;
        for (key, is_valid) in [
            ("type", accessor.type_ != Checked::Invalid),
            (
                "componentType",
                matches!(accessor.component_type, Checked::Valid(_)),
            ),
        ] {
            if !is_valid {
                let problem = format!(
                    "`accessors[{}].{key}`: it has no valid value",
                    index.value()
                );
                return Err(FileFault::new(problem, "one of glTF 2.0"));
            }
        }
        let n = accessor.count.0;
        budget.take(n.saturating_mul(n_bytes as u64))?;
        Ok((accessor, n as usize))
    }

    /// Returns the elements in the view of an accessor, if it has one.
    fn elements(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
    ) -> Result<Option<Elements<'_>>> {
        let Some(view) = accessor.buffer_view else {
            return Ok(None);
        };
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let component = type_of_components(accessor);
        let size = n_components(accessor) * component.size();
        let elements = self.in_view(view, offset, size, component, accessor.count.0);
        let elements = elements?.ok_or_else(|| outside(index))?;
        Ok(Some(Elements {
            normalized: accessor.normalized,
            ..elements
        }))
    }

    /// Returns `n` elements of this size in a view; `None` if they exceed it.
    fn in_view(
        &self,
        view: Index<buffer::View>,
        offset: u64,
        size: usize,
        component: ComponentType,
        n: u64,
    ) -> Result<Option<Elements<'_>>> {
        let (bytes, stride) = self.buffers.view(self.root, view)?;
        let stride = stride.unwrap_or(size);
        let last = n.checked_sub(1).map(|last| last.checked_mul(stride as u64));
        let end = match last {
            None => Some(offset),
            Some(last) => last.and_then(|last| last.checked_add(offset)?.checked_add(size as u64)),
        };
        let fits = end.is_some_and(|end| end <= bytes.len() as u64);
        Ok(fits.then(|| Elements {
            bytes: &bytes[offset as usize..],
            stride,
            component,
            normalized: false,
        }))
    }

    /// Calls `replace` for each element that a sparse accessor replaces, with its index, the values
    /// and the index of the value; `replace` returns true if the element exists.
    fn replace(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
        mut replace: impl FnMut(usize, &Elements, usize) -> bool,
    ) -> Result<()> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(());
        };
        let sparse::Sparse {
            count,
            indices,
            values,
            ..
        } = sparse;
        let of_indices = match &indices.component_type {
            Checked::Valid(kind) => kind.0,
            Checked::Invalid => ComponentType::U32,
        };
        let component = type_of_components(accessor);
        let size = n_components(accessor) * component.size();
        let (at, from) = (indices.byte_offset.0, values.byte_offset.0);
        let index_size = of_indices.size();
        let indices = self.in_view(indices.buffer_view, at, index_size, of_indices, count.0)?;
        let values = self.in_view(values.buffer_view, from, size, component, count.0)?;
        let (Some(indices), Some(values)) = (indices, values) else {
            return Err(outside(index));
        };
        let values = Elements {
            normalized: accessor.normalized,
            ..values
        };
        let mut numbers = 0..count.0 as usize;
        if numbers.all(|i| replace(indices.index(i) as usize, &values, i)) {
            Ok(())
        } else {
            Err(outside(index))
        }
    }
}

impl Elements<'_> {
    fn bytes<const N: usize>(&self, element: usize, component: usize) -> [u8; N] {
        let at = element * self.stride + component * N;
        // All elements are within the bytes.
        self.bytes[at..].first_chunk().copied().unwrap_or([0; N])
    }

    /// Returns a component of an element.
    fn number(&self, i: usize, k: usize) -> f32 {
        let (number, largest): (f32, f32) = match self.component {
            ComponentType::F32 => return f32::from_le_bytes(self.bytes(i, k)),
            ComponentType::U32 => return u32::from_le_bytes(self.bytes(i, k)) as f32,
            ComponentType::U8 => (self.bytes::<1>(i, k)[0].into(), u8::MAX.into()),
            ComponentType::U16 => (u16::from_le_bytes(self.bytes(i, k)).into(), u16::MAX.into()),
            ComponentType::I8 => (i8::from_le_bytes(self.bytes(i, k)).into(), i8::MAX.into()),
            ComponentType::I16 => (i16::from_le_bytes(self.bytes(i, k)).into(), i16::MAX.into()),
        };
        if self.normalized {
            f32::max(number / largest, -1.0)
        } else {
            number
        }
    }

    /// Returns the first component of an element as a whole number.
    fn index(&self, i: usize) -> u32 {
        match self.component {
            ComponentType::U8 => self.bytes::<1>(i, 0)[0].into(),
            ComponentType::U16 => u16::from_le_bytes(self.bytes(i, 0)).into(),
            _ => u32::from_le_bytes(self.bytes(i, 0)),
        }
    }
}

fn outside(index: Index<Accessor>) -> FileFault {
    let problem = format!("`accessors[{}]` reaches out of its view", index.value());
    FileFault::new(problem, "an offset and a count within it")
}

/// Returns the type of the components, which was checked before.
fn type_of_components(accessor: &Accessor) -> ComponentType {
    match &accessor.component_type {
        Checked::Valid(kind) => kind.0,
        Checked::Invalid => ComponentType::F32,
    }
}

/// Returns the number of components, whose type was checked before.
fn n_components(accessor: &Accessor) -> usize {
    match &accessor.type_ {
        Checked::Valid(kind) => kind.multiplicity(),
        Checked::Invalid => 1,
    }
}
