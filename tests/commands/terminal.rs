//! Text from input files reaches the terminal without control characters and without
//! bidirectional formatting characters.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{in_repository, raycost};

/// Reverses the following text, clears the screen, sets the window's title.
const EVIL: &str = "\u{202e}\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m\r";

/// Renders a scene of few pixels.
fn render_small(scene: &Path, out: &Path, flags: &[&str]) -> Output {
    raycost()
        .arg("render")
        .arg(scene)
        .args(["--width", "40", "--height", "30", "--out"])
        .arg(out)
        .args(flags)
        .output()
        .unwrap()
}

/// Everything that a command printed.
fn printed(output: &Output) -> String {
    let both = [&output.stdout[..], &output.stderr].concat();
    String::from_utf8(both).expect("text")
}

/// Asserts that the output has no control characters except line ends, and shows the
/// escaped ones.
fn assert_text(output: &Output) {
    let text = printed(output);
    let unseen = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
    assert!(!text.contains(unseen), "{text:?}");
    assert!(
        text.contains("\\u{202e}") || text.contains("\\u202e"),
        "{text}"
    );
}

/// A scene whose object and material have an evil name.
fn scene() -> String {
    let name = serde_json::to_string(EVIL)
        .unwrap()
        .replace("\u{9b}", "\\x9b");
    let text = fs::read_to_string(in_repository("configs/seed_extended.yaml")).unwrap();
    text.replacen("- sphere:", &format!("- name: {name}\n    sphere:"), 1)
}

#[test]
fn names_of_a_scene_are_shown_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.yaml");
    fs::write(&file, scene()).unwrap();
    let out = folder.path().join("out");
    let rendered = render_small(&file, &out, &["--also", "objects"]);
    assert!(rendered.status.success(), "{}", printed(&rendered));
    assert_text(&rendered);
    // The material of the object in the middle.
    let traced = raycost()
        .args([
            "trace", "--pixel", "20,15", "--width", "40", "--height", "30",
        ])
        .arg(&file)
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    assert!(traced.status.success(), "{}", printed(&traced));
    // The names of settings that differ are those of the summaries.
    let other = folder.path().join("other");
    let plain = in_repository("configs/seed_extended.yaml");
    assert!(render_small(&plain, &other, &[]).status.success());
    for flags in [&[][..], &["--json"]] {
        let diff = raycost()
            .arg("diff")
            .args([&out, &other])
            .args(flags)
            .arg("--out")
            .arg(folder.path().join("diff"))
            .output()
            .unwrap();
        assert!(diff.status.success(), "{}", printed(&diff));
        assert_text(&diff);
        if flags == ["--json"] {
            serde_json::from_slice::<serde_json::Value>(&diff.stdout).unwrap();
        }
    }
}

#[test]
fn a_line_of_a_damaged_summary_is_shown_as_text() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("summary.json"),
        format!("{{ \"raycost\": 1, \"{EVIL}\": 2 }}"),
    )
    .unwrap();
    let output = raycost().arg("view").arg(folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let text = printed(&output);
    assert!(!text.contains(['\u{1b}', '\u{9b}', '\u{202e}']), "{text:?}");
}

#[test]
fn words_of_the_command_line_are_shown_as_text() {
    for words in [
        vec!["render", EVIL],
        vec!["check", EVIL],
        vec!["view", EVIL],
        vec!["diff", EVIL, EVIL],
        vec!["study", EVIL],
        vec![EVIL],
        vec!["render", "a.yaml", "--width", EVIL],
    ] {
        let output = raycost().args(&words).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert_text(&output);
    }
}

#[test]
fn the_title_of_a_study_is_shown_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_repository("configs/seed_sphere.yaml");
    let title = serde_json::to_string(EVIL)
        .unwrap()
        .replace("\u{9b}", "\\x9b");
    let study = format!(
        "title: {title}\nscenes: [{}]\nflags: [--width=8, --height=8]\nrepeats: 1\nwarm_up: 0\n",
        scene.display()
    );
    let file = folder.path().join("study.yaml");
    fs::write(&file, study).unwrap();
    let output = raycost()
        .arg("study")
        .arg(&file)
        .arg("--out")
        .arg(folder.path().join("out"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", printed(&output));
    assert_text(&output);
}

/// Help that cannot be printed is a failure, as any other text is.
#[cfg(target_os = "linux")]
#[test]
fn help_to_a_full_disk_fails() {
    for words in [&["--help"][..], &["--version"], &["render", "--help"]] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = raycost().args(words).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{words:?}");
        assert!(printed(&output).contains("cannot write to the terminal"));
    }
}

/// One module writes to the terminal; indicatif draws the bars.
#[test]
fn one_module_writes_to_the_terminal() {
    let found = Command::new("grep")
        .args(["-rnE", r"print(ln)?!|\bstd(out|err)\(\)|io::std(out|err)"])
        .args(["--include=*.rs", "src"])
        .current_dir(in_repository(""))
        .output()
        .unwrap();
    let text = String::from_utf8(found.stdout).unwrap();
    let allowed = |line: &&str| {
        line.starts_with("src/host/text/terminal.rs:")
            // Without memory, nothing but fixed text and a number.
            || line.starts_with("src/host/allocator.rs:")
            || line.contains("ProgressDrawTarget::stderr()")
            || line.contains("//!")
    };
    let others: Vec<&str> = text.lines().filter(|line| !allowed(line)).collect();
    assert!(others.is_empty(), "{others:#?}");
}
