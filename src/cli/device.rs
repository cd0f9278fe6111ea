//! The device that traces the rays.

use ::device::{Device, DeviceError, DeviceLibrary};

/// A choice of where to render.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum DeviceChoice {
    /// This processor.
    Processor,
    /// A device of a library, with this part of its name, if any.
    Other(DeviceLibrary, Option<String>),
}

/// Reads `processor`, `opencl`, `cuda`, `opencl:TEXT` or `cuda:TEXT`.
pub(super) fn parse_device(text: &str) -> Result<DeviceChoice, String> {
    let (keyword, name) = match text.split_once(':') {
        Some((keyword, name)) => (keyword, Some(name.to_owned())),
        None => (text, None),
    };
    let library = match keyword {
        "processor" if name.is_none() => return Ok(DeviceChoice::Processor),
        "opencl" => DeviceLibrary::OpenCl,
        "cuda" => DeviceLibrary::Cuda,
        _ => {
            return Err(
                "expected `processor`, `opencl` or `cuda`, and after these `:` and a part of a \
                 device's name, if any"
                    .to_owned(),
            );
        }
    };
    if name.as_deref() == Some("") {
        return Err(format!("a part of the name follows `{keyword}:`"));
    }
    Ok(DeviceChoice::Other(library, name))
}

impl DeviceChoice {
    /// Opens the device, which proves its arithmetic; `None` for the processor.
    ///
    /// # Errors
    /// There is none, or it computes otherwise than this processor.
    pub(super) fn open(&self) -> Result<Option<Device>, DeviceError> {
        match self {
            Self::Processor => Ok(None),
            Self::Other(library, name) => Device::open(*library, name.as_deref()).map(Some),
        }
    }
}
