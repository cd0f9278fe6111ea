//! Kinds of ray queries, and their hits.

use math::simd::{Lanes, N_LANES, Vector, grow, lanes_mut};
use world::geometry::{Ray, RayStream};
use world::scene::{InstanceId, ObjectId, PlacedPrimitive};

/// A ray's hit on a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, greater than 0.
    pub t: f32,
    /// Index of the primitive in the scene.
    pub primitive: u32,
    /// The instance, for a primitive of an instanced mesh.
    pub instance: Option<InstanceId>,
}

impl Hit {
    /// Returns the primitive that was hit.
    #[inline]
    pub fn placed(&self) -> PlacedPrimitive {
        PlacedPrimitive {
            primitive: self.primitive,
            instance: self.instance,
        }
    }
}

/// A ray to be tested for occlusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowRay {
    /// The ray, whose direction is a unit vector.
    pub ray: Ray,
    /// Only hits with `t` in (0, `t_max`) count.
    pub t_max: f32,
    /// An object whose hits do not count.
    pub ignored: Option<ObjectId>,
}

/// Rays to be tested for occlusion, as a structure of arrays.
#[derive(Debug, Clone, Default)]
pub struct ShadowStream {
    /// The rays.
    pub(super) rays: RayStream,
    /// The `t_max` of each ray, padded to whole lanes.
    pub(super) t_max: Vec<f32>,
    /// The object that each ray ignores; empty if none ignores any.
    pub ignored: Vec<Option<ObjectId>>,
}

impl ShadowStream {
    /// Returns the rays.
    #[inline]
    pub fn rays(&self) -> &RayStream {
        &self.rays
    }

    /// Returns the parameter before which hits count for ray `i`.
    #[inline]
    pub fn t_max(&self, i: usize) -> f32 {
        self.t_max[i]
    }

    /// Returns the number of rays.
    #[inline]
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Returns true if there are no rays.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Removes all rays.
    #[inline]
    pub fn clear(&mut self) {
        self.rays.clear();
        self.ignored.clear();
    }

    /// Adds the rays of the lanes of `mask`, which end at `t_max`. The objects that they ignore, if
    /// any, are added separately.
    #[inline(always)]
    pub(crate) fn push_lanes<L: Lanes>(
        &mut self,
        origin: Vector<L>,
        direction: Vector<L>,
        t_max: L,
        mask: L::Mask,
    ) {
        let first = self.rays.len();
        self.rays.reserve(N_LANES);
        self.rays.push_lanes(origin, direction, mask);
        grow(&mut self.t_max, first + N_LANES);
        *lanes_mut(&mut self.t_max, first) = t_max.compress(mask).to_array();
    }

    /// Returns the object that ray `i` ignores.
    #[inline(always)]
    pub(super) fn ignored(&self, i: usize) -> Option<ObjectId> {
        self.ignored.get(i).copied().flatten()
    }

    /// Returns ray `i`.
    #[inline]
    pub fn get(&self, i: usize) -> ShadowRay {
        ShadowRay {
            ray: self.rays.get(i),
            t_max: self.t_max[i],
            ignored: self.ignored(i),
        }
    }

    /// Returns all rays.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = ShadowRay> {
        (0..self.len()).map(|i| self.get(i))
    }
}

impl FromIterator<ShadowRay> for ShadowStream {
    fn from_iter<T: IntoIterator<Item = ShadowRay>>(rays: T) -> Self {
        let mut stream = Self::default();
        for shadow in rays {
            stream.rays.push(shadow.ray);
            stream.t_max.push(shadow.t_max);
            stream.ignored.push(shadow.ignored);
        }
        stream
    }
}
