//! Writers of meshes, plain enough to be right.

use glam::Vec3;
use import::Mesh;

/// The mesh as OBJ, in as many of its forms as it has.
pub fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("# a comment\r\no thing\n");
    for v in &mesh.vertices {
        text += &format!("v {:e}   {} {} 1\r\n", v.x, v.y, v.z);
    }
    let uvs = mesh.uvs.as_ref();
    for uv in uvs.iter().flat_map(|uvs| &uvs.values) {
        text += &format!("vt {} {} 0\n", uv.x, uv.y);
    }
    for (i, [a, b, c]) in mesh.triangles.iter().map(|t| t.map(|i| i + 1)).enumerate() {
        // Without texture coordinates in the file, their numbers have no meaning.
        let [q, r, s] = match uvs {
            None => ["", "1", "2"].map(str::to_owned),
            Some(uvs) => uvs.triangles[i].map(|uv| (uv + 1).to_string()),
        };
        match &mesh.normals {
            None => text += &format!("f {a}/{q} \\\n {b}/{r} {c}/{s}/\n"),
            Some(normals) => {
                if i == 0 {
                    let line = |n: &Vec3| format!("vn {} {} {}\n", n.x, n.y, n.z);
                    text.extend(normals.values.iter().map(line));
                }
                let n = normals.values.len() as i64;
                let [k, l, m] = normals.triangles[i].map(|normal| i64::from(normal) - n);
                text += &format!("f {a}/{q}/{k} {b}/{r}/{l} {c}/{s}/{m} # behind\n");
            }
        }
    }
    text.into_bytes()
}

/// The three encodings of PLY.
#[derive(Debug, Clone, Copy)]
pub enum Encoding {
    Text,
    Little,
    Big,
}

/// Numbers of a row, as they are encoded.
enum Number {
    U8(u8),
    I32(i32),
    F32(f32),
    F64(f64),
}

impl Encoding {
    fn name(self) -> &'static str {
        match self {
            Self::Text => "ascii",
            Self::Little => "binary_little_endian",
            Self::Big => "binary_big_endian",
        }
    }

    fn row(self, numbers: &[Number], out: &mut Vec<u8>) {
        for number in numbers {
            match (self, number) {
                (Self::Text, Number::U8(n)) => out.extend(format!("{n} ").bytes()),
                (Self::Text, Number::I32(n)) => out.extend(format!("{n} ").bytes()),
                (Self::Text, Number::F32(n)) => out.extend(format!("{n} ").bytes()),
                (Self::Text, Number::F64(n)) => out.extend(format!("{n} ").bytes()),
                (_, Number::U8(n)) => out.push(*n),
                (Self::Little, Number::I32(n)) => out.extend(n.to_le_bytes()),
                (Self::Little, Number::F32(n)) => out.extend(n.to_le_bytes()),
                (Self::Little, Number::F64(n)) => out.extend(n.to_le_bytes()),
                (Self::Big, Number::I32(n)) => out.extend(n.to_be_bytes()),
                (Self::Big, Number::F32(n)) => out.extend(n.to_be_bytes()),
                (Self::Big, Number::F64(n)) => out.extend(n.to_be_bytes()),
            }
        }
        if matches!(self, Self::Text) {
            out.push(b'\n');
        }
    }
}

/// With properties and an element that are no mesh's, and its faces first.
pub fn ply(mesh: &Mesh, encoding: Encoding) -> Vec<u8> {
    let normals = mesh.normals.as_ref();
    let uvs = mesh.uvs.as_ref();
    let of_uvs = match uvs {
        Some(_) => "property float s\nproperty double t\n",
        None => "",
    };
    let (n_vertices, n_faces) = (mesh.vertices.len(), mesh.triangles.len());
    let of_normals = match normals {
        Some(_) => "property float nx\nproperty float ny\nproperty float nz\n",
        None => "",
    };
    let header = format!(
        "ply\nformat {} 1.0\ncomment a comment\nelement face {n_faces}\n\
         property uchar quality\nproperty list uchar int vertex_index\n\
         element camera 1\nproperty list uchar float view\nelement vertex {n_vertices}\n\
         property double x\nproperty float y\nproperty uchar red\nproperty float z\n\
         {of_normals}{of_uvs}end_header\n",
        encoding.name()
    );
    let mut out = header.into_bytes();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| Number::I32(i as i32));
        encoding.row(&[Number::U8(7), Number::U8(3), a, b, c], &mut out);
    }
    encoding.row(
        &[Number::U8(2), Number::F32(0.5), Number::F32(1.0)],
        &mut out,
    );
    for (i, v) in mesh.vertices.iter().enumerate() {
        let mut row = vec![Number::F64(v.x.into()), Number::F32(v.y)];
        row.extend([Number::U8(255), Number::F32(v.z)]);
        row.extend(
            normals
                .iter()
                .flat_map(|normals| normals.values[i].to_array().map(Number::F32)),
        );
        if let Some(uvs) = uvs {
            let [s, t] = uvs.values[i].to_array();
            row.extend([Number::F32(s), Number::F64(t.into())]);
        }
        encoding.row(&row, &mut out);
    }
    out
}

/// The mesh as binary STL, whose comment begins as a text does.
pub fn binary_stl(mesh: &Mesh) -> Vec<u8> {
    let mut out = format!("{:80}", "solid of somebody").into_bytes();
    out.extend((mesh.triangles.len() as u32).to_le_bytes());
    for &triangle in &mesh.triangles {
        let corners = mesh.triangle(triangle).vertices;
        let numbers = [Vec3::ZERO]
            .into_iter()
            .chain(corners)
            .flat_map(|vector| vector.to_array());
        out.extend(numbers.flat_map(f32::to_le_bytes));
        out.extend([7, 7]);
    }
    out
}

/// The mesh as a text in two solids.
pub fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("solid\r\n");
    for (i, &triangle) in mesh.triangles.iter().enumerate() {
        if i == 1 {
            text += "endsolid\n\nSOLID another one\n";
        }
        text += "  facet normal 0 0 1e0\n    outer loop\n";
        for v in mesh.triangle(triangle).vertices {
            text += &format!("      vertex {:e} {} {}\n", v.x, v.y, v.z);
        }
        text += "    endloop\n  endfacet\n";
    }
    (text + "endsolid").into_bytes()
}
