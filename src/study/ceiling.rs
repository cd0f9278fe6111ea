//! Limits of a plot: straight lines on logarithmic axes, each with its name at
//! one end: right of the axes, or where lines rise, below their left end.

use plotters::coord::Shift;
use plotters::element::PathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::PowerLaw;
use super::axis::Axis;
use super::figure::{Ceiling, Figure, Mark};
use super::ink::{Drawn, draw_text, text_width};

/// Pixels from one name to the next.
const LINE_HEIGHT: i32 = 19;
const TEXT_SIZE: i32 = 16;
/// Pixels between a line's end and its name.
const NAME_GAP: i32 = 6;

/// What the left axis has to show of the ceilings: their named ends, and the
/// limits of points below the highest of them.
pub(super) fn heights(figure: &Figure, x: &Axis) -> Vec<f64> {
    let ceilings = figure.ceilings.iter();
    let ends = ceilings.map(|ceiling| ceiling.law.at(named_end(&ceiling.law, x)));
    let marks = figure.series.iter().flat_map(|series| &series.points);
    ends.chain(marks.filter_map(|mark| limit_of(figure, mark)))
        .collect()
}

/// The limit of a point, where no ceiling is below it.
pub(super) fn limit_of(figure: &Figure, mark: &Mark) -> Option<f64> {
    let limit = mark.limit?;
    let highest = figure.ceilings.iter().map(|ceiling| ceiling.law.at(mark.x));
    let highest = highest.fold(0.0, f64::max);
    (limit <= highest.max(mark.y)).then_some(limit)
}

/// Pixels that names take on the right of the axes.
pub(super) fn names_width<DB: DrawingBackend>(
    ceilings: &[Ceiling],
    area: &DrawingArea<DB, Shift>,
) -> i32 {
    let on_right = ceilings.iter().filter(|ceiling| !is_rising(ceiling));
    let widths = on_right.map(|ceiling| NAME_GAP + text_width(area, &ceiling.label, TEXT_SIZE));
    widths.max().unwrap_or(0)
}

/// Draws lines and names, `to_pixels` being where a point of the axes lies.
pub(super) fn draw<DB: DrawingBackend>(
    ceilings: &[Ceiling],
    (x, y): (&Axis, &Axis),
    to_pixels: impl Fn(f64, f64) -> (i32, i32),
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let (mut on_left, mut on_right) = (Vec::new(), Vec::new());
    for ceiling in ceilings {
        let Some([left, right]) = within(&ceiling.law, x, y) else {
            continue;
        };
        let ends = [left, right].map(|x| to_pixels(x, ceiling.law.at(x)));
        area.draw(&PathElement::new(ends, BLACK.mix(0.6).stroke_width(1)))?;
        if is_rising(ceiling) {
            let (x, y) = ends[0];
            on_left.push(((x + NAME_GAP, y + 3), ceiling));
        } else {
            let (x, y) = ends[1];
            on_right.push(((x + NAME_GAP, y - LINE_HEIGHT / 2), ceiling));
        }
    }
    draw_names(on_left, area)?;
    draw_names(on_right, area)
}

/// Draws names from the top: one that would cover the one above it moves down.
fn draw_names<DB: DrawingBackend>(
    mut names: Vec<((i32, i32), &Ceiling)>,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    names.sort_by_key(|((_, y), _)| *y);
    let mut lowest = i32::MIN;
    for ((x, y), ceiling) in names {
        let top = y.max(lowest);
        lowest = top + LINE_HEIGHT;
        draw_text(area, &ceiling.label, (x, top), TEXT_SIZE, HPos::Left)?;
    }
    Ok(())
}

fn is_rising(ceiling: &Ceiling) -> bool {
    ceiling.law.exponent > 0.0
}

/// Where the name stands: beyond it the lines lie apart, and none crosses it.
fn named_end(law: &PowerLaw, x: &Axis) -> f64 {
    match law.exponent > 0.0 {
        true => x.low,
        false => x.high,
    }
}

/// The part of the lower axis over which the line lies within the left one.
fn within(law: &PowerLaw, x: &Axis, y: &Axis) -> Option<[f64; 2]> {
    if law.exponent == 0.0 {
        let is_within = (y.low..=y.high).contains(&law.factor);
        return is_within.then_some([x.low, x.high]);
    }
    let mut crossings = [y.low, y.high].map(|y| (y / law.factor).powf(1.0 / law.exponent));
    crossings.sort_by(f64::total_cmp);
    let [left, right] = [crossings[0].max(x.low), crossings[1].min(x.high)];
    (left < right).then_some([left, right])
}

#[cfg(test)]
mod tests {
    use super::super::figure::Scale;
    use super::*;

    #[test]
    fn lines_end_where_the_axes_do() {
        let axis = |ends: [f64; 2]| {
            let mut axis = Axis::around(ends.into_iter(), Scale::Log);
            [axis.low, axis.high] = ends;
            axis
        };
        let (x, y) = (axis([1.0, 100.0]), axis([10.0, 1000.0]));
        let law = |factor, exponent| PowerLaw { factor, exponent };
        assert_eq!(within(&law(100.0, 1.0), &x, &y), Some([1.0, 10.0]));
        assert_eq!(within(&law(5000.0, -1.0), &x, &y), Some([5.0, 100.0]));
        assert_eq!(within(&law(1e6, -1.0), &x, &y), None);
        assert_eq!(within(&law(500.0, 0.0), &x, &y), Some([1.0, 100.0]));
        assert_eq!(within(&law(5000.0, 0.0), &x, &y), None);
    }
}
