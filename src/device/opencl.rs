//! OpenCL: devices, programs, memory and queues.
#![expect(unsafe_code, reason = "commands of OpenCL read and write memory")]

use std::ffi::c_void;
use std::ptr::null_mut;
use std::sync::Arc;

use cl3::kernel::get_kernel_sub_group_info;
use opencl3::command_queue::{CL_QUEUE_PROFILING_ENABLE, CommandQueue};
use opencl3::context::Context;
use opencl3::device::{
    CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_GPU, CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, Device,
};
use opencl3::error_codes::ClError;
use opencl3::event::CL_COMPLETE;
use opencl3::kernel::{self, CL_KERNEL_MAX_SUB_GROUP_SIZE_FOR_NDRANGE, ExecuteKernel};
use opencl3::memory::{Buffer, CL_MEM_COPY_HOST_PTR, CL_MEM_READ_ONLY, CL_MEM_READ_WRITE, ClMem};
use opencl3::platform::{Platform, get_platforms};
use opencl3::program::Program;

use crate::library::{
    DeviceFault, DeviceProgram, GROUP, LaunchQueue, LibraryDevice, LoadedProgram, MAX_LAUNCH, wait,
};
use crate::program::Kernel;
use tracer::cost::KernelWork;

impl From<ClError> for DeviceFault {
    fn from(error: ClError) -> Self {
        Self::Call(error.to_string())
    }
}

/// Returns the devices of all drivers, graphics cards first.
///
/// # Errors
/// The system has no `libOpenCL`, or it lists no platform.
pub(crate) fn list() -> Result<Vec<Arc<dyn LibraryDevice>>, DeviceFault> {
    let platforms = get_platforms()?;
    let of = |platform: &Platform| platform.get_devices(CL_DEVICE_TYPE_ALL).unwrap_or_default();
    let all = platforms.iter().flat_map(of);
    let mut all: Vec<_> = all.map(Device::new).collect();
    let is_gpu = |kind: u64| kind & CL_DEVICE_TYPE_GPU != 0;
    all.sort_by_key(|device| !device.dev_type().is_ok_and(is_gpu));
    let listed = all
        .into_iter()
        .map(|device| Arc::new(OpenClDevice(device)) as _);
    Ok(listed.collect())
}

struct OpenClDevice(Device);

impl LibraryDevice for OpenClDevice {
    fn name(&self) -> String {
        let Self(device) = self;
        let name = device.name().unwrap_or_default();
        let driver = device.platform().ok();
        let driver = driver.and_then(|id| Platform::new(id).name().ok());
        let version = device.driver_version().unwrap_or_default();
        let driver = format!("{} {version}", driver.unwrap_or_default());
        format!("{} ({})", name.trim(), driver.trim())
    }

    fn n_bytes(&self) -> u64 {
        self.0.global_mem_size().unwrap_or(0)
    }

    fn max_array_bytes(&self) -> u64 {
        self.0.max_mem_alloc_size().unwrap_or(0)
    }

    fn has_doubles(&self) -> bool {
        let config = self.0.double_fp_config();
        config.is_ok_and(|config| config != 0)
    }

    fn compile(&self, text: &str) -> Result<Arc<dyn DeviceProgram>, DeviceFault> {
        let Self(device) = *self;
        let context = Context::from_device(&device)?;
        // Without the option, a device that could round correctly may not.
        let config = device.single_fp_config().unwrap_or(0);
        let mut options = String::new();
        if config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT != 0 {
            options += "-cl-fp32-correctly-rounded-divide-sqrt";
        }
        // The clock of kernels is a part of newer versions of OpenCL C than the default.
        if device.extensions()?.contains("cl_khr_kernel_clock") {
            options += " -cl-std=CL3.0";
        }
        // The names of what differs between the languages of devices come first.
        let text = include_str!("program/opencl.cl").to_owned() + text;
        let program = Program::create_and_build_from_source(&context, &text, &options);
        Ok(Arc::new(OpenClProgram {
            program: program.map_err(|log| DeviceFault::of_build(&log))?,
            context,
            device,
        }))
    }
}

struct OpenClProgram {
    program: Program,
    context: Context,
    device: Device,
}

impl DeviceProgram for OpenClProgram {
    fn load(self: Arc<Self>, arrays: &[&[u32]]) -> Result<LoadedProgram, DeviceFault> {
        let arrays = arrays.iter().map(|array| self.upload(array));
        let arrays = arrays.collect::<Result<Arc<[_]>, _>>()?;
        let queue = move || -> Result<Box<dyn LaunchQueue>, DeviceFault> {
            Ok(Box::new(OpenClQueue {
                queue: CommandQueue::create_default(&self.context, CL_QUEUE_PROFILING_ENABLE)?,
                input: self.allocate(1)?,
                output: self.allocate(1)?,
                kernels: Vec::new(),
                program: Arc::clone(&self),
                arrays: Arc::clone(&arrays),
            }))
        };
        Ok(Box::new(queue))
    }
}

impl OpenClProgram {
    fn upload(&self, array: &[u32]) -> Result<Buffer<u32>, DeviceFault> {
        let flags = CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR;
        let from = array.as_ptr().cast_mut().cast::<c_void>();
        // SAFETY: the call reads the whole array and keeps no reference to it.
        Ok(unsafe { Buffer::create(&self.context, flags, array.len(), from) }?)
    }

    fn allocate(&self, n: usize) -> Result<Buffer<u32>, DeviceFault> {
        // SAFETY: no memory of the host is passed.
        Ok(unsafe { Buffer::create(&self.context, CL_MEM_READ_WRITE, n, null_mut()) }?)
    }

    /// Returns the number of items of a sub-group; `None` if the device does not say.
    fn sub_group(&self, kernel: &kernel::Kernel) -> Option<usize> {
        // Drivers of older versions have no such function, and the loader calls it all the same.
        if self.device.version().ok()?.strip_prefix("OpenCL ")? < "2.1" {
            return None;
        }
        let group = [GROUP];
        let found = get_kernel_sub_group_info(
            kernel.get(),
            self.device.id(),
            CL_KERNEL_MAX_SUB_GROUP_SIZE_FOR_NDRANGE,
            size_of_val(&group),
            group.as_ptr().cast(),
        );
        found.ok().map(usize::from)
    }
}

struct OpenClQueue {
    program: Arc<OpenClProgram>,
    arrays: Arc<[Buffer<u32>]>,
    queue: CommandQueue,
    input: Buffer<u32>,
    output: Buffer<u32>,
    /// The kernels that were asked for; each thread needs its own, since they hold the arguments.
    kernels: Vec<(Kernel, kernel::Kernel)>,
}

impl OpenClQueue {
    /// Returns the index of a kernel in `kernels`.
    fn index(&mut self, kernel: Kernel) -> Result<usize, DeviceFault> {
        if let Some(index) = self.kernels.iter().position(|&(known, _)| known == kernel) {
            return Ok(index);
        }
        let created = kernel::Kernel::create(&self.program.program, kernel.name)?;
        self.kernels.push((kernel, created));
        Ok(self.kernels.len() - 1)
    }
}

impl LaunchQueue for OpenClQueue {
    fn launch(
        &mut self,
        kernel: Kernel,
        input: &[u32],
        output: &mut [u32],
        n: usize,
    ) -> Result<f64, DeviceFault> {
        let index = self.index(kernel)?;
        let input_and_len = (&mut self.input, input.len());
        for (buffer, len) in [input_and_len, (&mut self.output, output.len())] {
            if buffer.size()? < 4 * len {
                *buffer = self.program.allocate(len)?;
            }
        }
        // SAFETY: the kernels' parameters are such arrays in this order, the buffers are large enough,
        // and input and output outlive the commands, which do not block and for which `wait` waits; a
        // device that hangs gets memory that is never freed.
        unsafe {
            self.queue
                .enqueue_write_buffer(&mut self.input, 0, 0, input, &[])?;
            let mut launch = ExecuteKernel::new(&self.kernels[index].1);
            let buffers = [&self.input, &self.output];
            for array in self.arrays[..kernel.n_arrays].iter().chain(buffers) {
                launch.set_arg(array);
            }
            launch.set_arg(&(n as u32));
            launch.set_global_work_size(n.next_multiple_of(GROUP));
            launch.set_local_work_size(GROUP);
            let launched = launch.enqueue_nd_range(&self.queue)?;
            let done =
                self.queue
                    .enqueue_read_buffer(&self.output, 0, 0, output, &[launched.get()])?;
            self.queue.flush()?;
            for event in [&launched, &done] {
                wait(MAX_LAUNCH, || match event.command_execution_status()?.0 {
                    failure @ ..0 => Err(ClError(failure).into()),
                    status => Ok((status == CL_COMPLETE).then_some(())),
                })?;
            }
            let begin = launched.profiling_command_start()?;
            let end = launched.profiling_command_end()?;
            Ok(end.saturating_sub(begin) as f64)
        }
    }

    fn facts(&mut self, kernel: Kernel) -> Result<KernelWork, DeviceFault> {
        let index = self.index(kernel)?;
        let (program, created) = (&self.program, &self.kernels[index].1);
        let device = program.device.id();
        let warp = program.sub_group(created);
        let warp = warp.or_else(|| created.get_work_group_size_multiple(device).ok());
        Ok(KernelWork {
            warp_size: warp.filter(|&n| n > 0),
            private_bytes: created.get_private_mem_size(device).ok(),
            ..KernelWork::default()
        })
    }
}
