//! The device that traces the rays.

use ::device::{Device, DeviceError};

/// A device of OpenCL.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DeviceChoice {
    /// A part of its name; `None` for any.
    name: Option<String>,
}

/// Reads `opencl` or `opencl:TEXT`.
pub(super) fn parse_device(text: &str) -> Result<DeviceChoice, String> {
    let (language, name) = match text.split_once(':') {
        Some((language, name)) => (language, Some(name.to_owned())),
        None => (text, None),
    };
    match (language, name) {
        ("opencl", Some(name)) if name.is_empty() => {
            Err("a part of the name follows `opencl:`".to_owned())
        }
        ("opencl", name) => Ok(DeviceChoice { name }),
        _ => Err("expected `opencl`, or `opencl:` and a part of a device's name".to_owned()),
    }
}

impl DeviceChoice {
    /// Opens the device, which proves its arithmetic.
    ///
    /// # Errors
    /// There is none, or it computes otherwise than this processor.
    pub(super) fn open(&self) -> Result<Device, DeviceError> {
        Device::open(self.name.as_deref())
    }
}
