//! glTF files, made here: their triangles, materials and mistakes.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DVec3, Vec3};
use import::{Finish, Mesh, MeshOpacity, read_mesh, read_mesh_with_materials};
use scene::build::Geometries;
use scene::config::Config;
use serde_json::{Value, json};
use tracer::accel::Accel;
use tracer::cost::{NoProbe, RayKind};
use tracer::trace::Tracer;
use world::geometry::{Ray, RenderSpace};
use world::material::MaterialKind;
use world::scene::Scene;

use crate::common::parse;

/// A file: its JSON and its first buffer.
#[derive(Clone)]
pub struct Gltf {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl Gltf {
    /// Appends bytes to the buffer; returns the index of their view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view =
            json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() });
        self.binary.extend(bytes);
        self.json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        push(&mut self.json["bufferViews"], view)
    }

    /// Appends an accessor; returns its index.
    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let mut accessor = json!({
            "bufferView": view, "componentType": component, "count": count, "type": kind,
            "normalized": component == 5121 && kind != "SCALAR",
        });
        if kind == "VEC3" {
            // The bounds that positions need are not read.
            (accessor["min"], accessor["max"]) = (json!([0, 0, 0]), json!([1, 1, 1]));
        }
        push(&mut self.json["accessors"], accessor)
    }

    pub fn floats(&mut self, kind: &str, count: usize, numbers: &[f32]) -> usize {
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        self.accessor(kind, 5126, count, &bytes)
    }

    /// As a binary file.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.binary.len();
        let mut file = b"glTF".to_vec();
        file.extend(2_u32.to_le_bytes());
        file.extend((length as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.binary)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        file
    }

    /// As JSON, whose buffer is at a URI.
    pub fn gltf(&self, uri: &str) -> String {
        let mut json = self.json.clone();
        json["buffers"][0]["uri"] = uri.into();
        json.to_string()
    }
}

pub fn push(list: &mut Value, item: Value) -> usize {
    if list.is_null() {
        *list = json!([]);
    }
    let list = list.as_array_mut().unwrap();
    list.push(item);
    list.len() - 1
}

/// A sign: a panel with a picture, twice as large and turned by a quarter, and a mirrored
/// triangle with colors.
pub fn sign() -> Gltf {
    let mut file = Gltf {
        json: json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [
                { "translation": [1, 0, 0], "children": [1, 2] },
                { "mesh": 0, "scale": [2, 2, 2], "rotation": [0, 0, 0.5_f32.sqrt(), 0.5_f32.sqrt()] },
                { "mesh": 1, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1] },
            ],
        }),
        binary: Vec::new(),
    };
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let positions = file.floats("VEC3", 4, &corners);
    let normals = file.floats("VEC3", 4, &[0.0, 0.0, 1.0].repeat(4));
    let uvs = file.floats("VEC2", 4, &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let indices: Vec<u8> = [0_u16, 1, 2, 0, 2, 3]
        .iter()
        .flat_map(|i| i.to_le_bytes())
        .collect();
    let indices = file.accessor("SCALAR", 5123, 6, &indices);
    let triangle = file.floats("VEC3", 3, &corners[..9]);
    let colors = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]].concat();
    let colors = file.accessor("VEC4", 5121, 3, &colors);
    let mut picture = Vec::new();
    let texel = |x, y| image::Rgb([255 * u8::from(x < 2), 255 * u8::from(y < 2), 0]);
    let made = image::RgbImage::from_fn(4, 4, texel);
    made.write_to(
        &mut std::io::Cursor::new(&mut picture),
        image::ImageFormat::Png,
    )
    .unwrap();
    let picture = file.view(&picture);
    file.json["images"] = json!([{ "bufferView": picture, "mimeType": "image/png" }]);
    file.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33071 }]);
    file.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    file.json["materials"] = json!([
        { "name": "panel", "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 }, "baseColorFactor": [1, 0.5, 1, 1],
            "metallicFactor": 0.25, "roughnessFactor": 0.5,
        } },
        { "name": "painted", "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 0.5, 1] },
          "emissiveFactor": [0.1, 0, 0], "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 3 },
            "KHR_materials_ior": { "ior": 1.4 },
        } },
    ]);
    let panel = json!({
        "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs },
        "indices": indices, "material": 0,
    });
    let painted = json!({
        "attributes": { "POSITION": triangle, "COLOR_0": colors }, "material": 1,
    });
    file.json["meshes"] = json!([{ "primitives": [panel] }, { "primitives": [painted] }]);
    file
}

/// The mesh of a file with its materials, or the message about it.
pub fn read(name: &str, bytes: &[u8]) -> Result<Mesh, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let place = folder.path().display().to_string() + "/";
    let read = read_mesh_with_materials(&path, 1 << 20);
    read.map_err(|fault| fault.to_string().replace(&place, ""))
}

fn read_scene(folder: &Path, rest: &str) -> (Config, Geometries) {
    let mut config = parse(&format!(
        "image: {{ width: 4000, height: 3000 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         lights: []\nmaterials: {{ red: {{ color: [1, 0, 0] }} }}\n{rest}"
    ));
    let geometries = Geometries::read(&mut config, folder, u64::MAX).unwrap();
    (config, geometries)
}

fn scene_of(folder: &Path, rest: &str) -> Scene {
    let (config, geometries) = read_scene(folder, rest);
    // Rays are given in world space.
    scene::build::scene_in_space(&config, geometries, RenderSpace::default()).unwrap()
}

/// The color of the surface that a ray along -z meets.
fn color(scene: &Scene, [x, y]: [f32; 2]) -> Vec3 {
    let accel = Accel::new(scene, Default::default());
    let ray = Ray {
        origin: Vec3::new(x, y, 9.0),
        direction: -Vec3::Z,
    };
    let point = Tracer::new(scene, &accel).trace(&ray, RayKind::Camera, &mut NoProbe);
    point.unwrap().color
}

fn assert_color(scene: &Scene, [x, y]: [f32; 2], expected: [f32; 3]) {
    let found = color(scene, [x, y]);
    let difference = (found - Vec3::from(expected)).abs().max_element();
    assert!(difference < 0.01, "{x} {y}: {found}, expected {expected:?}");
}

#[test]
fn nodes_place_meshes_and_mirrored_ones_keep_their_outside() {
    let mesh = read("sign.glb", &sign().glb()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 6, 5]]);
    let expected = [
        [1, 0, 0],
        [1, 2, 0],
        [-1, 2, 0],
        [-1, 0, 0],
        [1, 0, 1],
        [0, 0, 1],
        [0, 1, 1],
    ];
    for (found, expected) in mesh.vertices.iter().zip(expected) {
        let expected = Vec3::from(expected.map(|x| x as f32));
        assert!(
            (found - expected).length() < 1e-6,
            "{found}, expected {expected}"
        );
    }
    for triangle in 0..3 {
        let normals = mesh.normals.as_ref().unwrap().at(triangle);
        assert!(
            normals
                .iter()
                .all(|normal| (normal - Vec3::Z).length() < 1e-6)
        );
        assert_eq!(
            mesh.triangle(mesh.triangles[triangle]).normal(),
            Some(Vec3::Z)
        );
    }
}

/// A small mesh keeps its shape at a node far away.
#[test]
fn nodes_place_meshes_far_away() {
    let mut file = sign();
    let near = read("a.glb", &file.glb()).unwrap();
    assert_eq!(near.origin, DVec3::ZERO);
    // 32 bits have room for these numbers, not for those of a child that is beside them.
    let far = DVec3::new(300_000.125, 4_000_000.5, 0.0);
    file.json["nodes"][0]["translation"] = json!(far.to_array());
    file.json["nodes"][1]["translation"] = json!([0.01, 0.07, 0]);
    let mesh = read("a.glb", &file.glb()).unwrap();
    for (i, (found, near)) in mesh.vertices.iter().zip(&near.vertices).enumerate() {
        let found = mesh.origin + found.as_dvec3() - far;
        let is_moved = f64::from(u8::from(i < 4));
        let expected = near.as_dvec3() - DVec3::X + is_moved * DVec3::new(0.01, 0.07, 0.0);
        assert!(found.distance(expected) < 1e-6, "{found} {expected}");
    }
}

#[test]
fn a_file_has_its_pictures_colors_and_finish() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sign.glb"), sign().glb()).unwrap();
    for model in ["blinn_phong", "path", "seed"] {
        let rest =
            format!("shading: {{ model: {model} }}\nobjects: [{{ mesh: {{ file: sign.glb }} }}]\n");
        let scene = scene_of(folder.path(), &rest);
        // Turned by a quarter, the upper left of the picture is at the lower left.
        assert_color(&scene, [-0.7, 0.3], [1.0, 0.5, 0.0]);
        assert_color(&scene, [-0.7, 1.7], [0.0, 0.5, 0.0]);
        assert_color(&scene, [0.8, 1.7], [0.0, 0.0, 0.0]);
        assert_color(&scene, [0.999, 0.0005], [1.0, 0.0, 0.0]);
        assert_color(&scene, [0.25, 0.25], [0.25, 0.5, 0.125]);
        let [_, panel, painted] = &scene.materials[..] else {
            unreachable!()
        };
        let principled = match panel.kind {
            MaterialKind::Principled { surface, .. } => Some(surface),
            _ => None,
        };
        let principled = principled.map(|of| (of.metallic, of.roughness, of.index));
        assert_eq!(principled, (model == "path").then_some((0.25, 0.5, 1.5)));
        let emission = if model == "seed" { 0.0 } else { 0.3 };
        assert!((painted.emission - Vec3::new(emission, 0.0, 0.0)).length() < 1e-6);
    }
    let rest = "objects: [{ mesh: { file: sign.glb }, material: red }]\n";
    assert_color(&scene_of(folder.path(), rest), [-0.7, 0.3], [1.0, 0.0, 0.0]);
}

/// A node without a name has that of its mesh; equal names are numbered, and a mesh that is placed
/// many times is one object.
#[test]
fn nodes_are_told_apart_by_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let labels = |file: &Gltf, rest: &str| {
        std::fs::write(folder.path().join("sign.glb"), file.glb()).unwrap();
        let (config, _) = read_scene(folder.path(), rest);
        let materials: Vec<_> = config.materials.keys().skip(1).cloned().collect();
        (
            config.object_labels().collect::<Vec<_>>(),
            materials.join(" "),
        )
    };
    let own = "objects: [{ mesh: { file: sign.glb } }]\n";
    let mut file = sign();
    let both = "sign.glb/panel sign.glb/painted";
    let by_material = ["sign.glb/panel", "sign.glb/painted"]
        .map(str::to_owned)
        .to_vec();
    assert_eq!(labels(&file, own), (by_material, both.to_owned()));
    file.json["nodes"][0]["mesh"] = 1.into();
    file.json["nodes"][1]["name"] = "board".into();
    file.json["nodes"][2]["name"] = "board".into();
    file.json["meshes"][1]["name"] = "flag".into();
    let (names, materials) = labels(&file, own);
    assert_eq!(
        names,
        ["sign.glb/board", "sign.glb/flag", "sign.glb/board 2"]
    );
    assert_eq!(materials, both);
    file.json["meshes"][1]["primitives"][0]["material"] = 0.into();
    let (names, materials) = labels(&file, &own.replace("mesh:", "name: at home, mesh:"));
    assert_eq!(names, ["at home/flag", "at home/board", "at home/board 2"]);
    assert_eq!(materials, "sign.glb/panel");
    let red = "objects: [{ mesh: { file: sign.glb }, material: red }]\n";
    assert_eq!(labels(&file, red).0, ["mesh 0"]);
    let places = "places: [[{ translate: [9, 0, 0] }], [{ scale: 2 }]]";
    let placed =
        format!("objects: [{{ instances: {{ mesh: {{ file: sign.glb }}, {places} }} }}]\n");
    assert_eq!(labels(&file, &placed).0, ["instances 0"]);
}

/// A factor multiplies the light of a picture of bytes between its texels, too, not its bytes; and
/// one picture serves two factors.
#[test]
fn a_factor_of_a_picture_is_not_rounded_to_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = sign();
    file.json["samplers"] = json!([{}]);
    let bright = file.json["materials"][0].clone();
    file.json["materials"][1] = bright;
    let mut triangle = file.json["meshes"][0]["primitives"][0].clone();
    triangle["material"] = 1.into();
    file.json["meshes"][1]["primitives"][0] = triangle;
    let factors = [[0.013, 0.5, 1.0], [0.7, 0.0021, 1.0]];
    let color_at = |factors: [[f32; 3]; 2], [x, y]: [f32; 2]| {
        let mut file = file.clone();
        for (i, [r, g, b]) in factors.into_iter().enumerate() {
            let color = &mut file.json["materials"][i]["pbrMetallicRoughness"]["baseColorFactor"];
            *color = json!([r, g, b, 1]);
        }
        std::fs::write(folder.path().join("sign.glb"), file.glb()).unwrap();
        let mesh = "objects: [{ mesh: { file: sign.glb } }]\n";
        color(&scene_of(folder.path(), mesh), [x, y])
    };
    for (at, factor) in [([-0.7, 1.1], factors[0]), ([0.45, 0.55], factors[1])] {
        let whole = color_at([[1.0; 3]; 2], at);
        assert!(whole.x > 0.1 && whole.y > 0.1, "{whole}");
        let error = color_at(factors, at) - whole * Vec3::from(factor);
        assert!(error.abs().max_element() < 1e-7, "{error}");
    }
    let read = read_mesh_with_materials(&folder.path().join("sign.glb"), 1 << 20).unwrap();
    let pictures: Vec<_> = read.materials.iter().flat_map(|of| &of.picture).collect();
    assert!(std::sync::Arc::ptr_eq(
        &pictures[0].picture,
        &pictures[1].picture
    ));
}

#[test]
fn json_with_a_buffer_inside_or_beside_it_is_the_same() {
    let file = sign();
    let binary = read("sign.glb", &file.glb()).unwrap();
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(&file.binary)
    );
    assert_eq!(
        read("sign.gltf", file.gltf(&uri).as_bytes()).unwrap(),
        binary
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a sign.bin"), &file.binary).unwrap();
    let path = folder.path().join("sign.gltf");
    std::fs::write(&path, file.gltf("a%20sign.bin")).unwrap();
    assert_eq!(read_mesh_with_materials(&path, 1 << 20).unwrap(), binary);
    assert_eq!(import::pieces_of(&path).len(), 0, "its name is encoded");
    let alone = read_mesh(&path).unwrap();
    assert_eq!((alone.materials.len(), alone.material_of.len()), (0, 0));
}

#[test]
fn strips_fans_and_sparse_numbers_are_read() {
    let mut file = sign();
    let strip = file.json["meshes"][0]["primitives"][0]
        .as_object_mut()
        .unwrap();
    strip.remove("indices");
    strip.insert("mode".into(), 5.into());
    assert_eq!(
        read("a.glb", &file.glb()).unwrap().triangles[..2],
        [[0, 1, 2], [2, 1, 3]]
    );
    file.json["meshes"][0]["primitives"][0]["mode"] = 6.into();
    assert_eq!(
        read("a.glb", &file.glb()).unwrap().triangles[..2],
        [[0, 1, 2], [0, 2, 3]]
    );
    file.json["meshes"][0]["primitives"][0]["mode"] = 1.into();
    assert_eq!(read("a.glb", &file.glb()).unwrap().triangles.len(), 1);
    let mut file = sign();
    let indices = file.view(&[2, 0, 0, 0]);
    let values = file.view(bytemuck::cast_slice(&[5.0_f32, 6.0, 7.0]));
    let triangle = file.json["meshes"][1]["primitives"][0]["attributes"]["POSITION"].clone();
    file.json["accessors"][triangle.as_u64().unwrap() as usize]["sparse"] = json!({
        "count": 1, "values": { "bufferView": values },
        "indices": { "bufferView": indices, "componentType": 5121 },
    });
    let mesh = read("a.glb", &file.glb()).unwrap();
    assert_eq!(mesh.vertices[6], Vec3::new(-4.0, 6.0, 8.0));
}

#[test]
fn transparency_is_opacity_or_glass() {
    let mut file = sign();
    let painted = |file: &Gltf| read("a.glb", &file.glb()).unwrap().materials[1].clone();
    assert_eq!(
        (painted(&file).transmission, painted(&file).index),
        (0.0, 1.4)
    );
    let Finish::Facets {
        metallic,
        roughness,
    } = painted(&file).finish
    else {
        panic!()
    };
    assert_eq!((metallic, roughness), (1.0, 1.0));
    let material = &mut file.json["materials"][1];
    material["alphaMode"] = "BLEND".into();
    material["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.25.into();
    let opacity = |factor, threshold| MeshOpacity {
        factor,
        picture: None,
        threshold,
    };
    assert_eq!(painted(&file).transmission, 0.0);
    assert_eq!(painted(&file).opacity, Some(opacity(0.25, None)));
    file.json["materials"][1]["alphaMode"] = "MASK".into();
    assert_eq!(painted(&file).opacity, Some(opacity(0.25, Some(0.5))));
    file.json["materials"][1]["alphaMode"] = "OPAQUE".into();
    assert_eq!(painted(&file).opacity, None);
    let glass = json!({ "transmissionFactor": 0.5 });
    file.json["materials"][1]["extensions"]["KHR_materials_transmission"] = glass;
    assert_eq!(
        (painted(&file).transmission, painted(&file).index),
        (0.5, 1.4)
    );
    let panel = &mut file.json["materials"][0];
    panel["alphaMode"] = "MASK".into();
    panel["alphaCutoff"] = 0.3.into();
    // An opaque picture has no holes.
    assert_eq!(
        read("a.glb", &file.glb()).unwrap().materials[0].opacity,
        None
    );
}

/// The opacities of vertices multiply the color's, and count as its mode says.
#[test]
fn vertices_have_opacities() {
    let mut file = sign();
    let colors = [[255, 0, 0, 0], [0, 255, 0, 51], [0, 0, 255, 102]].concat();
    let colors = file.accessor("VEC4", 5121, 3, &colors);
    file.json["meshes"][1]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
    let read = |file: &Gltf| read("a.glb", &file.glb()).unwrap();
    assert_eq!(read(&file).opacities, None);
    for mode in ["BLEND", "MASK"] {
        file.json["materials"][1]["alphaMode"] = mode.into();
        let opacities = read(&file).opacities.unwrap();
        assert_eq!(
            [0, 2].map(|i| opacities.at(i)),
            [[1.0; 3], [0.0, 0.4, 0.2]],
            "{mode}"
        );
        let opacity = read(&file).materials[1].opacity.clone().unwrap();
        assert_eq!(
            (opacity.factor, opacity.threshold),
            (1.0, (mode == "MASK").then_some(0.5))
        );
    }
}

/// The message about a sign of which one value is another.
fn fault_of(pointer: &str, value: Value) -> String {
    let mut file = sign();
    *file
        .json
        .pointer_mut(pointer)
        .unwrap_or_else(|| panic!("{pointer}")) = value;
    read("a.glb", &file.glb()).map(drop).unwrap_err()
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table of cases")]
fn a_mistake_is_reported_with_its_place() {
    for (pointer, value, expected) in [
        (
            "/asset/version",
            json!("1.0"),
            "it is glTF 1.0, expected glTF 2.0",
        ),
        (
            "/scenes/0/nodes",
            json!([9]),
            "`scenes[0].nodes[0]`: there is none with this index, expected one that there is",
        ),
        (
            "/nodes/1/mesh",
            json!(7),
            "`nodes[1].mesh`: there is none with this index, expected one that there is",
        ),
        (
            "/nodes/0/children",
            json!([1, 1]),
            "`nodes[1]` is a child of two nodes, expected a tree of nodes",
        ),
        (
            "/nodes/0/children",
            json!([0]),
            "`nodes[0]` is a child of two nodes, expected a tree of nodes",
        ),
        (
            "/nodes/0/translation",
            json!([1e38, 1e38, 1e39]),
            "the transform of `nodes[0]` is not finite, expected finite numbers",
        ),
        (
            "/accessors/3/count",
            json!(7),
            "`meshes[0].primitives[0]`: `accessors[3]` reaches out of its view, expected an offset and a count within it",
        ),
        ("/accessors/3/count", json!(u64::MAX), "its arrays take"),
        ("/accessors/0/count", json!(1_u64 << 40), "its arrays take"),
        (
            "/accessors/0/count",
            json!(3),
            "`meshes[0].primitives[0]`: there is no vertex 3, expected one of the 3, from 0",
        ),
        (
            "/accessors/1/count",
            json!(3),
            "`meshes[0].primitives[0]`: `accessors[1]` has 3 elements, expected one for each of the 4 vertices",
        ),
        (
            "/accessors/0/type",
            json!("VEC9"),
            "`accessors[0].type`: it has no valid value, expected one of glTF 2.0",
        ),
        (
            "/accessors/3/componentType",
            json!(5126),
            "`accessors[3]` has no indices",
        ),
        (
            "/bufferViews/2/byteLength",
            json!(4000),
            "`bufferViews[2]` reaches out of its buffer",
        ),
        (
            "/bufferViews/0/byteOffset",
            json!(u64::MAX),
            "`bufferViews[0]` reaches out of its buffer",
        ),
        ("/buffers/0/byteLength", json!(90_000), "`buffers[0]` has"),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(99),
            "a mesh has attributes of `accessors[99]`, expected one of the 6 accessors, from 0",
        ),
        (
            "/buffers/0/uri",
            json!("a.bin"),
            "`a.bin`: cannot read it: ",
        ),
    ] {
        let found = if pointer == "/buffers/0/uri" {
            read("a.gltf", sign().gltf("a.bin").as_bytes())
                .map(drop)
                .unwrap_err()
        } else {
            fault_of(pointer, value)
        };
        let name = if pointer == "/buffers/0/uri" {
            "`a.gltf`"
        } else {
            "`a.glb`"
        };
        assert!(
            found.starts_with(name) && found.contains(expected),
            "{pointer}: {found}"
        );
    }
    let mut file = sign();
    file.json["extensionsRequired"] = json!(["EXT_new", "KHR_draco_mesh_compression"]);
    // What the extension changes is no mistake of the file.
    file.json["accessors"][0] = json!({});
    let found = read("a.glb", &file.glb()).unwrap_err();
    let expected = "it requires the extension `KHR_draco_mesh_compression`: its meshes are \
                    compressed by Draco, expected a file that was exported without it";
    assert!(found.ends_with(expected), "{found}");
    let old = r#"{ "asset": { "version": 1.0 }, "meshes": { "a": {} } }"#;
    let found = read("a.gltf", old.as_bytes()).unwrap_err();
    assert!(
        found.ends_with("it is glTF 1.0, expected glTF 2.0"),
        "{found}"
    );
    let mut old = sign().glb();
    old[4] = 1;
    let found = read("a.glb", &old).unwrap_err();
    assert!(
        found.ends_with("it is glTF 1, expected glTF 2.0"),
        "{found}"
    );
}

/// The specification leaves names that begin with `_` to each program.
#[test]
fn attributes_of_other_programs_are_no_obstacle() {
    let mut file = sign();
    let plain = read("a.glb", &file.glb()).unwrap();
    let own = file.floats("VEC3", 4, &[0.0; 12]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["_OWN"] = own.into();
    assert_eq!(read("a.glb", &file.glb()), Ok(plain));
}

/// Gives the sign a light at a node of its own, whose parent stands at x = 1.
fn with_light(light: Value, node: Value) -> Gltf {
    let mut file = sign();
    file.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    file.json["extensions"]["KHR_lights_punctual"] = json!({ "lights": [light] });
    let of_light = push(&mut file.json["nodes"], node);
    file.json["nodes"][of_light]["extensions"]["KHR_lights_punctual"] = json!({ "light": 0 });
    push(&mut file.json["nodes"][0]["children"], of_light.into());
    file
}

/// A matte white surface in 1 lux has a radiance of 1 / pi.
#[test]
fn lights_shine_from_their_nodes() {
    // Turned from -z to -y, and moved; the scale counts for nothing.
    let down = [-(0.5_f32.sqrt()), 0.0, 0.0, 0.5_f32.sqrt()];
    let node = json!({ "translation": [1, 5, 0], "rotation": down, "scale": [3, 3, 3] });
    let cone = json!({ "innerConeAngle": 0.2, "outerConeAngle": 0.4 });
    // The light, the point that it lights, and the illuminance there.
    for (light, point, lux) in [
        (
            json!({ "type": "directional", "intensity": 7, "color": [1, 0.5, 0] }),
            [80.0, -9.0, 3.0],
            7.0,
        ),
        (
            json!({ "type": "point", "intensity": 60 }),
            [2.0, 3.0, 0.0],
            15.0,
        ),
        (json!({ "type": "point", "range": 9 }), [2.0, 6.0, 0.0], 1.0),
        (
            json!({ "type": "spot", "intensity": 60, "spot": cone }),
            [2.1, 3.0, 0.0],
            60.0 / 4.01,
        ),
        (
            json!({ "type": "spot", "intensity": 60, "spot": cone }),
            [3.0, 3.0, 0.0],
            0.0,
        ),
    ] {
        let mesh = read("a.glb", &with_light(light.clone(), node.clone()).glb()).unwrap();
        let [found] = mesh.lights[..] else {
            panic!("{light}: {:?}", mesh.lights);
        };
        let found = found.illuminate(Vec3::from(point).into()).radiance;
        let error = (found.x * std::f32::consts::PI - lux).abs();
        assert!(error < 1e-4 * lux.max(1.0), "{light}: {found:?}");
    }
    let limited = with_light(json!({ "type": "point", "range": 9 }), json!({}));
    let notes = read("a.glb", &limited.glb()).unwrap().notes;
    let expected = "the `range` of 1 light is ignored: light weakens with the distance";
    assert_eq!(notes, [expected]);
    let hidden = json!({ "scale": [0, 0, 0] });
    let sun = json!({ "type": "directional" });
    let mesh = read("a.glb", &with_light(sun, hidden).glb()).unwrap();
    assert_eq!(mesh.lights, []);
}

#[test]
fn lights_out_of_range_are_refused() {
    for (light, expected) in [
        (json!({ "type": "spot" }), "it is missing"),
        (
            json!({ "type": "point", "intensity": -1 }),
            "the intensity of light 0 is out of range, expected a number, at least 0",
        ),
        (
            json!({ "type": "point", "color": [1, -1, 0] }),
            "the color of light 0 is out of range",
        ),
        (
            json!({ "type": "spot", "spot": { "outerConeAngle": 2 } }),
            "the cone of light 0 is out of range",
        ),
    ] {
        let found = read("a.glb", &with_light(light.clone(), json!({})).glb()).unwrap_err();
        assert!(found.contains(expected), "{light}: {found}");
    }
    let mut file = with_light(json!({ "type": "point" }), json!({}));
    file.json["nodes"][3]["extensions"]["KHR_lights_punctual"] = json!({ "light": 1 });
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(found.contains("there is none with this index"), "{found}");
}

/// An object twice as large is as bright.
#[test]
fn a_file_lights_the_scene_that_shows_it() {
    let folder = tempfile::tempdir().unwrap();
    let sun = with_light(
        json!({ "type": "point", "intensity": 60 }),
        json!({ "translation": [0, 5, 0] }),
    );
    std::fs::write(folder.path().join("sign.glb"), sun.glb()).unwrap();
    let light = |object: &str, point: [f32; 3]| -> f32 {
        let rest = format!("objects: [{{ {object} }}]\n");
        let (config, _) = read_scene(folder.path(), &rest);
        let lights = config.lights.iter();
        lights
            .map(|light| light.illuminate(Vec3::from(point).into()).radiance.x)
            .sum()
    };
    let file = "mesh: { file: sign.glb }";
    let found = light(file, [1.0, 2.0, 0.0]);
    let expected = 60.0 / std::f32::consts::PI / 9.0;
    assert!((found / expected - 1.0).abs() < 1e-4, "{found}");
    let twice = format!("{file}, transform: [{{ scale: 2 }}]");
    let scaled = light(&twice, [2.0, 4.0, 0.0]);
    assert!((scaled / expected - 1.0).abs() < 1e-4, "{scaled}");
    let half = light("mesh: { file: sign.glb, lights: 0.5 }", [1.0, 2.0, 0.0]);
    assert!((half / expected - 0.5).abs() < 1e-4, "{half}");
    let none = "mesh: { file: sign.glb, lights: 0 }";
    assert_eq!(light(none, [1.0, 2.0, 0.0]), 0.0);
}

/// A panel whose picture varies what is not its color.
#[test]
fn light_roughness_and_metal_vary_as_their_pictures_do() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = sign();
    let panel = &mut file.json["materials"][0];
    panel["emissiveTexture"] = json!({ "index": 0 });
    panel["emissiveFactor"] = json!([0.5, 0.5, 0.5]);
    panel["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({ "index": 0 });
    std::fs::write(folder.path().join("sign.glb"), file.glb()).unwrap();
    for model in ["blinn_phong", "path"] {
        let rest =
            format!("shading: {{ model: {model} }}\nobjects: [{{ mesh: {{ file: sign.glb }} }}]\n");
        let scene = scene_of(folder.path(), &rest);
        let accel = Accel::new(&scene, Default::default());
        let panel = &scene.materials[1];
        assert_eq!(panel.emission, Vec3::splat(0.5));
        // Red, green and black of the picture.
        for ([x, y], [red, green]) in [
            ([-0.7, 0.3], [1.0, 1.0]),
            ([-0.7, 1.7], [0.0, 1.0]),
            ([0.8, 1.7], [0.0, 0.0]),
        ] {
            let ray = Ray {
                origin: Vec3::new(x, y, 9.0),
                direction: -Vec3::Z,
            };
            let tracer = Tracer::new(&scene, &accel);
            let point = tracer.trace(&ray, RayKind::Camera, &mut NoProbe).unwrap();
            let factors = point.factors;
            assert_eq!(Vec3::from(factors.emission), Vec3::new(red, green, 0.0));
            let facets = (factors.roughness, factors.metallic);
            let expected = if model == "path" {
                (green, 0.0)
            } else {
                (1.0, 1.0)
            };
            assert_eq!(facets, expected, "{model} {x} {y}");
        }
        // Rays find the light of a picture by chance.
        if model == "path" {
            assert_eq!(scene.lights.n_sources(), 1, "that of the painted triangle");
        }
    }
}

/// Nodes that show the same mesh over and over take its memory each.
#[test]
fn a_mesh_shown_too_often_is_refused_before_it_is_placed() {
    let mut file = sign();
    let n = 400_000;
    let corners = file.floats("VEC3", 30_000, &vec![0.5; 90_000]);
    file.json["meshes"][1]["primitives"][0] = json!({ "attributes": { "POSITION": corners } });
    file.json["nodes"] = json!(vec![json!({ "mesh": 1 }); n]);
    file.json["scenes"][0]["nodes"] = json!((0..n).collect::<Vec<_>>());
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(found.contains("its arrays take"), "{found}");
}

#[test]
fn damage_is_never_a_panic() {
    let file = sign();
    let glb = file.glb();
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(&file.binary)
    );
    let gltf = file.gltf(&uri).into_bytes();
    for (name, whole) in [("a.glb", &glb), ("a.gltf", &gltf)] {
        for i in 0..200 {
            let at = i * whole.len() / 200;
            let cut = read(name, &whole[..at]).unwrap_err();
            assert!(cut.starts_with(&format!("`{name}`")), "{cut}");
            for flip in [1, 0x20, 0x80] {
                let mut damaged = whole.clone();
                damaged[at] ^= flip;
                match read(name, &damaged) {
                    Err(fault) => assert!(fault.starts_with(&format!("`{name}`")), "{fault}"),
                    Ok(mesh) => {
                        let n = mesh.vertices.len() as u32;
                        assert!(
                            mesh.triangles
                                .as_flattened()
                                .iter()
                                .all(|corner| *corner < n)
                        );
                        mesh.into_parts();
                    }
                }
            }
        }
    }
}
