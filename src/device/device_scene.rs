//! A scene in the memory of a device.

use std::fmt;
use std::mem::{self, ManuallyDrop};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Instant;

use glam::Vec3;

use crate::library::{DeviceFault, GROUP, LaunchQueue, LoadedProgram};
use crate::multiprocessors::{self, MultiprocessorTimes};
use crate::opened::{Device, DeviceError, failed};
use crate::paths::{N_RESULTS, N_START, RecordedPaths};
use crate::program::{self, Kernel, NONE};
use crate::scene::SceneArrays;
use base::locked;
use base::stop::Cancellation;
use host::text::Diagnostic;
use math::sampling::Sampler;
use tracer::accel::{Accel, CountRay, Hit, PathStream, RayDevice, ShadowStream, TakePath};
use tracer::cost::{Cost, DeviceLaunch, FollowedPath, KernelWork, UsedDevice};
use tracer::shade::PathFormulas;
use world::camera::RayCone;
use world::geometry::{Ray, RayStream};
use world::scene::InstanceId;

/// Words of a ray.
const N_IN: usize = 8;
/// Words of an answer.
const N_OUT: usize = 5;

impl Device {
    /// Copies a scene to the device's memory; where all of its formulas can be recorded, the device
    /// will follow whole paths, else it traces rays. Its program counts steps and rays if `counts`; else
    /// all counters are 0. If the device fails later, the rays of the scene stay without hits,
    /// `cancellation` stops the work, and [`DeviceScene::check`] returns the reason.
    ///
    /// # Errors
    /// The scene is too large, the device has not enough memory, or it fails.
    pub fn load(
        &self,
        accel: &Accel,
        formulas: &PathFormulas,
        counts: bool,
        cancellation: &Cancellation,
    ) -> Result<DeviceScene<'_>, DeviceError> {
        let arrays = SceneArrays::new(accel).map_err(|part| {
            let message = format!("the scene has {part}, too many for a device");
            DeviceError::Failed(Diagnostic::new(message).with_help("render without `--device`"))
        })?;
        let paths = RecordedPaths::new(formulas);
        let all = all_arrays(&arrays, paths.as_ref().ok());
        let longest = all.iter().map(|array| size_of_val(*array)).max();
        let n_bytes = longest.unwrap_or(0) as u64;
        let (most, memory) = (self.machine.max_array_bytes(), self.machine.n_bytes());
        if n_bytes > most {
            let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
            return Err(DeviceError::Failed(Diagnostic::new(format!(
                "an array of the scene takes {:.2} GiB, but the device {} has {:.2} GiB of memory, and arrays of at \
                 most {:.2} GiB",
                gib(n_bytes),
                self.name(),
                gib(memory),
                gib(most)
            ))));
        }
        let functions = paths.as_ref().ok().map(|paths| &paths.text[..]);
        let text = program::text(arrays.world_levels, arrays.mesh_levels, functions, counts);
        let program = self.program(text);
        let loaded = program.and_then(|program| program.load(&all));
        Ok(DeviceScene {
            device: self,
            loaded: loaded.map_err(|fault| failed(self.name(), &fault))?,
            paths: paths.map(|_| (formulas.sampler, formulas.cone)),
            workers: Mutex::default(),
            kernels: Mutex::default(),
            multiprocessors: Mutex::new(MultiprocessorTimes::new(Instant::now())),
            failure: OnceLock::new(),
            cancellation: cancellation.clone(),
        })
    }
}

/// Returns the arrays that the kernels read, in the order of their parameters.
fn all_arrays<'a>(arrays: &'a SceneArrays, paths: Option<&'a RecordedPaths>) -> Vec<&'a [u32]> {
    let mut all = vec![
        bytemuck::cast_slice(&arrays.lines),
        &arrays.levels,
        &arrays.unbounded,
        &arrays.primitives,
        &arrays.records,
    ];
    if let Some(paths) = paths {
        all.extend([
            &paths.surfaces[..],
            bytemuck::cast_slice(&paths.data),
            bytemuck::cast_slice(&paths.places),
            &paths.tables,
        ]);
    }
    // A device has no empty arrays.
    let empty = all.iter_mut().filter(|array| array.is_empty());
    empty.for_each(|array| *array = &[0]);
    all
}

/// A scene in the memory of a device, which traces its rays.
pub struct DeviceScene<'a> {
    device: &'a Device,
    loaded: Arc<dyn LoadedProgram>,
    /// The numbers of the samples whose paths it follows, or the part of the scene that keeps it
    /// from following any.
    paths: Result<(Sampler, Option<RayCone>), String>,
    /// The workers that no thread uses at the moment.
    workers: Mutex<Vec<ManuallyDrop<Worker>>>,
    /// The work of each kernel that was launched.
    kernels: Mutex<Vec<KernelWork>>,
    /// Times at which each multiprocessor followed paths.
    multiprocessors: Mutex<MultiprocessorTimes>,
    failure: OnceLock<DeviceFault>,
    cancellation: Cancellation,
}

/// What a thread needs to launch kernels; reused from launch to launch. If the device fails, all
/// workers stay, and by their queues the scene: its driver may hang when memory is freed, or write
/// to it.
struct Worker {
    queue: Box<dyn LaunchQueue>,
    input: Vec<u32>,
    output: Vec<u32>,
}

impl Drop for DeviceScene<'_> {
    fn drop(&mut self) {
        if self.failure.get().is_none() {
            let idle = mem::take(&mut *locked(&self.workers));
            idle.into_iter()
                .for_each(|worker| drop(ManuallyDrop::into_inner(worker)));
        }
    }
}

impl DeviceScene<'_> {
    /// Returns an error if the device has failed.
    ///
    /// # Errors
    /// The reason.
    pub fn check(&self) -> Result<(), DeviceError> {
        match self.failure.get() {
            None | Some(DeviceFault::Stopped) => Ok(()),
            Some(fault) => Err(failed(self.device.name(), fault)),
        }
    }

    /// Returns the device with its work since the last call.
    pub fn take_work(&self) -> UsedDevice {
        UsedDevice {
            name: self.device.name().to_owned(),
            kernels: mem::take(&mut *locked(&self.kernels)),
            multiprocessors: locked(&self.multiprocessors).take(),
            processor_shades_because_of: self.paths.as_ref().err().cloned(),
        }
    }

    /// Adds a launch that took `ns` nanoseconds, given its answers, to the work of its kernel.
    fn add<const N: usize>(
        &self,
        kernel: Kernel,
        queue: &mut dyn LaunchQueue,
        ns: f64,
        answers: &[[u32; N]],
    ) -> Result<DeviceLaunch, DeviceFault> {
        // An answer has the node visits and the primitive tests there.
        let first = if kernel == Kernel::PATH { 6 } else { 3 };
        let steps =
            |answer: &[u32; N]| answer[first..first + 2].iter().map(|&n| u64::from(n)).sum();
        let steps: Vec<u64> = answers.iter().map(steps).collect();
        let name = kernel.name;
        let mut kernels = locked(&self.kernels);
        let number = match kernels.iter().position(|work| work.name == name) {
            Some(number) => number,
            None => {
                kernels.push(no_work(kernel, queue)?);
                kernels.len() - 1
            }
        };
        Ok(kernels[number].add(ns, steps.into_iter()))
    }

    /// Answers the queries of `n` rays, given their words. Calls `answer` with each ray's number
    /// and the words of its answer; for none if the device fails.
    fn answer<const M: usize, const N: usize>(
        &self,
        kernel: Kernel,
        rays: impl Iterator<Item = [u32; M]>,
        n: usize,
        answer: impl FnMut((usize, &[u32; N])),
    ) -> DeviceLaunch {
        if self.failure.get().is_some() || n == 0 {
            return DeviceLaunch::default();
        }
        match self.launch::<M, N>(kernel, rays, n) {
            Ok((worker, launch)) => {
                let answers = worker.output.as_chunks::<N>().0;
                answers.iter().enumerate().for_each(answer);
                locked(&self.workers).push(worker);
                launch
            }
            Err(fault) => {
                let _ = self.failure.set(fault);
                self.cancellation.cancel();
                DeviceLaunch::default()
            }
        }
    }

    fn launch<const M: usize, const N: usize>(
        &self,
        kernel: Kernel,
        rays: impl Iterator<Item = [u32; M]>,
        n: usize,
    ) -> Result<(ManuallyDrop<Worker>, DeviceLaunch), DeviceFault> {
        let idle = locked(&self.workers).pop();
        let mut worker = idle.map_or_else(|| self.worker(), Ok)?;
        let of = &mut *worker;
        of.input.clear();
        of.input.extend(rays.flatten());
        of.output.resize(N * n, 0);
        let ns = of.queue.launch(kernel, &of.input, &mut of.output, n)?;
        if kernel == Kernel::PATH {
            let seen = Instant::now();
            let runs = multiprocessors::runs_of(of.output.as_chunks().0);
            locked(&self.multiprocessors).add(runs, seen);
        }
        let launch = self.add(kernel, &mut *of.queue, ns, of.output.as_chunks::<N>().0)?;
        Ok((worker, launch))
    }

    fn worker(&self) -> Result<ManuallyDrop<Worker>, DeviceFault> {
        Ok(ManuallyDrop::new(Worker {
            queue: Arc::clone(&self.loaded).queue()?,
            input: Vec::new(),
            output: Vec::new(),
        }))
    }
}

/// Returns the work of a kernel that has not been launched.
fn no_work(kernel: Kernel, queue: &mut dyn LaunchQueue) -> Result<KernelWork, DeviceFault> {
    let facts = queue.facts(kernel)?;
    Ok(KernelWork {
        name: kernel.name.to_owned(),
        launches: 0,
        rays: 0,
        seconds: 0.0,
        group_size: GROUP,
        warp_size: facts.warp_size,
        private_bytes: facts.private_bytes,
        registers: facts.registers,
        occupancy: facts.occupancy,
        steps: 0,
        lane_steps: 0,
    })
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
        self.answer::<N_IN, N_OUT>(Kernel::NEAREST, words, rays.len(), |(i, answer)| {
            let [t, primitive, instance, n_visits, n_tests] = *answer;
            hits[i] = hit([t, primitive, instance]);
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
        self.answer::<N_IN, N_OUT>(Kernel::OCCLUDED, words, rays.len(), |(i, answer)| {
            let [found, _, _, n_visits, n_tests] = *answer;
            occluded[i] = found != NONE;
            count(i, n_visits, n_tests);
        })
    }

    fn follows_paths(&self, sampler: &Sampler, cone: Option<RayCone>) -> bool {
        self.paths.as_ref().is_ok_and(|of| *of == (*sampler, cone))
    }

    fn follow(&self, paths: &PathStream, take: TakePath) -> DeviceLaunch {
        let words = paths.rays.iter().enumerate().map(|(i, ray)| {
            let [pixel, sample] = paths.samples.get(i).copied().unwrap_or_default();
            let [a, b, c, d, e, f, ..] = words(&ray, 0.0, NONE);
            let [g, h, j, k] = paths.media.get(i).copied().unwrap_or_default();
            [a, b, c, d, e, f, pixel, sample, g, h, j, k]
        });
        self.answer::<N_START, N_RESULTS>(Kernel::PATH, words, paths.rays.len(), |(i, result)| {
            let (path, hit) = followed(result);
            take(i, &path, hit);
        })
    }
}

/// Returns the hit with these words.
fn hit([t, primitive, instance]: [u32; 3]) -> Option<Hit> {
    (t != NONE).then(|| Hit {
        t: f32::from_bits(t),
        primitive,
        instance: instance.checked_sub(1).map(InstanceId),
    })
}

/// Returns a followed path with the hit of its camera ray, given its words.
fn followed(result: &[u32; N_RESULTS]) -> (FollowedPath, Option<Hit>) {
    let [red, green, blue, t, primitive, instance, rest @ ..] = *result;
    let [n_visits, n_tests, n_shadows, rest @ ..] = rest;
    let [n_reflected, n_refracted, n_diffuse, rest @ ..] = rest;
    let [depth, bounces @ .., _, _, _, cycles, sm] = rest;
    let path = FollowedPath {
        color: Vec3::from([red, green, blue].map(f32::from_bits)),
        cost: Cost {
            node_visits: n_visits.into(),
            primitive_tests: n_tests.into(),
            rays: [0, n_shadows, n_reflected, n_refracted, n_diffuse].map(u64::from),
            depth: depth.into(),
        },
        bounces,
        cycles: (cycles > 0).then_some(cycles),
        sm: (sm != NONE).then_some(sm),
    };
    (path, hit([t, primitive, instance]))
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
