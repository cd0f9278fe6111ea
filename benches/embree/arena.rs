//! One scene, on which raycost and Embree build and trace in turn.

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

/// A quality of building, as raycost and as Embree have it.
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

/// A scene and the rays that are traced through it.
pub struct Arena<'a> {
    embree: &'static Functions,
    name: &'a str,
    primitives: &'a [Primitive],
    geometry: Geometry,
    rays: [(Kind, Rays); 4],
}

impl<'a> Arena<'a> {
    /// The scene with the rays of a square picture of `side` rows.
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

    /// How many rays are traced, all kinds together.
    pub fn n_rays(&self) -> usize {
        self.rays.iter().map(|(_, rays)| rays.len()).sum()
    }

    /// Whether all kernels give the same answers but for rounding; prints how
    /// many rays differ where some do.
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
                    if agreement.n_apart() > 0 {
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

    /// Races on one thread and on two, and tells of each result.
    ///
    /// # Errors
    /// Embree's.
    pub fn race(&self, course: Course, tell: &mut impl FnMut(Row)) -> Result<(), String> {
        for n_threads in [1, 2] {
            let course = Course {
                n_threads,
                ..course
            };
            // Embree builds on as many threads as any living device wants.
            let devices = self.devices(n_threads)?;
            for build in &BUILDS {
                let mut tell = |outcome| tell(self.row(build, n_threads, outcome));
                tell(self.race_builds(course, &devices, build)?);
                let accel = Accel::new(self.primitives, build.ours);
                let scenes = self.scenes(&devices, build)?;
                for (kind, rays) in &self.rays {
                    contest::outcomes(course, &accel, &rivals(&scenes, *kind), *kind, rays)
                        .into_iter()
                        .for_each(&mut tell);
                }
            }
        }
        Ok(())
    }

    /// Builds in turn.
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
            .zip(times[1..].iter().copied());
        let (isa, theirs) = fastest(embree).ok_or("there is no Embree device")?;
        let n = self.primitives.len();
        Ok(Outcome::new(Discipline::Build, n, times[0], theirs, isa))
    }

    /// Those of Embree's devices that the machine has.
    fn devices(&self, n_threads: usize) -> Result<Devices, String> {
        let device = |isa| Ok((isa, Device::new(self.embree, isa, n_threads)?));
        let devices: Vec<Result<_, String>> = ISAS.into_iter().map(device).collect();
        match devices.iter().any(Result::is_ok) {
            true => Ok(devices.into_iter().flatten().collect()),
            false => devices.into_iter().collect(),
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

/// How long the call takes, its result's end not included.
fn seconds<T>(call: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = call();
    let seconds = start.elapsed().as_secs_f64();
    drop(result);
    seconds
}
