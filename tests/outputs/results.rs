//! Reading inverts writing, and damaged files are refused.

use std::fs;
use std::path::{Path, PathBuf};

use base::Keyword;
use proptest::prelude::*;

use crate::common::generators::cases;
use crate::common::noise::noise;
use crate::common::{assert_success, in_repository, raycost};
use output::results::{FrameFile, HitsFile, Results};
use output::writers::{write_frame, write_hits};
use render::film::Film;
use render::schedule::TileGrid;
use scene::config::CostMode;
use vtk::Codec;

const MODES: [CostMode; 3] = [CostMode::None, CostMode::Counters, CostMode::Time];
proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn what_is_written_is_read_bit_for_bit(
        width in 1..70_u32,
        height in 1..70_u32,
        mode in prop::sample::select(MODES.to_vec()),
        codec in prop::sample::select(Codec::KEYWORDS),
        seed: u32,
    ) {
        check(&noise(width, height, mode, seed), codec);
    }

    #[test]
    fn no_damage_makes_a_reader_panic(
        at in 0..2000_usize,
        byte: u8,
        from in prop::sample::select(vec![0, 10_000]),
        codec in prop::sample::select(Codec::KEYWORDS),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let (frame, hits) = write(&noise(9, 5, CostMode::Time, 1), codec, folder.path());
        for path in [&frame, &hits] {
            let mut bytes = fs::read(path).unwrap();
            bytes[from + at] = byte;
            fs::write(path, bytes).unwrap();
        }
        if let Ok(frame) = FrameFile::open(&frame) {
            for info in frame.arrays().to_vec() {
                let _ = frame.read(&info.name);
            }
        }
        if let Ok(hits) = HitsFile::open(&hits) {
            for info in hits.arrays().to_vec() {
                let _ = hits.read(&info.name);
            }
            let _ = hits.read_points();
        }
    }
}

fn write(film: &Film, codec: Codec, folder: &Path) -> (PathBuf, PathBuf) {
    let (frame, hits) = (folder.join("frame.vti"), folder.join("hits.vtu"));
    write_frame(film, codec, &mut fs::File::create(&frame).unwrap()).unwrap();
    write_hits(film, codec, &mut fs::File::create(&hits).unwrap()).unwrap();
    (frame, hits)
}

/// Writes the film and compares what is read with its arrays.
fn check(film: &Film, codec: Codec) {
    let folder = tempfile::tempdir().unwrap();
    let (frame, hits) = write(film, codec, folder.path());
    let (frame, hits) = (
        FrameFile::open(&frame).unwrap(),
        HitsFile::open(&hits).unwrap(),
    );
    assert_eq!(
        (frame.width(), frame.height()),
        (film.grid.width, film.grid.height)
    );
    assert_eq!(hits.n_points(), film.n_hits());
    assert_eq!(frame.arrays().len(), film.columns().count());

    let is_hit: Vec<bool> = film
        .strips
        .iter()
        .flat_map(|strip| strip.object.iter().map(|&object| object >= 0))
        .collect();
    for column in film.columns() {
        let all: Vec<u8> = film
            .strips
            .iter()
            .flat_map(|strip| column.bytes(film, strip, &mut Vec::new()).to_vec())
            .collect();
        let array = frame.read(column.name).unwrap();
        assert_eq!(array.n_components, column.n_components);
        assert!(array.values.bytes() == all, "{}", column.name);
        let rows = film.grid.height / 3..film.grid.height.div_ceil(2);
        let row_bytes = all.len() / film.grid.height as usize;
        let of_rows = &all[rows.start as usize * row_bytes..rows.end as usize * row_bytes];
        let array = frame.read_rows(column.name, rows).unwrap();
        assert!(array.values.bytes() == of_rows, "{}", column.name);

        let of_hits: Vec<u8> = all
            .chunks(column.stride())
            .zip(&is_hit)
            .filter_map(|(bytes, hit)| hit.then_some(bytes))
            .flatten()
            .copied()
            .collect();
        let array = hits.read(column.name).unwrap();
        assert!(array.values.bytes() == of_hits, "{}", column.name);
    }
    let pixels = (0..is_hit.len()).filter(|&pixel| is_hit[pixel]);
    let pixels: Vec<i32> = pixels.map(|pixel| pixel as i32).collect();
    assert_eq!(
        hits.read("pixel").unwrap().values.as_slice(),
        Some(&pixels[..])
    );
    let points = film.strips.iter().flat_map(|strip| &strip.position);
    let points = points
        .zip(&is_hit)
        .filter_map(|(point, hit)| hit.then_some(point.as_dvec3().to_array()));
    let points: Vec<[f64; 3]> = points.collect();
    let found = hits.read_points().unwrap();
    assert_eq!(
        bytemuck::cast_slice::<_, u8>(&found),
        bytemuck::cast_slice::<_, u8>(&points)
    );
}

/// Renders a scene of few pixels into a folder.
fn render(folder: &Path, flags: &[&str]) {
    render_rows("30", folder, flags);
}

fn render_rows(height: &str, folder: &Path, flags: &[&str]) {
    let output = raycost()
        .arg("render")
        .arg(in_repository("configs/seed_extended.yaml"))
        .args(["--quiet", "--width", "40", "--out"])
        .arg(folder)
        .args(["--height", height])
        .args(flags)
        .output()
        .unwrap();
    assert_success(&output);
}

/// The error of opening all files of a folder.
fn error(folder: &Path) -> String {
    let all = || {
        let results = Results::open(folder)?;
        results.frame()?;
        results.hits()
    };
    all().unwrap_err().to_string()
}

#[test]
fn a_rendering_is_read() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &[]);
    let results = Results::open(folder.path()).unwrap();
    let frame = results.frame().unwrap();
    let visits = frame.read("node_visits").unwrap().values;
    let total = results.summary.cost.total("node_visits");
    assert_eq!(total, Some(visits.iter().sum()));
    assert_eq!(results.summary.scene.name, "seed_extended");
    let n_hits = frame
        .read("object")
        .unwrap()
        .values
        .iter()
        .filter(|&o| o >= 0.0)
        .count();
    assert_eq!(results.hits().unwrap().n_points(), n_hits);
}

#[test]
fn the_error_of_a_missing_array_names_the_option_that_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    let missing = |name| {
        let frame = Results::open(folder.path()).unwrap().frame().unwrap();
        frame.read(name).unwrap_err().to_string()
    };
    render(folder.path(), &["--cost", "counters"]);
    assert!(missing("time_ns").contains("render again with `--cost time`"));
    assert!(missing("time_mad_ns").contains("render again with `--repeats 10`"));
    render(folder.path(), &["--no-cost"]);
    assert!(missing("rays").contains("render again without `--no-cost`"));
    assert!(missing("frequency").contains("its arrays are pixel_x, pixel_y"));
}

#[test]
fn a_foreign_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert!(error(&path.join("nowhere")).contains("cannot read the folder"));
    assert!(error(path).contains("it has no summary.json"));
    assert!(error(&in_repository("README.md")).contains("is a file"));
    render(path, &[]);
    fs::remove_file(path.join("frame.vti")).unwrap();
    assert!(error(path).contains("frame.vti` is missing"));
}

#[test]
fn files_of_two_renderings_are_refused() {
    let [one, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    render(one.path(), &[]);
    render_rows("31", other.path(), &[]);
    for (file, what) in [
        ("hits.vtu", "hits.vtu has"),
        ("frame.vti", "frame.vti has 40 x 31"),
    ] {
        fs::copy(other.path().join(file), one.path().join(file)).unwrap();
        let error = error(one.path());
        assert!(
            error.contains("different renderings") && error.contains(what),
            "{error}"
        );
    }
}

#[test]
fn a_file_cut_anywhere_before_its_end_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (frame, hits) = write(&noise(9, 5, CostMode::Time, 1), Codec::None, folder.path());
    // Behind the last array that is read stand three of cells and two tags.
    let n_hits = HitsFile::open(&hits).unwrap().n_points();
    let tail = "\n</AppendedData>\n</VTKFile>\n".len();
    let mut files = vec![(frame, tail), (hits, tail + 3 * 8 + n_hits * 9)];
    for &codec in &Codec::KEYWORDS[1..] {
        let folder = folder.path().join(format!("{codec:?}"));
        fs::create_dir(&folder).unwrap();
        let (frame, _) = write(&noise(9, 5, CostMode::Time, 1), codec, &folder);
        files.push((frame, tail));
    }
    for (path, spare) in files {
        let whole = fs::read(&path).unwrap();
        for n in (0..whole.len() - spare)
            .step_by(37)
            .chain([whole.len() - spare - 1])
        {
            fs::write(&path, &whole[..n]).unwrap();
            let error = if path.ends_with("frame.vti") {
                FrameFile::open(&path).map(drop)
            } else {
                HitsFile::open(&path).map(drop)
            };
            let error = error.unwrap_err().to_string();
            assert!(error.contains("truncated") || n == 0, "{n}: {error}");
        }
    }
}

#[test]
fn a_damaged_block_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for &codec in &Codec::KEYWORDS[1..] {
        let (path, _) = write(
            &Film::new(TileGrid::new(99, 50, 16), 1, CostMode::Time),
            codec,
            folder.path(),
        );
        let mut bytes = fs::read(&path).unwrap();
        let end = bytes.len() - "\n</AppendedData>\n</VTKFile>\n".len();
        // Within `thread`, the last array.
        bytes[end - 20..end].fill(0xff);
        fs::write(&path, bytes).unwrap();
        let found = FrameFile::open(&path).unwrap().read("thread").map(drop);
        let error = found.unwrap_err();
        let what = "is damaged: a block of `thread` cannot be decompressed";
        assert!(error.to_string().contains(what), "{codec:?}: {error}");
    }
}

#[test]
fn a_foreign_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.vti");
    let (_, hits) = write(&noise(2, 2, CostMode::None, 1), Codec::None, folder.path());
    let text = fs::read(&path).unwrap();
    let text = text
        .iter()
        .map(|&byte| char::from(byte))
        .collect::<String>();
    let opened = |text: &str| {
        let bytes: Vec<u8> = text.chars().map(|c| c as u8).collect();
        fs::write(&path, bytes).unwrap();
        let read = |frame: FrameFile| frame.read("pixel_x").map(drop);
        FrameFile::open(&path)
            .and_then(read)
            .unwrap_err()
            .to_string()
    };
    for (ours, theirs, why) in [
        ("<?xml", "# vtk", "does not begin"),
        ("raw", "base64", "no appended data"),
        ("LittleEndian", "BigEndian", "is not this machine's"),
        ("UInt64", "UInt32", "not UInt64"),
        (
            "header_type",
            "compressor=\"vtkLZMADataCompressor\" header_type",
            "compressed by `vtkLZMADataCompressor`",
        ),
        (
            "header_type",
            "compressor=\"vtkZLibDataCompressor\" header_type",
            "the blocks of `pixel_x` do not hold 8 bytes",
        ),
        ("ImageData", "PolyData", "no ImageData"),
        ("type=\"UInt16\"", "type=\"Int16\"", "the type `Int16`"),
        ("offset=\"0\"", "", "not in its appended data"),
        (
            "offset=\"0\"",
            "offset=\"18446744073709551615\"",
            "no file is as long",
        ),
        ("offset=\"0\"", "offset=\"99999999\"", "truncated"),
        ("offset=\"0\"", "offset=\"4\"", "share bytes of it"),
        ("_\u{8}\0\0\0", "_\u{7}\0\0\0", "has 7 bytes instead of 8"),
        (
            " Extent=\"0 1 0 1",
            " Extent=\"0 1 0 -1",
            "not the extent of a picture",
        ),
        (
            " Extent=\"0 1 0 1",
            " Extent=\"0 65535 0 1",
            "not the extent of a picture",
        ),
        ("</Piece>", "</Peace>", "its header is damaged"),
    ] {
        assert!(text.contains(ours), "{ours}");
        let error = opened(&text.replace(ours, theirs));
        assert!(error.contains(why), "{theirs}: {error}");
    }
    assert!(
        FrameFile::open(&hits)
            .unwrap_err()
            .to_string()
            .contains("no ImageData")
    );
}
