//! The owned part of the BVH, without the primitives that it borrows.

use std::sync::Arc;

use super::BuildReport;
use super::build::TooLarge;
use super::bvh::Bvh;
use super::level::{self, SearchLevel};
use super::statistics::BvhStatistics;
use crate::accel::Acceleration;
use world::scene::{InstanceId, Instances, World};

/// The index of an acceleration structure.
#[derive(Debug, PartialEq)]
pub struct AccelIndex {
    pub(super) upper: SearchLevel,
    /// The structures of instanced meshes.
    pub(super) lower: Vec<Arc<SearchLevel>>,
    /// The ID of the first node of each of these structures.
    pub(super) first_ids: Vec<u32>,
    /// True if this index was refitted from another one.
    pub(super) is_refitted: bool,
}

impl AccelIndex {
    /// Builds the index over these primitives; keeps the structures of those `meshes` that have not
    /// changed. Calls `report` with each finished share of the build, from any thread; the shares
    /// add up to at most 1.
    ///
    /// # Errors
    /// If the hierarchy is larger than 8 GiB.
    pub(super) fn build(
        world: World,
        kind: Acceleration,
        meshes: &[Arc<SearchLevel>],
        report: BuildReport,
    ) -> Result<Self, TooLarge> {
        let n_all = world.primitives.len() as f64;
        let build = |primitives: &[_]| {
            let share = primitives.len() as f64 / n_all;
            SearchLevel::build(primitives, kind, |part| report(share * part))
        };
        let of_mesh = |(number, triangles): (usize, &[_])| {
            let kept = meshes.get(number);
            match kept.filter(|level| level.is_of_triangles(triangles)) {
                Some(level) => Ok(Arc::clone(level)),
                None => build(triangles).map(Arc::new),
            }
        };
        let upper = build(world.upper_level())?;
        let of_world = world.instances.into_iter().flat_map(Instances::meshes);
        let triangles = of_world.map(|mesh| &world.primitives[mesh.range()]);
        let lower = triangles.enumerate().map(of_mesh);
        let lower = lower.collect::<Result<Vec<_>, TooLarge>>()?;
        Ok(Self {
            first_ids: level::first_ids(&upper, &lower)?,
            upper,
            lower,
            is_refitted: false,
        })
    }

    /// Returns the index refitted to primitives that have moved, with the structures of meshes that
    /// have not changed, or `None` if their number or kinds differ, or if there is no hierarchy.
    pub(super) fn refitted(&self, world: World) -> Option<Self> {
        let upper = self.upper.refitted(world.upper_level())?;
        let meshes = world.instances.map_or(&[][..], Instances::meshes);
        if meshes.len() != self.lower.len() {
            return None;
        }
        let lower = self.lower.iter().zip(meshes).map(|(level, mesh)| {
            let triangles = &world.primitives[mesh.range()];
            if level.is_of_triangles(triangles) {
                return Some(Arc::clone(level));
            }
            level.refitted(triangles).map(Arc::new)
        });
        Some(Self {
            lower: lower.collect::<Option<_>>()?,
            upper,
            // The nodes are the same.
            first_ids: self.first_ids.clone(),
            is_refitted: true,
        })
    }

    /// Returns the size and expected cost of the hierarchy, including the hierarchies of instanced
    /// meshes; `None` for brute force.
    pub fn statistics(&self) -> Option<BvhStatistics> {
        let upper = self.upper.bvh.as_ref()?.statistics();
        let lower = self.lower.iter().filter_map(|level| level.bvh.as_ref());
        let both = upper.with_lower(lower.map(Bvh::statistics));
        Some(BvhStatistics {
            is_refitted: self.is_refitted,
            ..both
        })
    }

    /// Returns the expected number of node visits and primitive tests of a ray through the root's
    /// box, by the surface area heuristic, in both levels; 0 without a hierarchy.
    pub(super) fn sah_cost(&self, world: World) -> f64 {
        let of_level = |level: &SearchLevel| {
            let bvh = level.bvh.as_ref();
            bvh.map_or(0.0, |bvh| f64::from(bvh.statistics().sah_cost))
        };
        let upper = of_level(&self.upper);
        let Some(instances) = world.instances else {
            return upper;
        };
        let of_meshes: Vec<f64> = self.lower.iter().map(|level| of_level(level)).collect();
        let area =
            |primitive: usize| f64::from(world.primitives[primitive].bounds().surface_area());
        let ids = (0..instances.n_instances() as u32).map(InstanceId);
        let within: f64 = ids
            .map(|id| {
                let mesh = instances.get(id).mesh as usize;
                area(instances.box_of(id) as usize) * of_meshes[mesh]
            })
            .sum();
        let root = self.upper.bvh.as_ref().map_or(0.0, Bvh::surface_area);
        upper + within / root.max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use scene::build::Geometries;
    use scene::config::Config;
    use scene::yaml;
    use world::scene::Scene;

    /// Returns a scene with two instances of a mesh, one of which moves.
    fn scene(x: f32) -> Scene {
        let text = format!(
            "image: {{ width: 1, height: 1 }}\n\
             camera: {{ look_at: {{ eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
             materials: {{ m: {{ color: 1 }} }}\nlights: []\nobjects:\n\
             - instances: {{ mesh: {{ file: mesh.obj }}, places: [[{{ scale: 1 }}], [{{ translate: [{x}, 9, 0] }}]] }}\n  \
               material: m\n"
        );
        let mut config: Config = yaml::from_str(&text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
        std::fs::write(folder.path().join("mesh.obj"), mesh).unwrap();
        let geometries = Geometries::read(&mut config, folder.path(), u64::MAX).unwrap();
        scene::build::scene(&config, geometries).unwrap()
    }

    #[test]
    fn meshes_that_have_not_changed_are_kept() {
        let [first, moved] = [0.0, 3.0].map(scene);
        let kind = Acceleration::default();
        let build = |scene: &Scene, meshes: &[Arc<SearchLevel>]| {
            AccelIndex::build(scene.world(), kind, meshes, &|_| {}).unwrap()
        };
        let first = build(&first, &[]);
        let kept = build(&moved, &first.lower);
        let refitted = first.refitted(moved.world()).unwrap();
        assert!(Arc::ptr_eq(&first.lower[0], &kept.lower[0]));
        assert!(Arc::ptr_eq(&first.lower[0], &refitted.lower[0]));
        assert!(kept == build(&moved, &[]));
    }
}
