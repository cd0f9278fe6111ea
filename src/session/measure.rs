//! A scene → its pixels and their cost.

use std::sync::Arc;

use super::options::{Event, Options};
use super::rendering::Measured;
use super::scope::Scope;
use super::{RenderError, Session};
use base::stop;
use device::DeviceScene;
use host::affinity;
use host::text::Diagnostic;
use math::simd::Simd;
use output::limits;
use output::look::Look;
use output::summary::RanksSection;
use render::attribution::CostAttribution;
use render::instruments::Stages;
use render::lanes::IdleLanes;
use render::schedule::Schedule;
use render::tiles::{OnProgress, View, estimate_times, least_repeats, repeat_within};
use scene::build::Sensor;
use scene::config::{CostMode, SimdSet};
use tracer::accel::{Accel, BvhStatistics};
use tracer::cost::Meter;
use tracer::trace::Tracer;

impl Session {
    /// Renders and measures on the current rayon pool.
    pub(super) fn measure(
        &self,
        options: &Options,
        scope: &Scope,
        stages: &mut Stages,
    ) -> Result<Measured, RenderError> {
        // Build the hierarchy.
        let accel = self.accel(options, stages)?;
        let device = self.load(options, &accel)?;
        if device.is_some() {
            stages.end("load");
        }
        let of_processor = accel.clone();
        let accel = &accel.with_device(device.as_ref().map(|scene| scene as _));
        // Make the meter, which calibrates the clock.
        let (config, scene) = (&self.config, &self.scene);
        let tracer = Tracer::new(scene, accel);
        let meter = Meter::new(config.cost);
        if meter.clock().is_some() {
            stages.end("calibrate");
        }
        // Plan the tiles and their order, on the processor: a device may not count.
        let mut plan = scope.plan(Tracer::new(scene, &of_processor), config);
        if options.estimates_work {
            plan = estimate_times(plan, tracer, &meter);
        }
        if plan.is_estimated() {
            stages.end("order");
        }
        let n_pixels = config.image.n_pixels() as u64;
        // Render the passes onto the film.
        device.as_ref().map(DeviceScene::take_work);
        let n_rendered = u64::from(least_repeats(config)) * plan.n_pixels();
        let (mut film, schedule, repeats) =
            options.reported("render", n_rendered, |report: OnProgress| {
                let limits = &scope.limits;
                repeat_within(limits, config.repeats, tracer, &plan, &meter, report)
            });
        stages.end("render");
        let used_device = device.as_ref().map(DeviceScene::take_work);
        device.as_ref().map_or(Ok(()), DeviceScene::check)?;
        stop::check()?;
        scope.check()?;
        let ranks = dismiss_ranks(scope, &schedule);
        stop::check()?;
        scope.check()?;
        // Attribute the cost to objects and nodes.
        let is_attributed = CostAttribution::is_requested(&config.output) && scope.part.is_none();
        let attribution = is_attributed.then(|| {
            let sensor = &plan.sensor;
            let mut attribution = options.reported("observe", n_pixels, |report: OnProgress| {
                CostAttribution::measure(tracer, sensor, &film, &meter, &config.output, report)
            });
            film.keep_step_counts(std::mem::take(&mut attribution.step_counts));
            stages.end("observe");
            attribution
        });
        stop::check()?;
        // Put the rays in the lanes of warps.
        let warps = film.extra.lanes.filter(|_| scope.part.is_none());
        let lanes = warps.map(|warps| {
            let n_traced = n_pixels * (1 + u64::from(device.is_some()));
            let idle = options.reported("lanes", n_traced, |report: OnProgress| {
                IdleLanes::measure(tracer, &plan.sensor, &film, warps, report)
            });
            film.keep_idle_lanes(&idle.of_pixels, &idle.cycles, &idle.sms);
            stages.end("lanes");
            idle
        });
        device.as_ref().map_or(Ok(()), DeviceScene::check)?;
        stop::check()?;
        let hierarchy = (attribution.as_ref()).and_then(|costs| costs.hierarchy.as_ref());
        let epo = hierarchy.and_then(|hierarchy| hierarchy.nodes.first()?.epo);
        Ok(Measured {
            look: (scope.part.is_none()).then(|| Look::new(&film, config, tracer)),
            bvh: (accel.statistics()).map(|bvh| BvhStatistics { epo, ..bvh }),
            kernel: (accel.simd(), accel.traversal()),
            device: used_device,
            meter,
            film,
            n_tiles: plan.n_tiles(),
            schedule,
            repeats,
            attribution,
            lanes,
            ranks,
        })
    }

    /// Copies the scene to the memory of the device that traces its rays, if there is one.
    pub(super) fn load<'a>(
        &self,
        options: &'a Options,
        accel: &Accel,
    ) -> Result<Option<DeviceScene<'a>>, RenderError> {
        let Some(device) = &options.device else {
            return Ok(None);
        };
        if self.config.cost == CostMode::SingleRayTime {
            let message =
                "a device does not trace single rays: `--device` has no `single_ray_time`";
            let help = "measure `time`, or leave `--device` out";
            return Err(RenderError::Scene(Diagnostic::new(message).with_help(help)));
        }
        let sensor = Sensor::new(&self.scene, &self.config);
        let view = View::new(Tracer::new(&self.scene, accel), &sensor);
        let counts = self.config.cost.has_counters() || options.estimates_work;
        let (formulas, cancellation) = (&view.formulas(), &options.cancellation);
        Ok(Some(device.load(accel, formulas, counts, cancellation)?))
    }

    /// Returns the acceleration structure, reusing an existing one, or else building it or
    /// refitting the structure of another frame.
    pub(super) fn accel(
        &self,
        options: &Options,
        stages: &mut Stages,
    ) -> Result<Accel<'_>, RenderError> {
        let simd = options.simd.map(SimdSet::detect).transpose();
        let simd = simd.map_err(RenderError::Scene)?.unwrap_or_else(Simd::best);
        if let Some(index) = self.index.get() {
            let accel = Accel::from_index(&self.scene, Arc::clone(index));
            return Ok(accel.with_simd(simd).with_traversal(options.traversal));
        }
        options.report(Event::Begin {
            stage: "build",
            n_pixels: 0,
        });
        let report = |fraction| options.report(Event::Built { fraction });
        let n_rays = self.config.image.n_camera_rays();
        let base = self.base.get().map(|base| (base, n_rays));
        let accel = Accel::build_frame(&self.scene, self.config.acceleration, base, &report);
        options.report(Event::End);
        let accel = accel.map_err(|error| self.document.point_at(limits::too_large(error)))?;
        stages.end(if accel.is_refitted() {
            "refit"
        } else {
            "build"
        });
        // A build that was stopped is not whole.
        stop::check()?;
        let _ = self.index.set(accel.index());
        Ok(accel.with_simd(simd).with_traversal(options.traversal))
    }
}

/// Dismisses the other ranks, and returns the work of all of them.
fn dismiss_ranks(scope: &Scope, schedule: &Schedule) -> Option<RanksSection> {
    match scope.limits.team {
        Some(team) => Some(RanksSection::new(team, schedule, &team.dismiss())),
        None if scope.is_only_rank => Some(RanksSection::single(affinity::of_threads(), schedule)),
        None => None,
    }
}
