//! Outputs that are crafted to take time or memory are refused before their arrays are
//! read.

use std::fs;
use std::path::Path;

use crate::common::noise::noise;
use crate::common::{assert_success, in_repository, raycost};
use host::text::Diagnostic;
use output::results::{FrameFile, Results};
use output::writers::write_frame;
use scene::config::CostMode;
use vtk::Codec;

/// Opens a frame whose header `change` has edited; returns the error, or `fine`.
fn frame(folder: &Path, change: impl FnOnce(&str) -> String) -> String {
    let path = folder.join("frame.vti");
    let film = noise(2, 2, CostMode::None, 1);
    write_frame(&film, Codec::None, &mut fs::File::create(&path).unwrap()).unwrap();
    let bytes = fs::read(&path).unwrap();
    let tag = b"<AppendedData";
    let end = bytes.windows(tag.len()).position(|part| part == tag);
    let (header, rest) = bytes.split_at(end.unwrap());
    let header = change(std::str::from_utf8(header).unwrap());
    fs::write(&path, [header.as_bytes(), rest].concat()).unwrap();
    match FrameFile::open(&path) {
        Ok(_) => "fine".to_owned(),
        Err(error) => error.to_string(),
    }
}

/// The error that `n` attributes of the frame's root give.
fn with_attributes(n: usize) -> String {
    let folder = tempfile::tempdir().unwrap();
    let attributes: String = (0..n).map(|i| format!(" a{i}=\"\"")).collect();
    frame(folder.path(), |header| {
        header.replacen("<VTKFile", &format!("<VTKFile{attributes}"), 1)
    })
}

#[test]
fn a_header_of_many_attributes_is_refused_by_their_number() {
    assert_eq!(with_attributes(3), "fine");
    for n in [30, 300, 3000] {
        let error = with_attributes(n);
        assert!(error.contains("more than 16 attributes"), "{error}");
    }
}

#[test]
fn a_long_header_is_refused_by_its_length() {
    for n in [600_000, 900_000] {
        let error = with_attributes(n);
        assert!(
            error.contains("no appended data after its header"),
            "{error}"
        );
    }
}

#[test]
fn a_header_of_many_elements_is_refused_by_their_number() {
    let folder = tempfile::tempdir().unwrap();
    for element in ["<a/>", "<a>", "<!---->"] {
        let many = element.repeat(2000);
        let error = frame(folder.path(), |header| {
            header.replacen("<ImageData", &format!("{many}<ImageData"), 1)
        });
        assert!(error.contains("more than 512 elements"), "{error}");
    }
}

#[test]
fn the_number_of_components_is_limited() {
    let folder = tempfile::tempdir().unwrap();
    for n in ["0", "10", "4294967295"] {
        let error = frame(folder.path(), |header| {
            let one = "NumberOfComponents=\"3\"";
            assert!(header.contains(one), "{header}");
            header.replacen(one, &format!("NumberOfComponents=\"{n}\""), 1)
        });
        assert!(
            error.contains("numbers per point, expected 1 to 9"),
            "{error}"
        );
    }
}

/// A small output with a table of objects.
fn output() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let output = raycost()
        .arg("render")
        .arg(in_repository("configs/seed_extended.yaml"))
        .args(["--width", "8", "--height", "6", "--also", "objects"])
        .args(["--quiet", "--out"])
        .arg(folder.path())
        .output()
        .unwrap();
    assert_success(&output);
    folder
}

/// The cells of the table of objects.
fn rows_of(results: &Results) -> Result<Vec<Vec<String>>, Diagnostic> {
    let mut rows = Vec::new();
    let table = results.objects()?.unwrap();
    table.read_rows(|row| rows.push(row.iter().map(|cell| (*cell).to_owned()).collect()))?;
    Ok(rows)
}

#[test]
fn a_table_longer_than_its_scene_is_refused() {
    let folder = output();
    let path = folder.path().join("objects.csv");
    let whole = fs::read_to_string(&path).unwrap();
    let results = Results::open(folder.path()).unwrap();
    let (head, rows) = whole.split_once('\n').unwrap();
    // One row too many, and so many that the length of the file suffices.
    for (n, last) in [(1, "object,9,x,hit,all,1,1,1,1,1,1,1,1,1,1\n"), (3000, "")] {
        fs::write(&path, format!("{head}\n{}{last}", rows.repeat(n))).unwrap();
        let error = rows_of(&results).unwrap_err().to_string();
        assert!(
            error.contains("objects.csv is longer than the 120 rows"),
            "{error}"
        );
    }
    fs::write(&path, &whole).unwrap();
    assert_eq!(rows_of(&results).unwrap().len(), 120);
}

#[test]
fn no_name_becomes_a_formula_and_each_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let names = [
        "=cmd|' /C calc'!A0",
        "+1",
        "-1",
        "@SUM(A1)",
        "\t=1",
        "'quoted'",
    ];
    let text = fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let (head, _) = text.split_once("objects:").unwrap();
    let objects = names.map(|name| {
        let name = serde_json::to_string(name).unwrap();
        format!(
            "- {{ name: {name}, sphere: {{ center: [0, 0, 0], radius: 1 }}, material: blue }}\n"
        )
    });
    let scene = folder.path().join("scene.yaml");
    fs::write(&scene, format!("{head}objects:\n{}", objects.concat())).unwrap();
    let out = folder.path().join("out");
    let output = raycost()
        .args([
            "render",
            "--width=8",
            "--height=6",
            "--also=objects",
            "--quiet",
        ])
        .arg(&scene)
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    assert_success(&output);
    let mut table = csv::Reader::from_path(out.join("objects.csv")).unwrap();
    for row in table.records() {
        let row = row.unwrap();
        for (column, cell) in row.iter().enumerate() {
            let is_number = cell.parse::<f64>().is_ok() && column != 2;
            let is_formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']);
            assert!(is_number || !is_formula, "{cell:?}");
        }
    }
    let rows = rows_of(&Results::open(&out).unwrap()).unwrap();
    let found: Vec<&str> = rows.iter().step_by(12).map(|row| row[2].as_str()).collect();
    assert_eq!(&found[..names.len()], names);
}

#[test]
fn arrays_that_share_bytes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = frame(folder.path(), |header| {
        let begin = header.find("<DataArray").unwrap();
        let end = begin + header[begin..].find("/>").unwrap() + 2;
        let again = header[begin..end].repeat(100);
        header.replacen("<DataArray", &format!("{again}<DataArray"), 1)
    });
    assert!(error.contains("share bytes"), "{error}");
}

/// The compression ratio of a block is limited by its format.
#[test]
fn blocks_that_are_too_short_for_their_array_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for codec in [Codec::Lz4, Codec::Zlib] {
        let path = folder.path().join("frame.vti");
        let film = noise(600, 500, CostMode::None, 1);
        write_frame(&film, codec, &mut fs::File::create(&path).unwrap()).unwrap();
        let bytes = fs::read(&path).unwrap();
        let tag = b"<AppendedData encoding=\"raw\">";
        let tag = bytes
            .windows(tag.len())
            .position(|part| part == tag)
            .unwrap();
        let begin = tag + bytes[tag..].iter().position(|&byte| byte == b'_').unwrap() + 1;
        // The first block's length follows three 64-bit numbers.
        for length in [1, 1 << 20, u64::MAX] {
            let mut bytes = bytes.clone();
            bytes[begin + 24..begin + 32].copy_from_slice(&u64::to_ne_bytes(length));
            fs::write(&path, bytes).unwrap();
            let error = FrameFile::open(&path).err().map(|error| error.to_string());
            let is_refused = error
                .as_ref()
                .is_some_and(|error| error.contains("do not hold"));
            assert!(is_refused || length == 1, "{codec:?}, {length}: {error:?}");
        }
    }
}

/// Pixels that a page does not show are not all in memory at the same time.
#[test]
fn selected_pixels_are_those_of_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.vti");
    for codec in [Codec::None, Codec::Lz4, Codec::Zlib] {
        let film = noise(37, 23, CostMode::Time, 1);
        write_frame(&film, codec, &mut fs::File::create(&path).unwrap()).unwrap();
        let frame = FrameFile::open(&path).unwrap();
        for (columns, rows) in [
            (vec![0, 5, 36], vec![0, 1, 22]),
            (vec![3], vec![7]),
            (vec![], vec![1]),
            (vec![1], vec![]),
            ((0..37).collect(), (0..23).collect()),
        ] {
            for name in ["RGB", "object", "distance"] {
                let all = frame.read(name).unwrap();
                let picked = frame.read_selected(name, &columns, &rows).unwrap();
                let n = all.n_components;
                let mut expected = Vec::new();
                for y in &rows {
                    for x in &columns {
                        let pixel = (y * 37 + x) as usize;
                        expected.extend((0..n).map(|i| all.values.at(pixel * n + i).to_bits()));
                    }
                }
                let found: Vec<u64> = picked.values.iter().map(f64::to_bits).collect();
                assert!(found == expected, "{name}");
            }
        }
    }
}
