//! OpenCL: devices, programs, memory and queues.
#![expect(unsafe_code, reason = "commands of OpenCL read and write memory")]

use std::ffi::c_void;
use std::fmt;
use std::ptr::null_mut;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use cl3::kernel::get_kernel_sub_group_info;
use opencl3::command_queue::{CL_QUEUE_PROFILING_ENABLE, CommandQueue};
use opencl3::context::Context;
use opencl3::device::{
    CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_GPU, CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT,
};
use opencl3::error_codes::ClError;
use opencl3::event::{CL_COMPLETE, Event};
use opencl3::kernel::{CL_KERNEL_MAX_SUB_GROUP_SIZE_FOR_NDRANGE, ExecuteKernel, Kernel};
use opencl3::memory::{Buffer, CL_MEM_COPY_HOST_PTR, CL_MEM_READ_ONLY, CL_MEM_READ_WRITE};
use opencl3::platform::{Platform, get_platforms};
use opencl3::program::Program;

use base::stop;
use tracer::cost::KernelWork;

/// Time after which a device that has not finished a launch counts as hung.
const MAX_LAUNCH: Duration = Duration::from_secs(30);
/// Rays or triples of a launch that share a group.
const GROUP: usize = 64;

/// Why a device cannot go on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum DeviceFault {
    /// A call failed with this name of an error.
    Call(String),
    /// The program cannot be built; the compiler's first lines.
    Build(String),
    /// A launch has not finished in time.
    Hang,
    /// The work was stopped.
    Stopped,
}

impl From<ClError> for DeviceFault {
    fn from(error: ClError) -> Self {
        Self::Call(error.to_string())
    }
}

impl fmt::Display for DeviceFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Call(name) => write!(f, "{name}"),
            Self::Build(log) => write!(f, "its compiler refuses the program: {log}"),
            Self::Hang => write!(f, "it has not finished in {} s", MAX_LAUNCH.as_secs()),
            Self::Stopped => write!(f, "stopped"),
        }
    }
}

/// A device as OpenCL lists it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ListedDevice {
    device: opencl3::device::Device,
}

/// Returns the devices of all drivers, graphics cards first.
///
/// # Errors
/// The system has no `libOpenCL`, or it lists no platform.
pub(crate) fn list() -> Result<Vec<ListedDevice>, DeviceFault> {
    let platforms = get_platforms()?;
    let of = |platform: &Platform| platform.get_devices(CL_DEVICE_TYPE_ALL).unwrap_or_default();
    let all = platforms.iter().flat_map(of);
    let mut all: Vec<_> = all
        .map(|id| ListedDevice {
            device: opencl3::device::Device::new(id),
        })
        .collect();
    all.sort_by_key(|listed| !listed.is_gpu());
    Ok(all)
}

impl ListedDevice {
    fn is_gpu(&self) -> bool {
        let kind = self.device.dev_type();
        kind.is_ok_and(|kind| kind & CL_DEVICE_TYPE_GPU != 0)
    }

    /// Returns the device's name and its driver's.
    pub(crate) fn name(&self) -> String {
        let name = self.device.name().unwrap_or_default();
        let driver = self.device.platform().ok();
        let driver = driver.and_then(|id| Platform::new(id).name().ok());
        let version = self.device.driver_version().unwrap_or_default();
        let driver = format!("{} {version}", driver.unwrap_or_default());
        format!("{} ({})", name.trim(), driver.trim())
    }

    /// Returns the bytes of its memory.
    pub(crate) fn n_bytes(&self) -> u64 {
        self.device.global_mem_size().unwrap_or(0)
    }

    /// Returns the most bytes of one array.
    pub(crate) fn max_array_bytes(&self) -> u64 {
        self.device.max_mem_alloc_size().unwrap_or(0)
    }

    /// Returns true if it computes in double precision.
    pub(crate) fn has_doubles(&self) -> bool {
        self.device
            .double_fp_config()
            .is_ok_and(|config| config != 0)
    }

    pub(crate) fn open(&self) -> Result<OpenDevice, DeviceFault> {
        Ok(OpenDevice {
            listed: *self,
            context: Arc::new(Context::from_device(&self.device)?),
        })
    }
}

/// A device that programs run on.
#[derive(Debug, Clone)]
pub(crate) struct OpenDevice {
    pub(crate) listed: ListedDevice,
    context: Arc<Context>,
}

impl OpenDevice {
    /// Compiles a program.
    pub(crate) fn compile(&self, text: &str) -> Result<Program, DeviceFault> {
        let device = &self.listed.device;
        // Without the option, a device that could round correctly may not.
        let config = device.single_fp_config().unwrap_or(0);
        let options = if config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT == 0 {
            ""
        } else {
            "-cl-fp32-correctly-rounded-divide-sqrt"
        };
        Program::create_and_build_from_source(&self.context, text, options).map_err(|log| {
            let lines: Vec<_> = log.lines().filter(|line| !line.trim().is_empty()).collect();
            DeviceFault::Build(lines[..lines.len().min(3)].join("; "))
        })
    }

    /// Copies an array, which is not empty, to the device.
    pub(crate) fn upload<T: bytemuck::Pod>(&self, array: &[T]) -> Result<Buffer<T>, DeviceFault> {
        let flags = CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR;
        let from = array.as_ptr().cast_mut().cast::<c_void>();
        // SAFETY: the call reads the whole array and keeps no reference to it.
        Ok(unsafe { Buffer::create(&self.context, flags, array.len(), from) }?)
    }

    /// Returns the work of a kernel that has not been launched.
    pub(crate) fn no_work(&self, kernel: &Kernel) -> KernelWork {
        let device = self.listed.device.id();
        let warp = self.sub_group(kernel);
        let warp = warp.or_else(|| kernel.get_work_group_size_multiple(device).ok());
        KernelWork {
            name: kernel.function_name().unwrap_or_default(),
            launches: 0,
            rays: 0,
            seconds: 0.0,
            group_size: GROUP,
            warp_size: warp.filter(|&n| n > 0),
            private_bytes: kernel.get_private_mem_size(device).ok(),
            steps: 0,
            lane_steps: 0,
        }
    }

    /// Returns the number of items of a sub-group; `None` if the device does not say.
    fn sub_group(&self, kernel: &Kernel) -> Option<usize> {
        // Drivers of older versions have no such function, and the loader calls it all the same.
        let version = self.listed.device.version().ok()?;
        let version = version.strip_prefix("OpenCL ")?.split(' ').next()?;
        let (major, minor) = version.split_once('.')?;
        if (major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?) < (2, 1) {
            return None;
        }
        let group = [GROUP];
        let found = get_kernel_sub_group_info(
            kernel.get(),
            self.listed.device.id(),
            CL_KERNEL_MAX_SUB_GROUP_SIZE_FOR_NDRANGE,
            size_of_val(&group),
            group.as_ptr().cast(),
        );
        found.ok().map(usize::from)
    }

    fn allocate<T>(&self, n: usize) -> Result<Buffer<T>, DeviceFault> {
        // SAFETY: no memory of the host is passed.
        Ok(unsafe { Buffer::create(&self.context, CL_MEM_READ_WRITE, n, null_mut()) }?)
    }
}

/// A queue with memory for the input and the output of launches, reused from launch to launch.
pub(crate) struct LaunchQueue {
    machine: OpenDevice,
    queue: CommandQueue,
    input: Buffer<u32>,
    output: Buffer<u32>,
    lengths: [usize; 2],
}

impl LaunchQueue {
    pub(crate) fn new(machine: &OpenDevice) -> Result<Self, DeviceFault> {
        Ok(Self {
            queue: CommandQueue::create_default(&machine.context, CL_QUEUE_PROFILING_ENABLE)?,
            input: machine.allocate(1)?,
            output: machine.allocate(1)?,
            lengths: [1; 2],
            machine: machine.clone(),
        })
    }

    /// Runs a kernel for `n` items: its arguments are `arrays`, the input, the output and `n`.
    /// Returns the nanoseconds that it took on the device.
    pub(crate) fn launch(
        &mut self,
        kernel: &Kernel,
        arrays: &[&dyn Argument],
        input: &[u32],
        output: &mut [u32],
        n: usize,
    ) -> Result<f64, DeviceFault> {
        if n == 0 {
            return Ok(0.0);
        }
        let [input_len, output_len] = &mut self.lengths;
        if *input_len < input.len() {
            self.input = self.machine.allocate(input.len())?;
            *input_len = input.len();
        }
        if *output_len < output.len() {
            self.output = self.machine.allocate(output.len())?;
            *output_len = output.len();
        }
        let Self {
            queue,
            input: to,
            output: from,
            ..
        } = self;
        // SAFETY: the buffers are large enough, and input and output outlive the commands, for
        // which `wait` waits; a device that hangs gets memory that is never freed.
        unsafe {
            queue.enqueue_write_buffer(to, 1, 0, input, &[])?;
            let mut launch = ExecuteKernel::new(kernel);
            for array in arrays {
                array.set(&mut launch);
            }
            launch.set_arg(to).set_arg(from).set_arg(&(n as u32));
            launch.set_global_work_size(n.next_multiple_of(GROUP));
            launch.set_local_work_size(GROUP);
            let done = launch.enqueue_nd_range(queue)?;
            queue.flush()?;
            wait(&done)?;
            queue.enqueue_read_buffer(from, 1, 0, output, &[])?;
            let [begin, end] = [
                done.profiling_command_start()?,
                done.profiling_command_end()?,
            ];
            Ok(end.saturating_sub(begin) as f64)
        }
    }
}

/// An array that kernels read.
pub(crate) trait Argument {
    /// Makes it the next argument.
    fn set(&self, launch: &mut ExecuteKernel);
}

impl<T> Argument for Buffer<T> {
    fn set(&self, launch: &mut ExecuteKernel) {
        // SAFETY: the kernels' parameters are arrays of such numbers, in this order.
        unsafe { launch.set_arg(self) };
    }
}

/// Waits for a command, without trust in the driver.
fn wait(event: &Event) -> Result<(), DeviceFault> {
    let begin = Instant::now();
    loop {
        let status = event.command_execution_status()?.0;
        if status == CL_COMPLETE {
            return Ok(());
        }
        if status < 0 {
            return Err(ClError(status).into());
        }
        let waited = begin.elapsed();
        if waited > MAX_LAUNCH {
            return Err(DeviceFault::Hang);
        }
        if stop::is_requested() && waited > Duration::from_secs(2) {
            return Err(DeviceFault::Stopped);
        }
        // As long again as the wait so far, so that short launches are noticed soon.
        std::thread::sleep((waited / 8).clamp(Duration::from_micros(5), Duration::from_millis(2)));
    }
}

/// Values that threads take in turns: each uses its own, and returns it.
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T> Pool<T> {
    pub(crate) fn new() -> Self {
        Self(Mutex::default())
    }

    pub(crate) fn take(&self) -> Option<T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    pub(crate) fn put(&self, value: T) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(value);
    }
}
