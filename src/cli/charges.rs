//! Tables of the cost of objects and materials for the terminal.

use host::text::truncated;
use output::writers::{Group, RenderingView};
use render::attribution::{AttributedCost, AttributionRule, CostAttribution, Work};
use tracer::cost::Metric;

/// Greatest number of rows of a table; the last one sums up the rest.
const MAX_ROWS: usize = 10;
/// Greatest number of characters of a name.
const MAX_NAME_CHARS: usize = 29;

/// A row: shares of the picture and of the cost by both attribution rules.
struct ShareRow {
    name: String,
    /// From 0 to 1.
    shares: [f64; 3],
}

/// Formats two tables with the share of the picture and the share of the cost of each object and
/// each material, the most expensive first.
pub(super) fn tables(rendering: &RenderingView, attribution: &CostAttribution) -> String {
    let whole = attribution.objects.iter().copied();
    let whole = whole.fold(AttributedCost::default(), AttributedCost::with);
    let all = whole.all(AttributionRule::Hit);
    let has_some = |metric: &Metric| all.get(*metric) > 0.0;
    let times = Metric::measured_by(rendering.film.cost).into_iter();
    let metric = times.chain(Work::COUNTED).find(has_some);
    let metric = metric.unwrap_or(Metric::RAYS);
    let groups = Group::all(rendering, attribution);
    groups
        .iter()
        .map(|group| table(group, &whole, metric))
        .collect()
}

fn table(group: &Group, whole: &AttributedCost, metric: Metric) -> String {
    let numbers = |account: &AttributedCost| {
        let [primary, hit] = AttributionRule::ALL.map(|rule| account.all(rule).get(metric));
        [account.n_pixels(), primary, hit]
    };
    let whole = numbers(whole);
    let row = |(name, account): (&String, &AttributedCost)| {
        let numbers = numbers(account);
        let share = |i: usize| numbers[i] / whole[i].max(1.0);
        ShareRow {
            name: truncated(name, MAX_NAME_CHARS),
            shares: std::array::from_fn(share),
        }
    };
    let mut rows: Vec<ShareRow> = group.names.iter().zip(group.accounts).map(row).collect();
    // The sort is stable: equal costs keep the scene's order.
    rows.sort_by(|a, b| b.shares[1].total_cmp(&a.shares[1]));
    sum_up_the_rest(&mut rows, group.kind);
    let widest = rows.iter().map(|row| row.name.chars().count()).max();
    let width = widest.unwrap_or(0).max(group.kind.len());
    let label = metric.label;
    let mut text = format!(
        "{:<8}{:<width$}  {:>8}  {:>8}  {:>8}   of {label}, charged to what the pixel shows, what each ray hits\n",
        "", group.kind, "pixels", "primary", "hit"
    );
    for ShareRow { name, shares } in rows {
        let [pixels, primary, hit] = shares.map(|share| format!("{:.1} %", 100.0 * share));
        text += &format!("        {name:<width$}  {pixels:>8}  {primary:>8}  {hit:>8}\n");
    }
    text
}

/// Sums up the rows beyond the limit in one row.
fn sum_up_the_rest(rows: &mut Vec<ShareRow>, kind: &str) {
    if rows.len() <= MAX_ROWS + 1 {
        return;
    }
    let rest = rows.split_off(MAX_ROWS);
    rows.push(ShareRow {
        name: format!("{} more {kind}s", rest.len()),
        shares: std::array::from_fn(|i| rest.iter().map(|row| row.shares[i]).sum()),
    });
}
