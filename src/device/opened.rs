//! A device that is ready for scenes.

use std::fmt;
use std::sync::{Arc, Mutex};

use crate::cuda;
use crate::library::{self, DeviceFault, DeviceProgram, LibraryDevice};
use crate::opencl;
use crate::proof;
use base::locked;
use host::text::Diagnostic;

/// Help where a device cannot be used.
const OTHER_DEVICE: &str = "render without `--device`, or on another device";

/// A library of devices, which is loaded at run time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceLibrary {
    /// OpenCL, for devices of many makers.
    OpenCl,
    /// CUDA, for NVIDIA's cards.
    Cuda,
}

impl DeviceLibrary {
    fn list(self) -> Result<Vec<Arc<dyn LibraryDevice>>, DeviceFault> {
        match self {
            Self::OpenCl => opencl::list(),
            Self::Cuda => cuda::list(),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::OpenCl => "OpenCL",
            Self::Cuda => "CUDA",
        }
    }

    /// Returns that it lists no device, and why, if that is known.
    fn lists_none(self, why: &str) -> DeviceError {
        let remedy = match self {
            Self::OpenCl => {
                "install the driver of the graphics card, or PoCL for the processor: Debian's packages are \
                 `ocl-icd-libopencl1` and `pocl-opencl-icd`"
            }
            Self::Cuda => "install the driver of NVIDIA's card, or render without `--device`",
        };
        let message = format!("the system lists no {} device{why}", self.name());
        DeviceError::Missing(Diagnostic::new(message).with_help(remedy))
    }
}

/// A device whose arithmetic agrees with the processor's.
pub struct Device {
    pub(crate) machine: Arc<dyn LibraryDevice>,
    name: String,
    /// The text of the program that was compiled last, and the program.
    program: Mutex<Option<(String, Arc<dyn DeviceProgram>)>>,
}

/// Why a device cannot be used.
#[derive(Debug)]
pub enum DeviceError {
    /// The system has none of that name.
    Missing(Diagnostic),
    /// It fails, computes otherwise than the processor, or has not enough memory.
    Failed(Diagnostic),
}

impl Device {
    /// Opens a device of a library: the first graphics card, or else the first device; with a text,
    /// the first one whose name or driver contains it, in any case.
    ///
    /// # Errors
    /// There is none, or its arithmetic differs from IEEE 754's; the message says what there is.
    pub fn open(library: DeviceLibrary, name: Option<&str>) -> Result<Self, DeviceError> {
        let listed = library.list();
        let mut all = listed.map_err(|fault| library.lists_none(&format!(": {fault}")))?;
        let wanted = name.unwrap_or_default();
        let is_wanted = |name: &String| name.to_lowercase().contains(&wanted.to_lowercase());
        let names: Vec<_> = all.iter().map(|machine| machine.name()).collect();
        let Some(found) = names.iter().position(is_wanted) else {
            if names.is_empty() {
                return Err(library.lists_none(""));
            }
            let message = format!("no {} device has `{wanted}` in its name", library.name());
            let help = format!("there is `{}`", names.join("`, `"));
            return Err(DeviceError::Missing(
                Diagnostic::new(message).with_help(help),
            ));
        };
        let machine = all.swap_remove(found);
        let name = machine.name();
        if !machine.has_doubles() {
            let message = format!("the device {name} does not compute in double precision");
            return Err(DeviceError::Failed(Diagnostic::new(message)));
        }
        let failed = |fault: DeviceFault| failed(&name, &fault);
        if let Some(difference) = proof::refute(&machine).map_err(failed)? {
            let message = format!("the device {name} cannot render the same picture: {difference}");
            return Err(DeviceError::Failed(
                Diagnostic::new(message).with_help(OTHER_DEVICE),
            ));
        }
        Ok(Self {
            machine,
            name,
            program: Mutex::default(),
        })
    }

    /// Returns the device's name and its driver's.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the program with this text.
    pub(crate) fn program(&self, text: String) -> Result<Arc<dyn DeviceProgram>, DeviceFault> {
        let mut last = locked(&self.program);
        if let Some((_, program)) = last.as_ref().filter(|(of, _)| *of == text) {
            return Ok(Arc::clone(program));
        }
        let program = library::compile(&self.machine, text.clone())?;
        *last = Some((text, Arc::clone(&program)));
        Ok(program)
    }
}

impl fmt::Debug for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Device").field(&self.name).finish()
    }
}

/// Returns that the device of this name has failed.
pub(crate) fn failed(name: &str, fault: &DeviceFault) -> DeviceError {
    if let DeviceFault::Missing(library) = fault {
        let message =
            format!("the device {name} needs `{library}`, which the system does not have");
        return DeviceError::Missing(Diagnostic::new(message).with_help(
            "`pip install nvidia-cuda-nvrtc` installs it; its folder belongs in `LD_LIBRARY_PATH`. \
             `--device opencl` needs only the driver",
        ));
    }
    let message = format!("the device {name} fails: {fault}");
    DeviceError::Failed(Diagnostic::new(message).with_help(OTHER_DEVICE))
}
