//! What a study leaves: tables, plots and the last lines on the terminal.

use std::io::Write;
use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};

use super::{Failure, shown};
use crate::folder::{Replace, write_file};
use crate::study::{Figure, Plan, Plot, Row, Series, Standing, verdict, write_csv};
use crate::text::numbers::duration;
use crate::text::one_line;

/// Writes the tables and plots of a study.
pub(super) fn write_tables(
    out: &Path,
    plan: &Plan,
    rows: &[Row],
    standings: Option<&[Standing]>,
    made_by: &Value,
) -> Result<(), Failure> {
    write_file(&out.join("statistics.csv"), Replace::Known, |file| {
        write_csv(rows, file)
    })?;
    let mut fits = Vec::new();
    for (number, plot) in plan.plots.iter().enumerate() {
        let Some(figure) = Figure::of(plot, &plan.title, rows) else {
            continue;
        };
        fits.extend(fits_of(plot, &figure));
        let name = format!("plot-{}-{}-over-{}", number + 1, plot.y.join("-"), plot.x);
        write_figure(&figure, out, &name)?;
    }
    let mut all = json!({ "title": plan.title, "made_by": made_by, "fits": fits, "rows": rows });
    if let Some(standings) = standings {
        all["roofline"] = json!(standings);
    }
    write_file(&out.join("statistics.json"), Replace::Known, |file| {
        Ok(serde_json::to_writer_pretty(file, &all)?)
    })?;
    Ok(())
}

/// The power laws of a plot, by the names of their series.
fn fits_of(plot: &Plot, figure: &Figure) -> impl Iterator<Item = Value> {
    let fit = |series: &Series| {
        let law = series.law?;
        Some(json!({ "x": plot.x, "y": plot.y, "series": series.label, "law": law }))
    };
    figure.series.iter().filter_map(fit)
}

/// Writes a plot as SVG and as PNG.
pub(super) fn write_figure(figure: &Figure, out: &Path, name: &str) -> Result<(), Failure> {
    let path_of = |ending| out.join(format!("{name}.{ending}"));
    write_file(&path_of("svg"), Replace::Known, |file| {
        file.write_all(figure.to_svg()?.as_bytes())
    })?;
    write_file(&path_of("png"), Replace::Known, |file| {
        file.write_all(&figure.to_png()?)
    })?;
    Ok(())
}

/// What was found and where it is.
pub(super) fn closing_lines(
    plan: &Plan,
    rows: &[Row],
    standings: Option<&[Standing]>,
    out: &Path,
) -> String {
    let mut text = format!("{}\n\n", one_line(&plan.title));
    let values = |row: &Row| {
        let values = row.point.iter().map(|(name, value)| match value {
            Value::String(text) => format!("{name} {text}"),
            number => format!("{name} {number}"),
        });
        one_line(&values.collect::<Vec<_>>().join(", ")).into_owned()
    };
    let walls = || rows.iter().filter(|row| row.metric == "render_wall_ms");
    let width = walls()
        .map(|row| values(row).chars().count())
        .max()
        .unwrap_or(0);
    for row in walls() {
        let statistics = &row.statistics;
        let ms = |ms: f64| duration(Duration::from_secs_f64(ms / 1e3));
        text += &format!(
            "{:<width$} {:>9}  95 % [{}, {}], {} runs\n",
            values(row),
            ms(statistics.median),
            ms(statistics.low_95),
            ms(statistics.high_95),
            statistics.n,
        );
    }
    text += &remedies(walls());
    if let Some(standings) = standings {
        let nothing = || "no run had counters and a hierarchy: nothing to hold up".to_owned();
        text += &format!("\nbound   {}\n", verdict(standings).unwrap_or_else(nothing));
    }
    text + &format!("\nwrote   {}/\n\n", shown(out))
}

/// Which runs stand apart and what to do about them; nothing if none does.
fn remedies<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> String {
    let mut text = String::new();
    let n_points = rows.clone().count();
    let n_slow = rows.clone().filter(|row| row.first_is_slow).count();
    if n_slow > 0 {
        text += &format!(
            "note    the first run of {n_slow} of {n_points} points was slow: give one more to \
             `warm_up`\n"
        );
    }
    let n_runs: usize = rows.clone().map(|row| row.statistics.n).sum();
    let n_outliers: usize = rows.map(|row| row.statistics.n_outliers).sum();
    if n_outliers > 0 {
        text += &format!(
            "note    {n_outliers} of {n_runs} runs are far from the others of their point: they \
             count; stop what\n        else runs on this machine, or raise `repeats`\n"
        );
    }
    match text.is_empty() {
        true => text,
        false => format!("\n{text}"),
    }
}

/// What is to be said of all studies.
pub(super) fn last_lines(made_by: &Value, n_left: usize) -> String {
    let mut text = "each    runs.jsonl, statistics.csv, statistics.json, plots\n".to_owned();
    if let Some(reason) = made_by["no_hardware_counters"].as_str() {
        text += &format!("note    cycles, instructions and misses: {reason}\n");
    }
    if n_left > 0 {
        text += &format!("left    {n_left} runs when the time was up: give the command again\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::SampleStatistics;

    fn row(values: &[f64], first_is_slow: bool) -> Row {
        Row {
            point: serde_json::Map::new(),
            metric: "render_wall_ms".to_owned(),
            statistics: SampleStatistics::of(values).unwrap(),
            first_is_slow,
            oversubscribed: false,
        }
    }

    #[test]
    fn runs_that_stand_apart_are_told_with_a_remedy() {
        let even = row(&[1.0, 1.1, 0.9, 1.0, 1.05], false);
        assert_eq!(remedies([&even].into_iter()), "");
        let uneven = row(&[9.0, 1.1, 0.9, 1.0, 1.05], true);
        let text = remedies([&even, &uneven].into_iter());
        assert!(
            text.contains("first run of 1 of 2 points was slow"),
            "{text}"
        );
        assert!(
            text.contains("1 of 10 runs are far from the others"),
            "{text}"
        );
        assert!(
            text.contains("`warm_up`") && text.contains("`repeats`"),
            "{text}"
        );
    }
}
