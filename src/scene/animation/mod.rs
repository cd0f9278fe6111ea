//! The `animation` section: frame number → values of the scene.
//!
//! A frame is the scene with other values at some paths, as if they were set on the command line:
//! values of keyframes, and the eye and the target of a moving camera. [`Animation::at_frame`] sets
//! them in the scene's text, so that each value is read and checked like any other, and a message
//! about it points at its keyframes.

mod keyframe;
mod track;
mod orbit;
mod fly_through;
mod frame_range;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use fly_through::FlyThrough;
pub use frame_range::FrameRange;
pub use keyframe::{Interpolation, Keyframe, KeyframeValue};
pub use orbit::Orbit;

use crate::yaml::{Document, Fault, FieldPath};
use host::text::Diagnostic;
use tracer::accel::HierarchyUpdate;
use world::kinds;
use world::values::{self, Number};

/// Values of the scene that change from frame to frame.
///
/// ```
/// # use raycost_scene::animation::Animation;
/// let animation: Animation = raycost_scene::yaml::from_str(r#"
/// frames: 48
/// fps: 24
/// interpolation: smooth
/// keyframes:
///   objects[0].sphere.radius: [{ frame: 0, value: 1 }, { frame: 47, value: 2 }]
///   materials.lamp.emission: [{ frame: 12, value: 0 }, { frame: 24, value: [9, 8, 7] }]
/// orbit: { turns: 1 }
/// "#).unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "an animation such as { frames: 48, orbit: { turns: 1 } }"
)]
pub struct Animation {
    /// The number of frames, 1 to 100,000; by default the number of time steps of the longest data
    /// series.
    #[serde(default, with = "values::Between::<1, MAX_FRAMES>")]
    pub frames: Option<u32>,
    /// Frames per second; 24 by default.
    #[serde(default = "default_fps", with = "FramesPerSecond")]
    pub fps: f32,
    /// The interpolation between keyframes that do not specify one.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Keyframes by the path of the value that they change.
    #[serde(default)]
    pub keyframes: IndexMap<String, Vec<Keyframe>>,
    /// Moves the camera around its target.
    #[serde(default)]
    pub orbit: Option<Orbit>,
    /// Moves the camera along a smooth path.
    #[serde(default)]
    pub fly_through: Option<FlyThrough>,
    /// How the hierarchy of a frame is made: built, or refitted from the first frame.
    #[serde(default)]
    pub hierarchy: HierarchyUpdate,
}

/// The key of the section.
pub const KEY: &str = "animation";
/// Frames per second if none are given.
const DEFAULT_FPS: f32 = 24.0;
/// Maximum number of frames of an animation.
pub const MAX_FRAMES: u32 = 100_000;

fn default_fps() -> f32 {
    DEFAULT_FPS
}

kinds! {
    FramesPerSecond: f32 = Number { expected: "frames per second from 0.001 to 1000", ranges: &[[0.001, 1000.0]] };
}

/// No keyframes, for scenes that only show a data series.
impl Default for Animation {
    fn default() -> Self {
        Self {
            frames: None,
            fps: DEFAULT_FPS,
            interpolation: Interpolation::default(),
            keyframes: IndexMap::new(),
            orbit: None,
            fly_through: None,
            hierarchy: HierarchyUpdate::default(),
        }
    }
}

impl Animation {
    /// Checks the keyframes and the camera's path for this number of frames.
    ///
    /// # Errors
    /// The first mistake.
    pub fn check(&self, n_frames: u32) -> Result<(), Fault> {
        let keyframes = section().key("keyframes");
        for (path, track) in &self.keyframes {
            track::check(track, n_frames, &keyframes.clone().key(path))?;
        }
        let Some(fly_through) = &self.fly_through else {
            return Ok(());
        };
        if self.orbit.is_some() {
            let message = "the camera cannot have an `orbit` and a `fly_through`";
            return Err(Fault::at_key(
                section().key("orbit"),
                message,
                "expected one of both",
            ));
        }
        fly_through.check(&section().key("fly_through"))
    }

    /// Returns the fault of an animation whose number of frames is not given.
    pub fn without_frames(&self) -> Fault {
        let message = "the animation has no number of frames";
        let fault = Fault::at_key(section(), message, "expected `frames` in it");
        fault.with_help("write `frames: 48`, or show a data series, whose time steps are frames")
    }

    /// Returns the scene at a frame of `n_frames`, which [`check`](Self::check) has accepted.
    ///
    /// # Errors
    /// A path that the scene does not have, or a camera that cannot move.
    pub fn at_frame(
        &self,
        scene: &Document,
        frame: u32,
        n_frames: u32,
    ) -> Result<Document, Diagnostic> {
        let mut scene = scene.clone();
        for (path, keyframes) in &self.keyframes {
            let key = section().key("keyframes").key(path);
            if let Some(fault) = fixed(path, &key) {
                return Err(scene.point_at(fault));
            }
            let value = track::value_at(keyframes, self.interpolation, frame);
            scene.set_for(path, &value.to_string(), key)?;
        }
        if let Some(orbit) = self.orbit {
            let key = section().key("orbit");
            let camera = PosedCamera::find(&scene, &key)?;
            let eye = orbit.eye(camera.pose, frame, n_frames);
            scene.set_for(&camera.path("eye"), &listed(eye), key)?;
        }
        if let Some(fly_through) = &self.fly_through {
            let key = section().key("fly_through");
            let camera = PosedCamera::find(&scene, &key)?;
            let [eye, target] = fly_through.pose(frame, n_frames);
            scene.set_for(&camera.path("eye"), &listed(eye), key.clone())?;
            scene.set_for(&camera.path("target"), &listed(target), key)?;
        }
        Ok(scene)
    }
}

/// Returns the fault of a path whose value cannot vary between frames; `None` for other paths.
fn fixed(path: &str, key: &FieldPath) -> Option<Fault> {
    let sections = ["animation", "include", "image.width", "image.height"];
    let is_in = |section: &&str| {
        let rest = path.strip_prefix(section);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    let section = sections.into_iter().find(is_in)?;
    let message = format!("`{section}` is the same in all frames");
    let expected = "expected the path of another value";
    Some(Fault::at_key(key.clone(), message, expected))
}

fn section() -> FieldPath {
    FieldPath::default().key(KEY)
}

/// Eye, target and up of a camera.
type Pose = [[f64; 3]; 3];

/// A camera with an eye and a target, which can move.
struct PosedCamera {
    /// The key in the section `camera`.
    kind: &'static str,
    pose: Pose,
}

impl PosedCamera {
    /// Finds the camera of a scene; a message about a camera that cannot move points at `key`.
    fn find(scene: &Document, key: &FieldPath) -> Result<Self, Diagnostic> {
        let find = |kind: &'static str| {
            let point = |name: &str| {
                let path = FieldPath::default().key("camera").key(kind).key(name);
                scene.value_at::<[f64; 3]>(&path)
            };
            let up = point("up").unwrap_or([0.0, 1.0, 0.0]);
            let pose = [point("eye")?, point("target")?, up];
            Some(Self { kind, pose })
        };
        let kinds = ["look_at", "orthographic", "panorama"];
        kinds.into_iter().find_map(find).ok_or_else(|| {
            let expected = "expected a camera with `eye` and `target`";
            let fault = Fault::at_key(key.clone(), "this camera cannot move", expected);
            scene.point_at(fault.with_help("use `look_at`, `orthographic` or `panorama`"))
        })
    }

    /// Returns the path of one of its values.
    fn path(&self, name: &str) -> String {
        format!("camera.{}.{name}", self.kind)
    }
}

/// Formats `[x, y, z]`.
fn listed(point: [f64; 3]) -> String {
    KeyframeValue::List(point.to_vec()).to_string()
}
