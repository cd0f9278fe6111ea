//! The device that traces the rays.

use ::device::{Device, DeviceError, DeviceLibrary};

/// A device of a library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DeviceChoice {
    library: DeviceLibrary,
    /// A part of its name; `None` for any.
    name: Option<String>,
}

/// Reads `opencl`, `cuda`, `opencl:TEXT` or `cuda:TEXT`.
pub(super) fn parse_device(text: &str) -> Result<DeviceChoice, String> {
    let (keyword, name) = match text.split_once(':') {
        Some((keyword, name)) => (keyword, Some(name.to_owned())),
        None => (text, None),
    };
    let library = match keyword {
        "opencl" => DeviceLibrary::OpenCl,
        "cuda" => DeviceLibrary::Cuda,
        _ => {
            return Err(
                "expected `opencl` or `cuda`, and `:` and a part of a device's name, if any"
                    .to_owned(),
            );
        }
    };
    if name.as_deref() == Some("") {
        return Err(format!("a part of the name follows `{keyword}:`"));
    }
    Ok(DeviceChoice { library, name })
}

impl DeviceChoice {
    /// Opens the device, which proves its arithmetic.
    ///
    /// # Errors
    /// There is none, or it computes otherwise than this processor.
    pub(super) fn open(&self) -> Result<Device, DeviceError> {
        Device::open(self.library, self.name.as_deref())
    }
}
