//! Hits → groups of points, with a point for each ray that hit.

use super::points::{NO_POINT, PointGroup, Points};
use crate::accel::Hit;
use math::simd::{N_LANES, ascending, grow, lanes_mut};
use world::scene::{Scene, SurfaceClass};

impl Points {
    /// Groups the hits of rays; the points themselves are not computed yet.
    pub(super) fn group(&mut self, scene: &Scene, hits: &[Option<Hit>]) {
        self.has_factors = scene.has_factors;
        self.groups.clear();
        self.missed.clear();
        self.group_of_ray.clear();
        // Count the points of each group.
        let (blocks, rest) = hits.as_chunks::<N_LANES>();
        for (first, block) in (0..).step_by(N_LANES).zip(blocks) {
            // Neighbors often hit surfaces of the same class.
            if let Some(class) = class_of_all(scene, block) {
                let group = self.group_of(class);
                self.groups[group].n += N_LANES;
                let groups = [group as u32; N_LANES];
                self.group_of_ray.extend_from_slice(&groups);
            } else {
                self.group_one_by_one(scene, first, block);
            }
        }
        let first = hits.len() - rest.len();
        self.group_one_by_one(scene, first as u32, rest);
        // Place the points of each group behind one another.
        self.place();
        if scene.instances.is_some() {
            let end = self.end();
            grow(&mut self.instances, end);
        }
    }

    /// Groups the hits of rays from ray `first` on.
    #[inline(always)]
    fn group_one_by_one(&mut self, scene: &Scene, first: u32, hits: &[Option<Hit>]) {
        for (ray, hit) in (first..).zip(hits) {
            let Some(hit) = hit else {
                self.missed.push(ray);
                self.group_of_ray.push(NO_POINT);
                continue;
            };
            let group = self.group_of(scene.class(hit.primitive));
            self.groups[group].n += 1;
            self.group_of_ray.push(group as u32);
        }
    }

    /// Returns the index of the group of a class.
    #[inline(always)]
    fn group_of(&mut self, class: SurfaceClass) -> usize {
        if let Some(&group) = self.group_of_class.get(class.number())
            && let Some(found) = self.groups.get(group as usize)
            && found.class == class
        {
            return group as usize;
        }
        self.add_group(class)
    }

    #[cold]
    fn add_group(&mut self, class: SurfaceClass) -> usize {
        let group = self.groups.len();
        if self.group_of_class.len() <= class.number() {
            self.group_of_class.resize(class.number() + 1, 0);
        }
        self.group_of_class[class.number()] = group as u32;
        self.groups.push(PointGroup {
            class,
            shape: class.shape(),
            attributes: class.attributes(),
            material: class.material(),
            first: 0,
            n: 0,
        });
        group
    }

    /// Gives each hit its place.
    fn place(&mut self) {
        // Start each group at a whole lane.
        let mut n_points: usize = 0;
        for group in &mut self.groups {
            group.first = n_points;
            n_points += group.n.next_multiple_of(N_LANES);
            group.n = 0;
        }
        self.grow(n_points);
        // Give each ray the next place of its group, eight at a time where they agree.
        self.by_ray.clear();
        let group_of_ray = std::mem::take(&mut self.group_of_ray);
        let (blocks, rest) = group_of_ray.as_chunks::<N_LANES>();
        for (first, block) in (0..).step_by(N_LANES).zip(blocks) {
            if *block == [block[0]; N_LANES]
                && let Some(group) = self.groups.get_mut(block[0] as usize)
            {
                let point = group.first + group.n;
                group.n += N_LANES;
                *lanes_mut(&mut self.rays, point) = ascending(first);
                self.by_ray.extend_from_slice(&ascending(point as u32));
            } else {
                self.place_one_by_one(first, block);
            }
        }
        let first = group_of_ray.len() - rest.len();
        self.place_one_by_one(first as u32, rest);
        self.group_of_ray = group_of_ray;
        // Pad each group with copies of its last point.
        for group in &self.groups {
            let end = group.first + group.n;
            let last = self.rays[end - 1];
            self.rays[end..end.next_multiple_of(N_LANES)].fill(last);
        }
    }

    /// Gives the hits of rays their places, from ray `first` on; `groups` are the groups of these
    /// rays.
    #[inline(always)]
    fn place_one_by_one(&mut self, first: u32, groups: &[u32]) {
        for (ray, &group) in (first..).zip(groups) {
            let Some(group) = self.groups.get_mut(group as usize) else {
                self.by_ray.push(NO_POINT);
                continue;
            };
            let point = group.first + group.n;
            group.n += 1;
            self.rays[point] = ray;
            self.by_ray.push(point as u32);
        }
    }
}

/// Returns the class of the surfaces that eight rays hit, if it is the same for all.
#[inline(always)]
fn class_of_all(scene: &Scene, hits: &[Option<Hit>; N_LANES]) -> Option<SurfaceClass> {
    let class = scene.class(hits[0]?.primitive);
    for hit in &hits[1..] {
        if scene.class((*hit)?.primitive) != class {
            return None;
        }
    }
    Some(class)
}
