//! Parts of glTF files that place, pose, hide or show surfaces otherwise, and mistakes without
//! consequence.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use import::{Finish, Mesh};
use serde_json::{Value, json};

use crate::common::radiance;
use crate::gltf::{Gltf, push, read, sign};

/// The mesh of a file.
fn mesh(file: &Gltf) -> Mesh {
    read("a.glb", &file.glb()).unwrap()
}

/// The vertices in the space of the scene.
fn points(mesh: &Mesh) -> Vec<Vec3> {
    let vertices = mesh.vertices.iter();
    vertices
        .map(|vertex| *vertex + mesh.origin.as_vec3())
        .collect()
}

fn assert_near(found: Vec3, expected: [f32; 3]) {
    let error = (found - Vec3::from(expected)).abs().max_element();
    assert!(error < 1e-5, "{found}, expected {expected:?}");
}

#[test]
fn morph_targets_have_the_weights_of_their_node_or_of_their_mesh() {
    let mut file = sign();
    let moved = file.floats("VEC3", 3, &[0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0]);
    let far = file.floats("VEC3", 3, &[9.0; 9]);
    let painted = &mut file.json["meshes"][1];
    painted["primitives"][0]["targets"] = json!([{ "POSITION": far }, { "POSITION": moved }]);
    let corner = |file: &Gltf| points(&mesh(file))[4];
    assert_near(corner(&file), [1.0, 0.0, 1.0]);
    file.json["meshes"][1]["weights"] = json!([0, 0.5]);
    assert_near(corner(&file), [1.0, 0.0, 2.0]);
    file.json["nodes"][2]["weights"] = json!([0, -1]);
    assert_near(corner(&file), [1.0, 0.0, -1.0]);
    file.json["accessors"][moved]["count"] = 2.into();
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(
        found.contains("has 2 elements, expected one for each of the 3 vertices"),
        "{found}"
    );
}

/// A joint at x = 5 that doubles, and one that mirrors; the node's own place does not count.
#[test]
fn joints_place_the_vertices_of_skins() {
    let mut file = sign();
    let joints = [0_u16, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0];
    let joints = file.accessor("VEC4", 5123, 3, bytemuck::cast_slice(&joints));
    let weights = [1.0, 0.0, 0.0, 0.0, 0.25, 0.75, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let weights = file.floats("VEC4", 3, &weights);
    let unit = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 1.0,
    ];
    let inverse = file.floats("MAT4", 2, &unit.repeat(2));
    let attributes = &mut file.json["meshes"][1]["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (joints.into(), weights.into());
    let of = json!({ "translation": [4, 0, 1], "scale": [2, 2, 2] });
    let first = push(&mut file.json["nodes"], of);
    let second = push(&mut file.json["nodes"], json!({ "scale": [1, 1, 1] }));
    file.json["nodes"][0]["children"] = json!([1, 2, first, second]);
    file.json["skins"] = json!([{ "joints": [first, second], "inverseBindMatrices": inverse }]);
    file.json["nodes"][2]["skin"] = 0.into();
    let posed = mesh(&file);
    // The matrix of the mesh's node, which mirrors, does not count.
    assert_eq!(posed.triangles[2], [4, 5, 6]);
    let found = points(&posed);
    assert_near(found[4], [5.0, 0.0, -1.0]);
    assert_near(found[5], [0.25 * 7.0 + 0.75 * 2.0, 0.0, -1.0]);
    assert_near(found[6], [2.0, 1.0, -1.0]);
    file.json["skins"][0]["joints"] = json!([first]);
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(
        found.contains("there is no joint 1, expected one of the 1, from 0"),
        "{found}"
    );
    file.json["skins"][0]["joints"] = json!([first, second]);
    file.json["nodes"][0]["children"] = json!([1, 2, first]);
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(found.contains("is not in the scene"), "{found}");
}

#[test]
fn nodes_repeat_their_mesh_or_are_hidden() {
    let mut file = sign();
    let places = file.floats("VEC3", 2, &[0.0, 0.0, 0.0, 0.0, 3.0, 0.0]);
    let sizes = file.floats("VEC3", 2, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing", "KHR_node_visibility"]);
    file.json["nodes"][2]["extensions"]["EXT_mesh_gpu_instancing"] =
        json!({ "attributes": { "TRANSLATION": places, "SCALE": sizes } });
    let found = points(&mesh(&file));
    assert_eq!(found.len(), 10);
    assert_near(found[5], [0.0, 0.0, 1.0]);
    assert_near(found[8], [-1.0, 3.0, 1.0]);
    file.json["nodes"][2]["extensions"]["KHR_node_visibility"] = json!({ "visible": false });
    assert_eq!(mesh(&file).vertices.len(), 4);
    file.json["nodes"][2]["extensions"]["KHR_node_visibility"] = json!({ "visible": true });
    file.json["accessors"][places]["count"] = (1_u64 << 40).into();
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(found.contains("its arrays take"), "{found}");
}

/// A material with this extension.
fn with_extension(name: &str, value: Value) -> Gltf {
    let mut file = sign();
    file.json["extensionsRequired"] = json!([name]);
    for material in file.json["materials"].as_array_mut().unwrap() {
        material["extensions"][name] = value.clone();
    }
    file
}

#[test]
fn unlit_surfaces_show_their_colors_without_light() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sign.glb");
    let file = with_extension("KHR_materials_unlit", json!({}));
    assert_eq!(mesh(&file).notes, [""; 0]);
    std::fs::write(&path, file.glb()).unwrap();
    for model in ["blinn_phong, ambient: 0", "path"] {
        let colors = radiance(&format!(
            "
image: {{ width: 3, height: 3, samples_per_pixel: 4 }}
camera: {{ orthographic: {{ eye: [0.3, 0.3, 5], target: [0.3, 0.3, 0], height: 0.01 }} }}
shading: {{ model: {model} }}
materials: {{}}
lights: []
objects: [{{ mesh: {{ file: {} }} }}]",
            path.display()
        ));
        // The colors of the painted triangle's corners, by the distances from its edges.
        for color in colors {
            assert!(
                (color - Vec3::new(0.3, 0.4, 0.15)).abs().max_element() < 0.01,
                "{color}"
            );
        }
    }
}

#[test]
fn specular_colors_are_those_of_metals_or_of_clear_coats() {
    for (diffuse, specular, gloss, color, metallic) in [
        (
            [0.5, 0.2, 0.1],
            [0.04, 0.04, 0.04],
            0.75,
            [0.5, 0.2, 0.1],
            0.0,
        ),
        (
            [0.5, 0.2, 0.1],
            [0.0, 0.0, 0.0],
            1.0,
            [0.5208, 0.2083, 0.1042],
            0.0,
        ),
        (
            [0.0, 0.0, 0.0],
            [1.0, 0.766, 0.336],
            0.5,
            [1.0, 0.766, 0.336],
            1.0,
        ),
    ] {
        let value = json!({
            "diffuseFactor": [diffuse[0], diffuse[1], diffuse[2], 0.5],
            "specularFactor": specular, "glossinessFactor": gloss,
        });
        let mut file = with_extension("KHR_materials_pbrSpecularGlossiness", value);
        file.json["materials"][1]["alphaMode"] = "BLEND".into();
        let found = mesh(&file).materials[1].clone();
        assert!(
            (found.color - Vec3::from(color)).abs().max_element() < 1e-3,
            "{}",
            found.color
        );
        let Finish::Facets {
            metallic: share,
            roughness,
        } = found.finish
        else {
            unreachable!()
        };
        assert!((share - metallic).abs() < 1e-3, "{share}");
        assert!((roughness - (1.0 - gloss)).abs() < 1e-6, "{roughness}");
        assert_eq!(found.opacity.unwrap().factor, 0.5);
    }
}

#[test]
fn glossiness_counts_texel_by_texel() {
    let opacities = [0, 51, 204, 255];
    let picture = image::RgbaImage::from_fn(2, 2, |x, y| {
        image::Rgba([90, 90, 90, opacities[(2 * y + x) as usize]])
    });
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let uri = format!(
        "data:image/png;base64,{}",
        STANDARD.encode(png.into_inner())
    );
    let mut file = with_extension(
        "KHR_materials_pbrSpecularGlossiness",
        json!({
            "diffuseFactor": [0.5, 0.5, 0.5, 1.0], "glossinessFactor": 0.5,
            "specularGlossinessTexture": { "index": 0 },
        }),
    );
    file.json["images"][0] = json!({ "uri": uri });
    let material = &mesh(&file).materials[0];
    let (map, factors) = material.facets_map.as_ref().unwrap();
    let (size, texels) = map.picture.reduced(4);
    assert_eq!(size, [2, 2]);
    for ([_, found, ..], opacity) in texels.zip(opacities) {
        let expected = factors[0] * (1.0 - 0.5 * f32::from(opacity) / 255.0);
        assert!((found - expected).abs() < 0.003, "{found}, not {expected}");
    }
    let metallic = map.picture.reduced(1).1.next().unwrap()[2] * factors[1];
    assert!(
        matches!(material.finish, Finish::Facets { metallic: share, .. } if share == metallic),
        "{metallic}"
    );
}

/// The validator of Khronos has no error for files of these kinds.
#[test]
fn mistakes_without_consequence_change_nothing() {
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 11] = [
        ("scenes without nodes", |json| {
            json["scenes"] = json!([{ "nodes": [0] }, { "name": "empty" }]);
        }),
        ("whole numbers with a point", |json| {
            json["accessors"][0]["count"] = 4.0.into();
            json["bufferViews"][0]["byteLength"] = 48.0.into();
            json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0.0.into();
        }),
        ("an accessor of an unknown type, unused", |json| {
            push(
                &mut json["accessors"],
                json!({ "count": 1, "componentType": 5126, "type": "VEC5" }),
            );
        }),
        ("a buffer that is not there, unused", |json| {
            push(
                &mut json["buffers"],
                json!({ "uri": "http://a.b/c.bin", "byteLength": 4 }),
            );
        }),
        ("a texture without a picture, unused", |json| {
            push(&mut json["textures"], json!({}));
        }),
        ("a value that no one knows", |json| {
            json["materials"][0]["alphaMode"] = "SHINY".into();
            json["samplers"][0]["minFilter"] = 7.into();
        }),
        ("a camera of a program's own", |json| {
            json["cameras"] = json!([{ "type": "fisheye" }, { "type": "perspective" }]);
        }),
        ("positions without bounds", |json| {
            json["accessors"][0].as_object_mut().unwrap().remove("min");
            json["accessors"][0]["max"] = json!([1]);
        }),
        ("an attribute of an unknown name", |json| {
            json["meshes"][0]["primitives"][0]["attributes"]["SHINE"] = 0.into();
        }),
        ("another material without pictures", |json| {
            push(&mut json["materials"], json!({ "name": "spare" }));
            push(&mut json["images"], json!({ "uri": "gone.png" }));
        }),
        ("a view without a stride of its own", |json| {
            json["bufferViews"][0]["target"] = 1.into();
        }),
    ];
    let plain = mesh(&sign());
    for (what, change) in changes {
        let mut file = sign();
        change(&mut file.json);
        let mut found =
            read("a.glb", &file.glb()).unwrap_or_else(|fault| panic!("{what}: {fault}"));
        found.materials.retain(|material| material.name != "spare");
        assert_eq!(found.vertices, plain.vertices, "{what}");
        assert_eq!(found.materials, plain.materials, "{what}");
        assert_eq!(found.notes, plain.notes, "{what}");
    }
}

#[test]
fn accessors_without_bytes_are_zeros() {
    let mut file = sign();
    let zeros = json!({ "count": 3, "componentType": 5126, "type": "VEC3" });
    let zeros = push(&mut file.json["accessors"], zeros);
    file.json["meshes"][1]["primitives"][0]["targets"] = json!([{ "POSITION": zeros }]);
    file.json["meshes"][1]["weights"] = json!([1]);
    assert_eq!(mesh(&file).vertices, mesh(&sign()).vertices);
    file.json["accessors"][zeros]["type"] = "VEC5".into();
    let found = read("a.glb", &file.glb()).unwrap_err();
    assert!(
        found.contains("`accessors[6].type`: it has no valid value"),
        "{found}"
    );
}

#[test]
fn data_in_a_uri_is_read_as_browsers_do() {
    let mut file = sign();
    let plain = mesh(&file);
    while file.binary.len() % 3 != 1 {
        file.binary.push(0);
    }
    let written = STANDARD.encode(&file.binary);
    let broken = written
        .as_bytes()
        .chunks(76)
        .map(|line| str::from_utf8(line).unwrap());
    let broken: Vec<&str> = broken.collect();
    let encoded: String = file
        .binary
        .iter()
        .map(|byte| format!("%{byte:02X}"))
        .collect();
    assert!(written.ends_with("=="));
    for data in [
        format!(";base64,{}", broken.join("\n ")),
        format!(";base64,{}", written.trim_end_matches('=')),
        format!(
            "application/octet-stream;base64,{}",
            written.replace('=', "%3D")
        ),
    ] {
        let found = read("a.gltf", file.gltf(&format!("data:{data}")).as_bytes()).unwrap();
        assert_eq!(found.vertices, plain.vertices);
    }
    let found = read("a.gltf", file.gltf(&format!("data:,{encoded}")).as_bytes()).unwrap();
    assert_eq!(found.vertices, plain.vertices);
}

#[test]
fn what_is_not_read_is_named() {
    let mut file = sign();
    file.json["extensionsRequired"] = json!(["EXT_new", "KHR_materials_clearcoat"]);
    file.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_materials_ior"]);
    file.json["animations"] = json!([{ "channels": [], "samplers": [] }]);
    let points = file.json["meshes"][1]["primitives"][0].clone();
    push(&mut file.json["meshes"][1]["primitives"], points);
    file.json["meshes"][1]["primitives"][1]["mode"] = 0.into();
    let tangents = file.floats("VEC4", 4, &[1.0, 0.0, 0.0, 1.0].repeat(4));
    file.json["materials"][0]["normalTexture"] = json!({ "index": 0 });
    file.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = tangents.into();
    assert_eq!(
        mesh(&file).notes,
        [
            "1 primitive without triangles left out, such as points",
            "the tangents of 1 primitive are not read: bumps lie along the texture coordinates",
            "2 extensions left out: `EXT_new`, `KHR_materials_clearcoat`",
            "1 animation left out: shown at rest",
        ]
    );
}

#[test]
fn a_mesh_is_shown_without_pictures_that_cannot_be_read() {
    for (image, expected) in [
        (json!({ "uri": "gone.png" }), "gone.png`: cannot read it: "),
        (
            json!({ "bufferView": 0 }),
            "`images[0]`: it is not a picture",
        ),
        (
            json!({ "uri": "data:image/png;base64,!!" }),
            "`images[0]`: a `uri` has",
        ),
        (json!({ "bufferView": 9 }), ""),
    ] {
        let mut file = sign();
        file.json["images"][0] = image;
        let found = read("a.glb", &file.glb());
        if expected.is_empty() {
            assert!(found.unwrap_err().contains("there is none with this index"));
            continue;
        }
        let found = found.unwrap();
        assert_eq!(found.materials[0].picture, None);
        assert_eq!(found.materials[0].color, Vec3::new(1.0, 0.5, 1.0));
        let [note] = &found.notes[..] else {
            panic!("{:?}", found.notes);
        };
        assert!(
            note.starts_with("shown without `") && note.contains(expected),
            "{note}"
        );
    }
}
