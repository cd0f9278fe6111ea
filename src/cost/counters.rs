//! Counters of many pixels at a time.

use super::{Cost, RayKind};

/// What the work on some pixels cost, array by array, an entry a pixel: they go
/// into a film as they are. An entry that would pass 2^32 - 1 stays there; the
/// sums do not.
#[derive(Debug, Clone, Default)]
pub struct Counters {
    node_visits: Vec<u32>,
    primitive_tests: Vec<u32>,
    /// An array a kind, in the order of [`RayKind`].
    rays: [Vec<u32>; 4],
    depth: Vec<u32>,
    /// What had no room in the entries.
    beyond: Cost,
}

impl Counters {
    /// Begins anew with so many pixels, none of which has cost anything.
    pub fn reset(&mut self, n_pixels: usize) {
        for array in self.arrays_mut() {
            array.clear();
            array.resize(n_pixels, 0);
        }
        self.beyond = Cost::default();
    }

    /// BVH nodes entered for each pixel.
    pub fn node_visits(&self) -> &[u32] {
        &self.node_visits
    }

    /// Ray-primitive tests of each pixel.
    pub fn primitive_tests(&self) -> &[u32] {
        &self.primitive_tests
    }

    /// Rays of one kind of each pixel.
    pub fn rays_of(&self, kind: RayKind) -> &[u32] {
        &self.rays[kind as usize]
    }

    /// The longest path of each pixel, in bounces.
    pub fn depth(&self) -> &[u32] {
        &self.depth
    }

    /// What all pixels cost together.
    pub fn total(&self) -> Cost {
        let sum = |array: &[u32]| array.iter().copied().map(u64::from).sum();
        let shown = Cost {
            node_visits: sum(&self.node_visits),
            primitive_tests: sum(&self.primitive_tests),
            rays: std::array::from_fn(|kind| sum(&self.rays[kind])),
            depth: self.depth.iter().copied().max().unwrap_or(0).into(),
        };
        shown.with(self.beyond)
    }

    /// Adds what one pixel cost.
    pub fn add(&mut self, pixel: usize, cost: &Cost) {
        let Self { beyond, .. } = self;
        add(
            &mut self.node_visits[pixel],
            cost.node_visits,
            &mut beyond.node_visits,
        );
        add(
            &mut self.primitive_tests[pixel],
            cost.primitive_tests,
            &mut beyond.primitive_tests,
        );
        for (kind, rays) in self.rays.iter_mut().enumerate() {
            add(&mut rays[pixel], cost.rays[kind], &mut beyond.rays[kind]);
        }
        self.bounce(pixel, u32::try_from(cost.depth).unwrap_or(u32::MAX));
    }

    /// Adds a ray of this kind to each of the pixels, as often as it is there.
    pub(super) fn add_rays(&mut self, kind: RayKind, pixels: &[u32]) {
        let kind = kind as usize;
        let rays = &mut self.rays[kind];
        for &pixel in pixels {
            add(&mut rays[pixel as usize], 1, &mut self.beyond.rays[kind]);
        }
    }

    /// Adds what a ray's way through the hierarchy was.
    #[inline(always)]
    pub(super) fn add_traversal(&mut self, pixel: usize, node_visits: u32, primitive_tests: u32) {
        let Self { beyond, .. } = self;
        let visits = &mut self.node_visits[pixel];
        add(visits, node_visits.into(), &mut beyond.node_visits);
        let tests = &mut self.primitive_tests[pixel];
        add(tests, primitive_tests.into(), &mut beyond.primitive_tests);
    }

    /// A path of the pixel has come to so many bounces.
    #[inline(always)]
    pub(super) fn bounce(&mut self, pixel: usize, depth: u32) {
        let deepest = &mut self.depth[pixel];
        *deepest = depth.max(*deepest);
    }

    fn arrays_mut(&mut self) -> impl Iterator<Item = &mut Vec<u32>> {
        [
            &mut self.node_visits,
            &mut self.primitive_tests,
            &mut self.depth,
        ]
        .into_iter()
        .chain(&mut self.rays)
    }
}

/// Adds to an entry; what it has no room for, to `beyond`.
#[inline(always)]
fn add(entry: &mut u32, amount: u64, beyond: &mut u64) {
    match u32::try_from(u64::from(*entry) + amount) {
        Ok(sum) => *entry = sum,
        Err(_) => add_beyond(entry, amount, beyond),
    }
}

#[cold]
#[inline(never)]
fn add_beyond(entry: &mut u32, amount: u64, beyond: &mut u64) {
    let room = u32::MAX - *entry;
    *entry = u32::MAX;
    *beyond += amount - u64::from(room);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_entry_cannot_hold_is_in_the_total() {
        let most = u64::from(u32::MAX);
        let mut counters = Counters::default();
        counters.reset(2);
        let cost = Cost {
            node_visits: most - 1,
            primitive_tests: 3 * most,
            rays: [most, 1, 0, 0],
            depth: 7,
        };
        counters.add(1, &cost);
        counters.add_traversal(1, 5, 2);
        counters.add_rays(RayKind::Camera, &[0, 1, 1]);
        assert_eq!(counters.node_visits(), [0, u32::MAX]);
        assert_eq!(counters.primitive_tests(), [0, u32::MAX]);
        assert_eq!(counters.rays_of(RayKind::Camera), [1, u32::MAX]);
        assert_eq!(counters.rays_of(RayKind::Shadow), [0, 1]);
        assert_eq!(counters.depth(), [0, 7]);
        let expected = Cost {
            node_visits: most + 4,
            primitive_tests: 3 * most + 2,
            rays: [most + 3, 1, 0, 0],
            depth: 7,
        };
        assert_eq!(counters.total(), expected);
        counters.reset(1);
        assert_eq!(counters.total(), Cost::default());
    }
}
