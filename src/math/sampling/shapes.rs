//! Warps the unit square to shapes of the plane, with uniform density, and to directions.

use crate::simd::{Real, cos_sin, cos_sin_of_eighths};

/// Maps to the disk of radius 1, by the concentric map of Shirley and Chiu, "A Low Distortion Map
/// Between Disk and Square", JGT 2(3), 1997.
#[inline(always)]
pub fn disk<R: Real>([u, v]: [R; 2]) -> [R; 2] {
    let (one, two) = (u.splat(1.0), u.splat(2.0));
    let (x, y) = (two * u - one, two * v - one);
    let is_wide = y.abs().lt(x.abs());
    let (radius, other) = (R::select(is_wide, x, y), R::select(is_wide, y, x));
    let is_center = radius.equals(u.splat(0.0));
    let [cos, sin] = cos_sin_of_eighths(other / R::select(is_center, one, radius));
    let (along, across) = (radius * cos, radius * sin);
    [
        R::select(is_wide, along, across),
        R::select(is_wide, across, along),
    ]
}

/// Maps to a unit vector above the xy plane, with a density proportional to the cosine of its angle
/// with the z axis, by Malley's method.
#[inline(always)]
pub fn hemisphere<R: Real>(numbers: [R; 2]) -> [R; 3] {
    let [x, y] = disk(numbers);
    let (zero, one) = (x.splat(0.0), x.splat(1.0));
    [x, y, (one - x * x - y * y).max(zero).sqrt()]
}

/// A regular polygon with its corners on the circle of radius 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polygon {
    n: f32,
    /// The angle of the first corner, in turns.
    first: f32,
    /// The cosine and the sine of the angle between two corners.
    step: [f32; 2],
}

impl Polygon {
    /// Creates a polygon of `n` corners, at least 3; the first one is at this angle in turns,
    /// counterclockwise from the x axis.
    pub fn new(n: u32, first: f32) -> Self {
        Self {
            n: n as f32,
            first,
            step: cos_sin(1.0 / n as f32),
        }
    }

    /// Maps to the polygon: `u` selects one of the triangles around the center.
    #[inline(always)]
    pub fn point<R: Real>(&self, [u, v]: [R; 2]) -> [R; 2] {
        let scaled = u * u.splat(self.n);
        let corner = scaled.floor();
        let along = scaled - corner;
        let [x, y] = cos_sin(u.splat(self.first) + corner / u.splat(self.n));
        let [cos, sin] = self.step;
        let (cos, sin) = (u.splat(cos), u.splat(sin));
        let next = [x * cos - y * sin, x * sin + y * cos];
        let radius = v.sqrt();
        let (of_next, of_first) = (radius * along, radius * (u.splat(1.0) - along));
        [
            x * of_first + next[0] * of_next,
            y * of_first + next[1] * of_next,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points of a grid in the unit square.
    fn grid(n: u32) -> impl Iterator<Item = [f32; 2]> {
        let at = move |i| (i as f32 + 0.5) / n as f32;
        (0..n).flat_map(move |i| (0..n).map(move |j| [at(i), at(j)]))
    }

    /// Checks that, in each of 20 x 20 cells entirely inside a shape of this area, the share of
    /// points equals the cell's share of the area.
    fn check_density(points: &[[f32; 2]], area: f32, is_inside: impl Fn([f32; 2]) -> bool) {
        let mut counts = [[0; 20]; 20];
        for &[x, y] in points {
            assert!(is_inside([0.9999 * x, 0.9999 * y]), "{x}, {y}");
            counts[((x + 1.0) * 10.0) as usize % 20][((y + 1.0) * 10.0) as usize % 20] += 1;
        }
        let expected = points.len() as f32 * 0.01 / area;
        let mut n_cells = 0;
        for (i, row) in counts.iter().enumerate() {
            for (j, &n) in row.iter().enumerate() {
                let corner = |di, dj| [(i + di) as f32 / 10.0 - 1.0, (j + dj) as f32 / 10.0 - 1.0];
                let corners = [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)];
                if corners.into_iter().all(&is_inside) {
                    n_cells += 1;
                    assert!(
                        (n as f32 / expected - 1.0).abs() < 0.05,
                        "{i} {j}: {n}, {expected}"
                    );
                }
            }
        }
        assert!(n_cells > 80);
    }

    #[test]
    fn points_of_the_disk_are_uniform() {
        let points: Vec<_> = grid(600).map(disk::<f32>).collect();
        check_density(&points, std::f32::consts::PI, |[x, y]| x.hypot(y) <= 1.0);
        assert_eq!(disk([0.5_f32, 0.5]), [0.0, 0.0]);
    }

    #[test]
    fn points_of_polygons_are_uniform() {
        for (n, first) in [(3, 0.25), (5, 0.1), (6, 0.0), (8, -0.3)] {
            let polygon = Polygon::new(n, first);
            let points: Vec<_> = grid(900).map(|uv| polygon.point::<f32>(uv)).collect();
            let turn = std::f32::consts::TAU / n as f32;
            let is_inside = |[x, y]: [f32; 2]| {
                let middle = |i: u32| std::f32::consts::TAU * first + (i as f32 + 0.5) * turn;
                (0..n).all(|i| x * middle(i).cos() + y * middle(i).sin() <= (0.5 * turn).cos())
            };
            check_density(&points, 0.5 * n as f32 * turn.sin(), is_inside);
        }
    }
}
