//! Launches of kernels on a device.

use serde::{Deserialize, Serialize};

/// The cost of a launch of a kernel on a device.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DeviceLaunch {
    /// The time of the kernel in nanoseconds.
    pub ns: f64,
}

/// The launches of one kernel on a device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KernelWork {
    /// The name of the kernel.
    pub name: String,
    /// Number of launches.
    pub launches: u64,
    /// Number of rays of all launches.
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
}
