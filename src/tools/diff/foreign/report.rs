//! A comparison with another program as text for the terminal.

use super::agreement::{CostAgreement, ObjectShare};
use super::comparison::{ForeignDiff, ForeignDifference, in_order};
use crate::diff::ratio;
use crate::diff::report::{MAX_ROWS, colors_sentence, entry, light_sentence, ratio_label, table};
use base::numbers::counted;
use host::text::one_line;
use output::chart::short_number;
use tracer::cost::{Metric, MetricUnit};

/// Returns the report for the terminal.
pub fn report(diff: &ForeignDiff) -> String {
    let sentences = [diff.output.sentence(), diff.file.sentence()];
    let mut text = String::new();
    for (letter, sentence) in ["A", "B"].iter().zip(in_order(sentences, diff.position)) {
        text += &entry(letter, &[one_line(&sentence).into_owned()]);
    }
    text.push('\n');
    let [x, y] = diff.greatest();
    let place = format!("the greatest difference is at pixel {x},{y}");
    text += &match &diff.comparison {
        ForeignDifference::Picture(picture) => {
            let mut sentence = colors_sentence(picture, diff.output.size());
            if picture.n_pixels > 0 {
                let psnr_db = 20.0 * (255.0 / picture.rms).log10();
                sentence += &format!(", PSNR {psnr_db:.1} dB; {place}");
            }
            entry("picture", &[sentence])
        }
        ForeignDifference::Light(light) => {
            let mut sentence = light_sentence(light);
            if light.max > 0.0 {
                sentence += &format!("; {place}");
            }
            entry("light", &[sentence])
        }
        ForeignDifference::Cost(metric, agreement) => costs(diff, *metric, agreement),
    };
    text
}

fn costs(diff: &ForeignDiff, metric: Metric, agreement: &CostAgreement) -> String {
    let mut text = entry("total", &[totals_sentence(diff, metric, agreement)]);
    text += &entry("ranks", &[ranks_sentence(agreement)]);
    text += &entry("hottest", &[hottest_sentence(agreement)]);
    let factor = match agreement.median_factor {
        factor if factor.is_finite() => {
            format!("half of the pixels agree within a factor of {factor:.2}")
        }
        _ => "only one of the two has a cost in half of the pixels".to_owned(),
    };
    text += &entry("scaled", &[format!("to the same sum, {factor}")]);
    text + &objects_table(&agreement.objects)
}

fn totals_sentence(diff: &ForeignDiff, metric: Metric, agreement: &CostAgreement) -> String {
    let totals = agreement.totals;
    let [own, foreign] = in_order(totals, diff.position);
    let (own, unit) = match metric.unit {
        MetricUnit::Nanoseconds => (metric.format(own), "is in ns".to_owned()),
        MetricUnit::Count | MetricUnit::Ratio => (
            format!("{} {}", metric.format(own), metric.label),
            format!("counts {}", metric.label),
        ),
    };
    let [a, b] = in_order([own, short_number(foreign)], diff.position);
    let letter = ["A", "B"][diff.position];
    let ratio = ratio_label(ratio(totals));
    format!("{a} in A, {b} in B; B / A is {ratio} if {letter} {unit}")
}

fn ranks_sentence(agreement: &CostAgreement) -> String {
    match agreement.rank_correlation {
        Some(correlation) => {
            format!("Spearman's correlation over the pixels is {correlation:.3}")
        }
        None => "no correlation: all pixels of A or of B have the same cost".to_owned(),
    }
}

fn hottest_sentence(agreement: &CostAgreement) -> String {
    let pixels = counted(agreement.n_hottest as u64, "pixel");
    let percent = 100.0 * agreement.hottest_in_common;
    format!("{percent:.0} % of the hottest 1 % ({pixels}) are the same, 1 % by chance")
}

fn objects_table(objects: &[ObjectShare]) -> String {
    if objects.is_empty() {
        return String::new();
    }
    let heading = ["share by what the camera sees", "A", "B", "B - A"].map(str::to_owned);
    let row = |object: &ObjectShare| {
        let [a, b] = object.shares.map(|share| format!("{:.1} %", 100.0 * share));
        let change = format!("{:+.1} %", 100.0 * object.change());
        [one_line(&object.name).into_owned(), a, b, change]
    };
    let rows = objects.iter().take(MAX_ROWS).map(row);
    format!("\n{}", table(std::iter::once(heading).chain(rows)))
}
