//! A scene in the memory of a device.

use std::fmt;
use std::mem;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use opencl3::kernel::Kernel;
use opencl3::memory::Buffer;
use opencl3::program::Program;

use crate::opencl::{Argument, DeviceFault, LaunchQueue, OpenDevice, Pool};
use crate::opened::{Device, DeviceError};
use crate::scene::SceneArrays;
use base::stop::Cancellation;
use host::text::Diagnostic;
use tracer::accel::{Accel, CountRay, Hit, RayDevice, ShadowStream};
use tracer::cost::{DeviceLaunch, KernelWork};
use world::geometry::{Ray, RayStream};
use world::scene::InstanceId;

/// No primitive, object or hit.
const NONE: u32 = u32::MAX;
/// Words of a ray.
const N_IN: usize = 8;
/// Words of an answer.
const N_OUT: usize = 5;

impl Device {
    /// Copies a scene to the device's memory. If the device fails later, the rays of the scene stay
    /// without hits, `cancellation` stops the work, and [`DeviceScene::check`] returns the reason.
    ///
    /// # Errors
    /// The device has not enough memory, or fails.
    pub fn load(
        &self,
        accel: &Accel,
        cancellation: &Cancellation,
    ) -> Result<DeviceScene<'_>, DeviceError> {
        let arrays = SceneArrays::new(accel);
        let n_bytes = 4 * arrays.lines.len() as u64;
        let (most, memory) = (
            self.machine().listed.max_array_bytes(),
            self.machine().listed.n_bytes(),
        );
        if n_bytes > most {
            let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
            return Err(DeviceError::Failed(Diagnostic::new(format!(
                "the hierarchy takes {:.2} GiB, but the device {} has {:.2} GiB of memory, and arrays of at \
                 most {:.2} GiB",
                gib(n_bytes),
                self.name(),
                gib(memory),
                gib(most)
            ))));
        }
        let program = self.program(arrays.depths);
        let memory = program.and_then(|program| SceneMemory::new(self.machine(), program, &arrays));
        let memory = memory.map_err(|fault| self.failed(&fault))?;
        Ok(DeviceScene::new(self, memory, cancellation.clone()))
    }
}

/// A scene in the memory of a device, which traces its rays.
pub struct DeviceScene<'a> {
    device: &'a Device,
    memory: Arc<SceneMemory>,
    workers: Pool<Worker>,
    /// The work of each kernel that was launched.
    kernels: Mutex<Vec<KernelWork>>,
    failure: OnceLock<DeviceFault>,
    cancellation: Cancellation,
}

/// What the device holds of a scene.
pub(crate) struct SceneMemory {
    /// Shared with the device, which keeps its last program.
    program: Arc<Program>,
    lines: Buffer<f32>,
    tables: [Buffer<u32>; 4],
}

impl SceneMemory {
    /// Copies the arrays to the device.
    pub(crate) fn new(
        machine: &OpenDevice,
        program: Arc<Program>,
        arrays: &SceneArrays,
    ) -> Result<Self, DeviceFault> {
        Ok(Self {
            program,
            lines: machine.upload(&arrays.lines)?,
            tables: [
                machine.upload(&arrays.levels)?,
                machine.upload(&arrays.unbounded)?,
                machine.upload(&arrays.primitives)?,
                machine.upload(&arrays.records)?,
            ],
        })
    }
}

/// What a thread needs to launch kernels; reused from launch to launch.
struct Worker {
    queue: LaunchQueue,
    nearest: Kernel,
    occluded: Kernel,
    input: Vec<u32>,
    output: Vec<u32>,
    /// The last launch.
    launch: DeviceLaunch,
}

/// A query for the kernels.
#[derive(Clone, Copy)]
enum Query {
    Nearest,
    Occluded,
}

impl<'a> DeviceScene<'a> {
    /// Creates the scene of a device; if the device fails, `cancellation` stops the work.
    pub(crate) fn new(device: &'a Device, memory: SceneMemory, cancellation: Cancellation) -> Self {
        Self {
            device,
            memory: Arc::new(memory),
            workers: Pool::new(),
            kernels: Mutex::default(),
            failure: OnceLock::new(),
            cancellation,
        }
    }

    /// Returns an error if the device has failed.
    ///
    /// # Errors
    /// The reason.
    pub fn check(&self) -> Result<(), DeviceError> {
        match self.failure.get() {
            None | Some(DeviceFault::Stopped) => Ok(()),
            Some(fault) => Err(self.device.failed(fault)),
        }
    }

    /// Returns the work of each kernel since the last call.
    pub fn take_kernels(&self) -> Vec<KernelWork> {
        mem::take(&mut self.kernels.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Adds a launch that took `ns` nanoseconds, given its answers, to the work of its kernel.
    fn add(&self, kernel: &Kernel, ns: f64, answers: &[[u32; N_OUT]]) -> DeviceLaunch {
        let name = kernel.function_name().unwrap_or_default();
        let mut kernels = self.kernels.lock().unwrap_or_else(PoisonError::into_inner);
        let number = kernels.iter().position(|work| work.name == name);
        let number = number.unwrap_or_else(|| {
            kernels.push(self.device.machine().no_work(kernel));
            kernels.len() - 1
        });
        let steps =
            |&[.., n_visits, n_tests]: &[u32; N_OUT]| u64::from(n_visits) + u64::from(n_tests);
        kernels[number].add(ns, answers.iter().map(steps))
    }

    /// Answers the queries of `n` rays, given their words. Calls `answer` with each ray's number
    /// and the words of its answer; for none if the device fails.
    fn answer(
        &self,
        query: Query,
        rays: impl Iterator<Item = [u32; N_IN]>,
        n: usize,
        answer: impl FnMut((usize, &[u32; N_OUT])),
    ) -> DeviceLaunch {
        if self.failure.get().is_some() || n == 0 {
            return DeviceLaunch::default();
        }
        match self.launch(query, rays, n) {
            Ok(worker) => {
                let answers = worker.output[..N_OUT * n].as_chunks::<N_OUT>().0;
                answers.iter().enumerate().for_each(answer);
                let launch = worker.launch;
                self.workers.put(worker);
                launch
            }
            Err(fault) => {
                let _ = self.failure.set(fault);
                self.cancellation.cancel();
                // A driver that hangs would hang again when its memory is freed.
                mem::forget((Arc::clone(&self.memory), self.device.machine().clone()));
                DeviceLaunch::default()
            }
        }
    }

    fn launch(
        &self,
        query: Query,
        rays: impl Iterator<Item = [u32; N_IN]>,
        n: usize,
    ) -> Result<Worker, DeviceFault> {
        let mut worker = self.workers.take().map_or_else(|| self.worker(), Ok)?;
        worker.input.clear();
        worker.input.extend(rays.flatten());
        worker.output.resize(N_OUT * n, 0);
        let [levels, unbounded, primitives, records] = &self.memory.tables;
        let arrays: [&dyn Argument; 5] =
            [&self.memory.lines, levels, unbounded, primitives, records];
        let Worker {
            queue,
            nearest,
            occluded,
            input,
            output,
            launch,
        } = &mut worker;
        let kernel = match query {
            Query::Nearest => &*nearest,
            Query::Occluded => &*occluded,
        };
        match queue.launch(kernel, &arrays, input, output, n) {
            Ok(ns) => {
                *launch = self.add(kernel, ns, output.as_chunks().0);
                Ok(worker)
            }
            Err(fault) => {
                mem::forget(worker);
                Err(fault)
            }
        }
    }

    fn worker(&self) -> Result<Worker, DeviceFault> {
        Ok(Worker {
            queue: LaunchQueue::new(self.device.machine())?,
            nearest: Kernel::create(&self.memory.program, "nearest")?,
            occluded: Kernel::create(&self.memory.program, "occluded")?,
            input: Vec::new(),
            output: Vec::new(),
            launch: DeviceLaunch::default(),
        })
    }
}

impl RayDevice for DeviceScene<'_> {
    fn nearest(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        count: CountRay,
    ) -> DeviceLaunch {
        hits.clear();
        hits.resize(rays.len(), None);
        let words = rays.iter().map(|ray| words(&ray, f32::INFINITY, NONE));
        self.answer(Query::Nearest, words, rays.len(), |(i, answer)| {
            let [t, primitive, instance, n_visits, n_tests] = *answer;
            hits[i] = (t != NONE).then(|| Hit {
                t: f32::from_bits(t),
                primitive,
                instance: instance.checked_sub(1).map(InstanceId),
            });
            count(i, n_visits, n_tests);
        })
    }

    fn occluded(
        &self,
        rays: &ShadowStream,
        occluded: &mut Vec<bool>,
        count: CountRay,
    ) -> DeviceLaunch {
        occluded.clear();
        occluded.resize(rays.len(), false);
        let words = rays.iter().map(|shadow| {
            let ignored = shadow.ignored.map_or(NONE, |object| object.0);
            words(&shadow.ray, shadow.t_max, ignored)
        });
        self.answer(Query::Occluded, words, rays.len(), |(i, answer)| {
            let [found, _, _, n_visits, n_tests] = *answer;
            occluded[i] = found != NONE;
            count(i, n_visits, n_tests);
        })
    }
}

/// Returns the words of a ray: origin, direction, limit and ignored object.
fn words(ray: &Ray, limit: f32, ignored: u32) -> [u32; N_IN] {
    let Ray { origin, direction } = ray;
    let [x, y, z] = origin.to_array().map(f32::to_bits);
    let [u, v, w] = direction.to_array().map(f32::to_bits);
    [x, y, z, u, v, w, limit.to_bits(), ignored]
}

impl fmt::Debug for DeviceScene<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("DeviceScene")
            .field(&self.device.name())
            .finish()
    }
}
