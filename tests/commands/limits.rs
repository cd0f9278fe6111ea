//! Input that would take too much time or memory is refused with a message; an
//! allocation that the system refuses is a failure with a message, never a crash.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{in_repository, raycost};

/// Runs `raycost check` on a scene with this text.
fn check(text: &str) -> Output {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.yaml");
    fs::write(&file, text).unwrap();
    raycost().arg("check").arg(&file).output().unwrap()
}

fn refusal(text: &str) -> String {
    let output = check(text);
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

/// The parts of a scene before its objects.
const HEAD: &str = "
image: { width: 8, height: 6 }
camera: { look_at: { eye: [0, 1, 5], target: [0, 0, 0], fov_y_deg: 40 } }
materials: { blue: { color: 1 } }
lights: []
";

#[test]
fn aliases_of_a_long_name_are_refused_before_they_are_copied() {
    let name = "x".repeat(1 << 20);
    let first = format!(
        "- {{ name: &n {name}, sphere: {{ center: [0, 0, 0], radius: 1 }}, material: blue }}\n"
    );
    let others = "- { name: *n, sphere: { center: [0, 0, 0], radius: 1 }, material: blue }\n";
    let text = format!("{HEAD}objects:\n{first}{}", others.repeat(5000));
    let error = refusal(&text);
    assert!(error.contains("expand to too many values"), "{error}");
    assert!(error.contains("with this one"), "{error}");
}

#[test]
fn aliases_of_aliases_are_refused_before_they_are_written_out() {
    let mut text = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\n".to_owned();
    for n in 1..9 {
        let aliases = format!("*a{}, ", n - 1).repeat(10);
        text += &format!("a{n}: &a{n} [{aliases}]\n");
    }
    let error = refusal(&text);
    assert!(error.contains("expand to too many values"), "{error}");
}

#[test]
fn an_alias_that_a_scene_may_have_is_read() {
    let transform = "&t [{ translate: [1, 2, 3] }]";
    let object = "sphere: { center: [0, 0, 0], radius: 1 }, material: blue";
    let first = format!("- {{ {object}, transform: {transform} }}\n");
    let others = format!("- {{ {object}, transform: *t }}\n").repeat(5000);
    let output = check(&format!("{HEAD}objects:\n{first}{others}"));
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn names_and_keys_have_a_length() {
    let object = |name: &str| {
        format!(
            "{HEAD}objects: [{{ name: {name}, sphere: {{ center: [0, 0, 0], radius: 1 }}, material: blue }}]\n"
        )
    };
    assert!(check(&object(&"é".repeat(256))).status.success());
    let error = refusal(&object(&"é".repeat(257)));
    assert!(error.contains("at most 256 characters"), "{error}");
    let key = "k".repeat(257);
    let error = refusal(&format!("{HEAD}{key}: 1\n"));
    assert!(error.contains("a key is too long"), "{error}");
}

#[test]
fn a_study_has_a_number_of_runs() {
    let folder = tempfile::tempdir().unwrap();
    let list = (1..=256)
        .map(|n| n.to_string())
        .collect::<Vec<_>>()
        .join(", ");
    let scene = in_repository("configs/seed_sphere.yaml");
    let study = format!(
        "title: T\nscenes: [{}]\nvary: {{ threads: [{list}], samples_per_pixel: [{list}], max_depth: [1, 2, 3] }}\n",
        scene.display()
    );
    let file = folder.path().join("study.yaml");
    fs::write(&file, study).unwrap();
    let output = raycost().arg("study").arg(&file).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("the study has 2,162,688 runs"), "{error}");
}

#[test]
fn the_error_of_an_empty_scene_points_after_its_comments() {
    let error = refusal("# nothing\n# but comments\n");
    assert!(error.contains("scene.yaml:3:1"), "{error}");
    assert!(!error.contains("comments"), "{error}");
}

/// The program under limits of the shell.
#[cfg(target_os = "linux")]
fn limited(limit: &str, words: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_raycost");
    let command = format!("ulimit -c 0; {limit} && exec '{program}' {words}");
    Command::new("sh").args(["-c", &command]).output().unwrap()
}

/// The words of a run of a small picture.
#[cfg(target_os = "linux")]
fn small(out: &Path) -> String {
    let scene = in_repository("configs/seed_sphere.yaml");
    let (scene, out) = (scene.display(), out.display());
    format!("render '{scene}' --width 64 --height 48 --threads 2 --out '{out}'")
}

/// Whatever the limit, the program ends by itself, and says why.
#[cfg(target_os = "linux")]
#[test]
fn too_little_memory_is_a_failure_not_a_crash() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_refused = 0;
    let whole = folder.path().join("whole");
    assert!(limited("true", &small(&whole)).status.success());
    let whole = whole.display();
    let commands = [
        small(&folder.path().join("out")),
        format!("view '{whole}' --out '{whole}.html'"),
        format!("diff '{whole}' '{whole}' --out '{whole}-diff'"),
    ];
    for (mib, words) in (8..64).flat_map(|mib| commands.iter().map(move |words| (mib, words))) {
        let limit = format!("ulimit -v {}", mib << 10);
        if !limited(&limit, "--version").status.success() {
            // The system cannot start a program in so little.
            continue;
        }
        let output = limited(&limit, words);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        let code = output.status.code();
        let status = output.status;
        assert!(
            matches!(code, Some(0..=2)),
            "{mib} MiB, {words}: {status}, {error}"
        );
        assert!(
            code == Some(0) || error.contains("error"),
            "{mib} MiB: {error}"
        );
        n_refused += usize::from(code != Some(0));
    }
    assert!(n_refused > 0, "no limit was felt");
}

/// All threads that find no memory end the program with one message, and the rows of a table of many
/// objects are never in memory together.
#[cfg(target_os = "linux")]
#[test]
fn a_table_of_many_objects_takes_the_memory_of_a_small_one() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.yaml");
    let object = "- { sphere: { center: [0, 0, 0], radius: 1 }, material: blue }\n";
    let name = |i| object.replace("{ sphere", &format!("{{ name: n{i}, sphere"));
    let objects: String = (0..8000).map(name).collect();
    fs::write(&scene, format!("{HEAD}objects:\n{objects}")).unwrap();
    let out = folder.path().join("out");
    let (scene, out) = (scene.display(), out.display());
    let render = format!("render '{scene}' --cost counters --also objects --out '{out}'");
    assert!(limited("true", &render).status.success());
    let view = format!("view '{out}' --out '{out}.html'");
    let diff = format!("diff '{out}' '{out}' --out '{out}-diff'");
    let limit = |mib: u32| format!("export RAYON_NUM_THREADS=4; ulimit -v {}", mib << 10);
    // The rows as text would take 240 MiB.
    for words in [&view, &diff] {
        let output = limited(&limit(160), words);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{words}: {error}");
    }
    for mib in (24..100).step_by(4) {
        if !limited(&limit(mib), "--version").status.success() {
            continue;
        }
        let output = limited(&limit(mib), &view);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(
            matches!(output.status.code(), Some(0..=2)),
            "{mib}: {error}"
        );
        assert!(error.matches("error: ").count() <= 1, "{mib}: {error}");
    }
}

/// Threads that the system refuses are a message. What runs before the threads of `--threads` start,
/// or after they end, starts no other ones.
#[cfg(target_os = "linux")]
#[test]
fn only_the_threads_that_are_wanted_start() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let refused = "export RAYON_NUM_THREADS=60000; ulimit -v 1000000";
    let scene = in_repository("configs/elbow.yaml");
    let scene = scene.display();
    let words = format!(
        "'{scene}' --width 8 --height 6 --threads 1 --out '{}'",
        out.display()
    );
    let large = words.replace("--width 8 --height 6", "--width 1200 --height 900");
    for (command, words) in [
        ("render", &words),
        ("trace --pixel 3,3", &words),
        ("trace --pixel 300,300", &large),
    ] {
        let output = limited(refused, &format!("{command} {words}"));
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {error}");
    }
    let output = limited(refused, &format!("view '{}'", out.display()));
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(
        error.starts_with("error: cannot start the threads: "),
        "{error}"
    );
}

/// The program under a limit of threads, as a user who has no other ones: only root can become one,
/// and the limit does not bind root.
#[cfg(target_os = "linux")]
fn with_threads(n_threads: u32, words: &str) -> Option<Output> {
    let process = fs::metadata("/proc/self").unwrap();
    if std::os::unix::fs::MetadataExt::uid(&process) != 0 {
        return None;
    }
    let user = "setpriv --reuid 54321 --clear-groups";
    let program = env!("CARGO_BIN_EXE_raycost");
    let command = format!("{user} prlimit --nproc={n_threads} '{program}' {words}");
    // Standard input stays open.
    let (input, _open) = std::io::pipe().unwrap();
    let mut shell = Command::new("sh");
    Some(shell.args(["-c", &command]).stdin(input).output().unwrap())
}

/// Whatever thread is refused: either it only helps, or the program says so.
#[cfg(target_os = "linux")]
#[test]
fn a_refused_thread_is_a_message() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::set_permissions(path, fs::Permissions::from_mode(0o777)).unwrap();
    let scene = in_repository("configs/seed_sphere.yaml");
    let study = format!(
        "title: T\nscenes: [{}]\nvary: {{ threads: [1] }}\nflags: [--width=32, --height=24]\nrepeats: 1\n",
        scene.display()
    );
    let file = path.join("study.yaml");
    fs::write(&file, study).unwrap();
    let render = |name: &str, flag: &str| format!("{} {flag}", small(&path.join(name)));
    // Files that two threads would write.
    let large = render("large", "--resume");
    let large = large.replace("--width 64 --height 48", "--width 640 --height 480");
    let study = format!(
        "study '{}' --out '{}'",
        file.display(),
        path.join("study").display()
    );
    // The threads that a command takes; a study has two, and its run three.
    let commands = [
        (render("kept", "--resume"), 3),
        (large, 3),
        (render("watched", "--while-input-is-open"), 4),
        (study, 5),
    ];
    for (words, n_needed) in commands {
        let mut messages = String::new();
        for n_threads in 1..=n_needed {
            let Some(output) = with_threads(n_threads, &words) else {
                return;
            };
            let error = String::from_utf8_lossy(&output.stderr);
            let code = if n_threads < n_needed { 1 } else { 0 };
            assert_eq!(
                output.status.code(),
                Some(code),
                "{n_threads}, {words}: {error}"
            );
            assert!(!error.contains("panicked"), "{n_threads}, {words}: {error}");
            messages += &error;
        }
        println!("{messages}");
        let watches = !words.contains("--resume");
        assert_eq!(
            messages.contains("cannot start a thread: "),
            watches,
            "{messages}"
        );
        assert_eq!(messages.contains("`ulimit -u`"), watches, "{messages}");
    }
}

/// The bound of a scene is held against the limit of the process.
#[cfg(target_os = "linux")]
#[test]
fn the_limit_of_the_process_is_free_memory() {
    let scene = in_repository("configs/million_spheres.yaml");
    let command = format!(
        "ulimit -v {} && exec '{}' check '{}'",
        250 << 10,
        env!("CARGO_BIN_EXE_raycost"),
        scene.display()
    );
    let output = Command::new("sh").args(["-c", &command]).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("iB of memory are needed"), "{error}");
}

/// Another folder does not help where no file can be opened.
#[cfg(target_os = "linux")]
#[test]
fn advice_fits_a_lack_of_files() {
    let folder = tempfile::tempdir().unwrap();
    for n in 4..16 {
        let output = limited(&format!("ulimit -n {n}"), &small(folder.path()));
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(!error.contains("another folder"), "{n} files: {error}");
        if error.contains("Too many open files") {
            return;
        }
    }
    panic!("no limit was felt");
}

/// The promise of `docs/security.md`: `study` starts raycost or a launcher that was checked, and
/// an animation `ffmpeg`.
#[test]
fn no_other_program_is_started() {
    let mut folders = vec![in_repository("src")];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = fs::read_to_string(&path).unwrap_or_default();
            let starts = text.lines().map(str::trim).filter(|line| {
                let ways = ["Command::new(", ".exec()", "posix_spawn", "execv"];
                !line.starts_with("//") && ways.iter().any(|way| line.contains(way))
            });
            let name = path.strip_prefix(in_repository("src")).unwrap();
            found.extend(starts.map(|line| format!("{}: {line}", name.display())));
        }
    }
    found.sort();
    let expected = [
        "cli/study/process.rs: None => Command::new(program),",
        "cli/study/process.rs: let mut command = Command::new(&words[0]);",
        "cli/study/process.rs: let mut command = Command::new(program);",
        "tools/series/video.rs: let mut command = Command::new(FFMPEG);",
    ];
    assert_eq!(found, expected);
}
