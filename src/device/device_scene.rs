//! A scene in the memory of a device.

use std::fmt;
use std::mem::{self, ManuallyDrop};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use glam::Vec3;

use crate::library::{DeviceFault, GROUP, LaunchQueue, LoadedProgram};
use crate::multiprocessors::{self, MultiprocessorTimes};
use crate::opened::{Device, DeviceError, failed};
use crate::paths::{N_RESULTS, RecordedPaths};
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
    let of_paths = paths.into_iter().flat_map(|paths| &paths.arrays);
    all.extend(of_paths.map(Vec::as_slice));
    // A device has no empty arrays.
    let empty = all.iter_mut().filter(|array| array.is_empty());
    empty.for_each(|array| *array = &[0]);
    all
}

/// A scene in the memory of a device, which traces its rays.
pub struct DeviceScene<'a> {
    device: &'a Device,
    loaded: LoadedProgram,
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
            let idle = mem::take(&mut *locked(&self.workers)).into_iter();
            idle.map(ManuallyDrop::into_inner).for_each(drop);
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

    /// Answers the queries of `n` rays, given their words. Calls `answer` with each ray's number
    /// and the words of its answer; for none if the device fails.
    fn answer<const N: usize>(
        &self,
        kernel: Kernel,
        words: impl Iterator<Item = u32>,
        n: usize,
        answer: impl FnMut((usize, &[u32; N])),
    ) -> DeviceLaunch {
        if self.failure.get().is_some() || n == 0 {
            return DeviceLaunch::default();
        }
        match self.launch::<N>(kernel, words, n) {
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

    /// Launches a kernel, and adds the launch to its work.
    fn launch<const N: usize>(
        &self,
        kernel: Kernel,
        words: impl Iterator<Item = u32>,
        n: usize,
    ) -> Result<(ManuallyDrop<Worker>, DeviceLaunch), DeviceFault> {
        let idle = locked(&self.workers).pop();
        let mut worker = idle.map_or_else(|| self.worker(), Ok)?;
        let of = &mut *worker;
        of.input.clear();
        of.input.extend(words);
        of.output.resize(N * n, 0);
        let ns = of.queue.launch(kernel, &of.input, &mut of.output, n)?;
        // An answer has the node visits and the primitive tests from there on.
        let mut first = 3;
        if kernel == Kernel::PATH {
            let seen = Instant::now();
            let runs = multiprocessors::runs_of(of.output.as_chunks().0);
            locked(&self.multiprocessors).add(runs, seen);
            first = 6;
        }
        let steps = |answer: &[u32; N]| answer[first..][..2].iter().map(|&n| u64::from(n)).sum();
        let answers = of.output.as_chunks::<N>().0.iter();
        let steps: Vec<u64> = answers.map(steps).collect();
        let mut kernels = locked(&self.kernels);
        let known = kernels.iter().position(|work| work.name == kernel.name);
        let number = known.unwrap_or(kernels.len());
        if known.is_none() {
            kernels.push(KernelWork {
                name: kernel.name.to_owned(),
                group_size: GROUP,
                ..of.queue.facts(kernel)?
            });
        }
        let launch = kernels[number].add(ns, steps.into_iter());
        Ok((worker, launch))
    }

    fn worker(&self) -> Result<ManuallyDrop<Worker>, DeviceFault> {
        Ok(ManuallyDrop::new(Worker {
            queue: (self.loaded)()?,
            input: Vec::new(),
            output: Vec::new(),
        }))
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
        let rest = [f32::INFINITY.to_bits(), NONE];
        let words = rays.iter().flat_map(|ray| words(&ray, rest));
        self.answer::<N_OUT>(Kernel::NEAREST, words, rays.len(), |(i, answer)| {
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
        let words = rays.iter().flat_map(|shadow| {
            let ignored = shadow.ignored.map_or(NONE, |object| object.0);
            words(&shadow.ray, [shadow.t_max.to_bits(), ignored])
        });
        self.answer::<N_OUT>(Kernel::OCCLUDED, words, rays.len(), |(i, answer)| {
            let [found, _, _, n_visits, n_tests] = *answer;
            occluded[i] = found != NONE;
            count(i, n_visits, n_tests);
        })
    }

    fn follows_paths(&self, sampler: &Sampler, cone: Option<RayCone>) -> bool {
        self.paths.as_ref().is_ok_and(|of| *of == (*sampler, cone))
    }

    fn follow(&self, paths: &PathStream, take: TakePath) -> DeviceLaunch {
        let words = paths.rays.iter().enumerate().flat_map(|(i, ray)| {
            let sample = paths.samples.get(i).copied().unwrap_or_default();
            let media = paths.media.get(i).copied().unwrap_or_default();
            words(&ray, sample).into_iter().chain(media)
        });
        self.answer::<N_RESULTS>(Kernel::PATH, words, paths.rays.len(), |(i, result)| {
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

/// Returns the words of a ray: origin, direction, and two more.
fn words(ray: &Ray, [a, b]: [u32; 2]) -> [u32; 8] {
    let [x, y, z] = ray.origin.to_array().map(f32::to_bits);
    let [u, v, w] = ray.direction.to_array().map(f32::to_bits);
    [x, y, z, u, v, w, a, b]
}

impl fmt::Debug for DeviceScene<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("DeviceScene").field(&self.device).finish()
    }
}
