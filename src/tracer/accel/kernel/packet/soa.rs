//! Rays of a packet as a structure of arrays, and the selection of coherent ones.

use glam::Vec3;

use crate::accel::kernel::block::LaneArray;
use math::simd::{self, Arithmetic, InstructionSet, Lanes, Mask, N_LANES, Vector};
use world::geometry::{Ray, RayStream, Shear, dominant_axis};

/// Cosine of the largest angle, 11 degrees, between the first ray of a packet and another.
const MIN_COSINE: f32 = 0.98;

/// Number of eight-lane registers that hold one number of each ray of a packet.
pub(super) const N_HALVES: usize = 2;

/// Number of rays of a packet.
pub(super) const N_RAYS: usize = N_HALVES * N_LANES;

/// A value for each ray of a packet.
pub(super) type PerRay<T> = [[T; N_LANES]; N_HALVES];

/// Returns the number of rays of a packet in one register.
#[inline(always)]
pub(super) const fn rays_per_part<I: InstructionSet>() -> usize {
    N_RAYS / <I::Wide as simd::Wide>::N_PARTS
}

/// Returns the active rays of a part: bit `i` for its ray `i`.
#[inline(always)]
pub(super) fn active_in_part<I: InstructionSet>(active: u16, part: usize) -> u16 {
    active >> (rays_per_part::<I>() * part) & (u16::MAX >> (N_RAYS - rays_per_part::<I>()))
}

/// The rays of a packet as a structure of arrays: x, y and z.
pub(super) struct RaySoa {
    pub(super) origins: [PerRay<f32>; 3],
    pub(super) directions: [PerRay<f32>; 3],
}

impl RaySoa {
    /// Memory for rays.
    pub(super) const EMPTY: Self = Self {
        origins: [[[0.0; N_LANES]; N_HALVES]; 3],
        directions: [[[0.0; N_LANES]; N_HALVES]; 3],
    };

    /// Loads the rays from index `first` on.
    #[inline(always)]
    pub(super) fn fill(&mut self, rays: &RayStream, first: usize) {
        for half in 0..N_HALVES {
            let [origins, directions] = rays.lanes(first + N_LANES * half);
            for axis in 0..3 {
                self.origins[axis][half] = *origins[axis];
                self.directions[axis][half] = *directions[axis];
            }
        }
    }

    /// Returns one of the rays.
    #[inline(always)]
    pub(super) fn ray(&self, ray: usize) -> Ray {
        Ray {
            origin: at(&self.origins, ray),
            direction: at(&self.directions, ray),
        }
    }

    /// Returns the rays, as bits, that are coherent with the first: in the same octant, with the
    /// same dominant axis, and at a small angle.
    #[inline(always)]
    pub(super) fn coherent_with_first<I: InstructionSet>(&self, set: I) -> u16 {
        let first = self.ray(0).direction;
        let axis = Shear::along(first).axes[2];
        let [x, y, z] = &self.directions;
        u16::from_le_bytes([
            coherent_lanes(set, [&x[0], &y[0], &z[0]], first, axis),
            coherent_lanes(set, [&x[1], &y[1], &z[1]], first, axis),
        ])
    }

    /// Replaces other rays by the first one.
    #[inline(always)]
    pub(super) fn replace_by_first(&mut self, mut others: u16) {
        while others != 0 {
            let ray = others.trailing_zeros() as usize % N_RAYS;
            others &= others - 1;
            for soa in [&mut self.origins, &mut self.directions] {
                for numbers in soa {
                    numbers[ray / N_LANES][ray % N_LANES] = numbers[0][0];
                }
            }
        }
    }
}

/// Returns the vector of a ray.
#[inline(always)]
pub(super) fn at([x, y, z]: &[PerRay<f32>; 3], ray: usize) -> Vec3 {
    let (half, lane) = (ray / N_LANES % N_HALVES, ray % N_LANES);
    Vec3::new(x[half][lane], y[half][lane], z[half][lane])
}

/// Returns the directions, as bits, that are coherent with the first one, whose dominant axis is
/// given.
#[inline(always)]
fn coherent_lanes<I: InstructionSet>(
    set: I,
    [x, y, z]: [&LaneArray; 3],
    first: Vec3,
    axis: usize,
) -> u8 {
    let (x, y, z) = (set.load(x), set.load(y), set.load(z));
    let (first_x, first_y, first_z) = (set.splat(first.x), set.splat(first.y), set.splat(first.z));
    // Compare the octants by the signs of the components.
    let other_octant = x.flip_sign_by(first_x).signs()
        | y.flip_sign_by(first_y).signs()
        | z.flip_sign_by(first_z).signs();
    // Compare the angle with the first ray.
    let cosine = x * first_x + y * first_y + z * first_z;
    let is_near = set.splat(MIN_COSINE).le(cosine).bits();
    // Compare the dominant axes.
    let (is_y, is_z) = dominant_axis(Vector { x, y, z });
    let (is_y, is_z) = (is_y.bits(), is_z.bits());
    let same_axis = match axis {
        0 => !is_y & !is_z,
        1 => is_y & !is_z,
        _ => is_z,
    };
    !other_octant & is_near & same_axis
}

/// Guesses from a few of these rays if enough of them are coherent.
#[inline(always)]
pub(super) fn may_be_coherent(rays: &RayStream, first: usize) -> bool {
    let n_near = usize::from(are_near(rays, first, first + 4))
        + usize::from(are_near(rays, first, first + 9))
        + usize::from(are_near(rays, first, first + 15));
    n_near >= 2
}

/// Returns true if the angle between two rays is small.
#[inline(always)]
fn are_near(rays: &RayStream, i: usize, j: usize) -> bool {
    rays.get(i).direction.dot(rays.get(j).direction) >= MIN_COSINE
}
