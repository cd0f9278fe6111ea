//! Steps that cannot be made here, and the report on the others.

use std::collections::HashMap;

use super::intervals::{interval_of, shown_ms};
use super::launcher::check_startable;
use crate::cli::device::parse_device;
use device::DeviceError;
use host::text::one_line;
use tools::study::{LeftOutStep, StatisticsRow, StudyPlan, StudyStep, label_of};

/// Removes the steps that this machine, this build or this call cannot make. Returns them.
pub(super) fn leave_out(plan: &mut StudyPlan, any_command: bool) -> Vec<LeftOutStep> {
    let launcher = plan.launcher.clone();
    // A device is tried once: its library compiles a kernel, and proves its arithmetic.
    let mut tried = HashMap::new();
    plan.leave_out(|step: &StudyStep| {
        if step.command.is_some() && !any_command {
            return Some("starts another program, which needs `--allow-commands`".to_owned());
        }
        let launcher = launcher.as_ref().filter(|_| step.has_ranks());
        let cannot_start = launcher.and_then(|launcher| check_startable(launcher).err());
        cannot_start
            .map(|fault| fault.message)
            .or_else(|| step.lacks_instructions())
            .or_else(|| {
                let device = step.device()?;
                let why = tried.entry(device.to_owned());
                why.or_insert_with(|| why_not_on(device)).clone()
            })
    })
}

/// Returns the reason why this machine cannot render on a device, if there is one.
fn why_not_on(device: &str) -> Option<String> {
    let choice = match parse_device(device) {
        Ok(choice) => choice,
        Err(expected) => return Some(expected),
    };
    let (DeviceError::Missing(why) | DeviceError::Failed(why)) = choice.open().err()?;
    Some(why.message().to_owned())
}

/// Returns a table of the steps: time, speedups, and the work of a ray; and the steps left out.
pub(super) fn lines_of(rows: &[StatisticsRow], left_out: &[LeftOutStep]) -> String {
    let heading = [
        "step",
        "render time",
        "95 % interval",
        "over last",
        "in all",
        "visits",
        "tests",
    ];
    let mut table = vec![heading.map(str::to_owned)];
    let has_scenes = rows
        .iter()
        .any(|row| row.point["scene"] != rows[0].point["scene"]);
    let times = rows.iter().filter(|row| row.metric == "render_wall_ms");
    table.extend(times.map(|time| {
        let name = if has_scenes {
            label_of(&time.point)
        } else {
            time.point["step"].as_str().unwrap_or_default().to_owned()
        };
        cells(rows, time, &name)
    }));
    let width = |column: usize| table.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..heading.len()).filter_map(width).collect();
    let mut text = String::new();
    for [step, others @ ..] in &table {
        text += &format!("{step:<0$}", widths[0]);
        for (cell, width) in others.iter().zip(&widths[1..]) {
            text += &format!("  {cell:>width$}");
        }
        text.push('\n');
    }
    for LeftOutStep { step, reason } in left_out {
        text += &format!(
            "\nnote    `{}` is left out: {}\n",
            one_line(step),
            one_line(reason)
        );
    }
    text
}

/// Returns the cells of a step by its render time; a metric that it lacks is empty.
fn cells(rows: &[StatisticsRow], time: &StatisticsRow, name: &str) -> [String; 7] {
    let of_step = |metric: &str, unit: &str| {
        let is_it = |row: &&StatisticsRow| row.metric == metric && row.point == time.point;
        let found = rows.iter().find(is_it);
        found.map_or(String::new(), |row| {
            three_digits(row.statistics.median) + unit
        })
    };
    let statistics = &time.statistics;
    [
        one_line(name).into_owned(),
        shown_ms(statistics.median),
        interval_of(statistics),
        of_step("speedup_over_step", " x"),
        of_step("speedup_over_start", " x"),
        of_step("node_visits_per_ray", ""),
        of_step("primitive_tests_per_ray", ""),
    ]
}

/// Returns a number with three digits or all of its whole ones.
fn three_digits(value: f64) -> String {
    let n_decimals = match value.abs() {
        ..10.0 => 2,
        ..100.0 => 1,
        _ => 0,
    };
    format!("{value:.n_decimals$}")
}
