//! The results of a study: tables, plots and the report on the terminal.

use std::fs;
use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::intervals::{interval_of, shown_ms};
use super::steps;
use crate::cli::{Failure, shown};
use host::folder::{Replace, write_file};
use host::text::one_line;
use tools::study::{
    Figure, LeftOutStep, LogLaw, PlotSpec, RooflinePoint, Series, StatisticsRow, StudyPlan,
    bottleneck_report, label_of, write_csv,
};

/// The results of a study.
pub(super) struct StudyResults<'a> {
    pub(super) plan: &'a StudyPlan,
    /// The statistics of all points.
    pub(super) rows: &'a [StatisticsRow],
    /// The points of the roofline, if the study requests it.
    pub(super) points: Option<&'a [RooflinePoint]>,
    /// The steps that could not be made.
    pub(super) left_out: &'a [LeftOutStep],
}

/// Maximum number of characters of a plot's name; its number is unique.
const MAX_PLOT_NAME: usize = 200;

/// Writes the tables and plots of a study. Returns the lines on the plots: their laws, and which
/// have no values.
pub(super) fn write_tables(
    out: &Path,
    results: &StudyResults,
    made_by: &Value,
) -> Result<String, Failure> {
    let StudyResults { plan, rows, .. } = results;
    write_file(&out.join("statistics.csv"), Replace::Known, |file| {
        write_csv(rows, file)
    })?;
    let (mut fits, mut drawn, mut lines) = (Vec::new(), Vec::new(), String::new());
    for (number, plot) in plan.plots.iter().enumerate() {
        let Some(figure) = Figure::new(plot, &plan.title, rows) else {
            lines += &without_values(plot, number + 1);
            continue;
        };
        lines += &laws_of(plot, &figure);
        fits.extend(fits_of(plot, &figure));
        let x = plot.x.replace(['/', '\\', ':', '"'], "-");
        let name = format!("plot-{}-{}-over-{x}", number + 1, plot.y.join("-"));
        let name: String = name.chars().take(MAX_PLOT_NAME).collect();
        write_figure(&figure, out, &name)?;
        drawn.push(name);
    }
    remove_other_plots(out, &drawn)?;
    let mut all = json!({ "title": plan.title, "made_by": made_by, "fits": fits, "rows": rows });
    if let Some(points) = results.points {
        all["roofline"] = json!(points);
    }
    if !plan.steps.is_empty() {
        all["left_out"] = json!(results.left_out);
    }
    write_file(&out.join("statistics.json"), Replace::Known, |file| {
        Ok(serde_json::to_writer_pretty(file, &all)?)
    })?;
    Ok(lines)
}

/// Removes the plots that an earlier version of the study drew from fewer runs.
fn remove_other_plots(out: &Path, drawn: &[String]) -> Result<(), Failure> {
    let failed = |error| super::cannot_write(out, &error);
    for entry in fs::read_dir(out).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let [stem, ending] = [path.file_stem(), path.extension()]
            .map(|part| part.unwrap_or_default().to_string_lossy().into_owned());
        let is_plot = stem.starts_with("plot-") && ["svg", "png"].contains(&&*ending);
        if is_plot && !drawn.contains(&stem) {
            fs::remove_file(&path).map_err(failed)?;
        }
    }
    Ok(())
}

/// Returns the note on a plot that no run has values for.
fn without_values(PlotSpec { x, y, .. }: &PlotSpec, number: usize) -> String {
    let (x, y) = (one_line(x), y.join("` or `"));
    format!("\nnote    plot {number} has no values: no run has `{y}` over `{x}`\n")
}

/// Returns a line for each law of a plot.
fn laws_of(plot: &PlotSpec, figure: &Figure) -> String {
    let line = |series: &Series| {
        let label = match &*series.label {
            "" => figure.y_title.clone(),
            label => label.to_owned(),
        };
        let (label, x) = (one_line(&label), one_line(&figure.x_title));
        Some(format!("law     {label} = {}, x: {x}\n", series.law?))
    };
    let lines: String = figure.series.iter().filter_map(line).collect();
    match (plot.fit, &*lines) {
        (true, "") => {
            "\nnote    no law fits: it needs positive values at two sizes or more\n".to_owned()
        }
        (_, "") => lines,
        _ => format!("\n{lines}"),
    }
}

/// Returns the fitted laws of a plot with the labels of their series.
fn fits_of(plot: &PlotSpec, figure: &Figure) -> impl Iterator<Item = Value> {
    let fit = |series: &Series| {
        let law = series.law?;
        Some(json!({
            "x": plot.x,
            "y": plot.y,
            "series": series.label,
            "law": law,
            "log_law": LogLaw::fit(&series.samples()),
        }))
    };
    figure.series.iter().filter_map(fit)
}

/// Writes a plot as SVG and PNG.
pub(super) fn write_figure(figure: &Figure, out: &Path, name: &str) -> Result<(), Failure> {
    let path_of = |ending| out.join(format!("{name}.{ending}"));
    write_file(&path_of("svg"), Replace::Known, |file| {
        file.write_all(figure.to_svg().as_bytes())
    })?;
    write_file(&path_of("png"), Replace::Known, |file| {
        figure.write_png(file)
    })?;
    Ok(())
}

/// Returns the report on a study: title, render time of each point, notes, the lines on its plots,
/// and the folder.
pub(super) fn lines_of(results: &StudyResults, of_plots: &str, out: &Path) -> String {
    let plan = results.plan;
    let table = if plan.steps.is_empty() {
        table_of_points(results.rows)
    } else {
        steps::lines_of(results.rows, results.left_out)
    };
    let mut text = format!("{}\n\n{table}", one_line(&plan.title));
    text += &overheads(results.rows);
    text += &notes(
        results
            .rows
            .iter()
            .filter(|row| row.metric == "render_wall_ms"),
    );
    text += of_plots;
    if let Some(points) = results.points {
        let unknown = || "unknown: no run had both counters and a BVH".to_owned();
        let report = bottleneck_report(points).unwrap_or_else(unknown);
        text += &format!("\nbound   {report}\n");
    }
    text + &format!("\nwrote   {}/\n\n", shown(out))
}

/// Returns a table of the render time of each point.
fn table_of_points(rows: &[StatisticsRow]) -> String {
    let mut text = String::new();
    let label = |row: &StatisticsRow| one_line(&label_of(&row.point)).into_owned();
    let walls = || rows.iter().filter(|row| row.metric == "render_wall_ms");
    let width = walls()
        .map(|row| label(row).chars().count())
        .max()
        .unwrap_or(0);
    let width = width.max("point".len());
    let heading = ["point", "render time", "95 % interval", "runs"];
    let [point, time, interval, runs] = heading;
    text += &format!("{point:<width$}  {time:>11}  {interval:<20}  {runs:>4}\n");
    for row in walls() {
        let statistics = &row.statistics;
        text += &format!(
            "{:<width$}  {:>11}  {:<20}  {:>4}\n",
            label(row),
            shown_ms(statistics.median),
            interval_of(statistics),
            statistics.n,
        );
    }
    text
}

/// Returns a line for the CPU time that measuring adds at each point of a study of `cost`.
fn overheads(rows: &[StatisticsRow]) -> String {
    let percent = |share: f64| format!("{:+.1} %", 100.0 * share);
    let line = |row: &StatisticsRow| {
        let interval = row.statistics.interval.map(|interval| {
            let [low, high] = [interval.low_95, interval.high_95].map(percent);
            format!(" [{low}, {high}]")
        });
        let label = label_of(&row.point);
        let median = percent(row.statistics.median);
        let interval = interval.unwrap_or_default();
        format!(
            "measure {}: {median} CPU time{interval}\n",
            one_line(&label)
        )
    };
    let overheads = rows.iter().filter(|row| row.metric == "measuring_overhead");
    let lines: String = overheads.map(line).collect();
    match &*lines {
        "" => lines,
        _ => format!("\n{lines}"),
    }
}

/// Returns notes on outliers and what to do about them; empty if there are none.
fn notes<'a>(rows: impl Iterator<Item = &'a StatisticsRow> + Clone) -> String {
    let mut text = String::new();
    let n_points = rows.clone().count();
    let n_slow = rows.clone().filter(|row| row.first_is_slow).count();
    if n_slow > 0 {
        text += &format!(
            "note    the first run of {n_slow} of {n_points} points was slow: increase `warm_up` \
             by one\n"
        );
    }
    let n_runs: usize = rows.clone().map(|row| row.statistics.n).sum();
    let n_outliers: usize = rows.map(|row| row.statistics.n_outliers).sum();
    if n_outliers > 0 {
        text += &format!(
            "note    {n_outliers} of {n_runs} runs are outliers, which count: stop other programs \
             on this machine,\n        or increase `repeats`\n"
        );
    }
    if text.is_empty() {
        text
    } else {
        format!("\n{text}")
    }
}

/// Returns the last lines, which apply to all studies.
pub(super) fn last_lines(made_by: &Value, n_left: usize) -> String {
    let mut text =
        "files   runs.jsonl, statistics.csv, statistics.json and plots in each folder\n".to_owned();
    for (key, metrics) in [
        ("no_hardware_counters", "cycles, instructions and misses"),
        ("no_energy", "energy"),
    ] {
        if let Some(reason) = made_by[key].as_str() {
            text += &format!("note    {metrics}: {reason}\n");
        }
    }
    if n_left > 0 {
        text += &format!(
            "left    {n_left} runs after the time budget: repeat the command to continue\n"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use tools::study::SampleStatistics;

    fn row(values: &[f64], first_is_slow: bool) -> StatisticsRow {
        StatisticsRow {
            point: serde_json::Map::new(),
            metric: "render_wall_ms".to_owned(),
            statistics: SampleStatistics::from_values(values).unwrap(),
            first_is_slow,
            oversubscribed: false,
        }
    }

    #[test]
    fn outliers_are_reported_with_a_remedy() {
        let even = row(&[1.0, 1.1, 0.9, 1.0, 1.05], false);
        assert_eq!(notes([&even].into_iter()), "");
        let uneven = row(&[9.0, 1.1, 0.9, 1.0, 1.05], true);
        let text = notes([&even, &uneven].into_iter());
        assert!(
            text.contains("first run of 1 of 2 points was slow"),
            "{text}"
        );
        assert!(text.contains("1 of 10 runs are outliers"), "{text}");
        assert!(
            text.contains("`warm_up`") && text.contains("`repeats`"),
            "{text}"
        );
    }
}
