//! Renders tiles whose pixels have planned numbers of samples: the first ones of all pixels, then, by
//! these, the others.

use super::TileRenderer;
use super::sample_plan::SamplePlanner;
use super::stream::StreamRenderer;
use super::view::View;
use crate::film::Rendered;
use crate::schedule::Tile;
use tracer::cost::{Counters, Meter, NoProbe, PixelProbe, Stopwatch};

/// Creates the renderer of tiles without times, if efficiency decides about samples.
pub(super) fn planned<'a>(view: View<'a>, meter: &Meter) -> Option<Box<dyn TileRenderer + 'a>> {
    let planner = SamplePlanner::of(view)?;
    match meter {
        Meter::Off => {
            let stream = StreamRenderer::<NoProbe>::new(view);
            Some(Box::new(PlannedRenderer { stream, planner }))
        }
        Meter::Counters => {
            let stream = StreamRenderer::<Counters>::new(view);
            Some(Box::new(PlannedRenderer { stream, planner }))
        }
        Meter::Time(_) | Meter::SingleRayTime(_) => None,
    }
}

struct PlannedRenderer<'a, P> {
    stream: StreamRenderer<'a, P>,
    planner: SamplePlanner<'a>,
}

impl<P: PixelProbe> TileRenderer for PlannedRenderer<'_, P> {
    fn render(&mut self, tile: &Tile) {
        let Self { stream, planner } = self;
        let mut planned = std::mem::take(&mut stream.planned);
        if P::COUNTS {
            stream.render_first(tile);
            planner.plan_after(tile, stream, &mut planned);
            stream.planned = planned;
            stream.render_planned();
        } else {
            // Costs are not known: the planner renders all first samples, too.
            planner.plan(tile, &mut planned);
            stream.planned = planned;
            stream.render(tile);
        }
    }

    fn rendered(&mut self) -> Rendered<'_> {
        self.stream.rendered()
    }

    fn stopwatch(&mut self) -> &mut Stopwatch {
        self.stream.stopwatch()
    }
}
