//! The numbers of points and cells of each step, and their offsets.

use hdf5_metno::{Group, H5Type};
use ndarray::{ArrayView, Dimension, arr2, aview1};

/// The sizes of a step; all zero for an image.
#[derive(Clone, Copy, Default)]
pub(super) struct StepSize {
    pub(super) n_points: i64,
    pub(super) n_cells: i64,
    /// Number of point ids in all cells.
    pub(super) n_ids: i64,
}

/// Writes the sizes of grids, each of one piece.
pub(super) fn write_sizes(root: &Group, steps: &[StepSize]) -> hdf5_metno::Result<()> {
    let of = |size: fn(&StepSize) -> i64| steps.iter().map(size).collect::<Vec<i64>>();
    write_list(root, "NumberOfPoints", &of(|step| step.n_points))?;
    write_list(root, "NumberOfCells", &of(|step| step.n_cells))?;
    write_list(root, "NumberOfConnectivityIds", &of(|step| step.n_ids))
}

/// Creates the group of time steps at these times.
pub(super) fn write_times(root: &Group, times: &[f64]) -> hdf5_metno::Result<Group> {
    let group = root.create_group("Steps")?;
    let n_steps = group.new_attr::<i64>().create("NSteps")?;
    n_steps.write_scalar(&(times.len() as i64))?;
    write_list(&group, "Values", times)?;
    Ok(group)
}

/// Writes the start of each part of grids at each time.
pub(super) fn write_offsets(group: &Group, steps: &[StepSize]) -> hdf5_metno::Result<()> {
    let points = begins(steps, |step| step.n_points);
    let cells = begins(steps, |step| step.n_cells);
    let ids = begins(steps, |step| step.n_ids);
    write_list(group, "PartOffsets", &begins(steps, |_| 1))?;
    write_list(group, "NumberOfParts", &vec![1_i64; steps.len()])?;
    write_list(group, "PointOffsets", &points)?;
    table(group, "CellOffsets", &columns(&cells))?;
    table(group, "ConnectivityIdOffsets", &columns(&ids))
}

/// Writes the start of the values of these point arrays at each time.
pub(super) fn write_point_offsets(
    group: &Group,
    names: &[String],
    begins: &[i64],
) -> hdf5_metno::Result<()> {
    let offsets = group.create_group("PointDataOffsets")?;
    let mut names = names.iter();
    names.try_for_each(|name| write_list(&offsets, name, begins))
}

/// Returns the sum of the sizes of the steps before each step.
pub(super) fn begins(steps: &[StepSize], size: impl Fn(&StepSize) -> i64) -> Vec<i64> {
    let begin = |next: &mut i64, step: &StepSize| {
        let begin = *next;
        *next += size(step);
        Some(begin)
    };
    steps.iter().scan(0, begin).collect()
}

fn columns(numbers: &[i64]) -> Vec<[i64; 1]> {
    numbers.iter().map(|&n| [n]).collect()
}

/// Writes a list of numbers or texts.
pub(super) fn write_list<T: H5Type>(
    group: &Group,
    name: &str,
    numbers: &[T],
) -> hdf5_metno::Result<()> {
    write_untimed(group, name, aview1(numbers))
}

/// Writes a table.
pub(super) fn table<const N: usize>(
    group: &Group,
    name: &str,
    rows: &[[i64; N]],
) -> hdf5_metno::Result<()> {
    write_untimed(group, name, arr2(rows).view())
}

/// Writes a dataset without its creation time, so that equal runs write equal bytes.
fn write_untimed<T: H5Type, D: Dimension>(
    group: &Group,
    name: &str,
    values: ArrayView<T, D>,
) -> hdf5_metno::Result<()> {
    let builder = group.new_dataset_builder().with_data(values);
    let builder = builder.with_dcpl(|plist| plist.obj_track_times(false));
    builder.create(name).map(|_| ())
}
