//! Eight vectors of three.

use std::ops::{Add, Mul, Sub};

use glam::Vec3;

use super::{InstructionSet, Lanes, N_LANES};

/// Eight points or vectors, with the operations of [`Vec3`] to the last bit.
#[derive(Clone, Copy)]
pub(in crate::accel) struct Vec3Lanes<L> {
    pub(in crate::accel) x: L,
    pub(in crate::accel) y: L,
    pub(in crate::accel) z: L,
}

impl<L: Lanes> Vec3Lanes<L> {
    /// The same vector in all lanes.
    #[inline(always)]
    pub(in crate::accel) fn splat<I: InstructionSet<Lanes = L>>(set: I, v: Vec3) -> Self {
        Self {
            x: set.splat(v.x),
            y: set.splat(v.y),
            z: set.splat(v.z),
        }
    }

    /// The coordinates, lane by lane.
    #[inline(always)]
    pub(in crate::accel) fn to_arrays(self) -> [[f32; N_LANES]; 3] {
        [self.x.to_array(), self.y.to_array(), self.z.to_array()]
    }

    #[inline(always)]
    pub(in crate::accel) fn dot(self, other: Self) -> L {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
}

impl<L: Lanes> Add for Vec3Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl<L: Lanes> Sub for Vec3Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

/// By one factor a lane.
impl<L: Lanes> Mul<L> for Vec3Lanes<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: L) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}
