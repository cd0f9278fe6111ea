//! Pictures: files of every format, and where on a surface each of their points lies.

use scene::build::{Geometries, Sensor};
use std::fs;
use std::path::Path;

use exr::prelude::{Image, SpecificChannels, Vec2 as Place, WritableImage};
use glam::{DVec3, Vec2, Vec3};
use image::{DynamicImage, ImageFormat};
use import::{FileFault, Mesh, read_mesh, read_picture};
use proptest::prelude::*;
use scene::config::{Config, CostMode};
use tracer::accel::Accel;
use tracer::cost::{NoProbe, RayKind};
use tracer::trace::{SurfacePoint, Tracer};
use world::color::Transfer;
use world::geometry::{Ray, RenderSpace};
use world::picture::{Picture, Sampling, TexelFilter, Wrap};
use world::scene::Scene;

use crate::common::generators::cases;
use crate::common::{film, in_repository, parse};

const MEMORY: u64 = 1 << 26;

/// Columns and rows of the pictures that are written.
const SIZE: [u32; 2] = [7, 5];

fn read(bytes: &[u8], transfer: Option<Transfer>) -> Result<std::sync::Arc<Picture>, FileFault> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture");
    fs::write(&path, bytes).unwrap();
    read_picture(&path, transfer, MEMORY)
}

/// A picture in a format, encoded by the `image` crate.
fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Numbers from 0 to 1, different in each channel of each pixel.
fn numbers(n_channels: usize) -> Vec<f32> {
    let n = (SIZE[0] * SIZE[1]) as usize * n_channels;
    (0..n).map(|i| (i * 37 % 101) as f32 / 100.0).collect()
}

/// A picture of each kind that the formats have.
fn pictures() -> Vec<(DynamicImage, ImageFormat)> {
    let [width, height] = SIZE;
    let bytes = |n| numbers(n).iter().map(|x| (x * 255.0) as u8).collect();
    let words = |n| numbers(n).iter().map(|x| (x * 65_535.0) as u16).collect();
    let png = [
        image::GrayImage::from_raw(width, height, bytes(1)).map(DynamicImage::from),
        image::GrayAlphaImage::from_raw(width, height, bytes(2)).map(DynamicImage::from),
        image::RgbImage::from_raw(width, height, bytes(3)).map(DynamicImage::from),
        image::RgbaImage::from_raw(width, height, bytes(4)).map(DynamicImage::from),
        image::ImageBuffer::from_raw(width, height, words(3)).map(DynamicImage::ImageRgb16),
        image::ImageBuffer::from_raw(width, height, words(4)).map(DynamicImage::ImageRgba16),
    ];
    let rgb = image::Rgb32FImage::from_raw(width, height, numbers(3)).map(DynamicImage::from);
    let rgba = image::Rgba32FImage::from_raw(width, height, numbers(4)).map(DynamicImage::from);
    let png = png.map(|picture| (picture.unwrap(), ImageFormat::Png));
    let others = [
        (rgb.clone().unwrap(), ImageFormat::Hdr),
        (rgb.unwrap(), ImageFormat::OpenExr),
        (rgba.unwrap(), ImageFormat::OpenExr),
    ];
    png.into_iter().chain(others).collect()
}

/// The texel in a column and a row.
fn texel(picture: &Picture, column: u32, row: u32) -> [f32; 4] {
    let [width, height] = picture.size().map(|side| side as f32);
    let nearest = Sampling {
        filter: TexelFilter::Nearest,
        wrap: Wrap::Clamp,
    };
    let (u, v) = ((column as f32 + 0.5) / width, (row as f32 + 0.5) / height);
    picture.at(nearest, [u, 1.0 - v], 0.0)
}

/// The function of IEC 61966-2-1.
fn light(number: f32) -> f32 {
    match number {
        n if n <= 0.04045 => n / 12.92,
        n => ((n + 0.055) / 1.055).powf(2.4),
    }
}

/// As ImageMagick and OpenCV write them.
#[test]
fn radiance_pictures_have_either_signature() {
    let rgb = image::Rgb32FImage::from_raw(SIZE[0], SIZE[1], numbers(3)).unwrap();
    let bytes = encoded(&rgb.into(), ImageFormat::Hdr);
    let rest = bytes.strip_prefix(b"#?RADIANCE").unwrap();
    let other = [b"#?RGBE", rest].concat();
    assert_eq!(read(&other, None).unwrap(), read(&bytes, None).unwrap());
}

#[test]
fn a_luminance_of_openexr_is_gray() {
    let value = |at: Place<usize>| (at.0 as f32 + 0.25 * at.1 as f32, 0.5_f32);
    let gray = SpecificChannels::build()
        .with_channel("Y")
        .with_pixel_fn(move |at| (value(at).0,));
    let with_opacity = SpecificChannels::build()
        .with_channel("Y")
        .with_channel("A");
    let with_opacity = with_opacity.with_pixel_fn(value);
    let size = (SIZE[0] as usize, SIZE[1] as usize);
    let mut files = [(); 2].map(|()| std::io::Cursor::new(Vec::new()));
    Image::from_channels(size, gray)
        .write()
        .to_buffered(&mut files[0])
        .unwrap();
    Image::from_channels(size, with_opacity)
        .write()
        .to_buffered(&mut files[1])
        .unwrap();
    for (file, opacity) in files.into_iter().zip([1.0, 0.5]) {
        let picture = read(&file.into_inner(), None).unwrap();
        for (column, row) in [(0, 0), (6, 0), (0, 4), (3, 2)] {
            let gray = column as f32 + 0.25 * row as f32;
            assert_eq!(texel(&picture, column, row), [gray, gray, gray, opacity]);
        }
    }
}

#[test]
fn luminance_and_chroma_of_openexr_are_colors() {
    let color = [0.2, 0.5, 0.9_f32];
    let luminance = 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
    let [red, _, blue] = color.map(|light| (light - luminance) / luminance);
    let channels = SpecificChannels::build()
        .with_channel("Y")
        .with_channel("RY")
        .with_channel("BY");
    let channels = channels.with_pixel_fn(move |_| (luminance, red, blue));
    let mut file = std::io::Cursor::new(Vec::new());
    Image::from_channels((8, 4), channels)
        .write()
        .to_buffered(&mut file)
        .unwrap();
    let mut bytes = file.into_inner();
    let found = texel(&read(&bytes, None).unwrap(), 3, 2);
    for (found, expected) in found.iter().zip(color) {
        assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
    }
    // After the channel's name: its type, its use, and one sample of how many columns and rows.
    for name in ["RY\0", "BY\0"] {
        let length = name.len();
        let at = bytes.windows(length).position(|of| of == name.as_bytes());
        let at = at.unwrap() + length + 8;
        bytes[at] = 2;
        bytes[at + 4] = 2;
    }
    let fault = read(&bytes, None).unwrap_err();
    let expected = "its channels have different resolutions";
    assert!(fault.problem.starts_with(expected), "{fault:?}");
}

#[test]
fn every_format_is_read() {
    for (written, format) in pictures() {
        let bytes = encoded(&written, format);
        for transfer in [None, Some(Transfer::Srgb), Some(Transfer::Linear)] {
            let found = read(&bytes, transfer).unwrap();
            assert_eq!(found.size(), SIZE);
            let is_srgb = match transfer {
                None => format == ImageFormat::Png,
                Some(transfer) => transfer == Transfer::Srgb,
            };
            // Radiance pictures have a common exponent and eight bits of each channel.
            let rounding = if format == ImageFormat::Hdr {
                0.01
            } else {
                1e-6
            };
            for (column, row, pixel) in written.to_rgba32f().enumerate_pixels() {
                let [colors @ .., opacity] = pixel.0;
                let colors = colors.map(|number| if is_srgb { light(number) } else { number });
                let expected = [colors[0], colors[1], colors[2], opacity];
                for (found, expected) in texel(&found, column, row).iter().zip(expected) {
                    let error = (found - expected).abs();
                    assert!(error <= rounding, "{format:?}: {found}, not {expected}");
                }
            }
        }
    }
}

#[test]
fn a_jpeg_is_nearly_what_was_written() {
    let smooth = |x, y| image::Rgb([20 + 5 * x as u8, 200 - 4 * y as u8, 90]);
    let written = DynamicImage::from(image::RgbImage::from_fn(32, 24, smooth));
    let found = read(
        &encoded(&written, ImageFormat::Jpeg),
        Some(Transfer::Linear),
    )
    .unwrap();
    for (x, y, pixel) in written.to_rgb8().enumerate_pixels() {
        let [r, g, b, opacity] = texel(&found, x, y);
        for (found, expected) in [r, g, b].into_iter().zip(pixel.0) {
            assert!((255.0 * found - f32::from(expected)).abs() < 9.0);
        }
        assert_eq!(opacity, 1.0);
    }
}

/// A whole file of each format.
fn files() -> Vec<Vec<u8>> {
    let mut files: Vec<Vec<u8>> = pictures()
        .iter()
        .map(|(picture, format)| encoded(picture, *format))
        .collect();
    let rgb = image::RgbImage::from_fn(20, 20, |x, y| image::Rgb([x as u8 * 9, y as u8 * 9, 5]));
    files.push(encoded(&rgb.into(), ImageFormat::Jpeg));
    files
}

#[test]
fn a_picture_that_ends_early_is_refused_or_a_picture() {
    for file in files() {
        for n in 0..file.len() {
            if let Err(fault) = read(&file[..n], None) {
                assert!(fault.message().starts_with('`'));
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn damage_never_panics(
        file in prop::sample::select(files()),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = file;
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(found) = read(&bytes, None) {
            let [width, height] = found.size();
            let last = texel(&found, width - 1, height - 1);
            prop_assert!(last.iter().all(|channel| channel.is_finite()));
        }
    }
}

#[test]
fn numbers_that_are_not_finite_have_a_place() {
    for (number, expected) in [(f32::NAN, None), (f32::INFINITY, None), (-3.0, Some(0.0))] {
        let mut picture = image::Rgb32FImage::new(4, 3);
        picture.get_pixel_mut(2, 1).0[1] = number;
        let found = read(&encoded(&picture.into(), ImageFormat::OpenExr), None);
        match expected {
            Some(light) => assert_eq!(texel(&found.unwrap(), 2, 1)[1], light),
            None => {
                let message = found.unwrap_err().message();
                assert!(message.contains("column 2, row 1"), "{message}");
            }
        }
    }
}

/// A scene of an object whose color is a picture.
fn scene(folder: &Path, image: &str, object: &str) -> Scene {
    scene_of(
        folder,
        &format!("{{ color: {{ image: {image} }} }}"),
        object,
    )
}

/// A scene of an object of this material.
fn scene_of(folder: &Path, material: &str, object: &str) -> Scene {
    let mut config = config_of(material, object);
    let geometries = Geometries::read(&mut config, folder, u64::MAX).unwrap();
    // Rays are given in world space.
    scene::build::scene_in_space(&config, geometries, RenderSpace::default()).unwrap()
}

fn config_of(material: &str, object: &str) -> Config {
    parse(&format!(
        "image: {{ width: 4, height: 3 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         materials: {{ picture: {material} }}\n\
         lights: []\n\
         objects: [{{ {object}, material: picture }}]\n"
    ))
}

/// The surface points that rays from all directions toward the center hit.
fn surface_points(scene: &Scene) -> Vec<SurfacePoint> {
    let accel = Accel::new(scene, Default::default());
    let tracer = Tracer::new(scene, &accel);
    let trace = |i: u64| {
        let [x, y, z, w] = math::sampling::uniform([3, i, 0]);
        let origin = 9.0 * (Vec3::new(x, y, z) - 0.5).normalize();
        let direction = (w * Vec3::new(y, z, x) - origin).normalize();
        tracer.trace(&Ray { origin, direction }, RayKind::Camera, &mut NoProbe)
    };
    let points: Vec<SurfacePoint> = (0..3000).filter_map(trace).collect();
    assert!(points.len() > 1000);
    points
}

/// A picture whose red is the fraction of its width and whose green that of its height.
fn ramp(folder: &Path) {
    let color = |x, y| image::Rgb([x as f32 / 63.0, 1.0 - y as f32 / 31.0, 0.5]);
    let picture = image::Rgb32FImage::from_fn(64, 32, color);
    let bytes = encoded(&picture.into(), ImageFormat::OpenExr);
    fs::write(folder.join("ramp.exr"), bytes).unwrap();
}

/// Where in the clamped ramp a color is: with half a texel of plain color at the edges.
fn ramp_color(uv: Vec2) -> Vec3 {
    let along = |t: f32, n: f32| ((t.clamp(0.0, 1.0) * n - 0.5) / (n - 1.0)).clamp(0.0, 1.0);
    Vec3::new(along(uv.x, 64.0), along(uv.y, 32.0), 0.5)
}

/// The largest difference of the points' colors from those at the expected coordinates.
fn largest_error(image: &str, object: &str, expected: impl Fn(&SurfacePoint) -> Vec2) -> f32 {
    let folder = tempfile::tempdir().unwrap();
    ramp(folder.path());
    let error = |point: &SurfacePoint| {
        let expected = ramp_color(expected(point));
        (point.color - expected).abs().max_element()
    };
    let points = surface_points(&scene(folder.path(), image, object));
    points.iter().map(error).fold(0.0, f32::max)
}

#[test]
fn a_plane_carries_a_picture_by_its_axes() {
    let image = "{ file: ramp.exr, wrap: clamp, filter: bilinear, size: [2, 0.5], \
                 mapping: { planar: { origin: [-1, 0, 0.2], right: [1, 0, 0], up: [0, 1, 1] } } }";
    let object = "box: { min: [-1, -1, -1], max: [1, 1, 1] }";
    let error = largest_error(image, object, |point| {
        let from = point.position - Vec3::new(-1.0, 0.0, 0.2);
        Vec2::new(from.x / 2.0, (from.y + from.z) / 2.0_f32.sqrt() / 0.5)
    });
    assert!(error < 1e-4, "{error}");
}

#[test]
fn a_sphere_carries_a_map_of_longitudes() {
    let image = "{ file: ramp.exr, wrap: clamp, filter: bilinear, mapping: spherical }";
    let object = "sphere: { center: [0, 0, 0], radius: 1.5 }";
    let error = largest_error(image, object, |point| {
        let p = point.position.normalize();
        let longitude = p.x.atan2(p.z) / std::f32::consts::TAU;
        Vec2::new(0.5 + longitude, 0.5 + p.y.asin() / std::f32::consts::PI)
    });
    assert!(error < 1e-4, "{error}");
}

#[test]
fn faces_along_the_axes_have_one_projection_each() {
    let image = "{ file: ramp.exr, wrap: clamp, filter: bilinear, size: 3, mapping: triplanar }";
    let object = "box: { min: [0, 0, 0], max: [1, 1, 1] }";
    let error = largest_error(image, object, |point| {
        let (p, n) = (point.position, point.normal);
        let uv = match n.abs().max_position() {
            0 => Vec2::new(-p.z * n.x.signum(), p.y),
            1 => Vec2::new(p.x, -p.z * n.y.signum()),
            _ => Vec2::new(p.x * n.z.signum(), p.y),
        };
        uv / 3.0
    });
    assert!(error < 1e-4, "{error}");
}

/// The triangle nearest to a point, by brute force in double precision, and the point's
/// barycentric coordinates.
fn nearest_triangle(mesh: &Mesh, point: Vec3) -> (usize, [f64; 3]) {
    let at = point.as_dvec3();
    let found = (0..mesh.triangles.len()).map(|i| {
        let triangle = mesh.triangle(mesh.triangles[i]);
        let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
        let normal = (b - a).cross(c - a);
        let area = normal.length_squared();
        let weight = |p: DVec3, q: DVec3| (q - p).cross(at - p).dot(normal) / area;
        let weights = [weight(b, c), weight(c, a), weight(a, b)];
        let outside = weights.iter().fold(0.0, |least: f64, w| least.min(*w));
        let away = ((at - a).dot(normal) / normal.length()).abs();
        (away - outside, i, weights)
    });
    let (_, i, weights) = found.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    (i, weights)
}

#[test]
fn a_mesh_carries_a_picture_by_its_texture_coordinates() {
    let file = in_repository("configs/meshes/spot.obj");
    let mesh = read_mesh(&file).unwrap();
    let uvs = mesh.uvs.as_ref().unwrap();
    let object = format!("mesh: {{ file: {} }}", file.display());
    let image = "{ file: ramp.exr, wrap: clamp, filter: bilinear }";
    let error = largest_error(image, &object, |point| {
        let (i, weights) = nearest_triangle(&mesh, point.position);
        let corners = uvs.at(i).into_iter().zip(weights);
        corners.map(|(uv, weight)| uv * weight as f32).sum()
    });
    assert!(error < 1e-3, "{error}");
}

/// A picture of black and white texels in turns.
fn fine_checker(folder: &Path) -> Picture {
    let color = |x: u32, y: u32| image::Luma([if (x + y).is_multiple_of(2) { 255 } else { 0 }]);
    let picture = image::GrayImage::from_fn(64, 64, color);
    let bytes = encoded(&picture.into(), ImageFormat::Png);
    fs::write(folder.join("fine.png"), &bytes).unwrap();
    let found = read(&bytes, None).unwrap();
    std::sync::Arc::unwrap_or_clone(found)
}

#[test]
fn a_ray_sees_as_much_of_a_picture_as_its_cone_is_wide() {
    let folder = tempfile::tempdir().unwrap();
    let picture = fine_checker(folder.path());
    let image = "{ file: fine.png, size: [30, 20], \
                 mapping: { planar: { right: [1, 0, 0], up: [0, 0.6, 0.8] } } }";
    let object = "box: { min: [-1, -1, -1], max: [1, 1, 1] }";
    let scene = scene(folder.path(), image, object);
    // One sample of three pixels in a height of 40 degrees.
    let spread = 2.0 * 20.0_f32.to_radians().tan() / 3.0;
    let accel = Accel::new(&scene, Default::default());
    let sensor = Sensor::new(&scene, &config_of("{ color: 1 }", object));
    let tracer = Tracer::new(&scene, &accel).with_cone(sensor.cone);
    let (up, across) = (Vec3::new(0.0, 0.6, 0.8), Vec3::new(0.0, -0.8, 0.6));
    for i in 0..500 {
        let [x, y, z, length] = math::sampling::uniform([5, i, 0]);
        let origin = 4.0 * (Vec3::new(x, y, z) - 0.5).normalize();
        let direction = (0.5 * Vec3::new(y, z, x) - origin).normalize();
        let ray = Ray { origin, direction };
        let point = tracer.trace_after(length, &ray, RayKind::Reflection, &mut NoProbe);
        let Some(point) = point else { continue };
        let width = spread * (length + point.distance) / direction.dot(point.normal).abs();
        let density = (point.normal.dot(across).abs() / 600.0).sqrt();
        let uv = [point.position.x / 30.0, point.position.dot(up) / 20.0];
        let [r, g, b, _] = picture.at(Sampling::default(), uv, width * density);
        let error = (point.color - Vec3::new(r, g, b)).abs().max_element();
        assert!(error < 1e-3, "{i}: {error}");
    }
}

#[test]
fn a_mirror_lengthens_the_path_of_a_cone() {
    let folder = tempfile::tempdir().unwrap();
    fine_checker(folder.path());
    let file = folder.path().join("fine.png");
    // Far from the mirror, and near to what it shows: texels are smaller than a pixel.
    let mut config = parse(&format!(
        "image: {{ width: 32, height: 32 }}
camera: {{ look_at: {{ eye: [0, 0, 100], target: [0, 0, 0], fov_y_deg: 1 }} }}
shading: {{ ambient: 1 }}
materials:
  mirror: {{ color: 1, ambient: 0, diffuse: 0, reflection: 1 }}
  wall:
    color:
      image:
        file: {}
        mapping: {{ planar: {{ right: [0, 0, 1], up: [0, 1, 0] }} }}
lights: []
objects:
  - plane: {{ point: [0, 0, 0], normal: [1, 0, 1] }}
    material: mirror
  - plane: {{ point: [1.5, 0, 0], normal: [-1, 0, 0] }}
    material: wall
",
        file.display()
    ));
    for mode in [CostMode::None, CostMode::SingleRayTime] {
        config.cost = mode;
        let colors: Vec<[u8; 3]> = film(&config, 1).values(|strip| &strip.rgb).collect();
        assert_eq!(colors.len(), 32 * 32);
        // Half of the light is level 188.
        let all_gray = colors.iter().all(|color| (165..210).contains(&color[0]));
        assert!(all_gray, "{colors:?}");
    }
}

/// The largest difference of the points' normals from those of a picture of one normal,
/// whose axes right and up at each point are `axes`.
fn largest_tilt_error(
    mapping: &str,
    object: &str,
    axes: impl Fn(&SurfacePoint) -> [Vec3; 2],
) -> f32 {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::Rgb32FImage::from_pixel(4, 4, image::Rgb([0.75, 0.4, 0.9]));
    let bytes = encoded(&picture.into(), ImageFormat::OpenExr);
    fs::write(folder.path().join("tilt.exr"), bytes).unwrap();
    let material = format!(
        "{{ color: 1, normal_map: {{ image: {{ file: tilt.exr, mapping: {mapping} }}, strength: 0.5 }} }}"
    );
    let error = |point: &SurfacePoint| {
        let own = point.geometric_normal;
        let [right, up] = axes(point);
        let right = right.reject_from_normalized(own).normalize();
        let up = up
            .reject_from_normalized(own)
            .reject_from_normalized(right)
            .normalize();
        let expected = (0.25 * right - 0.1 * up + 0.8 * own).normalize();
        (point.normal - expected).length()
    };
    let points = surface_points(&scene_of(folder.path(), &material, object));
    points.iter().map(error).fold(0.0, f32::max)
}

#[test]
fn normals_tilt_along_the_axes_of_the_picture() {
    let planar = "{ planar: { right: [1, 0.5, 0.3], up: [0.2, 0.4, -1] } }";
    let cube = "box: { min: [-1, -1, -1], max: [1, 1, 1] }";
    let axes = [Vec3::new(1.0, 0.5, 0.3), Vec3::new(0.2, 0.4, -1.0)];
    let error = largest_tilt_error(planar, cube, |_| axes);
    assert!(error < 1e-4, "planar: {error}");
    let error = largest_tilt_error("triplanar", cube, |point| {
        let n = point.geometric_normal;
        match n.abs().max_position() {
            0 => [-Vec3::Z * n.x.signum(), Vec3::Y],
            1 => [Vec3::X, -Vec3::Z * n.y.signum()],
            _ => [Vec3::X * n.z.signum(), Vec3::Y],
        }
    });
    assert!(error < 1e-4, "triplanar: {error}");
    let ball = "sphere: { center: [0, 0, 0], radius: 1.5 }";
    let error = largest_tilt_error("spherical", ball, |point| {
        [Vec3::Y.cross(point.position), Vec3::Y]
    });
    assert!(error < 1e-3, "spherical: {error}");
}

#[test]
fn normals_of_a_mesh_tilt_along_its_texture_coordinates() {
    let file = in_repository("configs/meshes/spot.obj");
    let mesh = read_mesh(&file).unwrap();
    let uvs = mesh.uvs.as_ref().unwrap();
    let object = format!("mesh: {{ file: {}, normals: flat }}", file.display());
    let error = largest_tilt_error("uv", &object, |point| {
        let (i, _) = nearest_triangle(&mesh, point.position);
        let [a, b, c] = mesh.triangle(mesh.triangles[i]).vertices;
        let [p, q, r] = uvs.at(i);
        // The inverse of the map from edges in texture coordinates to edges in space.
        let edges = glam::Mat2::from_cols(q - p, r - p).inverse();
        let [along_u, along_v] =
            [edges.x_axis, edges.y_axis].map(|weights| weights.x * (b - a) + weights.y * (c - a));
        [along_u, along_v]
    });
    assert!(error < 1e-2, "{error}");
}
