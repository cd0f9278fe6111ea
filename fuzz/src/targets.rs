//! The fuzz targets: each takes any bytes, and panics where raycost breaks a
//! promise. The project's own tests run them on the seeds and on what was found.

use std::path::{Path, PathBuf};

use host::text::Diagnostic;
use import::{
    IsosurfaceChoice, MAX_BYTES_PER_BYTE, Mesh, RadiusChoice, read_isosurface, read_lines,
    read_mesh, read_mesh_with, read_picture, read_points, read_spheres, read_tubes,
};
use output::estimate::Memory;
use output::results::{self, FrameFile, HitsFile};
use scene::build::Geometries;
use scene::config::Config;
use scene::yaml::Source;
use serde_json::Value;
use tempfile::TempDir;
use tools::diff::{Diff, Side};
use tools::study::{self, StudyPlan, statistics_rows, write_csv};
use tools::view::Page;
use world::material::ArrayChoice;

/// Memory that a scene may take, in bytes.
const AVAILABLE: u64 = 64 << 20;
/// Runs of a study that is followed further; larger ones take their time.
const MOST_RUNS: u64 = 1000;

/// The files of a picture of 8 x 6 pixels.
const FRAME: &[u8] = include_bytes!("../output/frame.vti");
const HITS: &[u8] = include_bytes!("../output/hits.vtu");
const SUMMARY: &[u8] = include_bytes!("../output/summary.json");

thread_local! {
    static FOLDERS: [Folder; 2] = folders();
}

/// Scenes: YAML → config → primitives in world space.
pub fn scene(input: &[u8]) {
    let Ok(text) = str::from_utf8(input) else {
        return;
    };
    if let Err(diagnostic) = build(text) {
        let message = diagnostic.render(true);
        assert!(message.contains("error"), "{message}");
    }
}

fn build(text: &str) -> Result<(), Diagnostic> {
    // A folder that is not there: no file of this machine is read.
    let source = Source::new("/nowhere/scene.yaml", text);
    let mut config: Config = source.parse()?;
    let point_at = |fault| source.point_at(fault);
    let geometries = Geometries::read(&mut config, source.folder(), 0).map_err(point_at)?;
    let memory = Memory::estimate(&config, &geometries);
    memory.check(AVAILABLE).map_err(point_at)?;
    scene::build::scene(&config, geometries).map_err(point_at)?;
    Ok(())
}

/// Meshes, tables of spheres and tubes, VTK data sets and pictures; the first byte picks the
/// format.
pub fn geometry(input: &[u8]) {
    let Some((format, bytes)) = input.split_first() else {
        return;
    };
    let most = MAX_BYTES_PER_BYTE * bytes.len() as u64;
    FOLDERS.with(|[folder, _]| match format {
        b'o' | b'p' => {
            let name = if *format == b'o' { "a.obj" } else { "a.ply" };
            if let Ok(mesh) = read_mesh(&folder.write(name, bytes)) {
                check_mesh(&mesh);
                assert!(mesh.n_bytes() <= most, "{} of {most}", mesh.n_bytes());
            }
        }
        b's' => {
            let path = folder.write("a.csv", bytes);
            if let Ok(spheres) = read_spheres(&path, Some(&RadiusChoice::Same(1.0)), None) {
                assert!(spheres.n_bytes() <= most, "{} of {most}", spheres.n_bytes());
            }
        }
        b't' => {
            let path = folder.write("a.csv", bytes);
            if let Ok(tubes) = read_tubes(&path, Some(&RadiusChoice::Same(1.0)), None) {
                assert!(tubes.n_bytes() <= most, "{} of {most}", tubes.n_bytes());
            }
        }
        b'v' => data_set(&folder.write("a.vtk", bytes)),
        b'i' => {
            if let Ok(found) = read_picture(&folder.write("a.png", bytes), None, AVAILABLE) {
                assert!(found.n_bytes() <= AVAILABLE);
            }
        }
        _ => {}
    });
}

fn check_mesh(mesh: &Mesh) {
    let n_vertices = mesh.vertices.len() as u32;
    let mut indices = mesh.triangles.iter().flatten();
    assert!(indices.all(|&index| index < n_vertices));
    assert!(mesh.vertices.iter().all(|vertex| vertex.is_finite()));
}

/// A VTK file in each of the ways that objects read it, with an array if it has one.
fn data_set(path: &Path) {
    let surface = read_mesh(path);
    surface.iter().for_each(check_mesh);
    let names = surface.map(|mesh| mesh.arrays).unwrap_or_default();
    let array = names.into_iter().next().map(|name| ArrayChoice {
        is_color: false,
        name,
        component: None,
        of: None,
    });
    if let Ok(mesh) = read_mesh_with(path, array.as_ref()) {
        check_mesh(&mesh);
    }
    let radius = RadiusChoice::Same(1.0);
    let _ = read_points(path, &radius, None);
    if let Ok(tubes) = read_lines(path, &radius, None) {
        assert!(tubes.capsules().len() > 0);
    }
    if let Some(array) = array {
        let choice = IsosurfaceChoice {
            array: array.clone(),
            values: vec![0.5],
        };
        let surface = read_isosurface(path, &choice, Some(&array));
        surface.iter().for_each(check_mesh);
    }
}

/// VTK files: `frame.vti` and `hits.vtu`, with all their arrays.
pub fn vtk(input: &[u8]) {
    FOLDERS.with(|[folder, _]| {
        let path = folder.write("a.vtk", input);
        if let Ok(frame) = FrameFile::open(&path) {
            let n_pixels = frame.width() as usize * frame.height() as usize;
            for info in frame.arrays().to_vec() {
                if let Ok(array) = frame.read(&info.name) {
                    assert_eq!(array.values.len(), n_pixels * array.n_components);
                }
                if let Ok(array) = frame.read_selected(&info.name, &[0], &[0]) {
                    assert_eq!(array.values.len(), array.n_components);
                }
            }
        }
        if let Ok(hits) = HitsFile::open(&path) {
            for info in hits.arrays().to_vec() {
                if let Ok(array) = hits.read(&info.name) {
                    let n_points = hits.n_points();
                    assert_eq!(array.values.len(), n_points * array.n_components);
                }
            }
            let _ = hits.read_points();
        }
    });
}

/// An output folder's `summary.json` and `objects.csv` beside whole VTK files,
/// as `view` and `diff` read them.
pub fn output(input: &[u8]) {
    let (summary, table) = two_parts(input);
    FOLDERS.with(|[ours, other]| {
        ours.write("summary.json", summary);
        ours.write("objects.csv", table);
        let Ok(results) = results::Results::open(ours.path()) else {
            return;
        };
        if let Ok(view) = Page::new(&results) {
            view.write(&mut std::io::sink()).expect("a sink takes all");
        }
        if let Ok(sides) = Side::open([ours.path(), other.path()]) {
            let _ = Diff::compare(&sides);
        }
    });
}

/// Study files, and the runs from which an interrupted study continues.
pub fn study(input: &[u8]) {
    let (study, runs) = two_parts(input);
    let Ok(study) = str::from_utf8(study) else {
        return;
    };
    let plan = match Source::new("study.yaml", study).parse::<StudyPlan>() {
        Ok(plan) => plan.into_quick(),
        Err(diagnostic) => {
            assert!(diagnostic.render(true).contains("error"));
            return;
        }
    };
    if plan.n_runs() > MOST_RUNS {
        return;
    }
    assert_eq!(plan.runs().len() as u64, plan.n_runs());
    FOLDERS.with(|[folder, _]| {
        let path = folder.write("runs.jsonl", runs);
        if let Ok(results) = study::RunLog::open(&path, &Value::Null) {
            let rows = statistics_rows(&plan, &results.runs, None);
            write_csv(&rows, &mut std::io::sink()).expect("a sink takes all");
        }
    });
}

/// Two files in one input, cut at a line `---8<---`: so their bytes stay
/// readable.
fn two_parts(input: &[u8]) -> (&[u8], &[u8]) {
    const CUT: &[u8] = b"---8<---\n";
    let cut = input.windows(CUT.len()).position(|part| part == CUT);
    match cut {
        Some(at) => (&input[..at], &input[at + CUT.len()..]),
        None => (input, b""),
    }
}

/// A thread's temporary folder, removed when the thread ends.
struct Folder(TempDir);

/// Two output folders, of which the targets change the first.
fn folders() -> [Folder; 2] {
    let folders = [Folder::new(), Folder::new()];
    for folder in &folders {
        folder.write("frame.vti", FRAME);
        folder.write("hits.vtu", HITS);
        folder.write("summary.json", SUMMARY);
    }
    folders
}

impl Folder {
    /// A folder in memory, where the system has a place for that.
    fn new() -> Self {
        let in_memory = Path::new("/dev/shm");
        let folder = if in_memory.is_dir() {
            tempfile::tempdir_in(in_memory)
        } else {
            tempfile::tempdir()
        };
        Self(folder.expect("a folder for temporary files"))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file, over an older one of the same name; gives its path.
    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("room for a small file");
        path
    }
}
