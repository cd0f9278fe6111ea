//! `lanes.csv`: the idle lanes of warps of several sizes, filled in several orders, and of the warps
//! of a device.

use std::io::{self, Write};

use super::file::{FileContent, OutputFile};
use base::Keyword;
use render::lanes::{IdleLanes, LaneKind, WarpSums};
use scene::config::{OptionalOutput, RayOrder, Warps};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "lanes.csv",
    is_wanted: |request| request.has(OptionalOutput::Lanes),
    content: FileContent::Written(|job, out| match job.rendering.lanes {
        Some(idle) => write(idle, out),
        None => Ok(()),
    }),
};

/// Writes a row for each kind of ray, order and size of warp, and for each query of a device one with
/// the order `launches`.
fn write(idle: &IdleLanes, out: impl Write) -> io::Result<()> {
    let mut rows = csv::Writer::from_writer(out);
    rows.write_record([
        "ray_kind",
        "order",
        "warp",
        "rays",
        "warps",
        "steps",
        "lane_steps",
        "idle_share",
    ])?;
    for kind in std::iter::once(None).chain(LaneKind::ALL.map(Some)) {
        let name = kind.map_or("all", LaneKind::name);
        for &order in RayOrder::KEYWORDS {
            for warp in Warps::SIZES {
                let sums = idle.sums(kind, Warps { warp, order });
                let words = [name.to_owned(), order.name().to_owned(), warp.to_string()];
                rows.write_record(words.into_iter().chain(numbers(&sums)))?;
            }
        }
    }
    for launched in &idle.launched {
        let warp = launched.warp.to_string();
        let words = [launched.query.to_owned(), "launches".to_owned(), warp];
        rows.write_record(words.into_iter().chain(numbers(&launched.sums)))?;
    }
    rows.flush()
}

fn numbers(sums: &WarpSums) -> [String; 5] {
    let share = match sums.lane_steps {
        0 => String::new(),
        _ => format!("{:.6}", sums.idle_share()),
    };
    let [rays, warps, steps, lane_steps] =
        [sums.n_rays, sums.n_warps, sums.steps, sums.lane_steps].map(|n| n.to_string());
    [rays, warps, steps, lane_steps, share]
}
