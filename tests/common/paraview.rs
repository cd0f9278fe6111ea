//! Loads states in a real ParaView.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

use super::{assert_success, in_repository, raycost};

/// A scene whose camera looks away from the only object.
pub const NOTHING: &str = "
image: { width: 64, height: 48 }
camera:
  look_at: { eye: [0, 0, 5], target: [0, 0, 9], fov_y_deg: 40 }
materials:
  gray: { color: 0.5 }
lights: []
objects:
  - sphere: { center: [0, 0, 0], radius: 1 }
    material: gray
";

/// Renders into a folder whose name has characters that XML and shells must escape.
pub fn render(scene: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    run("render", scene, name, arguments)
}

/// Traces pixels into such a folder.
pub fn trace(scene: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    run("trace", scene, name, arguments)
}

fn run(command: &str, scene: &Path, name: &str, arguments: &[&str]) -> PathBuf {
    let out = folder("out ü & co").join(name);
    let output = raycost()
        .arg(command)
        .arg(scene)
        .args(["--quiet", "--out"])
        .arg(&out)
        .args(arguments)
        .output();
    assert_success(&output.unwrap());
    out
}

/// Writes a scene file.
pub fn scene_file(name: &str, text: &str) -> PathBuf {
    let file = folder("scenes").join(name).with_extension("yaml");
    fs::write(&file, text).unwrap();
    file
}

/// Returns the path of a state's picture.
pub fn screenshot(out: &Path, what: &str) -> PathBuf {
    let name = out.file_name().unwrap().to_str().unwrap();
    folder("").join(format!("{name}, {what}.png"))
}

/// A folder in `target/paraview/`.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .with_file_name("paraview")
        .join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs what its arguments name on a virtual screen.
pub fn on_virtual_screen() -> Command {
    on_virtual_screen_of("1920x1200")
}

/// Runs what its arguments name on a virtual screen of this size in pixels. Two `xvfb-run -a`
/// that start at once may choose the same screen: each has another number to begin with. Without
/// -noreset the X server resets whenever a program closes its last window, and refuses the next
/// one meanwhile.
pub fn on_virtual_screen_of(size: &str) -> Command {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    // Others may test at the same time.
    let first = 100 * (1 + std::process::id() % 500);
    let number = first + NEXT.fetch_add(1, Ordering::Relaxed);
    let mut command = Command::new("xvfb-run");
    command.args(["-a", "-n", &number.to_string()]);
    command.args(["-s", &format!("-screen 0 {size}x24 -noreset")]);
    command
}

/// The variable that fills fresh memory with 42, a polyhedron's cell type, for pieces: ParaView 5.11 does
/// not set the types of their cells before it uses them, and then crashes at a threshold.
pub fn for_pieces(out: &Path) -> Option<(&'static str, &'static str)> {
    let has_pieces = out.join("hits.pvtu").exists();
    has_pieces.then_some(("MALLOC_PERTURB_", "213"))
}

/// The arguments of `check_state.py` for a state: its file, its output folder, its picture and flags.
pub fn state(file: &Path, out: &Path, screenshot: &Path, flags: &[&str]) -> Vec<OsString> {
    let paths = [file, out, screenshot].map(OsString::from);
    let flags = flags.iter().map(OsString::from);
    paths.into_iter().chain(flags).collect()
}

/// Returns the text of a state.
pub fn read(out: &Path, state: &str) -> String {
    fs::read_to_string(out.join(state).with_extension("pvsm")).unwrap()
}

/// Loads states of an output folder in one ParaView, and checks their pictures.
pub fn load(out: &Path, states: &[Vec<OsString>]) -> Output {
    on_virtual_screen()
        .arg("pvbatch")
        .arg(in_repository("paraview/check_state.py"))
        .args(states.join(&OsString::from("--")))
        .env("RAYCOST_OUT", out)
        .envs(for_pieces(out))
        .output()
        .expect("run tests/with-paraview")
}

/// Loads the states of these names by their own paths, which show these arrays, with commas between them.
pub fn load_own(out: &Path, states: &[(&str, &str)]) {
    let states = states.iter().map(|(name, arrays)| {
        let file = out.join(name).with_extension("pvsm");
        let require = format!("--require={arrays}");
        state(
            &file,
            out,
            &screenshot(out, name),
            &["--from-state", &require],
        )
    });
    assert_success(&load(out, &states.collect::<Vec<_>>()));
}
