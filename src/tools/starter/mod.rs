//! Scenes to start from: one that shows the sections, and one around a mesh.

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

use base::keywords;
use host::available_memory;
use host::text::{Diagnostic, one_line};
use import::{DataSeries, FileFault, Mesh, RadiusChoice, Spheres, Tubes};
use scene::yaml::{Source, quoted};
use world::geometry::{Aabb, Sphere};
use world::values::MAX_NAME;

keywords! {
    /// The axis of a mesh that points upward.
    pub enum UpAxis {
        /// +y, as in most programs for pictures
        Y = "y",
        /// +z, as in engineering and on maps
        Z = "z",
    }
}

/// A commented scene.
pub const SCENE: &str = include_str!("scene.yaml");

/// The vertical angle of view of scenes around meshes, in degrees.
const FOV_Y_DEG: f32 = 35.0;
/// The direction from a mesh to the eye: from the front, a little from the right and from above.
const TO_EYE: Vec3 = Vec3::new(0.45, 0.35, 1.0);
/// Light from all around, weakest where a mesh stands on the floor.
const SKY: &str = "\
  # The sky, from four sides: it leaves shadows where the mesh touches the floor.
  - directional: { direction: [1, -1.2, 0.3], intensity: 0.09 }
  - directional: { direction: [-0.3, -1.2, 1], intensity: 0.09 }
  - directional: { direction: [-1, -1.2, -0.3], intensity: 0.09 }
  - directional: { direction: [0.3, -1.2, -1], intensity: 0.09 }
";
/// Light from the camera's side, for a subject that brings no light.
const LAMPS: &str = "\
  # The key light from the upper left, and a weak one that fills its shadows.
  - directional: { direction: [0.7, -1, -0.8], color: [1, 0.96, 0.9], intensity: 0.7 }
  - directional: { direction: [-1, -0.2, -0.5], color: [0.8, 0.9, 1], intensity: 0.15 }
";
/// The greatest light of a file's own lights on its box: about that of [`LAMPS`].
const OWN_LIGHT: f32 = 0.85;
/// The greatest coordinate of a mesh: those of its camera are up to 1e15.
const FARTHEST: f64 = 1e14;
/// The height of terrain relative to its shorter side: less than this.
const LOW: f32 = 0.4;
/// The steps that turn z upward.
const STANDING: &str = "\
    # In the file, +z points up.
    transform: [{ rotate: { axis: [1, 0, 0], angle_deg: -90 } }]
";
/// The normals of meshes that lack them: smooth up to edges.
const SMOOTH: &str = "{ smooth: { angle_deg: 30 } }";

/// Writes the scene of a mesh, a table or a series of them, as a file that lies beside it.
///
/// # Errors
/// If the mesh cannot be read, is damaged, or may need more memory than is free.
pub fn scene_beside(mesh: &Path, up: Option<UpAxis>) -> Result<Source, Diagnostic> {
    let name = Path::new(mesh.file_name().unwrap_or_default());
    let text = scene_of(mesh, name, up)?;
    Ok(Source::new(mesh.display().to_string(), text))
}

/// Returns the text of a scene that shows a mesh, which its scene file finds at `path_in_scene`.
/// Without `up`, the format or the shape of the mesh says which axis points upward.
///
/// # Errors
/// The errors of [`scene_beside`].
pub fn scene_of(
    mesh: &Path,
    path_in_scene: &Path,
    up: Option<UpAxis>,
) -> Result<String, Diagnostic> {
    let of_file = |fault: FileFault| fault.of_argument();
    let stills = stills_of(mesh).map_err(of_file)?;
    for still in &stills {
        let n_bytes = import::max_bytes(still).map_err(of_file)?;
        if n_bytes > available_memory() {
            let message = format!("`{}` may need more memory than is free", still.display());
            return Err(Diagnostic::new(message).with_help("use a smaller file"));
        }
    }
    let file = path_in_scene;
    let mut subject = subject_of(&stills[0], file).map_err(of_file)?;
    for still in &stills[1..] {
        subject.enclose(&subject_of(still, file).map_err(of_file)?);
    }
    let greatest = subject.greatest_coordinate();
    if greatest > FARTHEST {
        let message = format!("`{}` has coordinates up to {greatest:.0e}", mesh.display());
        let help = format!("expected at most {FARTHEST:e}: write it in a larger unit");
        return Err(Diagnostic::new(message).with_help(help));
    }
    let subject = match up.unwrap_or_else(|| likely_up(mesh, &subject.bounds)) {
        UpAxis::Y => subject,
        UpAxis::Z => subject.standing(),
    };
    Ok(text_of(&subject, file))
}

/// Returns the axis that likely points upward: z of STL, which printers and CAD write, and of
/// surfaces that are low in z, such as terrain; y of glTF, whose specification says so, and others.
fn likely_up(mesh: &Path, bounds: &Aabb) -> UpAxis {
    let extent = bounds.max - bounds.min;
    let is_low = extent.z > 0.0 && extent.z < LOW * extent.x.min(extent.y);
    let format = mesh.extension().unwrap_or_default().to_ascii_lowercase();
    match format.to_str() {
        Some("gltf" | "glb") => UpAxis::Y,
        Some("stl") => UpAxis::Z,
        _ if is_low => UpAxis::Z,
        _ => UpAxis::Y,
    }
}

/// Returns the files to look at: of a series of files its first and its last one.
fn stills_of(mesh: &Path) -> import::Result<Vec<PathBuf>> {
    if !import::is_series(mesh) {
        return Ok(vec![mesh.to_owned()]);
    }
    let DataSeries(mut steps) = import::read_series(Path::new(""), mesh)?;
    let last = steps.pop();
    let ends = steps.into_iter().take(1).chain(last);
    Ok(ends.map(|step| step.file).collect())
}

/// Returns the subject of the scene of a mesh or a table, which the scene finds at `file`.
fn subject_of(mesh: &Path, file: &Path) -> import::Result<Subject> {
    if import::is_table(mesh) {
        return subject_of_table(mesh, file);
    }
    let fault = match import::read_mesh_with_materials(mesh, available_memory() / 2) {
        Ok(mesh) => return Ok(Subject::surface(mesh, file)),
        Err(fault) => fault,
    };
    if let Ok(mesh) = import::read_mesh(mesh) {
        return Ok(Subject {
            lost: Some(fault.message()),
            ..Subject::surface(mesh, file)
        });
    }
    // A data set of lines, or a cloud of points, has no triangle.
    let radius = RadiusChoice::Same(1.0);
    if import::is_vtk(mesh)
        && let Ok(tubes) = import::read_lines(mesh, &radius, None)
    {
        return Ok(Subject::lines(tubes, file, RadiusSource::OfAll));
    }
    match import::read_points(mesh, &radius, None) {
        Ok(points) => Ok(Subject::points(points, file, RadiusSource::OfAll)),
        Err(_) => Err(fault),
    }
}

/// Returns the subject of a table: lines if it has a column of them, and spheres otherwise.
fn subject_of_table(table: &Path, file: &Path) -> import::Result<Subject> {
    let of_all = Some(&RadiusChoice::Same(1.0));
    let (spheres, radius, radii) = match import::read_spheres(table, None, None) {
        Ok(spheres) => (spheres, None, RadiusSource::OfFile),
        Err(_) => (
            import::read_spheres(table, of_all, None)?,
            of_all,
            RadiusSource::OfAll,
        ),
    };
    if import::has_lines(table)? {
        let tubes = import::read_tubes(table, radius, None)?;
        return Ok(Subject::lines(tubes, file, radii));
    }
    Ok(Subject::points(spheres, file, radii))
}

/// The radii of spheres or tubes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RadiusSource {
    /// One for all.
    OfAll,
    /// The radii of the file.
    OfFile,
}

impl RadiusSource {
    /// Returns the key of the radius, which a file with radii does not need.
    fn key(self, radius: f32) -> String {
        match self {
            Self::OfAll => format!(", radius: {}", digits(radius.max(1e-15).into(), radius)),
            Self::OfFile => String::new(),
        }
    }
}

/// The subject of a scene.
struct Subject {
    /// The origin of its box.
    origin: DVec3,
    bounds: Aabb,
    colors: SubjectColors,
    /// The reason why the mesh's materials cannot be used, if it has any.
    lost: Option<String>,
    /// True if the lights of the file light it.
    has_lights: bool,
    /// The lines of the object that turn it upright, if any.
    transform: &'static str,
    /// The object's geometry, with a comment on its keys.
    geometry: String,
}

/// The source of a subject's colors.
enum SubjectColors {
    /// One color for the whole subject.
    One,
    /// An array of this name.
    Array(String),
    /// The materials of the file.
    OfFile,
}

impl Subject {
    fn surface(mesh: Mesh, file: &Path) -> Self {
        let corners = mesh.triangles.iter().flatten();
        let bounds = Aabb::from_points(corners.map(|&vertex| mesh.vertices[vertex as usize]));
        let normals = if mesh.normals.is_none() {
            SMOOTH
        } else {
            "file"
        };
        let file = quoted(&file.to_string_lossy());
        let factor = light_factor(&mesh, &bounds);
        let lights = match factor {
            Some(factor) => format!(", lights: {}", digits(factor.into(), factor)),
            None if mesh.lights.is_empty() => String::new(),
            None => ", lights: 0".to_owned(),
        };
        let about_lights = if lights.is_empty() {
            ""
        } else {
            "    # `lights` is a factor on the lights of the file: 1 for all of them, 0 for none.\n"
        };
        Self {
            origin: mesh.origin,
            bounds,
            has_lights: factor.is_some(),
            transform: "",
            colors: match first_array(mesh.arrays) {
                _ if !mesh.materials.is_empty() => SubjectColors::OfFile,
                Some(array) => SubjectColors::Array(array),
                None => SubjectColors::One,
            },
            lost: None,
            geometry: format!(
                "\
    # `normals` come from the `file`, or are `smooth` (here up to edges) or `flat`.
{about_lights}    mesh: {{ file: {file}, normals: {normals}{lights} }}"
            ),
        }
    }

    /// Returns the subject with its z axis upward.
    fn standing(self) -> Self {
        let turned = |[x, y, z]: [f32; 3]| Vec3::new(x, z, -y);
        let corners = [self.bounds.min, self.bounds.max].map(|corner| turned(corner.to_array()));
        Self {
            origin: DVec3::new(self.origin.x, self.origin.z, -self.origin.y),
            bounds: Aabb::from_points(corners),
            transform: STANDING,
            ..self
        }
    }

    fn lines(tubes: Tubes, file: &Path, radii: RadiusSource) -> Self {
        let bounds = tubes.bounds();
        let radius = radii.key(0.004 * (bounds.max - bounds.min).length());
        let file = quoted(&file.to_string_lossy());
        Self {
            origin: tubes.origin,
            bounds,
            has_lights: false,
            transform: "",
            colors: first_array(tubes.arrays).map_or(SubjectColors::One, SubjectColors::Array),
            lost: None,
            geometry: format!(
                "\
    # `radius` may also be that of an array: {{ array: …, scale: … }}.
    tubes: {{ file: {file}{radius} }}"
            ),
        }
    }

    fn points(points: Spheres, file: &Path, radii: RadiusSource) -> Self {
        let of_points = Aabb::from_points(points.spheres.iter().map(|sphere| sphere.center));
        let size = (of_points.max - of_points.min).length();
        // Neighbors on a surface of this size nearly touch.
        let spacing = 0.5 * size / (points.spheres.len() as f32).sqrt();
        let radius = if size > 0.0 {
            spacing.min(0.05 * size)
        } else {
            1.0
        };
        let corners = |sphere: &Sphere| {
            let radius = if radii == RadiusSource::OfAll {
                radius
            } else {
                sphere.radius
            };
            [sphere.center - radius, sphere.center + radius]
        };
        let has_colors = points.colors.is_some();
        let array = first_array(points.arrays).filter(|_| !has_colors);
        let (file, radius) = (quoted(&file.to_string_lossy()), radii.key(radius));
        Self {
            origin: points.origin,
            bounds: Aabb::from_points(points.spheres.iter().flat_map(corners)),
            has_lights: false,
            transform: "",
            colors: array.map_or(SubjectColors::One, SubjectColors::Array),
            lost: None,
            geometry: format!(
                "\
    # `radius` may also be that of an array: {{ array: …, scale: … }}.
    spheres: {{ file: {file}{radius} }}"
            ),
        }
    }

    /// Grows the box to that of another time step.
    fn enclose(&mut self, other: &Self) {
        let moved = (other.origin - self.origin).as_vec3();
        let others = [other.bounds.min + moved, other.bounds.max + moved];
        let own = [self.bounds.min, self.bounds.max];
        self.bounds = Aabb::from_points(own.into_iter().chain(others));
    }

    /// Returns the greatest magnitude of a coordinate in its box.
    fn greatest_coordinate(&self) -> f64 {
        let corners = [self.bounds.min, self.bounds.max];
        let corners = corners.map(|corner| self.origin + corner.as_dvec3());
        corners[0].abs().max(corners[1].abs()).max_element()
    }
}

/// Returns the factor that turns a file's lights into those of a picture that is neither dark nor
/// all white; `None` if no light reaches the corners or the center of its box.
fn light_factor(mesh: &Mesh, bounds: &Aabb) -> Option<f32> {
    let brightest = |at: Vec3| -> f32 {
        let at = (mesh.origin + at.as_dvec3()).as_vec3();
        let lights = mesh.lights.iter();
        lights
            .map(|light| Vec3::from(light.illuminate(at.into()).radiance).max_element())
            .sum()
    };
    let points = bounds.corners().into_iter().chain([bounds.center()]);
    let factor = OWN_LIGHT / points.map(brightest).reduce(f32::max)?;
    (factor.is_finite() && factor > 0.0).then_some(factor)
}

/// Returns the first array that can be named in a scene.
fn first_array(arrays: Vec<String>) -> Option<String> {
    let mut arrays = arrays.into_iter();
    arrays.find(|name| name.chars().count() <= MAX_NAME && !name.chars().any(char::is_control))
}

fn text_of(subject: &Subject, file: &Path) -> String {
    let Subject {
        origin,
        bounds,
        geometry,
        ..
    } = subject;
    let center = origin + bounds.center().as_dvec3();
    // All of the sphere around the box is in view.
    let radius = (0.5 * (bounds.max - bounds.min).length()).max(1e-6);
    let distance = radius / (0.5 * FOV_Y_DEG.to_radians()).sin();
    let eye = center + (distance * TO_EYE.normalize()).as_dvec3();
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name: String = stem.chars().take(200).collect();
    let (materials, material) = match &subject.colors {
        SubjectColors::One => (
            "\n  clay: { color: [0.66, 0.55, 0.46], specular: 0.12, exponent: 40 }".to_owned(),
            "material: clay",
        ),
        SubjectColors::Array(array) => {
            let array = quoted(array);
            let color = format!("{{ array: {{ name: {array}, bar: {array} }} }}, specular: 0.05");
            (
                format!("\n  field: {{ color: {color} }}"),
                "material: field",
            )
        }
        SubjectColors::OfFile => (
            String::new(),
            "# Without a `material`, the mesh has the materials of its file.",
        ),
    };
    // The colors of an array are to be read off, without shadows of a floor.
    let is_measured = matches!(subject.colors, SubjectColors::Array(_));
    let (floor_material, floor) = if is_measured {
        (String::new(), String::new())
    } else {
        let at = point(
            DVec3::new(center.x, origin.y + f64::from(bounds.min.y), center.z),
            radius,
        );
        (
            "\n  floor: { color: [0.4, 0.41, 0.43] }".to_owned(),
            format!(
                "  - name: floor\n    plane: {{ point: {at}, normal: [0, 1, 0] }}\n    \
                 material: floor\n"
            ),
        )
    };
    let lamps = if subject.has_lights { "" } else { LAMPS };
    let (ambient, sky) = if is_measured { (0.3, "") } else { (0.1, SKY) };
    format!(
        "\
# The mesh {title}: the camera sees all of it, with +y up.
{lost}image: {{ width: 800, height: 600, samples_per_pixel: 4 }}
camera:
  look_at: {{ eye: {eye}, target: {target}, fov_y_deg: {FOV_Y_DEG} }}
background: {{ gradient: {{ bottom: [0.5, 0.53, 0.57], top: [0.2, 0.27, 0.38] }} }}
shading: {{ ambient: {ambient}, max_depth: 2 }}
materials:{materials}{floor_material}
lights:
{lamps}{sky}objects:
  - name: {name}
{geometry}
{transform}    {material}
{floor}",
        transform = subject.transform,
        title = one_line(&stem),
        eye = point(eye, radius),
        target = point(center, radius),
        name = quoted(&name),
        lost = subject.lost.as_ref().map_or(String::new(), |lost| {
            format!("# Its own materials cannot be used: {}\n", one_line(lost))
        }),
    )
}

/// Returns a point with the digits that its distance from others, `scale`, needs.
fn point(point: DVec3, scale: f32) -> String {
    let [x, y, z] = point.to_array().map(|x| digits(x, scale));
    format!("[{x}, {y}, {z}]")
}

/// Returns a number with four digits of `scale`.
fn digits(x: f64, scale: f32) -> String {
    let exponent = f64::from(scale).log10().floor() as i32 - 3;
    let power = 10.0_f64.powi(exponent.abs());
    // Powers of ten below one are not exact; powers above are, and lead to the shortest digits.
    let rounded = if exponent < 0 {
        (x * power).round() / power
    } else {
        (x / power).round() * power
    };
    (rounded + 0.0).to_string()
}
