//! A camera that moves around its target.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Pose;
use world::kinds;
use world::values::Number;

/// Moves the camera around its target, about its `up`, at the same distance and height. After a
/// whole number of turns, the frame after the last would equal the first.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(deny_unknown_fields, expecting = "an orbit such as { turns: 1 }")]
pub struct Orbit {
    /// The number of turns over all frames, counterclockwise as seen from above; clockwise if
    /// negative.
    #[serde(with = "Turns")]
    pub turns: f64,
}

kinds! {
    Turns: f32 = Number { expected: "a number of turns from -1000 to 1000", ranges: &[[-1000.0, 1000.0]] };
}

impl Orbit {
    /// Returns the eye at a frame.
    pub(super) fn eye(self, [eye, target, up]: Pose, frame: u32, n_frames: u32) -> [f64; 3] {
        let turn = self.turns * f64::from(frame) / f64::from(n_frames);
        // Exact after whole turns.
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * (turn - turn.floor()));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let length = dot(up, up).sqrt();
        if length == 0.0 || sin == 0.0 && cos == 1.0 {
            return eye;
        }
        let axis = up.map(|x| x / length);
        let arm = [0, 1, 2].map(|i| eye[i] - target[i]);
        let along = dot(axis, arm);
        let across = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            axis[j] * arm[k] - axis[k] * arm[j]
        });
        // Rodrigues' formula.
        [0, 1, 2].map(|i| {
            let flat = arm[i] - axis[i] * along;
            target[i] + axis[i] * along + flat * cos + across[i] * sin
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_goes_counterclockwise_about_up() {
        let orbit = Orbit { turns: 1.0 };
        let pose = [[1.0, 2.0, 5.0], [1.0, 1.0, 1.0], [0.0, 3.0, 0.0]];
        let eye = orbit.eye(pose, 1, 4);
        let expected = [5.0, 2.0, 1.0];
        assert!(
            (0..3).all(|i| (eye[i] - expected[i]).abs() < 1e-12),
            "{eye:?}"
        );
        assert_eq!(orbit.eye(pose, 0, 4), pose[0]);
        assert_eq!(orbit.eye(pose, 4, 4), pose[0]);
    }
}
