//! The fit of a linear model.

/// Maximum number of passes over all unknowns.
const MAX_PASSES: usize = 10_000;

/// A relative change of an unknown's term below this counts as converged.
const PRECISION: f64 = 1e-12;

/// Returns the non-negative unknowns for which the sum of `(row · unknowns - value)²` over all rows
/// is least. An unknown whose column is zero is zero.
///
/// By coordinate descent on the normal equations: Franc, Hlaváč and Navara, "Sequential
/// Coordinate-Wise Algorithm for the Non-negative Least Squares Problem", CAIP 2005.
pub fn non_negative_least_squares<const N: usize>(
    rows: impl Iterator<Item = ([f64; N], f64)>,
) -> [f64; N] {
    let (mut products, mut gradient) = ([[0.0; N]; N], [0.0; N]);
    // Sum the normal equations.
    for (row, value) in rows {
        for i in 0..N {
            gradient[i] -= row[i] * value;
            for j in 0..N {
                products[i][j] += row[i] * row[j];
            }
        }
    }
    let tolerance = gradient.map(|slope| slope.abs() * PRECISION);
    let mut unknowns = [0.0_f64; N];
    // Minimize along one coordinate after the other until none changes.
    for _ in 0..MAX_PASSES {
        let mut has_changed = false;
        for i in 0..N {
            if products[i][i] == 0.0 {
                continue;
            }
            let better = (unknowns[i] - gradient[i] / products[i][i]).max(0.0);
            let change = better - unknowns[i];
            unknowns[i] = better;
            has_changed |= (change * products[i][i]).abs() > tolerance[i];
            for j in 0..N {
                gradient[j] += change * products[i][j];
            }
        }
        if !has_changed {
            break;
        }
    }
    unknowns
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The Karush-Kuhn-Tucker conditions: each unknown is zero where the sum would rise with
        /// it, else the sum is stationary in it.
        #[test]
        fn no_unknown_can_improve_the_fit(
            rows in prop::collection::vec((prop::array::uniform4(0.0..9.0), 0.0..9.0), 4..40)
        ) {
            let unknowns = non_negative_least_squares(rows.iter().copied());
            let error = |row: &[f64; 4], value: f64| {
                let fitted: f64 = row.iter().zip(unknowns).map(|(a, x)| a * x).sum();
                fitted - value
            };
            for i in 0..4 {
                let slope: f64 = rows.iter().map(|(row, value)| row[i] * error(row, *value)).sum();
                let scale: f64 = rows.iter().map(|(row, value)| row[i] * value).sum();
                prop_assert!(unknowns[i] >= 0.0);
                prop_assert!(slope >= -1e-6 * scale);
                prop_assert!(unknowns[i] == 0.0 || slope <= 1e-6 * scale);
            }
        }
    }

    #[test]
    fn a_column_of_zeros_has_no_weight() {
        let rows = [([1.0, 0.0], 2.0), ([3.0, 0.0], 6.0)];
        assert_eq!(non_negative_least_squares(rows.into_iter()), [2.0, 0.0]);
        let none: [([f64; 2], f64); 0] = [];
        assert_eq!(non_negative_least_squares(none.into_iter()), [0.0; 2]);
    }
}
