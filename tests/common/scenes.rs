//! Random scenes.

use std::fmt::Write;

use proptest::prelude::*;
use scene::config::Config;

use super::parse;

/// A scene with mirrors, a plane, which has no bounding box, and a background.
pub const SMALL_SCENE: &str = "
image: { width: 50, height: 40 }
camera:
  look_at: { eye: [0, 1, 5], target: [0, 0.5, 0], fov_y_deg: 40 }
materials:
  red: { color: [1, 0.2, 0.1], reflection: 0.3 }
lights:
  - point: { position: [3, 5, 9] }
objects:
  - sphere: { center: [0.5, 0.3, 0], radius: 1 }
    material: red
    name: ball
  - plane: { point: [0, -1, 0], normal: [0, 1, 0] }
    material: red
  - sphere_cloud: { count: 40, min: [-2, 0, -2], max: [2, 2, 2], radius: [0.05, 0.2], seed: 3 }
    material: red
";

/// Some spheres and a box above a plane, with materials of different reflection.
#[derive(Debug, Clone)]
pub struct RandomScene {
    pub model: &'static str,
    pub size: [u32; 2],
    pub samples: u32,
    pub max_depth: u32,
    pub seed: u64,
    /// Whether some objects are of glass and water.
    pub has_media: bool,
    /// Whether some surfaces emit light.
    pub has_lamps: bool,
    /// Whether some surfaces have holes.
    pub openings: usize,
    /// Whether some meshes are placed many times.
    pub has_instances: bool,
    /// The colors of the floor, the cloud and a roof with texture coordinates and colors.
    pub colors: [&'static str; 3],
    /// More keys of their materials.
    pub bumps: [&'static str; 3],
    /// The colors of a mesh, of spheres and of tubes of VTK files by arrays.
    pub arrays: [&'static str; 3],
    /// The scale of the tubes.
    pub wire_scale: &'static str,
    pub reflections: [f32; 3],
    pub specular: f32,
    /// For each light, whether it is a point light.
    pub lights: Vec<bool>,
    pub acceleration: &'static str,
    pub camera: &'static str,
    /// More keys of the image.
    pub sampling: &'static str,
    pub background: &'static str,
    /// The fog of path tracing, and that of `blinn_phong`.
    pub fog: [&'static str; 2],
}

impl RandomScene {
    /// The config of its YAML text.
    pub fn config(&self) -> Config {
        parse(&self.text())
    }

    /// Its YAML text.
    #[expect(clippy::too_many_lines, reason = "one random scene in one place")]
    pub fn text(&self) -> String {
        let Self {
            model,
            size: [width, height],
            samples,
            max_depth,
            seed,
            has_media,
            has_lamps,
            openings,
            has_instances,
            colors: [floor_color, cloud_color, roof_color],
            bumps: [floor_bumps, cloud_bumps, roof_bumps],
            arrays: [field_color, grain_color, wire_color],
            wire_scale,
            reflections: [floor, ball, cloud],
            specular,
            lights,
            acceleration,
            camera,
            sampling,
            background,
            fog,
        } = self;
        // Some of the cloud's spheres overlap.
        let (media, of_cloud) = match *model {
            "seed" => ("", "cloud"),
            "path" if *has_media => (
                ROUGH_MEDIA,
                "[cloud, glass, water, gold, lamp, paint, matte]",
            ),
            _ if *has_media => (MEDIA, "[cloud, glass, water, gold]"),
            _ => ("", "cloud"),
        };
        let (lamp, lamps) = match *model {
            "seed" => ("ball", ""),
            _ if *has_lamps => ("lamp", LAMPS),
            _ => ("ball", ""),
        };
        let emission = if *model == "seed" {
            ""
        } else {
            ", emission: [3, 2, 1]"
        };
        let [floor_openings, cloud_openings, roof_openings] = match *model {
            "seed" => [""; 3],
            _ => OPENINGS[*openings],
        };
        let fog = match *model {
            "path" | "path_by_power" => fog[0],
            "blinn_phong" => fog[1],
            _ => "",
        };
        let ambient = match *model {
            "path" => ", light_sampling: each",
            "path_by_power" | "ambient_occlusion" => "",
            _ => ", ambient: 0.1",
        };
        let model = match *model {
            "path_by_power" => "path",
            other => other,
        };
        let mut text = format!(
            "
image: {{ width: {width}, height: {height}, samples_per_pixel: {samples}, seed: {seed}{sampling} }}
camera: {{ {camera} }}
background: {{ {background} }}
{fog}
shading: {{ model: {model}, max_depth: {max_depth}{ambient} }}
acceleration: {acceleration}
materials:
  floor: {{ color: {floor_color}, reflection: {floor}{floor_bumps}{floor_openings} }}
  ball: {{ color: [0.9, 0.2, 0.1], specular: {specular}, reflection: {ball} }}
  roof: {{ color: {roof_color}{roof_bumps}{roof_openings} }}
  cloud: {{ color: {cloud_color}, specular: 0.3, exponent: 7.5, reflection: {cloud}{cloud_bumps}{cloud_openings} }}
  lamp: {{ color: 0.2{emission} }}
  field: {{ color: {field_color}, specular: 0.1 }}
  grains: {{ color: {grain_color} }}
  wires: {{ color: {wire_color}, specular: 0.2 }}
{media}objects:
  - plane: {{ point: [0, -1, 0], normal: [0, 1, 0] }}
    material: floor
  - sphere: {{ center: [0, 0, 0], radius: 0.9 }}
    material: ball
  - box: {{ min: [1, -1, -1], max: [2, 0.5, 0] }}
    material: {lamp}
  - cylinder: {{ ends: [[-1.2, -1, -2], [-1, 1, -2.2]], radius: 0.3 }}
    material: {lamp}
  - cone: {{ ends: [[2, -1, 1], [2.2, 0.4, 1]], radius: [0.5, 0.1] }}
    material: ball
  - capsule: {{ ends: [[-2, -0.6, 0.5], [-1, -0.8, 1.5]], radius: [0.2, 0.1] }}
    material: {lamp}
  - capsule: {{ ends: [[-1, -0.8, 1.5], [0.4, -0.7, 1.8]], radius: [0.1, 0.15] }}
    material: ball
  - capsule: {{ ends: [[0.4, -0.7, 1.8], [1, -0.9, 0.8]], radius: 0.15 }}
    material: ball
    transform: [{{ scale: [1, 1.2, 1] }}]
  - mesh: {{ file: ../tests/files/tile.obj }}
    material: roof
  - mesh: {{ file: ../tests/files/vtk/curvilinear_raw.vts, normals: smooth }}
    material: field
    transform: [{{ scale: 0.3 }}, {{ translate: [-2, 0.4, -1] }}]
  - spheres: {{ file: ../tests/files/vtk/block_zlib.vtu, radius: 0.12 }}
    material: grains
    transform: [{{ scale: 0.7 }}, {{ translate: [0.6, 0.6, 1] }}]
  - tubes: {{ file: ../tests/files/vtk/lines_zlib.vtp, radius: {{ array: thickness }} }}
    material: wires
    transform: [{{ scale: {wire_scale} }}, {{ translate: [-0.5, 0.3, 1.6] }}]
  - mesh: {{ file: data/abc_flow.vti, isosurface: {{ array: velocity, value: 3 }} }}
    material: ball
    transform: [{{ scale: 0.2 }}, {{ translate: [-2.4, 1.2, -2] }}]
{lamps}  - sphere_cloud: {{ count: 40, min: [-3, -1, -3], max: [3, 2, 3], radius: [0.1, 0.4], seed: {seed} }}
    material: {of_cloud}
lights:"
        );
        if *has_instances {
            let of_medium = match media {
                "" => lamp,
                _ => "glass",
            };
            let instances = INSTANCES.replace("LAMP", lamp).replace("MEDIUM", of_medium);
            text = text.replace("objects:\n", &format!("objects:\n{instances}"));
        }
        for (i, at_point) in lights.iter().enumerate() {
            let x = 3 * i as i32 - 4;
            let light = if *at_point {
                format!("point: {{ position: [{x}, 4, 3], intensity: 0.6 }}")
            } else {
                format!("directional: {{ direction: [{x}, -2, -1], color: [0.5, 0.4, 0.3] }}")
            };
            write!(text, "\n  - {light}").unwrap();
        }
        if lights.is_empty() {
            text.push_str(" []");
        }
        text
    }
}

/// Surfaces that emit light.
const LAMPS: &str = "  - rectangle: { corner: [-2, 3, -1], edges: [[1, 0, 0], [0, 0.2, 1]] }
    material: lamp
  - disk: { center: [2, 2, 2], normal: [-1, -1, 0], radius: 0.5 }
    material: lamp
  - triangle: { vertices: [[-2, 0, 1], [-2, 1, 1], [-2.5, 0, 2]] }
    material: lamp
  - sphere: { center: [-1.5, 1, 0.5], radius: 0.3 }
    material: lamp
    transform: [{ scale: [1, 2, 1] }]
";

/// Meshes at many places, some of them mirrored, some inside each other.
const INSTANCES: &str = "  - instances:
      mesh: { file: ../tests/files/tile.obj }
      places:
        - [{ scale: 0.4 }, { rotate: { axis: [1, 2, 0], angle_deg: 50 } }, { translate: [1, 1.5, 2] }]
        - [{ scale: [-0.4, 0.3, 0.5] }, { rotate: { axis: [0, 1, 3], angle_deg: 200 } }, { translate: [-1, 1, 2] }]
        - [{ scale: [0.5, 0.2, -0.4] }, { translate: [0, 0.2, 2] }]
    material: roof
    transform: [{ scale: [1, 0.9, 1.1] }, { rotate: { axis: [0, 1, 0], angle_deg: 10 } }]
  - instances:
      mesh: { file: ../tests/files/vtk/curvilinear_raw.vts, normals: smooth }
      places:
        - [{ scale: 0.2 }, { translate: [1.5, 0.8, 0.5] }]
        - [{ scale: [0.2, 0.3, -0.2] }, { rotate: { axis: [1, 1, 0], angle_deg: 70 } }, { translate: [-1, -0.6, 2.5] }]
    material: field
  - instances:
      mesh: { file: data/abc_flow.vti, isosurface: { array: velocity, value: 3 } }
      places: [[{ scale: 0.1 }, { translate: [0, 1, 1.5] }], [{ scale: [-0.1, 0.1, 0.1] }, { translate: [1, -0.8, 3] }]]
    material: MEDIUM
  - instances:
      mesh: { file: ../tests/files/tile.obj }
      places: [[{ scale: 0.2 }, { translate: [-2, 2, 1] }], [{ scale: [0.3, -0.2, 0.1] }, { translate: [2, 2, 2] }]]
    material: LAMP
";

/// Materials of media and metals whose surfaces may be rough.
const ROUGH_MEDIA: &str =
    "  glass: { dielectric: { index: 1.5, absorption: [0.1, 0.9, 3], priority: 1 }, roughness: 0.4 }
  water: { dielectric: { index: 1.33 } }
  gold: { conductor: gold, roughness: 0.3, two_sided: false }
  paint: { color: [0.8, 0.3, 0.1], principled: { metallic: 0.3, roughness: 0.4, transmission: 0.3 } }
  matte: { color: 0.7, principled: { roughness: 0.9 } }
";

/// Materials of media.
const MEDIA: &str =
    "  glass: { dielectric: { index: 1.5, absorption: [0.1, 0.9, 3], priority: 1 }, specular: 0.2 }
  water: { dielectric: { index: 1.33 } }
  gold: { conductor: gold, specular: 0.1 }
";

/// The color of a floor without a picture.
pub const CHECKER: &str = "{ checker: { even: 1, odd: 0.1, size: 0.5, axes: xz } }";

/// Colors for the floor.
const FLOOR_COLORS: [&str; 3] = [
    CHECKER,
    "{ image: { file: pictures/planks.png, mapping: planar, size: [2, 1.5] } }",
    "{ image: { file: pictures/planks.png, mapping: planar, filter: nearest, wrap: mirror } }",
];

/// Colors for the cloud.
const CLOUD_COLORS: [&str; 3] = [
    "0.6",
    "{ image: { file: pictures/planks.png, mapping: triplanar, size: 0.3, transfer: linear } }",
    "{ image: { file: pictures/globe.png, mapping: { spherical: { center: [0, 3, 0] } } } }",
];

/// Colors for a mesh with texture coordinates and colors.
const ROOF_COLORS: [&str; 3] = [
    "0.8",
    "vertex_colors",
    "{ image: { file: pictures/spot.png, wrap: clamp, size: [1.3, 2] } }",
];

/// Normals for the floor, the cloud and the mesh.
const BUMPS: [[&str; 2]; 3] = [
    [
        "",
        ", normal_map: { image: { file: pictures/plank_normals.png, mapping: planar, size: 2 } }",
    ],
    [
        "",
        ", normal_map: { image: { file: pictures/plank_normals.png, mapping: triplanar } }",
    ],
    [
        "",
        ", normal_map: { image: { file: pictures/plank_normals.png }, strength: 3 }",
    ],
];

/// Colors for a mesh with arrays.
const FIELD_COLORS: [&str; 4] = [
    "{ array: { name: speed } }",
    "{ array: { name: speed, component: 1, map: viridis, range: quantiles } }",
    "{ array: { name: height of it, map: turbo, scale: log, range: [0.1, 2] } }",
    "{ array: { name: number, map: set1 } }",
];

/// Colors for spheres with arrays.
const GRAIN_COLORS: [&str; 2] = [
    "0.7",
    "{ array: { name: speed, of: points, map: cividis } }",
];

/// Colors for tubes with arrays.
const WIRE_COLORS: [&str; 3] = [
    "0.4",
    "{ array: { name: speed, map: viridis } }",
    "{ array: { name: number, map: set2, bar: number, labels: [none, one] } }",
];

/// Openings of the floor, the cloud and the mesh.
const OPENINGS: [[&str; 3]; 3] = [[""; 3], HOLES, VEILS];

const VEILS: [&str; 3] = [
    ", opacity: { image: { file: pictures/spot.png, mapping: planar }, factor: 0.8 }",
    ", opacity: 0.4",
    ", opacity: { image: { file: pictures/spot.png } }",
];

const HOLES: [&str; 3] = [
    ", cutout: { image: { file: pictures/planks.png, mapping: planar }, threshold: 0.1 }",
    ", cutout: { image: { file: pictures/globe.png, mapping: triplanar, size: 0.4 }, threshold: 0.4 }",
    ", cutout: { image: { file: pictures/spot.png } }",
];

/// Needs more than two samples.
const BY_EFFICIENCY: &str = ", sampler: sobol, adaptive: { by: efficiency, min_samples: 2 }";

/// More keys of the image.
const SAMPLING: [&str; 6] = [
    "",
    ", sampler: sobol",
    ", filter: tent, filter_radius: 0.8",
    ", sampler: sobol, filter: blackman_harris",
    ", sampler: sobol, adaptive: { noise: 0.05, min_samples: 2 }",
    BY_EFFICIENCY,
];

/// Fog that scatters light, and fog that does not.
const FOGS: [[&str; 2]; 4] = [
    ["", ""],
    ["", ""],
    [
        "fog: { mean_free_path: 6, color: [0.9, 0.7, 0.4], anisotropy: -0.4, radius: 3 }",
        "fog: { mean_free_path: 6, color: [0.9, 0.7, 0.4], radius: 3 }",
    ],
    [
        "fog: { mean_free_path: 3, anisotropy: 0.7 }",
        "fog: { mean_free_path: 3 }",
    ],
];

/// Backgrounds.
pub const BACKGROUNDS: [&str; 3] = [
    "gradient: { bottom: 0.2, top: [0.3, 0.5, 0.9] }",
    "environment_map: { file: ../tests/files/sky.hdr, rotation_deg: 70, intensity: 0.3 }",
    "sky: { sun: { elevation_deg: 25, azimuth_deg: 100 } }",
];

/// Cameras in front of the scene, and one in its middle.
pub const CAMERAS: [&str; 4] = [
    "look_at: { eye: [0, 1, 6], target: [0, 0, 0], fov_y_deg: 50 }",
    "look_at: { eye: [0, 1, 6], target: [0, 0, 0], fov_y_deg: 50, lens: { radius: 0.2 } }",
    "look_at: { eye: [0, 1, 6], target: [0, 0, 0], fov_y_deg: 50, \
     lens: { radius: 0.3, focus_distance: 4, blades: 5, rotation_deg: 20 } }",
    "panorama: { eye: [0.5, 1.5, 1.5], target: [0, 0, 0] }",
];

prop_compose! {
    /// A random scene with a small image.
    pub fn scenes()(
        model in prop_oneof![
            2 => Just("blinn_phong"), 1 => Just("seed"), 1 => Just("ambient_occlusion"),
            2 => Just("path"), 1 => Just("path_by_power"),
        ],
        size in [1_u32..40, 1_u32..40],
        samples in 1_u32..=9,
        max_depth in 0_u32..6,
        seed in 0_u64..1000,
        has_media in any::<bool>(),
        has_lamps in any::<bool>(),
        openings in prop_oneof![3 => Just(0), 1 => Just(1), 1 => Just(2)],
        has_instances in prop::bool::weighted(0.4),
        floor_color in prop::sample::select(&FLOOR_COLORS[..]),
        cloud_color in prop::sample::select(&CLOUD_COLORS[..]),
        roof_color in prop::sample::select(&ROOF_COLORS[..]),
        floor_bumps in prop::sample::select(&BUMPS[0][..]),
        cloud_bumps in prop::sample::select(&BUMPS[1][..]),
        roof_bumps in prop::sample::select(&BUMPS[2][..]),
        field_color in prop::sample::select(&FIELD_COLORS[..]),
        grain_color in prop::sample::select(&GRAIN_COLORS[..]),
        wire_color in prop::sample::select(&WIRE_COLORS[..]),
        wire_scale in prop::sample::select(&["0.4", "[0.4, 0.5, 0.4]"][..]),
        reflections in [0.0_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0]
            .prop_map(|shares| shares.map(|share| if share < 0.3 { 0.0 } else { share })),
        specular in prop_oneof![Just(0.0_f32), 0.0_f32..1.0],
        lights in prop::collection::vec(any::<bool>(), 0..4),
        acceleration in prop_oneof![4 => Just("bvh"), 1 => Just("brute_force")],
        camera in prop::sample::select(&CAMERAS[..]),
        sampling in prop::sample::select(&SAMPLING[..]),
        background in prop::sample::select(&BACKGROUNDS[..]),
        fog in prop::sample::select(&FOGS[..]),
    ) -> RandomScene {
        // Without a hierarchy each ray tests all primitives.
        let most = if acceleration == "brute_force" { 12 } else { 40 };
        let samples = if sampling == BY_EFFICIENCY { samples.max(3) } else { samples };
        RandomScene {
            model, size: size.map(|n| n.min(most)), samples, max_depth, seed, has_media, has_lamps, openings, has_instances,
            colors: [floor_color, cloud_color, roof_color],
            bumps: [floor_bumps, cloud_bumps, roof_bumps],
            arrays: [field_color, grain_color, wire_color], wire_scale, reflections, specular, lights, acceleration, camera, sampling,
            background, fog,
        }
    }
}
