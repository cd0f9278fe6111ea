//! A Hilbert curve for rectangles of any size.
//!
//! After Jakub Červený's `gilbert`, "a generalized Hilbert space-filling curve for rectangular
//! domains of arbitrary sizes" (github.com/jakubcerveny/gilbert): a rectangle is divided into two
//! or three, each with a curve that ends where the next one starts.

use glam::IVec2;

/// Returns each cell (column, row) of a grid once, each adjacent to the one before. At most one
/// step is diagonal, if the longer side is odd and the shorter one even.
pub fn hilbert_curve(n_columns: u32, n_rows: u32) -> Vec<(u32, u32)> {
    let mut cells = Vec::with_capacity(n_columns as usize * n_rows as usize);
    let along_x = IVec2::new(n_columns as i32, 0);
    let along_y = IVec2::new(0, n_rows as i32);
    if n_columns >= n_rows {
        walk(IVec2::ZERO, along_x, along_y, &mut cells);
    } else {
        walk(IVec2::ZERO, along_y, along_x, &mut cells);
    }
    cells
}

/// Adds the curve over the rectangle from the corner `from`, spanned by two vectors along the axes.
/// The curve ends at the far end of `major`.
fn walk(from: IVec2, major: IVec2, minor: IVec2, cells: &mut Vec<(u32, u32)>) {
    let [length, breadth] = [major, minor].map(|side| side.abs().element_sum());
    let [major_step, minor_step] = [major.signum(), minor.signum()];
    if length == 1 || breadth == 1 {
        let (step, n) = match breadth {
            1 => (major_step, length),
            _ => (minor_step, breadth),
        };
        cells.extend((0..n).map(|i| {
            let cell = from + i * step;
            (cell.x as u32, cell.y as u32)
        }));
        return;
    }
    if 2 * length > 3 * breadth {
        // A long rectangle: two parts along `major`.
        let first = half(major, major_step);
        walk(from, first, minor, cells);
        walk(from + first, major - first, minor, cells);
        return;
    }
    // Up, along, and down again.
    let up = half(minor, minor_step);
    let along = major.div_euclid(IVec2::splat(2));
    walk(from, up, along, cells);
    walk(from + up, major, minor - up, cells);
    let corner = from + (major - major_step) + (up - minor_step);
    walk(corner, -up, along - major, cells);
}

/// Returns about half of a side, an even number of steps if possible: the curve along an even side
/// ends where the next one starts.
fn half(side: IVec2, step: IVec2) -> IVec2 {
    let half = side.div_euclid(IVec2::splat(2));
    let is_odd = half.element_sum() % 2 != 0;
    if is_odd && side.abs().element_sum() > 2 {
        half + step
    } else {
        half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_visits_every_cell_once_and_steps_to_adjacent_cells() {
        for (n_columns, n_rows) in (1..=24).flat_map(|x| (1..=24).map(move |y| (x, y))) {
            let cells = hilbert_curve(n_columns, n_rows);
            let mut sorted: Vec<u32> = cells.iter().map(|(x, y)| y * n_columns + x).collect();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..n_columns * n_rows));
            let steps = cells
                .windows(2)
                .map(|pair| [pair[0].0.abs_diff(pair[1].0), pair[0].1.abs_diff(pair[1].1)]);
            let is_odd = n_columns.max(n_rows) % 2 == 1 && n_columns.min(n_rows) % 2 == 0;
            let diagonals = steps.filter(|step| *step != [1, 0] && *step != [0, 1]);
            let diagonals: Vec<_> = diagonals.collect();
            assert!(
                diagonals.len() <= usize::from(is_odd),
                "{n_columns} x {n_rows}"
            );
            assert!(diagonals.iter().all(|step| *step == [1, 1]));
        }
    }

    #[test]
    fn on_a_square_of_a_power_of_two_it_is_the_hilbert_curve() {
        let first = [(0, 0), (0, 1), (1, 1), (1, 0)];
        assert_eq!(hilbert_curve(2, 2), first);
        // It finishes each quarter before the next.
        let quarters = hilbert_curve(16, 16);
        for quarter in quarters.chunks(64) {
            let (x, y) = (quarter[0].0 / 8, quarter[0].1 / 8);
            assert!(
                quarter
                    .iter()
                    .all(|cell| (cell.0 / 8, cell.1 / 8) == (x, y))
            );
        }
    }
}
