//! Launches of kernels on a device.

use std::time::Instant;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Cost, RaysByBounce};

/// The cost of a launch of a kernel on a device.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DeviceLaunch {
    /// The time of the kernel in nanoseconds.
    pub ns: f64,
    /// Number of rays that the device traced in lockstep, one after the other in the order of the
    /// launch; `None` if it does not say.
    pub warp_size: Option<usize>,
}

/// The color and the cost of a path that a device has followed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FollowedPath {
    /// The radiance of the sample: linear light.
    pub color: Vec3,
    /// The counters; of the rays without the camera ray.
    pub cost: Cost,
    /// Number of rays by bounce, without the camera ray.
    pub bounces: RaysByBounce,
    /// Cycles of the device's clock from the start of the path to its end, at most 2^32 - 1; `None`
    /// if it does not have one.
    pub cycles: Option<u32>,
    /// Number of the multiprocessor that followed it; `None` if the device does not say.
    pub sm: Option<u32>,
}

/// The device that a picture was rendered on.
#[derive(Debug, Clone, PartialEq)]
pub struct UsedDevice {
    /// Its name and its driver's.
    pub name: String,
    /// The launches, by kernel.
    pub kernels: Vec<KernelWork>,
    /// Times at which each multiprocessor followed paths; empty if the device does not say. Runs of one
    /// multiprocessor do not overlap.
    pub multiprocessors: Vec<MultiprocessorRun>,
    /// The part of the scene because of which the processor shades; `None` if the device follows
    /// whole paths.
    pub processor_shades_because_of: Option<String>,
}

/// Paths that one multiprocessor followed without a pause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MultiprocessorRun {
    /// The number of the multiprocessor.
    pub number: u32,
    /// Number of paths.
    pub paths: u64,
    /// The start of the first path.
    pub begin: Instant,
    /// The end of the last path.
    pub end: Instant,
}

/// The launches of one kernel on a device.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct KernelWork {
    /// The name of the kernel.
    pub name: String,
    /// Number of launches.
    pub launches: u64,
    /// Number of rays of all launches; of a kernel that follows whole paths, of their camera rays.
    pub rays: u64,
    /// The time of all launches, by the device's clock, in seconds.
    pub seconds: f64,
    /// Number of rays that share a work-group.
    pub group_size: usize,
    /// Number of rays that the device traces in lockstep: its sub-group; left out if it does not
    /// say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warp_size: Option<usize>,
    /// Bytes of memory that each ray has to itself beyond registers; left out if the device does
    /// not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub private_bytes: Option<u64>,
    /// Registers of 32 bits that each ray has; left out if the device does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub registers: Option<usize>,
    /// The share of a compute unit's warps that the kernel can fill, 0 to 1, by its registers and
    /// memory; left out if the device does not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub occupancy: Option<f64>,
    /// Node visits and primitive tests of all rays.
    #[serde(default)]
    pub steps: u64,
    /// Steps of all lanes of the warps, the idle ones included: the warp size times the greatest
    /// number of steps of a ray, summed over the warps of all launches; 0 without a warp size.
    #[serde(default)]
    pub lane_steps: u64,
}

impl KernelWork {
    /// Adds a launch, given the steps of each ray in the order of the launch. Its warp size is the
    /// kernel's.
    pub fn add(&mut self, ns: f64, steps: impl Iterator<Item = u64>) -> DeviceLaunch {
        self.launches += 1;
        self.seconds += ns / 1e9;
        let warp_size = self.warp_size.unwrap_or(0);
        let (mut n, mut most) = (0, 0);
        for steps in steps {
            self.rays += 1;
            self.steps += steps;
            most = steps.max(most);
            n += 1;
            if n == warp_size {
                self.lane_steps += warp_size as u64 * most;
                (n, most) = (0, 0);
            }
        }
        self.lane_steps += warp_size as u64 * most;
        DeviceLaunch {
            ns,
            warp_size: self.warp_size,
        }
    }

    /// Returns the share of idle lanes, 0 to 1; `None` without steps of lanes.
    pub fn idle_share(&self) -> Option<f64> {
        let share = 1.0 - self.steps as f64 / self.lane_steps as f64;
        (self.lane_steps > 0).then_some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_take_the_steps_of_the_longest_ray_of_their_warp() {
        let mut work = KernelWork {
            name: "nearest".to_owned(),
            launches: 0,
            rays: 0,
            seconds: 0.0,
            group_size: 64,
            warp_size: Some(4),
            private_bytes: None,
            registers: None,
            occupancy: None,
            steps: 0,
            lane_steps: 0,
        };
        assert_eq!(work.idle_share(), None);
        let launch = work.add(2e9, [1, 2, 3, 4, 10, 0].into_iter());
        assert_eq!((launch.ns, launch.warp_size), (2e9, Some(4)));
        work.add(1e9, [5, 5, 5, 5].into_iter());
        assert_eq!((work.launches, work.rays, work.seconds), (2, 10, 3.0));
        assert_eq!((work.steps, work.lane_steps), (40, 4 * (4 + 10 + 5)));
        assert_eq!(work.idle_share(), Some(1.0 - 40.0 / 76.0));
        // A device that does not say its warp size.
        let mut unknown = KernelWork {
            warp_size: None,
            lane_steps: 0,
            ..work
        };
        unknown.add(1e9, [7, 9].into_iter());
        assert_eq!((unknown.steps, unknown.idle_share()), (56, None));
    }
}
