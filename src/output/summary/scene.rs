//! The sections on the scene.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use base::Keyword;
use host::provenance::Checksum;
use math::simd::Simd;
use scene::config::{
    Acceleration, Adaptive, FilmSettings, Image, PictureWindow, PixelFilter, PixelPattern, Quality,
    ShadingModel, Traversal,
};
use tracer::accel::BvhStatistics;
use tracer::cost::{KernelWork, UsedDevice};
use world::camera::{ImagePlane, Projection};
use world::color::{Development, ToneCurve, Transfer};

/// The scene file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneSection {
    /// The file's stem.
    pub name: String,
    /// The path as the user typed it.
    pub file: String,
    /// The values set on the command line, such as `image.seed=7`; left out if none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
}

/// The frame of an animated scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameSection {
    /// Number, from 0.
    pub number: u32,
    /// The number of all frames.
    pub n_frames: u32,
    /// Time, as in the data series or in seconds of the video.
    pub time: f64,
    /// A hash of all inputs of the frame's files: if it differs, the frame is rendered again.
    pub fingerprint: Checksum,
    /// The values of the frame's ParaView states, from which the states of the series are made.
    #[serde(default)]
    pub states: serde_json::Value,
}

/// Size and sampling of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ImageSection {
    /// The number of columns.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// The number of camera rays through each pixel.
    pub samples_per_pixel: u32,
    /// Seed of the sampling pattern.
    pub seed: u64,
    /// The pattern of the samples in a pixel; left out if stratified.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sampler: PixelPattern,
    /// The pixel filter; left out if a box.
    #[serde(default, skip_serializing_if = "is_default")]
    pub filter: PixelFilter,
    /// The radius of the filter in pixels; left out if it is the filter's usual one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter_radius: Option<f32>,
    /// Adaptive sampling, whose maximum or mean is the samples per pixel; left out without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adaptive: Option<Adaptive>,
    /// The position in a larger picture; left out for a whole picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window: Option<PictureWindow>,
}

/// The conversion from light to the numbers of the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FilmSection {
    /// Exposure in stops.
    pub exposure: f32,
    /// The tone curve: `none`, `agx` or `aces`.
    pub tone_curve: String,
    /// The transfer function: `srgb` or `linear`.
    pub transfer: String,
}

/// Positions of the pixels in world space. Either `eye` or `direction` is given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CameraSection {
    /// The origin of all camera rays of a perspective camera, or the center of its lens.
    pub eye: Option<[f64; 3]>,
    /// The direction of all camera rays of an orthographic camera, a unit vector.
    pub direction: Option<[f32; 3]>,
    /// The sample point of the top left pixel.
    pub origin: [f64; 3],
    /// The step from one column to the next.
    pub right: [f32; 3],
    /// The step from one row to the row below.
    pub down: [f32; 3],
    /// True for a panorama's map, whose lengths are angles in radians.
    #[serde(default, skip_serializing_if = "is_default")]
    pub panorama: bool,
    /// The lens, if the camera has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lens: Option<LensSection>,
}

/// The lens of a camera, in world units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LensSection {
    /// Radius.
    pub radius: f32,
    /// The distance of the plane in focus.
    pub focus_distance: f32,
}

/// An object of the scene file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ObjectEntry {
    /// Name, if the scene file gives one.
    pub name: Option<String>,
    /// Shape: `sphere`, `mesh`, …
    pub kind: String,
    /// The names of its materials.
    pub materials: Vec<String>,
}

/// The acceleration structure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AccelerationSection {
    /// `bvh` or `brute_force`.
    pub kind: String,
    /// The quality of a BVH.
    pub quality: Option<Quality>,
    /// The size of a BVH.
    pub bvh: Option<BvhStatistics>,
    /// The vector instructions: `portable`, `avx2` or `avx512`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simd: Option<String>,
    /// How the rays of a wave were traced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traversal: Option<Traversal>,
    /// The name of the device that traced the rays of waves, and of its driver; left out for the
    /// processor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// The launches on the device in the stage `render`, by kernel; left out for the processor.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kernels: Vec<KernelEntry>,
    /// The part of the scene because of which the device traces rays and the processor shades; left
    /// out if the device follows whole paths, and for the processor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub processor_shades_because_of: Option<String>,
}

/// The launches of a kernel on the device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KernelEntry {
    /// Their number, rays and time.
    #[serde(flatten)]
    pub work: KernelWork,
    /// The share of the threads' time in the stage `render` in which they waited for the kernel.
    pub share: f64,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl ImageSection {
    /// Returns the position in the picture; a whole picture is its own window.
    pub fn place(&self) -> PictureWindow {
        self.window.unwrap_or(PictureWindow {
            origin: [0; 2],
            picture: [self.width, self.height],
        })
    }
}

impl From<&Image> for ImageSection {
    fn from(image: &Image) -> Self {
        Self {
            width: image.width,
            height: image.height,
            samples_per_pixel: image.samples_per_pixel,
            seed: image.seed,
            sampler: image.sampler,
            filter: image.filter,
            filter_radius: image.filter_radius,
            adaptive: image.adaptive,
            window: image.window,
        }
    }
}

impl FilmSection {
    /// Describes the film of a scene with this shading model; `None` if light stays as it is.
    pub fn new(film: &FilmSettings, model: ShadingModel) -> Option<Self> {
        let plain = Development::new(0.0, ToneCurve::None, Transfer::Linear);
        (film.development(model) != plain).then(|| Self {
            exposure: film.exposure,
            tone_curve: film.tone_curve.name().to_owned(),
            transfer: film.transfer(model).name().to_owned(),
        })
    }
}

impl CameraSection {
    /// Returns the camera in coordinates relative to its `origin`.
    pub fn relative_to_origin(&self) -> Self {
        let from_origin = |point: [f64; 3]| [0, 1, 2].map(|axis| point[axis] - self.origin[axis]);
        Self {
            eye: self.eye.map(from_origin),
            origin: [0.0; 3],
            ..*self
        }
    }
}

impl From<&ImagePlane> for CameraSection {
    fn from(plane: &ImagePlane) -> Self {
        let space = &plane.space;
        let legible = |point| space.legible(point);
        let (eye, direction) = match plane.projection {
            Projection::Perspective | Projection::Panorama { .. } => {
                (Some(legible(plane.eye_in_world)), None)
            }
            Projection::Parallel { direction } => (None, Some(direction.to_array())),
        };
        let steps = |vector: Vec3| vector.to_array().map(|step| space.world_length(step));
        Self {
            eye,
            direction,
            origin: legible(plane.eye_in_world + space.unit() * plane.to_first.as_dvec3()),
            right: steps(plane.right),
            down: steps(plane.down),
            panorama: matches!(plane.projection, Projection::Panorama { .. }),
            lens: plane.lens.map(|lens| LensSection {
                radius: space.world_length(lens.radius),
                focus_distance: space.world_length(lens.focus_distance),
            }),
        }
    }
}

impl AccelerationSection {
    /// Describes a structure; `bvh` is the size of a BVH.
    pub fn new(
        acceleration: Acceleration,
        bvh: Option<BvhStatistics>,
        simd: Simd,
        traversal: Traversal,
        device: Option<&UsedDevice>,
        kernels: Vec<KernelEntry>,
    ) -> Self {
        Self {
            kind: acceleration.kind().to_owned(),
            quality: acceleration.quality(),
            simd: Some(simd.to_string()),
            traversal: Some(traversal),
            device: device.map(|device| device.name.clone()),
            kernels,
            processor_shades_because_of: device
                .and_then(|device| device.processor_shades_because_of.clone()),
            bvh,
        }
    }
}
