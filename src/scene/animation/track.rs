//! The keyframes of one value, and the values between them.

use super::keyframe::{Interpolation, Keyframe, KeyframeValue};
use crate::yaml::{Fault, FieldPath};

/// Checks the keyframes of the value at `path`.
pub(super) fn check(track: &[Keyframe], n_frames: u32, path: &FieldPath) -> Result<(), Fault> {
    let Some(first) = track.first() else {
        let message = "there are no keyframes";
        return Err(Fault::new(
            path.clone(),
            message,
            "expected at least one { frame: …, value: … }",
        ));
    };
    for (index, keyframe) in track.iter().enumerate() {
        let path = path.clone().index(index);
        let Keyframe { frame, value, .. } = keyframe;
        if *frame >= n_frames {
            let message = format!("there is no frame {frame}");
            let expected = match n_frames {
                1 => "expected 0, the only frame".to_owned(),
                n => format!("expected 0 to {}", n - 1),
            };
            return Err(Fault::new(path.key("frame"), message, expected));
        }
        if let Some(before) = index.checked_sub(1).map(|before| track[before].frame)
            && before >= *frame
        {
            let message = if before == *frame {
                format!("frame {frame} has two keyframes")
            } else {
                format!("frame {frame} comes after frame {before}")
            };
            let expected = format!("expected more than {before}");
            let fault = Fault::new(path.key("frame"), message, expected);
            return Err(fault.with_help("put keyframes in the order of their frames"));
        }
        let is_alike = matches!(
            (value, &first.value),
            (KeyframeValue::Number(_), KeyframeValue::Number(_))
                | (KeyframeValue::List(_), KeyframeValue::List(_))
        ) && value.numbers().len() == first.value.numbers().len();
        if !is_alike {
            let message = format!("a keyframe has {}", value.kind());
            let expected = format!("expected {}, as in the first one", first.value.kind());
            return Err(Fault::new(path.key("value"), message, expected));
        }
    }
    Ok(())
}

/// Returns the value at a frame, given at least one keyframe: before the first and after the last,
/// the value of the nearest.
pub(super) fn value_at(
    track: &[Keyframe],
    interpolation: Interpolation,
    frame: u32,
) -> KeyframeValue {
    let next = track.partition_point(|keyframe| keyframe.frame <= frame);
    let Some(last) = next.checked_sub(1) else {
        return track[0].value.clone();
    };
    let (from, Some(to)) = (&track[last], track.get(next)) else {
        return track[last].value.clone();
    };
    let span = f64::from(to.frame - from.frame);
    let t = f64::from(frame - from.frame) / span;
    let number = |i: usize| {
        let [a, b] = [from, to].map(|keyframe| keyframe.value.numbers()[i]);
        match from.interpolation.unwrap_or(interpolation) {
            Interpolation::Linear => a + (b - a) * t,
            Interpolation::Smooth => {
                let [d, e] = [last, next].map(|index| slope(track, index, i) * span);
                hermite([a, b], [d, e], t).clamp(a.min(b), a.max(b))
            }
        }
    };
    let n = from.value.numbers().len();
    from.value.with_numbers((0..n).map(number))
}

/// Returns the change per frame of number `i` at a keyframe, after Fritsch and Butland, "A Method
/// for Constructing Local Monotone Piecewise Cubic Interpolants", 1984: the weighted harmonic mean
/// of the slopes on both sides, or 0 if they differ in sign, and at both ends.
fn slope(track: &[Keyframe], index: usize, i: usize) -> f64 {
    let (Some(before), Some(after)) = (index.checked_sub(1), track.get(index + 1)) else {
        return 0.0;
    };
    let (before, at) = (&track[before], &track[index]);
    let side = |from: &Keyframe, to: &Keyframe| {
        let span = f64::from(to.frame - from.frame);
        (
            span,
            (to.value.numbers()[i] - from.value.numbers()[i]) / span,
        )
    };
    let ((left, rise_before), (right, rise_after)) = (side(before, at), side(at, after));
    if rise_before * rise_after <= 0.0 {
        return 0.0;
    }
    let (w, v) = (2.0 * right + left, right + 2.0 * left);
    (w + v) / (w / rise_before + v / rise_after)
}

/// Returns the cubic with these end values and slopes, at `t` from 0 to 1.
fn hermite([a, b]: [f64; 2], [d, e]: [f64; 2], t: f64) -> f64 {
    let rise = b - a;
    a + t * (d + t * (3.0 * rise - 2.0 * d - e + t * (d + e - 2.0 * rise)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(numbers: &[(u32, f64)]) -> Vec<Keyframe> {
        let keyframe = |&(frame, number): &(u32, f64)| Keyframe {
            frame,
            value: KeyframeValue::Number(number),
            interpolation: None,
        };
        numbers.iter().map(keyframe).collect()
    }

    fn at(track: &[Keyframe], interpolation: Interpolation, frame: u32) -> f64 {
        value_at(track, interpolation, frame).numbers()[0]
    }

    #[test]
    fn values_pass_through_keyframes_and_stay_before_and_after() {
        let track = track(&[(2, 1.0), (4, 3.0), (10, -1.0)]);
        for interpolation in [Interpolation::Linear, Interpolation::Smooth] {
            let expected = [(0, 1.0), (2, 1.0), (4, 3.0), (10, -1.0), (12, -1.0)];
            for (frame, value) in expected {
                assert_eq!(at(&track, interpolation, frame), value);
            }
        }
        assert_eq!(at(&track, Interpolation::Linear, 3), 2.0);
        assert_eq!(at(&track, Interpolation::Smooth, 3), 2.0);
    }

    #[test]
    fn a_smooth_value_never_goes_beyond_its_keyframes_nor_back() {
        let numbers = [(0, 0.0), (1, 5.0), (90, 5.1), (91, 50.0), (100, 50.0)];
        let track = track(&numbers);
        let values: Vec<f64> = (0..=100)
            .map(|frame| at(&track, Interpolation::Smooth, frame))
            .collect();
        assert!(values.is_sorted());
    }

    /// SciPy 1.17, PchipInterpolator([0, 10, 30, 40], [0, 1, 7, 8])(t), between the second
    /// and the third keyframe, where both have the same slopes.
    #[test]
    fn between_inner_keyframes_the_curve_is_that_of_scipy() {
        let track = track(&[(0, 0.0), (10, 1.0), (30, 7.0), (40, 8.0)]);
        for (frame, expected) in SCIPY {
            let value = at(&track, Interpolation::Smooth, frame);
            assert!((value - expected).abs() < 1e-12, "{frame}: {value}");
        }
    }

    const SCIPY: [(u32, f64); 3] = [
        (12, 1.372_631_578_947_368_4),
        (20, 4.0),
        (27, 6.381_842_105_263_157),
    ];
}
