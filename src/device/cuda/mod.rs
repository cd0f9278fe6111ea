//! CUDA: NVIDIA's cards, by their driver (`libcuda.so.1`) and NVIDIA's compiler (`libnvrtc`), which
//! are loaded at run time.
//!
//! The program is the same text as for OpenCL, with another prelude (`cuda.cu`). NVRTC makes PTX of
//! it (`compiler`), which is checked for operations that are not exact (`ptx`), and which the driver
//! compiles for the card (`context`).

mod compiler;
mod context;
mod driver;
mod functions;
mod ptx;

use std::ffi::c_int;
use std::sync::Arc;

use crate::library::{
    DeviceFault, DeviceProgram, KernelFacts, LaunchQueue, ListedDevice, LoadedProgram, OpenDevice,
};
use crate::program::Kernel;
use compiler::Compiler;
use context::{Context, CudaMemory, Module, Stream};
use driver::{DeviceAttribute, Driver};

/// The names of what differs between the languages of devices.
const PRELUDE: &str = include_str!("../program/cuda.cu");

/// Returns the devices of the driver.
///
/// # Errors
/// The system has no driver, or it does not start.
pub(crate) fn list() -> Result<Vec<Box<dyn ListedDevice>>, DeviceFault> {
    let driver = Arc::new(Driver::open()?);
    let listed = driver.devices()?.into_iter().map(|device| {
        let driver = Arc::clone(&driver);
        Box::new(CudaListed { driver, device }) as _
    });
    Ok(listed.collect())
}

struct CudaListed {
    driver: Arc<Driver>,
    device: c_int,
}

impl ListedDevice for CudaListed {
    fn name(&self) -> String {
        let name = self.driver.device_name(self.device).unwrap_or_default();
        let version = self.driver.version().unwrap_or_default();
        format!("{} (CUDA {version})", name.trim())
    }

    /// All cards do for which NVRTC compiles.
    fn has_doubles(&self) -> bool {
        true
    }

    fn open(&self) -> Result<Box<dyn OpenDevice>, DeviceFault> {
        let attribute = |attribute| self.driver.device_attribute(attribute, self.device);
        Ok(Box::new(CudaDevice {
            n_bytes: self.driver.device_bytes(self.device)? as u64,
            warp_size: attribute(DeviceAttribute::WarpSize)? as usize,
            capability: 10 * attribute(DeviceAttribute::CapabilityMajor)?
                + attribute(DeviceAttribute::CapabilityMinor)?,
            context: Arc::new(Context::new(Arc::clone(&self.driver), self.device)?),
            compiler: Compiler::open()?,
        }))
    }
}

/// An open device.
struct CudaDevice {
    compiler: Compiler,
    context: Arc<Context>,
    n_bytes: u64,
    warp_size: usize,
    /// Its compute capability, times 10.
    capability: c_int,
}

impl OpenDevice for CudaDevice {
    fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    fn max_array_bytes(&self) -> u64 {
        self.n_bytes
    }

    fn compile(&self, text: &str) -> Result<Arc<dyn DeviceProgram>, DeviceFault> {
        let text = PRELUDE.to_owned() + text;
        let ptx = self.compiler.compile(&text, self.capability)?;
        Ok(Arc::new(CudaProgram {
            module: Module::new(&self.context, &ptx)?,
            context: Arc::clone(&self.context),
            warp_size: self.warp_size,
        }))
    }
}

struct CudaProgram {
    module: Module,
    context: Arc<Context>,
    warp_size: usize,
}

impl DeviceProgram for CudaProgram {
    fn load(self: Arc<Self>, arrays: &[&[u32]]) -> Result<Arc<dyn LoadedProgram>, DeviceFault> {
        let stream = Stream::new(&self.context)?;
        let copy = |array: &&[u32]| {
            let memory = CudaMemory::new(&self.context, array.len())?;
            stream.write(&memory, array)?;
            Ok(memory)
        };
        let arrays = arrays
            .iter()
            .map(copy)
            .collect::<Result<_, DeviceFault>>()?;
        stream.wait()?;
        Ok(Arc::new(CudaScene {
            arrays,
            program: self,
        }))
    }
}

struct CudaScene {
    program: Arc<CudaProgram>,
    arrays: Vec<CudaMemory>,
}

impl LoadedProgram for CudaScene {
    fn queue(self: Arc<Self>) -> Result<Box<dyn LaunchQueue>, DeviceFault> {
        let context = &self.program.context;
        Ok(Box::new(CudaQueue {
            stream: Stream::new(context)?,
            input: CudaMemory::new(context, 1)?,
            output: CudaMemory::new(context, 1)?,
            loaded: self,
        }))
    }
}

struct CudaQueue {
    loaded: Arc<CudaScene>,
    stream: Stream,
    input: CudaMemory,
    output: CudaMemory,
}

impl LaunchQueue for CudaQueue {
    fn launch(
        &mut self,
        kernel: Kernel,
        input: &[u32],
        output: &mut [u32],
        n: usize,
    ) -> Result<f64, DeviceFault> {
        let CudaProgram {
            module, context, ..
        } = &*self.loaded.program;
        for (memory, len) in [
            (&mut self.input, input.len()),
            (&mut self.output, output.len()),
        ] {
            if memory.len() < len {
                *memory = CudaMemory::new(context, len)?;
            }
        }
        self.stream.write(&self.input, input)?;
        let arrays = &self.loaded.arrays[..kernel.n_arrays()];
        let arrays = arrays.iter().chain([&self.input, &self.output]);
        let ns = self.stream.run(&module.kernel(kernel.name())?, arrays, n)?;
        self.stream.read(&self.output, output)?;
        Ok(ns)
    }

    fn facts(&mut self, kernel: Kernel) -> Result<KernelFacts, DeviceFault> {
        let CudaProgram {
            module, warp_size, ..
        } = &*self.loaded.program;
        let kernel = module.kernel(kernel.name())?;
        Ok(KernelFacts {
            warp_size: Some(*warp_size),
            private_bytes: Some(module.local_bytes(&kernel)?),
        })
    }
}
