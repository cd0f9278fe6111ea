//! The differences of an output and a file of another program.

use super::agreement::{CostAgreement, scaled_ratios};
use super::file::{ForeignContent, ForeignFile};
use crate::diff::{LightDifference, PictureDifference, Side};
use host::text::Diagnostic;
use tracer::cost::Metric;

/// An output folder and a file of another program, as A and B, and their differences.
#[derive(Debug)]
pub struct ForeignDiff {
    /// The output.
    pub output: Side,
    /// The file of the other program.
    pub file: ForeignFile,
    /// The position of the file: 0 for A, 1 for B.
    pub position: usize,
    /// The differences.
    pub comparison: ForeignDifference,
    /// The difference B - A of each pixel, row-major, row 0 on top: of the channel that differs
    /// most, or the logarithm to base 2 of the ratio of costs that are scaled to the same sum.
    pub map: Vec<f32>,
}

/// The differences, by the content of the file.
#[derive(Debug)]
pub enum ForeignDifference {
    /// Of two pictures of 8-bit colors.
    Picture(PictureDifference),
    /// Of linear light.
    Light(LightDifference),
    /// Of this metric and the cost of the other program.
    Cost(Metric, CostAgreement),
}

impl ForeignDiff {
    /// Compares an output with a file. `position` is that of the file. A cost map is compared `by` a
    /// metric, by default the time, or node visits if the output does not have it.
    ///
    /// # Errors
    /// If the output lacks the array to compare with.
    pub fn compare(
        output: Side,
        file: ForeignFile,
        position: usize,
        by: Option<Metric>,
    ) -> Result<Self, Diagnostic> {
        let (comparison, map) = match &file.content {
            ForeignContent::Cost(costs) => costs_compared(&output, costs, position, by)?,
            _ if by.is_some() => {
                let message = format!("`{}` does not hold a cost map", file.path.display());
                let help = "leave out `--by`, or give one number for each pixel";
                return Err(Diagnostic::new(message).with_help(help));
            }
            ForeignContent::Colors(colors) => {
                output.require(&["RGB"])?;
                let own = output.colors(output.rows())?;
                let [a, b] = in_order([&own, colors], position);
                let map = greatest_differences(a.iter().zip(b), f32::from);
                (
                    ForeignDifference::Picture(PictureDifference::compare(a, b)),
                    map,
                )
            }
            ForeignContent::Light(light) => {
                output.require(&["radiance"])?;
                let own = output.radiance(output.rows())?;
                let [a, b] = in_order([&own, light], position);
                let pixels = a.as_chunks::<3>().0.iter().zip(b.as_chunks::<3>().0);
                let map = greatest_differences(pixels, |channel| channel);
                (
                    ForeignDifference::Light(LightDifference::compare(a, b)),
                    map,
                )
            }
        };
        Ok(Self {
            output,
            file,
            position,
            comparison,
            map,
        })
    }

    /// Returns the pixel with the greatest difference that is finite: column and row.
    pub(super) fn greatest(&self) -> [usize; 2] {
        let sizes = self.map.iter().map(|difference| difference.abs());
        let finite = sizes.enumerate().filter(|(_, size)| size.is_finite());
        let greatest = finite.max_by(|(_, x), (_, y)| x.total_cmp(y));
        let pixel = greatest.map_or(0, |(pixel, _)| pixel);
        let width = self.output.size()[0] as usize;
        [pixel % width, pixel / width]
    }
}

/// Returns an output's and a file's values as those of A and B.
pub fn in_order<T>([own, foreign]: [T; 2], position: usize) -> [T; 2] {
    match position {
        0 => [foreign, own],
        _ => [own, foreign],
    }
}

/// Returns the difference B - A of each pixel in the channel that differs most.
fn greatest_differences<'a, T: Copy + 'a>(
    pixels: impl Iterator<Item = (&'a [T; 3], &'a [T; 3])>,
    number: impl Fn(T) -> f32,
) -> Vec<f32> {
    let difference = |(a, b): (&[T; 3], &[T; 3])| {
        let channels = a.iter().zip(b).map(|(a, b)| number(*b) - number(*a));
        let greatest = channels.max_by(|x, y| x.abs().total_cmp(&y.abs()));
        greatest.unwrap_or_default()
    };
    pixels.map(difference).collect()
}

fn costs_compared(
    output: &Side,
    foreign: &[f64],
    position: usize,
    by: Option<Metric>,
) -> Result<(ForeignDifference, Vec<f32>), Diagnostic> {
    let by_default = [Metric::TIME, Metric::NODE_VISITS];
    let by_default = by_default.into_iter().find(|metric| output.has(*metric));
    let metric = by.or(by_default).unwrap_or(Metric::NODE_VISITS);
    output.require(&[metric.name])?;
    let own = output.costs(metric, output.rows())?;
    if own.iter().all(|&cost| cost == 0.0) {
        let message = format!("`{}` has no {}", output.name(), metric.label);
        let help = "choose another metric with `--by`, such as `--by primitive_tests`";
        return Err(Diagnostic::new(message).with_help(help));
    }
    let objects = if output.has_array("object") {
        output.ids("object", output.rows())?
    } else {
        Vec::new()
    };
    let costs = in_order([&own[..], foreign], position);
    let agreement = CostAgreement::measure(costs, &objects, |id| output.object_name(id));
    let map = scaled_ratios(costs).map(|ratio| ratio.log2() as f32);
    Ok((ForeignDifference::Cost(metric, agreement), map.collect()))
}
