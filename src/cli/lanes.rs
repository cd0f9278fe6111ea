//! The table of idle lanes for the terminal.

use base::Keyword;
use render::lanes::{IdleLanes, LaneKind};
use scene::config::{RayOrder, Warps};

/// Formats the share of idle lanes by kind of ray and by order, for warps of the chosen size.
pub(super) fn table(idle: &IdleLanes, chosen: Warps) -> String {
    let orders = RayOrder::KEYWORDS.iter().copied();
    let names = orders.clone().map(|order| format!("{:>9}", order.name()));
    let idle_of = format!("idle of {}", chosen.warp);
    let mut text = format!("lanes   {idle_of:<11}{}\n", names.collect::<String>());
    let kinds = LaneKind::ALL.map(Some).into_iter().chain([None]);
    for kind in kinds {
        let shares = orders.clone().map(|order| {
            let sums = idle.sums(kind, Warps { order, ..chosen });
            match sums.lane_steps {
                0 => format!("{:>9}", "-"),
                _ => format!("{:>7.1} %", 100.0 * sums.idle_share()),
            }
        });
        let name = kind.map_or("all", LaneKind::name);
        text += &format!("        {name:<11}{}\n", shares.collect::<String>());
    }
    text
}
