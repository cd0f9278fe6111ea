//! Gradients in grids.

use glam::{DMat3, DVec3};

use super::super::piece::{Piece, grid_index};

/// Returns the gradient of values at a point of a grid, by differences between its neighbors.
pub(super) fn gradient(piece: &Piece, values: &[f64], size: [usize; 3], point: usize) -> DVec3 {
    let at = grid_index(size, point);
    let strides = [1, size[0], size[0] * size[1]];
    let (mut ways, mut steps) = ([DVec3::ZERO; 3], DVec3::ZERO);
    for axis in 0..3 {
        let before = if at[axis] > 0 {
            point - strides[axis]
        } else {
            point
        };
        let is_last = at[axis] + 1 == size[axis];
        let behind = if is_last {
            point
        } else {
            point + strides[axis]
        };
        let place = |point| piece.position(point).unwrap_or(DVec3::NAN);
        ways[axis] = place(behind) - place(before);
        let [low, high] = [before, behind].map(|point| values[point]);
        steps[axis] = high - low;
    }
    // The scalar products of the gradient with these vectors are the differences.
    let [x, y, z] = ways;
    DMat3::from_cols(x, y, z).transpose().inverse() * steps
}
