//! A diff as text for the terminal.

use std::time::Duration;

use super::gate::Gate;
use super::group::PixelBounds;
use super::noise::{Noise, Test};
use super::settings::{self, Setting};
use super::{
    CostGroup, Diff, EqualNoise, KernelTimes, LightDifference, PictureDifference, Side, Total,
    ratio,
};
use base::numbers::{count, counted, duration};
use host::text::one_line;
use math::statistics::CONFIDENCE;
use tracer::cost::Metric;

/// Greatest number of rows of a table of objects or tiles.
pub(super) const MAX_ROWS: usize = 5;
/// Greatest number of settings that are listed; the rest is counted.
const MAX_SETTINGS: usize = 12;

/// Returns the report for the terminal, the most important part first.
pub fn report(diff: &Diff, sides: &[Side; 2], gate: Option<&Gate>) -> String {
    let mut text = String::new();
    for (letter, side) in ["A", "B"].into_iter().zip(sides) {
        text += &entry(letter, &[one_line(&side.sentence()).into_owned()]);
    }
    if sides.iter().any(Side::is_cut) {
        text += &entry("pixels", &[common_pixels(diff.size, &sides[0])]);
    }
    text += &totals_table(diff);
    text += &entry("noise", &noise_lines(diff));
    if let Some(gate) = gate {
        text += &entry("gate", &[gate.sentence()]);
    }
    text += &kernels_table(&diff.kernels);
    text += &groups_table("by what the camera sees", &diff.objects);
    text += &groups_table("by what any ray meets", &diff.reached);
    text += &groups_table("by tile", &diff.tiles);
    text.push('\n');
    text += &entry("picture", &[picture_sentence(diff)]);
    let counters = diff.n_other_counts.map(|n| counters_sentence(n, diff.size));
    text += &entry("counters", counters.as_slice());
    let light = diff.light.as_ref().map(light_sentence);
    text += &entry("light", light.as_slice());
    let work = diff.equal_noise.as_ref().map(work_sentence);
    text += &entry("work", work.as_slice());
    text += &entry("settings", &setting_lines(&diff.settings));
    text += &entry("machine", &setting_lines(&diff.machine));
    text
}

/// Formats `name    first line`, with the other lines below the first.
pub(super) fn entry(name: &str, lines: &[String]) -> String {
    let names = std::iter::once(name).chain(std::iter::repeat(""));
    let line = |(name, line): (&str, &String)| format!("{name:<10}{line}\n");
    names.zip(lines).map(line).collect()
}

/// Returns the part of the picture that both outputs show.
fn common_pixels([width, height]: [u32; 2], a: &Side) -> String {
    let [x, y] = a.origin();
    format!("the {width} x {height} at {x},{y} of the picture, which both outputs show")
}

fn totals_table(diff: &Diff) -> String {
    let heading = ["cost", "A", "B", "B - A", "B / A"].map(str::to_owned);
    let row = |total: &Total| {
        let [a, b] = total.cost;
        let name = total.metric.label.to_owned();
        [
            name,
            total.metric.format(a),
            total.metric.format(b),
            total.metric.format_change(b - a),
            ratio_label(diff.ratio(total)),
        ]
    };
    let is_there = |total: &&Total| total.cost != [0.0; 2];
    let rows = diff.totals.0.iter().filter(is_there).map(row);
    format!("\n{}\n", table(std::iter::once(heading).chain(rows)))
}

/// Returns a table of the times of devices' kernels, and of the shares of idle lanes; empty if the
/// processor traced all rays itself.
fn kernels_table(kernels: &[KernelTimes]) -> String {
    if kernels.is_empty() {
        return String::new();
    }
    let heading = ["kernel", "A", "B", "B / A", "idle in A", "in B"].map(str::to_owned);
    let row = |kernel: &KernelTimes| {
        let seconds = [&kernel.a, &kernel.b].map(|work| work.as_ref().map(|work| work.seconds));
        let [a, b] = seconds.map(|seconds| match seconds {
            Some(seconds) => duration(Duration::from_secs_f64(seconds)),
            None => "-".to_owned(),
        });
        let ratio = match seconds {
            [Some(a), Some(b)] => ratio_label(ratio([a, b])),
            _ => String::new(),
        };
        let idle = [&kernel.a, &kernel.b].map(|work| work.as_ref()?.idle_share());
        let [idle_a, idle_b] = idle.map(|share| match share {
            Some(share) => format!("{:.1} %", 100.0 * share),
            None => "-".to_owned(),
        });
        [kernel.name.clone(), a, b, ratio, idle_a, idle_b]
    };
    let rows = kernels.iter().map(row);
    format!("\n{}", table(std::iter::once(heading).chain(rows)))
}

/// Returns a table of the groups whose main cost changed most.
fn groups_table(title: &str, groups: &[CostGroup]) -> String {
    let Some(first) = groups.first() else {
        return String::new();
    };
    let (metric, name) = match first.totals.cost(Metric::TIME) {
        Some(_) => (Metric::TIME, "time"),
        None => (Metric::NODE_VISITS, "nodes + tests"),
    };
    let n_changed = groups.iter().filter(|group| group.change() != 0.0).count();
    let (shown, rest) = groups.split_at(n_changed.min(MAX_ROWS));
    if shown.is_empty() {
        return format!("\n{name} {title}: the same\n");
    }
    let title = &format!("{name} {title}");
    let heading = [title, "A", "B", "B - A", "B / A", "nodes", "tests"].map(str::to_owned);
    let row = |group: &CostGroup| {
        let [a, b] = group.totals.main();
        let ratio_of = |metric| {
            group
                .totals
                .cost(metric)
                .map(|cost| ratio_label(ratio(cost)))
        };
        [
            name_and_place(group),
            metric.format(a),
            metric.format(b),
            metric.format_change(group.change()),
            ratio_label(ratio([a, b])),
            ratio_of(Metric::NODE_VISITS).unwrap_or_default(),
            ratio_of(Metric::PRIMITIVE_TESTS).unwrap_or_default(),
        ]
    };
    let rows = shown.iter().map(row);
    let mut text = format!("\n{}", table(std::iter::once(heading).chain(rows)));
    if !rest.is_empty() {
        let change = metric.format_change(rest.iter().map(CostGroup::change).sum());
        text += &format!("and {} more: {change} together\n", count(rest.len() as u64));
    }
    text
}

fn name_and_place(group: &CostGroup) -> String {
    match group.bounds {
        None => one_line(&group.name).into_owned(),
        Some(PixelBounds { x, y }) => {
            format!("{}, x {}..{}, y {}..{}", group.name, x[0], x[1], y[0], y[1])
        }
    }
}

fn work_sentence(found: &EqualNoise) -> String {
    let percent = |share: f64| format!("{:.1}", 100.0 * share);
    let [low, high] = found.interval.map(percent);
    format!(
        "B has the noise of A for {} % of its node visits and tests ({:.0} % confidence: {low} to {high} %)",
        percent(found.work),
        100.0 * CONFIDENCE,
    )
}

/// Formats a ratio, such as `0.902`; `new` if A's cost is 0.
pub(super) fn ratio_label(ratio: f64) -> String {
    if ratio.is_finite() {
        format!("{ratio:.3}")
    } else {
        "new".to_owned()
    }
}

/// Formats rows of cells, the first column flush left, the others flush right.
pub(crate) fn table<const N: usize>(rows: impl Iterator<Item = [String; N]>) -> String {
    let rows: Vec<[String; N]> = rows.collect();
    let width = |column: usize| {
        let widths = rows.iter().map(|row| row[column].chars().count());
        widths.max().unwrap_or(0)
    };
    let widths: [usize; N] = std::array::from_fn(width);
    let line = |row: &[String; N]| {
        let mut line = format!("{:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(widths).skip(1) {
            line += &format!("  {cell:>width$}");
        }
        format!("{}\n", line.trim_end())
    };
    rows.iter().map(line).collect()
}

fn noise_lines(diff: &Diff) -> Vec<String> {
    let mut lines = vec![noise_sentence(diff)];
    let is_device = |setting: &Setting| setting.name == settings::DEVICE;
    let is_hardware = |setting: &Setting| setting.name.starts_with("machine.");
    let differ = |is: &dyn Fn(&Setting) -> bool| diff.machine.iter().any(is);
    let which = match (differ(&is_hardware), differ(&is_device)) {
        (true, _) => Some("machines"),
        (false, true) => Some("devices"),
        (false, false) => None,
    };
    if let Some(which) = which.filter(|_| diff.noise.is_some()) {
        lines.push(format!(
            "A and B ran on different {which}, which changes their times too"
        ));
    }
    lines
}

/// Returns the result of the test of the times.
fn noise_sentence(diff: &Diff) -> String {
    let Some(noise) = &diff.noise else {
        return "none: counters are exact; a time is missing in A or B".to_owned();
    };
    let advice = "render both with `--repeats 10`";
    match noise {
        Noise::Unknown => format!(
            "a change of time cannot be tested without repeats: {advice}; counters are exact"
        ),
        Noise::Cut => "a change of time cannot be tested in a part of a picture; counters are \
                       exact"
            .to_owned(),
        Noise::TooFew(test) => format!(
            "a change of time cannot be tested with so few repeats, {advice}: {}",
            evidence(test)
        ),
        Noise::WithinNoise(test) => {
            format!("the change of time is within noise: {}", evidence(test))
        }
        Noise::Slower(test) => format!("B is slower by more than noise: {}", evidence(test)),
        Noise::Faster(test) => format!("B is faster by more than noise: {}", evidence(test)),
    }
}

/// Returns the estimate, its confidence interval and the test.
fn evidence(test: &Test) -> String {
    let estimate = ratio_label(test.ratio.estimate);
    let interval = test.ratio.interval.map_or(String::new(), |[low, high]| {
        let percent = 100.0 * CONFIDENCE;
        format!(
            " ({percent} %: {} to {})",
            ratio_label(low),
            ratio_label(high)
        )
    });
    let [n_a, n_b] = test.n;
    format!(
        "B / A is {estimate}{interval}; Mann-Whitney {}, {n_a} and {n_b} repeats",
        test.p_label()
    )
}

pub(super) fn light_sentence(light: &LightDifference) -> String {
    let LightDifference { mean, max, rms } = light;
    let [a, b] = mean;
    format!("mean {a:.5} in A, {b:.5} in B; the difference is {max:.5} at most, RMS {rms:.5}")
}

fn picture_sentence(diff: &Diff) -> String {
    let colors = colors_sentence(&diff.picture, diff.size);
    match diff.n_other_objects {
        0 => colors,
        n => format!(
            "{colors}; {} another object",
            match n {
                1 => "1 pixel sees".to_owned(),
                n => format!("{} see", counted(n, "pixel")),
            }
        ),
    }
}

/// Returns the number of pixels with other counters, of a picture of this size.
fn counters_sentence(n: u64, size: [u32; 2]) -> String {
    match n {
        0 => "the same in every pixel".to_owned(),
        n => format!("others in {} of {} pixels", count(n), n_pixels(size)),
    }
}

/// Returns the number of pixels of a picture of this size.
fn n_pixels(size: [u32; 2]) -> String {
    count(size.iter().map(|&n| u64::from(n)).product())
}

/// Returns the difference of the colors of two pictures of this size.
pub(super) fn colors_sentence(picture: &PictureDifference, size: [u32; 2]) -> String {
    let n_all = n_pixels(size);
    match picture.n_pixels {
        0 => "the same colors".to_owned(),
        n => format!(
            "{} of {n_all} pixels differ, by {} of 255 at most, RMS {:.2}",
            count(n),
            picture.max,
            picture.rms
        ),
    }
}

fn setting_lines(settings: &[Setting]) -> Vec<String> {
    if settings.is_empty() {
        return vec!["the same".to_owned()];
    }
    let line = |setting: &Setting| one_line(&setting.to_string()).into_owned();
    let mut lines: Vec<String> = settings.iter().take(MAX_SETTINGS).map(line).collect();
    if settings.len() > MAX_SETTINGS {
        lines.push(format!("and {} more", settings.len() - MAX_SETTINGS));
    }
    lines
}
