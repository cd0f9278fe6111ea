//! A Hilbert curve over any rectangle.
//!
//! After Jakub Červený's `gilbert`, "a generalized Hilbert space-filling curve
//! for rectangular domains of arbitrary sizes" (github.com/jakubcerveny/gilbert):
//! a rectangle is cut into two or three, each with a curve of its own whose end
//! meets the next one's begin.

use glam::IVec2;

/// Every place (column, row) of a grid once, each beside the one before; at
/// most one step goes to a diagonal neighbour, where the longer side is odd and
/// the shorter one even.
pub fn hilbert_curve(n_columns: u32, n_rows: u32) -> Vec<(u32, u32)> {
    let mut places = Vec::with_capacity(n_columns as usize * n_rows as usize);
    let along_x = IVec2::new(n_columns as i32, 0);
    let along_y = IVec2::new(0, n_rows as i32);
    match n_columns >= n_rows {
        true => walk(IVec2::ZERO, along_x, along_y, &mut places),
        false => walk(IVec2::ZERO, along_y, along_x, &mut places),
    }
    places
}

/// Walks the rectangle at the corner `from`, spanned by two vectors along the
/// axes: the curve ends at the far end of `major`.
fn walk(from: IVec2, major: IVec2, minor: IVec2, places: &mut Vec<(u32, u32)>) {
    let [length, breadth] = [major, minor].map(|side| side.abs().element_sum());
    let [forth, aside] = [major.signum(), minor.signum()];
    if length == 1 || breadth == 1 {
        let (step, n) = match breadth {
            1 => (forth, length),
            _ => (aside, breadth),
        };
        places.extend((0..n).map(|i| {
            let place = from + i * step;
            (place.x as u32, place.y as u32)
        }));
        return;
    }
    if 2 * length > 3 * breadth {
        // A long one: two, one after the other.
        let first = half(major, forth);
        walk(from, first, minor, places);
        walk(from + first, major - first, minor, places);
        return;
    }
    // Up, along, and down again.
    let up = half(minor, aside);
    let along = major.div_euclid(IVec2::splat(2));
    walk(from, up, along, places);
    walk(from + up, major, minor - up, places);
    let corner = from + (major - forth) + (up - aside);
    walk(corner, -up, along - major, places);
}

/// About half of a side, an even number of steps where it can be: the curve of
/// an even side ends where the next one begins.
fn half(side: IVec2, step: IVec2) -> IVec2 {
    let half = side.div_euclid(IVec2::splat(2));
    let is_odd = half.element_sum() % 2 != 0;
    match is_odd && side.abs().element_sum() > 2 {
        true => half + step,
        false => half,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_visits_every_place_once_and_goes_from_neighbour_to_neighbour() {
        for (n_columns, n_rows) in (1..=24).flat_map(|x| (1..=24).map(move |y| (x, y))) {
            let places = hilbert_curve(n_columns, n_rows);
            let mut sorted: Vec<u32> = places.iter().map(|(x, y)| y * n_columns + x).collect();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..n_columns * n_rows));
            let steps = places
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
    fn a_square_of_a_power_of_two_is_the_curve_of_hilbert() {
        let first = [(0, 0), (0, 1), (1, 1), (1, 0)];
        assert_eq!(hilbert_curve(2, 2), first);
        // Each quarter is walked through before the next.
        let quarters = hilbert_curve(16, 16);
        for quarter in quarters.chunks(64) {
            let (x, y) = (quarter[0].0 / 8, quarter[0].1 / 8);
            assert!(
                quarter
                    .iter()
                    .all(|place| (place.0 / 8, place.1 / 8) == (x, y))
            );
        }
    }
}
