//! A session of a worker: it renders the tiles that rank 0 deals to it.

use super::options::without_thread;
use super::{Options, RenderError, Session};
use base::stop;
use device::DeviceScene;
use render::instruments::Stages;
use render::ranks::Ranks;
use render::tiles::{self, TilePlan};
use scene::build::Sensor;
use scene::config::{TileOrder, Tiling};
use tracer::cost::Meter;
use tracer::trace::Tracer;

impl Session {
    /// Renders the tiles that rank 0 deals to this rank.
    ///
    /// # Errors
    /// The errors of [`Self::render`].
    pub(crate) fn work(&self, options: &Options, ranks: &Ranks) -> Result<(), RenderError> {
        options.thread_pool()?.install(|| {
            let accel = self.accel(options, &mut Stages::default())?;
            let device = self.load(options, &accel)?;
            let accel = accel.with_device(device.as_ref().map(|scene| scene as _));
            let tracer = Tracer::new(&self.scene, &accel);
            let meter = Meter::new(self.config.cost);
            // The order of tiles comes from rank 0.
            let tiling = Tiling {
                order: TileOrder::Scanline,
                ..self.config.tiles
            };
            let plan = TilePlan::new(tracer, &Sensor::new(&self.scene, &self.config), tiling);
            let done = tiles::work(ranks, tracer, &plan, &meter);
            done.map_err(|error| RenderError::Machine(without_thread(&error)))?;
            device.as_ref().map_or(Ok(()), DeviceScene::check)?;
            Ok(stop::check()?)
        })
    }
}
