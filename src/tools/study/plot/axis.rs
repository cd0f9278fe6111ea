//! The axes of plots: their ends and ticks.

use output::chart::{LabeledAxis, Scale, Ticks, short_number};

/// Length of a label as a share of a logarithmic axis.
const LABEL_GAP: f64 = 0.12;
/// Maximum number of steps between the labels of a linear axis.
const N_STEPS: f64 = 8.0;
/// Minimum distance between two labeled levels as a share of the axis.
const LEVEL_GAP: f64 = 0.07;

/// Returns an axis around these values, at least one, with margins at both ends.
pub(super) fn axis_around(values: impl Iterator<Item = f64>, scale: Scale) -> LabeledAxis {
    let ends = ends_around(values, scale);
    let ticks = match scale {
        Scale::Logarithmic => scale.ticks(ends, LABEL_GAP),
        Scale::Linear => Ticks {
            minor: Vec::new(),
            ..scale.ticks(ends, 1.0 / N_STEPS)
        },
    };
    LabeledAxis::new(scale, ends, ticks, short_number)
}

/// Returns an axis around these levels of a factor, which have labels where there is room.
pub(super) fn axis_of_levels(mut levels: Vec<f64>, scale: Scale) -> LabeledAxis {
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < 2 {
        return axis_around(levels.into_iter(), scale);
    }
    let ends = ends_around(levels.iter().copied(), scale);
    let ticks = Ticks::spaced(&levels, LEVEL_GAP, |level| scale.position(level, ends));
    LabeledAxis::new(scale, ends, ticks, short_number)
}

/// Returns an axis of the named positions 0, 1, ….
pub(super) fn axis_of_names(names: &[String]) -> LabeledAxis {
    let ticks = Ticks {
        major: (0..names.len()).map(|place| place as f64).collect(),
        minor: Vec::new(),
    };
    let ends = [-0.5, names.len() as f64 - 0.5];
    LabeledAxis::new(Scale::Linear, ends, ticks, |place| {
        names[place as usize].clone()
    })
}

fn ends_around(values: impl Iterator<Item = f64>, scale: Scale) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    match scale {
        Scale::Logarithmic => {
            let room = (high / low).powf(0.08).max(1.2);
            [low / room, high * room]
        }
        Scale::Linear => [low.min(0.0), high + 0.08 * (high - low.min(0.0)).max(1e-9)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_axis_has_few_round_ticks_from_zero() {
        let ticks = |high: f64| axis_around([high].into_iter(), Scale::Linear).ticks.major;
        assert_eq!(ticks(7.0), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let fifths = [0.0, 1.0, 2.0, 3.0, 4.0].map(|n| n * 0.2);
        assert_eq!(ticks(0.9), fifths);
    }

    #[test]
    fn levels_have_labels_where_there_is_room() {
        let levels = vec![1000.0, 1.0, 1.1, 8.0, 1.0];
        let ticks = axis_of_levels(levels, Scale::Logarithmic).ticks;
        assert_eq!(ticks.major, [1.0, 8.0, 1000.0]);
        assert_eq!(ticks.minor, [1.1]);
    }
}
