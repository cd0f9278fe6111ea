//! One scene that raycost and Embree build and trace in turn.

use std::iter;
use std::time::Instant;

use raycost::accel::Accel;
use raycost::config::{self, Acceleration};
use raycost::geometry::Shape;
use raycost::scene::Primitive;

use crate::agreement::Agreement;
use crate::contest::{self, fastest, rivals};
use crate::device::{Device, Geometry, Scene};
use crate::ffi::{Functions, Quality};
use crate::kernel::CountingStream;
use crate::race::{Course, in_turn};
use crate::rays::{self, Kind, Rays};
use crate::report::{Discipline, Outcome, Row, goal};
use crate::scenes::View;

/// A build quality of raycost and the corresponding one of Embree.
struct Build {
    names: [&'static str; 2],
    ours: Acceleration,
    embree: Quality,
}

const BUILDS: [Build; 2] = [
    Build {
        names: ["fast", "medium"],
        ours: Acceleration::Bvh(config::Quality::Fast),
        embree: Quality::Medium,
    },
    Build {
        names: ["high", "high"],
        ours: Acceleration::Bvh(config::Quality::High),
        embree: Quality::High,
    },
];

/// Embree's instruction sets.
pub const ISAS: [&str; 2] = ["avx2", "avx512"];

/// Devices by their instruction sets.
type Devices = Vec<(&'static str, Device)>;

/// A scene and the rays to trace through it.
pub struct Arena<'a> {
    embree: &'static Functions,
    name: &'a str,
    primitives: &'a [Primitive],
    geometry: Geometry,
    rays: [(Kind, Rays); 4],
}

impl<'a> Arena<'a> {
    /// The scene with the rays of a square image of `side` rows.
    pub fn new(
        embree: &'static Functions,
        name: &'a str,
        primitives: &'a [Primitive],
        view: &View,
        side: usize,
    ) -> Self {
        let accel = Accel::new(primitives, Acceleration::default());
        Self {
            embree,
            name,
            primitives,
            geometry: Geometry::of(primitives),
            rays: rays::all(&accel, primitives, view, side),
        }
    }

    /// Number of rays of all kinds.
    pub fn n_rays(&self) -> usize {
        self.rays.iter().map(|(_, rays)| rays.len()).sum()
    }

    /// Whether all kernels have the same answers up to rounding; prints the numbers
    /// of rays that differ.
    ///
    /// # Errors
    /// Embree's.
    pub fn check(&self) -> Result<bool, String> {
        let mut is_good = true;
        let devices = self.devices(1)?;
        for build in &BUILDS {
            let accel = Accel::new(self.primitives, build.ours);
            let scenes = self.scenes(&devices, build)?;
            for (kind, rays) in &self.rays {
                for rival in rivals(&scenes, *kind) {
                    let ours = CountingStream(&accel);
                    let agreement = Agreement::of(&ours, rival.kernel.as_ref(), rays);
                    if agreement.n_different() > 0 {
                        let [_, quality] = build.names;
                        println!(
                            "{}, {kind}, Embree {quality}, {rival}: {agreement}",
                            self.name
                        );
                    }
                    is_good &= agreement.is_good();
                }
            }
        }
        Ok(is_good)
    }

    /// Measures with one thread and with two; calls `report` with each result.
    ///
    /// # Errors
    /// Embree's.
    pub fn race(&self, course: Course, report: &mut impl FnMut(Row)) -> Result<(), String> {
        for n_threads in [1, 2] {
            let course = Course {
                n_threads,
                ..course
            };
            // Embree builds with the largest number of threads of any living device.
            let devices = self.devices(n_threads)?;
            for build in &BUILDS {
                let mut report = |outcome| report(self.row(build, n_threads, outcome));
                report(self.race_builds(course, &devices, build)?);
                let accel = Accel::new(self.primitives, build.ours);
                let scenes = self.scenes(&devices, build)?;
                for (kind, rays) in &self.rays {
                    contest::outcomes(course, &accel, &rivals(&scenes, *kind), *kind, rays)
                        .into_iter()
                        .for_each(&mut report);
                }
            }
        }
        Ok(())
    }

    /// Measures the builds, in turn.
    fn race_builds(
        &self,
        course: Course,
        devices: &Devices,
        build: &Build,
    ) -> Result<Outcome, String> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(course.n_threads)
            .build()
            .map_err(|error| error.to_string())?;
        let builders: Vec<_> = iter::once(None).chain(devices.iter().map(Some)).collect();
        let times = in_turn(course.n_rounds, &builders, |device| match device {
            None => pool.install(|| seconds(|| Accel::new(self.primitives, build.ours))),
            Some((_, device)) => seconds(|| device.scene(&self.geometry, build.embree)),
        });
        let embree = devices
            .iter()
            .map(|(isa, _)| *isa)
            .zip(times[1..].iter().map(Vec::as_slice));
        let (isa, theirs) = fastest(embree).ok_or("there is no Embree device")?;
        let n = self.primitives.len();
        Ok(Outcome::new(Discipline::Build, n, &times[0], theirs, isa))
    }

    /// Embree's devices for the instruction sets of the CPU.
    fn devices(&self, n_threads: usize) -> Result<Devices, String> {
        let device = |isa| Ok((isa, Device::new(self.embree, isa, n_threads)?));
        let devices: Vec<Result<_, String>> = ISAS.into_iter().map(device).collect();
        if devices.iter().any(Result::is_ok) {
            Ok(devices.into_iter().flatten().collect())
        } else {
            devices.into_iter().collect()
        }
    }

    fn scenes<'d>(
        &'d self,
        devices: &'d Devices,
        build: &Build,
    ) -> Result<Vec<(&'static str, Scene<'d>)>, String> {
        let scene = |(isa, device): &'d (&'static str, Device)| {
            Ok((*isa, device.scene(&self.geometry, build.embree)?))
        };
        devices.iter().map(scene).collect()
    }

    fn row(&self, build: &Build, n_threads: usize, outcome: Outcome) -> Row {
        let of_spheres = matches!(self.primitives[0].world_shape(), Some(Shape::Sphere(_)));
        Row {
            scene: self.name.to_owned(),
            quality: build.names,
            n_threads,
            goal: goal(outcome.discipline, build.embree, of_spheres),
            outcome,
        }
    }
}

/// The time of the call in seconds, without dropping its result.
fn seconds<T>(call: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = call();
    let seconds = start.elapsed().as_secs_f64();
    drop(result);
    seconds
}
