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

use crate::library::{DeviceFault, DeviceProgram, LaunchQueue, LibraryDevice, LoadedProgram};
use crate::program::Kernel;
use compiler::Compiler;
use context::{Context, CudaMemory, LOCAL_BYTES, Module, REGISTERS, Stream};
use driver::{CAPABILITY, Driver, MAX_THREADS, WARP_SIZE};
use tracer::cost::KernelWork;

/// Returns the devices of the driver.
///
/// # Errors
/// The system has no driver, or it does not start.
pub(crate) fn list() -> Result<Vec<Arc<dyn LibraryDevice>>, DeviceFault> {
    let driver = Arc::new(Driver::open()?);
    let listed = driver.devices()?.into_iter().map(|device| {
        let driver = Arc::clone(&driver);
        Arc::new(CudaDevice { driver, device }) as _
    });
    Ok(listed.collect())
}

struct CudaDevice {
    driver: Arc<Driver>,
    device: c_int,
}

impl LibraryDevice for CudaDevice {
    fn name(&self) -> String {
        let name = self.driver.device_name(self.device).unwrap_or_default();
        let version = self.driver.version().unwrap_or_default();
        format!("{name} (CUDA {version})")
    }

    fn n_bytes(&self) -> u64 {
        self.driver.device_bytes(self.device).unwrap_or(0) as u64
    }

    fn compile(&self, text: &str) -> Result<Arc<dyn DeviceProgram>, DeviceFault> {
        let attribute = |attribute| self.driver.device_attribute(attribute, self.device);
        let [major, minor] = CAPABILITY.map(attribute);
        // The names of what differs between the languages of devices come first.
        let text = include_str!("../program/cuda.cu").to_owned() + text;
        let ptx = Compiler::open()?.compile(&text, 10 * major? + minor?)?;
        let context = Arc::new(Context::new(&self.driver, self.device)?);
        Ok(Arc::new(Module::new(&context, &ptx)?))
    }
}

impl DeviceProgram for Module {
    fn load(self: Arc<Self>, arrays: &[&[u32]]) -> Result<LoadedProgram, DeviceFault> {
        let stream = Stream::new(self.context())?;
        let copy = |array: &&[u32]| {
            let memory = CudaMemory::new(self.context(), array.len())?;
            stream.write(&memory, array)?;
            Ok(memory)
        };
        let arrays = arrays.iter().map(copy);
        let arrays = arrays.collect::<Result<Arc<[_]>, DeviceFault>>()?;
        stream.wait()?;
        let queue = move || -> Result<Box<dyn LaunchQueue>, DeviceFault> {
            Ok(Box::new(CudaQueue {
                stream: Stream::new(self.context())?,
                inputs: Vec::new(),
                outputs: Vec::new(),
                module: Arc::clone(&self),
                arrays: Arc::clone(&arrays),
            }))
        };
        Ok(Box::new(queue))
    }
}

struct CudaQueue {
    module: Arc<Module>,
    arrays: Arc<[CudaMemory]>,
    stream: Stream,
    /// Memory for the input and the output of launches, the longest last.
    inputs: Vec<CudaMemory>,
    outputs: Vec<CudaMemory>,
}

impl LaunchQueue for CudaQueue {
    fn launch(
        &mut self,
        kernel: Kernel,
        input: &[u32],
        output: &mut [u32],
        n: usize,
    ) -> Result<f64, DeviceFault> {
        let context = self.module.context();
        let from = CudaMemory::last_of(&mut self.inputs, context, input.len())?;
        let to = CudaMemory::last_of(&mut self.outputs, context, output.len())?;
        self.stream.write(from, input)?;
        let arrays = self.arrays[..kernel.n_arrays].iter().chain([from, to]);
        let ns = self.stream.run(&self.module, kernel.name, arrays, n)?;
        self.stream.read(to, output)?;
        Ok(ns)
    }

    fn facts(&mut self, kernel: Kernel) -> Result<KernelWork, DeviceFault> {
        let module = &self.module;
        let [warp_size, most] = [WARP_SIZE, MAX_THREADS].map(|of| module.context().attribute(of));
        Ok(KernelWork {
            warp_size: Some(warp_size?),
            private_bytes: Some(module.attribute(LOCAL_BYTES, kernel.name)? as u64),
            registers: Some(module.attribute(REGISTERS, kernel.name)?),
            occupancy: Some(module.max_items(kernel.name)? as f64 / most? as f64),
            ..KernelWork::default()
        })
    }
}
