//! One scene that raycost and Embree build and trace in turn.

use std::iter;
use std::time::Instant;

use math::simd::Simd;
use scene::config::{self, Acceleration};
use tracer::accel::Accel;
use world::geometry::Shape;
use world::scene::Primitive;

use crate::agreement::Agreement;
use crate::contest::{self, fastest, rivals};
use crate::device::{Device, Geometry, Mode, Scene};
use crate::ffi::{Functions, Quality};
use crate::kernel::CountingStream;
use crate::race::{Course, in_turn};
use crate::rays::{self, Kind, Rays};
use crate::report::{Discipline, Outcome, Row, goal};
use crate::scenes::View;
use crate::selection::{BUILD, Selection};
use crate::tinybvh::{TinyBvh, Tree};

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

/// Devices by their instruction sets.
type Devices = Vec<(&'static str, Device)>;

/// A scene and the rays to trace through it.
pub struct Arena<'a> {
    selection: &'a Selection,
    /// raycost's instruction set.
    simd: Simd,
    pub name: &'a str,
    primitives: &'a [Primitive],
    geometry: Geometry,
    rays: [(Kind, Rays); 4],
}

impl<'a> Arena<'a> {
    /// Creates the scene with the rays of a square image of `side` rows.
    ///
    /// # Errors
    /// If the CPU does not have the selected instruction set.
    pub fn new(
        selection: &'a Selection,
        name: &'a str,
        primitives: &'a [Primitive],
        view: &View,
        side: usize,
    ) -> Result<Self, String> {
        let accel = Accel::new(primitives, Acceleration::default());
        Ok(Self {
            selection,
            simd: selection.simd()?,
            name,
            primitives,
            geometry: Geometry::of(primitives),
            rays: rays::all(&accel, primitives, view, side),
        })
    }

    /// Returns the number of rays of all kinds.
    pub fn n_rays(&self) -> usize {
        self.rays.iter().map(|(_, rays)| rays.len()).sum()
    }

    /// Returns true if all kernels have the same answers up to rounding; prints the numbers of rays
    /// that differ.
    ///
    /// # Errors
    /// Embree's errors.
    pub fn check(&self, embree: &'static Functions) -> Result<bool, String> {
        let mut is_good = true;
        let devices = self.devices(embree, 1)?;
        for build in &BUILDS {
            let accel = self.accel(build);
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

    /// Measures the selected races; calls `report` with each result.
    ///
    /// # Errors
    /// Embree's errors.
    pub fn race(
        &self,
        embree: &'static Functions,
        course: Course,
        report: &mut impl FnMut(Row),
    ) -> Result<(), String> {
        for &n_threads in &self.selection.threads {
            let course = Course {
                n_threads,
                ..course
            };
            // Embree builds with the largest number of threads of any living device.
            let devices = self.devices(embree, n_threads)?;
            let is_wanted = |build: &&Build| self.selection.has_quality(build.names[0]);
            for build in BUILDS.iter().filter(is_wanted) {
                let mut report = |outcome| report(self.row(build, n_threads, outcome));
                if self.selection.has_race(BUILD) {
                    report(self.race_builds(course, &devices, build)?);
                }
                let mut rays = self.rays.iter().filter(|(kind, _)| self.selects(*kind));
                let Some(first) = rays.next() else { continue };
                let accel = self.accel(build);
                let scenes = self.scenes(&devices, build)?;
                for (kind, rays) in iter::once(first).chain(rays) {
                    contest::outcomes(course, &accel, &rivals(&scenes, *kind), *kind, rays)
                        .into_iter()
                        .for_each(&mut report);
                }
            }
        }
        Ok(())
    }

    /// Traces the selected rays with single rays of raycost and of tinybvh, which takes part where
    /// the scene is made of triangles; calls `report` with each result and the rays that differ.
    pub fn race_tinybvh(
        &self,
        tinybvh: &TinyBvh,
        course: Course,
        report: &mut impl FnMut(Row, Agreement),
    ) {
        let is_wanted = |build: &&Build| self.selection.has_quality(build.names[0]);
        for build in BUILDS.iter().filter(is_wanted) {
            let Some(tree) = Tree::build(tinybvh, self.primitives, build.embree) else {
                return;
            };
            let accel = self.accel(build);
            for (kind, rays) in self.rays.iter().filter(|(kind, _)| self.selects(*kind)) {
                let agreement = Agreement::of(&CountingStream(&accel), &tree, rays);
                let outcome = contest::against_tinybvh(course, &accel, &tree, *kind, rays);
                report(self.row(build, course.n_threads, outcome), agreement);
            }
        }
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
            Some((_, device)) => seconds(|| device.scene(&self.geometry, build.embree, Mode::Fast)),
        });
        let embree = devices
            .iter()
            .map(|(isa, _)| *isa)
            .zip(times[1..].iter().map(Vec::as_slice));
        let (isa, theirs) = fastest(embree).ok_or("there is no Embree device")?;
        let n = self.primitives.len();
        Ok(Outcome::new(Discipline::Build, n, &times[0], theirs, isa))
    }

    fn selects(&self, kind: Kind) -> bool {
        self.selection.has_race(&kind.to_string())
    }

    /// Returns the hierarchy with the selected instruction set.
    fn accel(&self, build: &Build) -> Accel<'a> {
        let accel = Accel::new(self.primitives, build.ours);
        accel.with_simd(self.simd)
    }

    /// Returns Embree's devices for the selected instruction sets that the CPU has.
    fn devices(&self, embree: &'static Functions, n_threads: usize) -> Result<Devices, String> {
        let device = |isa| Ok((isa, Device::new(embree, isa, n_threads)?));
        let isas = self.selection.isas();
        let devices: Vec<Result<_, String>> = isas.iter().copied().map(device).collect();
        if devices.iter().any(Result::is_ok) {
            Ok(devices.into_iter().flatten().collect())
        } else {
            devices.into_iter().collect()
        }
    }

    /// Returns a scene for each device and mode; spheres have only one mode.
    fn scenes<'d>(
        &'d self,
        devices: &'d Devices,
        build: &Build,
    ) -> Result<Vec<(&'static str, Scene<'d>)>, String> {
        let modes: &[Mode] = if self.is_of_spheres() {
            &[Mode::Fast]
        } else {
            &[Mode::Fast, Mode::Robust]
        };
        let pairs = devices
            .iter()
            .flat_map(|device| modes.iter().map(move |mode| (device, *mode)));
        let scene = |((isa, device), mode): (&'d (&'static str, Device), Mode)| {
            Ok((*isa, device.scene(&self.geometry, build.embree, mode)?))
        };
        pairs.map(scene).collect()
    }

    fn is_of_spheres(&self) -> bool {
        matches!(self.primitives[0].world_shape(), Some(Shape::Sphere(_)))
    }

    fn row(&self, build: &Build, n_threads: usize, outcome: Outcome) -> Row {
        Row {
            scene: self.name.to_owned(),
            quality: build.names,
            n_threads,
            goal: goal(outcome.discipline, build.embree, self.is_of_spheres()),
            outcome,
        }
    }
}

/// Returns the time of the call in seconds, without dropping its result.
fn seconds<T>(call: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    let result = call();
    let seconds = start.elapsed().as_secs_f64();
    drop(result);
    seconds
}
