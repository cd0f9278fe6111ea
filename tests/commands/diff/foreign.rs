//! Pictures and cost maps of other programs, in files that are written here byte by byte.

use std::fs;
use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::{SCENE, diff, error, json_report, render};
use crate::common::assert_success;
use crate::common::data_set::DataSet;

/// The size of the scene's picture.
const SIZE: [usize; 2] = [50, 40];

/// Renders the scene to `out`, a folder in a new one.
fn output(arguments: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "out", SCENE, arguments);
    folder
}

/// The bytes of an array of `out`, row 0 on top, of pixels of `n` bytes.
fn array(folder: &Path, name: &str, n: usize) -> Vec<u8> {
    let frame = DataSet::read(&folder.join("out/frame.vti"));
    let rows = frame.array(name).bytes.chunks_exact(SIZE[0] * n).rev();
    rows.flatten().copied().collect()
}

/// The numbers of an array of `out`, of four bytes each.
fn words<T>(folder: &Path, name: &str, n: usize, number: impl Fn([u8; 4]) -> T) -> Vec<T> {
    let bytes = array(folder, name, 4 * n);
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|&word| number(word))
        .collect()
}

fn npy(kind: &str, shape: &str, body: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(body);
    file
}

/// A PFM of numbers with row 0 on top, `n` for each pixel.
fn pfm(numbers: &[f32], n: usize) -> Vec<u8> {
    let kind = if n == 3 { "PF" } else { "Pf" };
    let mut file = format!("{kind}\n{} {}\n-1.0\n", SIZE[0], SIZE[1]).into_bytes();
    let bottom_up = numbers.chunks_exact(SIZE[0] * n).rev().flatten();
    file.extend(bottom_up.flat_map(|number| number.to_le_bytes()));
    file
}

/// A PNG of 8-bit channels: color type 2 is RGB, 6 is RGBA.
fn png(color_type: u8, n: usize, pixels: &[u8]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8], body: &[u8]| {
        let mut crc = flate2::Crc::new();
        crc.update(kind);
        crc.update(body);
        file.extend((body.len() as u32).to_be_bytes());
        file.extend([kind, body].concat());
        file.extend(crc.sum().to_be_bytes());
    };
    let [width, height] = SIZE.map(|side| (side as u32).to_be_bytes());
    let header = [&width[..], &height, &[8, color_type, 0, 0, 0]].concat();
    chunk(b"IHDR", &header);
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    for row in pixels.chunks_exact(SIZE[0] * n) {
        zlib.write_all(&[0]).unwrap();
        zlib.write_all(row).unwrap();
    }
    chunk(b"IDAT", &zlib.finish().unwrap());
    chunk(b"IEND", &[]);
    file
}

/// An uncompressed OpenEXR file with these channels of 32-bit floats, sorted by name.
fn exr(channels: &[(&str, Vec<f32>)]) -> Vec<u8> {
    let [width, height] = SIZE.map(|side| side as i32);
    let mut file = [20000630_u32, 2].map(u32::to_le_bytes).concat();
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        file.extend(format!("{name}\0{kind}\0").as_bytes());
        file.extend((value.len() as u32).to_le_bytes());
        file.extend(value);
    };
    let mut list = Vec::new();
    for (name, _) in channels {
        list.extend(format!("{name}\0").as_bytes());
        list.extend([2_u32, 0, 1, 1].map(u32::to_le_bytes).concat());
    }
    list.push(0);
    let window = [0, 0, width - 1, height - 1].map(i32::to_le_bytes).concat();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    file.push(0);
    let row_bytes = 4 * SIZE[0] * channels.len();
    let first = file.len() + 8 * SIZE[1];
    for row in 0..SIZE[1] {
        file.extend(((first + row * (8 + row_bytes)) as u64).to_le_bytes());
    }
    for row in 0..SIZE[1] {
        file.extend(
            [row as u32, row_bytes as u32]
                .map(u32::to_le_bytes)
                .concat(),
        );
        for (_, numbers) in channels {
            let numbers = &numbers[row * SIZE[0]..][..SIZE[0]];
            file.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
    }
    file
}

/// The text of a PPM as `P3`.
fn ppm_text(pixels: &[u8]) -> Vec<u8> {
    let values: Vec<String> = pixels.iter().map(u8::to_string).collect();
    format!("P3 # by hand\n50 40\n255\n{}\n", values.join("\n")).into_bytes()
}

#[test]
fn a_picture_is_compared_in_every_format() {
    let folder = output(&["--cost=counters"]);
    let path = folder.path();
    let mut pixels = array(path, "RGB", 3);
    let own = pixels.clone();
    // Channels of the pixels 3,2 and 7,39.
    for (channel, change) in [(3 * (2 * 50 + 3), 9), (3 * (39 * 50 + 7) + 1, 100)] {
        pixels[channel] = match pixels[channel] {
            value @ ..128 => value + change,
            value => value - change,
        };
    }
    let opaque: Vec<u8> = pixels
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|&[r, g, b]| [r, g, b, 255])
        .collect();
    let files = [
        ("mine.png", png(2, 3, &pixels)),
        ("rgba.png", png(6, 4, &opaque)),
        ("mine.ppm", [b"P6\n50 40\n255\n", &pixels[..]].concat()),
        ("text.ppm", ppm_text(&pixels)),
        ("mine.npy", npy("|u1", "40, 50, 3", &pixels)),
    ];
    let rms = ((9.0 * 9.0 + 100.0 * 100.0) / 6000.0_f64).sqrt();
    for (name, bytes) in files {
        fs::write(path.join(name), bytes).unwrap();
        for names in [["out", name], [name, "out"]] {
            let (found, code) = json_report(path, &names);
            assert_eq!(code, Some(0), "{names:?}");
            let expected = json!({ "n_pixels": 2, "max": 100, "rms": rms });
            assert_eq!(found["picture"], expected, "{names:?}");
            assert_eq!(found["greatest_difference"], json!([7, 39]), "{names:?}");
        }
    }
    let text = String::from_utf8(diff(path, &["mine.png", "out"]).stdout).unwrap();
    for line in [
        "A         mine.png: a picture of 8-bit colors, of another program\n",
        "picture   2 of 2,000 pixels differ, by 100 of 255 at most, RMS 1.30, PSNR 45.9 dB; \
         the greatest difference is at pixel 7,39\n",
        "wrote     out/diff-mine-out: diff.png (",
    ] {
        assert!(text.contains(line), "{text}");
    }
    fs::write(path.join("same.png"), png(2, 3, &own)).unwrap();
    let text = String::from_utf8(diff(path, &["out", "same.png"]).stdout).unwrap();
    assert!(text.contains("picture   the same colors\n"), "{text}");
}

#[test]
fn linear_light_is_compared_in_every_format() {
    let folder = output(&["--cost=counters", "--also=radiance"]);
    let path = folder.path();
    let mut light = words(path, "radiance", 3, f32::from_ne_bytes);
    // The green channel of the pixel 20,30, above white.
    let changed = 3 * (30 * 50 + 20) + 1;
    let before = light[changed];
    light[changed] = before + 8.0;
    let change = f64::from(light[changed]) - f64::from(before);
    let channel = |i: usize| {
        light
            .iter()
            .skip(i)
            .step_by(3)
            .copied()
            .collect::<Vec<f32>>()
    };
    let bytes: Vec<u8> = light
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let doubles = light
        .iter()
        .flat_map(|&number| f64::from(number).to_le_bytes());
    let files = [
        ("mine.pfm", pfm(&light, 3)),
        (
            "mine.exr",
            exr(&[("B", channel(2)), ("G", channel(1)), ("R", channel(0))]),
        ),
        ("mine.npy", npy("<f4", "40, 50, 3", &bytes)),
        (
            "doubles.npy",
            npy("<f8", "40, 50, 3", &doubles.collect::<Vec<u8>>()),
        ),
    ];
    for (name, bytes) in files {
        fs::write(path.join(name), bytes).unwrap();
        let (found, code) = json_report(path, &["out", name]);
        assert_eq!(
            (code, &found["light"]["max"]),
            (Some(0), &json!(change)),
            "{name}"
        );
        let rms = found["light"]["rms"].as_f64().unwrap();
        assert!((rms - change / 6000_f64.sqrt()).abs() < 1e-12, "{name}");
        assert_eq!(found["greatest_difference"], json!([20, 30]), "{name}");
    }
    render(path, "out", SCENE, &["--cost=counters"]);
    let message = error(path, &["out", "mine.pfm"]);
    assert!(message.contains("no array `radiance`"), "{message}");
    assert!(message.contains("`--also radiance`"), "{message}");
}

#[test]
fn a_cost_map_in_another_unit_agrees_with_itself() {
    let folder = output(&["--cost=counters"]);
    let path = folder.path();
    let visits = words(path, "node_visits", 1, u32::from_ne_bytes);
    let times: Vec<f32> = visits.iter().map(|&visits| 2.5 * visits as f32).collect();
    let bytes: Vec<u8> = times
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let integers: Vec<u8> = visits
        .iter()
        .flat_map(|&n| i64::from(n * 5).to_le_bytes())
        .collect();
    let files = [
        ("times.pfm", pfm(&times, 1), 2.5),
        ("times.exr", exr(&[("Y", times)]), 2.5),
        ("times.npy", npy("<f4", "40, 50", &bytes), 2.5),
        ("column.npy", npy("<f4", "40, 50, 1", &bytes), 2.5),
        ("visits.npy", npy("<i8", "40, 50", &integers), 5.0),
    ];
    let total: u32 = visits.iter().sum();
    for (name, bytes, factor) in files {
        fs::write(path.join(name), bytes).unwrap();
        let (found, code) = json_report(path, &["out", name]);
        let cost = &found["cost"];
        assert_eq!(code, Some(0), "{name}");
        assert_eq!(cost["metric"], "node_visits");
        assert_eq!(
            cost["totals"],
            json!([f64::from(total), factor * f64::from(total)])
        );
        for (key, expected) in [
            ("hottest_in_common", 1.0),
            ("median_factor", 1.0),
            ("rank_correlation", 1.0),
        ] {
            let value = cost[key].as_f64().unwrap();
            assert!((value - expected).abs() < 1e-6, "{name}: {key} is {value}");
        }
        assert_eq!(cost["n_hottest"], 20);
    }
    let text = String::from_utf8(diff(path, &["times.npy", "out"]).stdout).unwrap();
    for line in [
        " in B; B / A is 0.400 if A counts node visits\n",
        "ranks     Spearman's correlation over the pixels is 1.000\n",
        "hottest   100 % of the hottest 1 % (20 pixels) are the same, 1 % by chance\n",
        "scaled    to the same sum, half of the pixels agree within a factor of 1.00\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
}

#[test]
fn a_cost_map_of_other_pixels_is_told_apart() {
    let folder = output(&["--cost=time"]);
    let path = folder.path();
    let rays = words(path, "shadow_rays", 1, u32::from_ne_bytes);
    let balls: Vec<i32> = words(path, "object", 1, i32::from_ne_bytes);
    // All of the cost is in the pixels of the ball.
    let costs: Vec<u8> = balls.iter().map(|&object| u8::from(object == 0)).collect();
    fs::write(path.join("ball.npy"), npy("|u1", "40, 50", &costs)).unwrap();
    let (found, _) = json_report(path, &["out", "ball.npy", "--by=shadow_rays"]);
    let cost = &found["cost"];
    let n_ball = costs.iter().filter(|&&cost| cost == 1).count() as f64;
    assert_eq!(cost["totals"][1], json!(n_ball));
    let of_ball = rays.iter().zip(&balls).filter(|(_, object)| **object == 0);
    let of_ball: u32 = of_ball.map(|(rays, _)| rays).sum();
    let objects = cost["objects"].as_array().unwrap();
    let ball = objects
        .iter()
        .find(|object| object["name"] == "ball")
        .unwrap();
    let share = f64::from(of_ball) / f64::from(rays.iter().sum::<u32>());
    assert_eq!(ball["shares"], json!([share, 1.0]));
    let correlation = cost["rank_correlation"].as_f64().unwrap();
    assert!(correlation.abs() < 0.9, "{correlation}");
    let in_common = cost["hottest_in_common"].as_f64().unwrap();
    assert!((0.0..0.2).contains(&in_common), "{in_common}");
    // Times are the default.
    let (found, _) = json_report(path, &["out", "ball.npy"]);
    assert_eq!(found["cost"]["metric"], "time_ns");
    // A map of equal costs says nothing.
    fs::write(path.join("flat.npy"), npy("|u1", "40, 50", &[7; 2000])).unwrap();
    let (found, _) = json_report(path, &["out", "flat.npy", "--by=rays"]);
    assert_eq!(found["cost"]["rank_correlation"], Value::Null);
    // Each of its pixels counts by a hundredth, at most as much as those of the output.
    let mut sorted = words(path, "rays", 1, u32::from_ne_bytes);
    sorted.sort_by(|a, b| b.cmp(a));
    let n_above = sorted.iter().filter(|&&rays| rays > sorted[19]).count() as f64;
    let n_tied = sorted.iter().filter(|&&rays| rays == sorted[19]).count() as f64;
    let expected = 0.01 * n_above + n_tied * f64::min(0.01, (20.0 - n_above) / n_tied);
    let in_common = found["cost"]["hottest_in_common"].as_f64().unwrap();
    assert!((in_common - expected / 20.0).abs() < 1e-9, "{in_common}");
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table of cases")]
fn files_that_cannot_be_compared_are_refused() {
    let folder = output(&["--cost=counters"]);
    let path = folder.path();
    let map = npy("<f4", "40, 50", &[0; 8000]);
    let mut strange = vec![0; 8000];
    strange[4 * (50 + 2)..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let nan = npy("<f4", "40, 50", &strange);
    strange[4 * (50 + 2)..][..4].copy_from_slice(&(-1_f32).to_le_bytes());
    let mut fortran = map.clone();
    let order = map.windows(5).position(|word| word == b"False").unwrap();
    fortran[order..][..5].copy_from_slice(b"True ");
    let whole = png(2, 3, &[9; 6000]);
    let pfm_map = pfm(&[1.0; 2000], 1);
    let big_endian = [b"Pf\n50 40\n1.0\n", &pfm_map[14..]].concat();
    let numbers = || vec![1.0; 2000];
    let exr_map = exr(&[("Y", numbers())]);
    let cases: &[(&str, &[u8], &str, &str)] = &[
        (
            "text",
            b"# a file",
            "it is not a picture or a cost map of a known format",
            "NPY file",
        ),
        (
            "empty",
            b"",
            "it is not a picture or a cost map of a known format",
            "NPY file",
        ),
        (
            "torn.png",
            &whole[..60],
            "the PNG cannot be decoded",
            "close the file",
        ),
        (
            "clear.png",
            &png(6, 4, &[9; 8000]),
            "the pixel 0,0 is transparent",
            "without an alpha",
        ),
        (
            "small.ppm",
            b"P6 40 50 255\n",
            "it has 40 x 50 pixels, the output 50 x 40",
            "--width 40",
        ),
        (
            "huge.ppm",
            b"P6 99999999999 9 255\n",
            "it has 99999999999 x 9 pixels",
            "50 x 40",
        ),
        (
            "torn.ppm",
            b"P6 50 40 255\nabc",
            "it ends early, after 3 of 6000 bytes",
            "close",
        ),
        (
            "wide.ppm",
            b"P6 50 40 65535\n",
            "its greatest value is 65535",
            "from 0 to 255",
        ),
        (
            "words.ppm",
            b"P3 50 40 255 1 2 3 x",
            "the pixel 1,0 has the value `x`",
            "0 to 255",
        ),
        (
            "short.ppm",
            b"P3 50 40 255 1 2 3",
            "it ends early, after 3 of 6000 values",
            "close",
        ),
        ("header.pfm", b"PF 50", "its header is damaged", "height"),
        ("big.pfm", &big_endian, "its scale is 1.0", "little-endian"),
        (
            "torn.pfm",
            &pfm_map[..70],
            "it ends early, after 56 of 8000 bytes",
            "close the file",
        ),
        (
            "torn.exr",
            &exr_map[..800],
            "the OpenEXR picture cannot be decoded",
            "close the file",
        ),
        (
            "two.exr",
            &exr(&[("u", numbers()), ("v", numbers())]),
            "its channels are u, v",
            "`R`",
        ),
        ("header.npy", &map[..40], "its header is damaged", "np.save"),
        (
            "torn.npy",
            &map[..map.len() - 4],
            "it ends early, after 7996 of 8000",
            "close the file",
        ),
        (
            "long.npy",
            &[&map[..], b"x"].concat(),
            "1 bytes follow its pixels",
            "close the file",
        ),
        (
            "big.npy",
            &npy(">f4", "40, 50", &[]),
            "its type is `>f4`",
            "np.ascontiguousarray",
        ),
        (
            "half.npy",
            &npy("<f2", "40, 50", &[]),
            "its type is `<f2`",
            "np.ascontiguousarray",
        ),
        (
            "turned.npy",
            &npy("<f4", "50, 40", &[]),
            "it has 40 x 50 pixels",
            "50 x 40",
        ),
        (
            "pair.npy",
            &npy("<f4", "40, 50, 2", &[]),
            "its shape is (40, 50, 2)",
            "(40, 50, 3)",
        ),
        (
            "flat.npy",
            &npy("<f4", "2000,", &[]),
            "its shape is (2000,)",
            "(40, 50)",
        ),
        (
            "fortran.npy",
            &fortran,
            "its order is Fortran's",
            "np.ascontiguousarray",
        ),
        (
            "zero.npy",
            &map,
            "its costs add up to 0",
            "the time or the work",
        ),
        (
            "nan.npy",
            &nan,
            "the pixel 2,1 is not a finite number",
            "finite",
        ),
        (
            "negative.npy",
            &npy("<f4", "40, 50", &strange),
            "the pixel 2,1 has a negative cost",
            "0",
        ),
    ];
    for (name, bytes, message, help) in cases {
        fs::write(path.join(name), bytes).unwrap();
        let found = error(path, &["out", name]);
        let begin = format!("error: `{name}`: {message}");
        assert!(found.starts_with(&begin) && found.contains(help), "{found}");
    }
    let options: &[(&[&str], &str)] = &[
        (&["nan.npy", "zero.npy"], "A and B are files"),
        (
            &["out", "nan.npy", "--fail-above=5%"],
            "`--fail-above` compares two outputs",
        ),
        (
            &["out", "out", "--by=rays"],
            "`--by` is for the cost map of another program",
        ),
        (
            &["out", "nan.npy", "--by=time_ns"],
            "the pixel 2,1 is not a finite number",
        ),
        (
            &["out", "costs.npy", "--by=time_ns"],
            "has no array `time_ns`",
        ),
        (
            &["out", "costs.npy", "--by=refraction_rays"],
            "`out` has no refraction rays",
        ),
        (
            &["out", "whole.png", "--by=rays"],
            "`whole.png` does not hold a cost map",
        ),
    ];
    fs::write(path.join("costs.npy"), npy("|u1", "40, 50", &[7; 2000])).unwrap();
    fs::write(path.join("whole.png"), whole).unwrap();
    for (arguments, message) in options {
        let found = error(path, arguments);
        assert!(found.contains(message), "{found}");
    }
    assert!(!path.join("out/diff-out-costs").exists());
    let written = diff(path, &["out", "costs.npy"]);
    assert_success(&written);
}
