//! Invalid studies, foreign results and duplicate runs are refused.

use super::{STUDY, folder, raycost, run, stderr_of};
use crate::common::assert_success;
use std::fs;
use std::process::Command;
use tools::study::OVERRIDING;

#[cfg(unix)]
#[test]
fn a_log_that_cannot_be_written_ends_with_1_and_leaves_none() {
    let folder = folder(STUDY);
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -f 0; exec \"$@\"", "sh"]);
    shell
        .arg(raycost().get_program())
        .args(["study", "study.yaml", "--out", "out"]);
    let failed = shell.current_dir(folder.path()).output().unwrap();
    assert_eq!(failed.status.code(), Some(1), "{}", stderr_of(&failed));
    assert!(
        stderr_of(&failed).contains("ulimit -f"),
        "{}",
        stderr_of(&failed)
    );
    assert!(!folder.path().join("out/runs.jsonl").exists());
}

#[test]
fn every_flag_that_overrides_the_file_is_known() {
    let help = raycost().args(["render", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let words: Vec<&str> = help.split_whitespace().collect();
    let known = OVERRIDING.map(|(flag, _)| flag);
    let (mut flag, mut n_found) = ("", 0);
    for (at, word) in words.iter().enumerate() {
        flag = word.strip_prefix("--").unwrap_or(flag);
        if words[at..].starts_with(&["instead", "of", "the", "file's"]) {
            assert!(known.contains(&flag), "{flag}");
            n_found += 1;
        }
    }
    assert!(n_found > 10, "{n_found}");
}

#[test]
fn foreign_results_stay_unchanged() {
    let folder = folder(STUDY);
    let file = folder.path().join("out/runs.jsonl");
    fs::create_dir(folder.path().join("out")).unwrap();
    for (held, expected) in [
        ("{\"raycost_study\":99,\"made_by\":{}}\n", "has format 99"),
        // Of a raycost that did not keep of which flags and scenes its runs are.
        (
            "{\"raycost_study\":1,\"made_by\":{}}\n",
            "has format 1 of results, which this raycost does not continue",
        ),
        (
            "{\"raycost_study\":2,\"made_by\":{}}\n",
            "were made with another machine",
        ),
        ("the notes of somebody\n", "holds no results"),
    ] {
        fs::write(&file, held).unwrap();
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(
            stderr_of(&refused).contains(expected),
            "{}",
            stderr_of(&refused)
        );
        assert_eq!(fs::read_to_string(&file).unwrap(), held);
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table of cases")]
fn mistakes_are_reported_before_the_first_run() {
    for (study, expected) in [
        ("title: x\nscenes: []", "`scenes` cannot be an empty list"),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { threads: [] }",
            "`vary.threads` cannot be an empty list",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { image_size: [9x] }",
            "expected a size: [100, 75], 100x75, or 100 for a square",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { image_size: [0] }",
            "expected a size: [100, 75], 100x75, or 100 for a square",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { cost: [time, counters] }\n\
             plots: [{ x: cost, y: render_wall_ms, fit: true }]",
            "a law needs numbers, and `cost` has names",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { image.width: [8, 16] }\nflags: [--width=4]",
            "`--width` overrides `image.width`\n --> study.yaml:3:9",
        ),
        (
            "title: x\nscenes: [scene.yaml]\ncases: [{ max_depth: 1, shading.max_depth: 2 }]",
            "`--max-depth` overrides `shading.max_depth`",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { max_depth: [0, 300] }",
            "expected a whole number from 0 to 255",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { theads: [1] }",
            "did you mean `threads`?",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nsteps: [{ name: a b, set: { threads: 1 } }, { name: a-b, set: { threads: 2 } }]",
            "the pictures of two steps would be the file `step-scene-a-b.png`",
        ),
        (
            &format!(
                "title: x\nscenes: [scene.yaml]\nsteps: [{{ name: {}, set: {{ threads: 1 }} }}]",
                "n".repeat(250)
            ),
            "the picture of `steps[0].name` would have a file name of 265 bytes",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { threads: [0] }",
            "`vary.threads[0]` cannot be `0`",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { camera.lookat.fov_y_deg: [20] }",
            "did you mean `look_at`?",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { camera.look_at.fov_y_deg: [20, 200] }",
            "`camera.look_at.fov_y_deg` cannot be `200`",
        ),
        (
            "title: x\nscenes: [scene.yaml, scene.yaml]",
            "`scenes` has an item twice\n --> study.yaml:2:",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { threads: [1, 2, 1] }",
            "`vary.threads` has an item twice\n --> study.yaml:3:",
        ),
        (
            "title: x\nscenes: [scene.yaml]\ncases: [{ threads: 1 }, { threads: 1 }]",
            "`cases` has an item twice\n --> study.yaml:3:",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nquick: { vary: { threads: [1, 1] } }",
            "`quick.vary.threads` has an item twice\n --> study.yaml:3:",
        ),
        (
            "title: x\nscenes: [scene.yaml]\ncases: [{ threads: 1 }]\nvary: { threads: [2] }",
            "`threads` is in `cases`, too\n --> study.yaml:4:",
        ),
        ("title: x\nscenes: ['-']", "cannot read the scene `./-`"),
        (
            "title: x\nscenes: [study.yaml]",
            "`./study.yaml` is a study, not a scene",
        ),
        ("title: x\nscenes: [none.yaml]", "cannot read the scene"),
        (
            "title: x\nscenes: [scene.yaml]\nflags: [--with=3]",
            "--with",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nflags: [--out=elsewhere]",
            "--out",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nflags: [scene.yaml]",
            "`scene.yaml` in `flags` is not a flag",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { device: [processor, 'opencl:'] }",
            "invalid value 'opencl:' for '--device <DEVICE>'",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nflags: [--simd=sse9]",
            "invalid value 'sse9' for '--simd <SET>'",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { objects: [5] }",
            "no `sphere_cloud`",
        ),
    ] {
        let folder = folder(study);
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2), "{study}");
        assert!(
            stderr_of(&refused).contains(expected),
            "{study}\n{}",
            stderr_of(&refused)
        );
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table of cases")]
fn mistakes_about_the_launcher_are_shown_at_their_lines() {
    for (lines, expected) in [
        (
            "vary: { ranks: [1, 2] }",
            "error: `ranks` need a `launcher`
 --> study.yaml:3:7
  |
3 | vary: { ranks: [1, 2] }
  |       ^^^^^^^^^^^^^^^^^ one is there without the other
  |
  = help: add `launcher: \"mpirun -n {ranks}\"`
",
        ),
        (
            "cases: [{ ranks: 1 }]",
            "error: `ranks` need a `launcher`
 --> study.yaml:3:8
  |
3 | cases: [{ ranks: 1 }]
  |        ^^^^^^^^^^^^^^ one is there without the other
  |
  = help: add `launcher: \"mpirun -n {ranks}\"`
",
        ),
        (
            "launcher: mpirun -n {ranks}",
            "error: a `launcher` needs the factor `ranks`
 --> study.yaml:3:11
  |
3 | launcher: mpirun -n {ranks}
  |           ^^^^^^^^^^^^^^^^^ one is there without the other
  |
  = help: add `ranks: [1, 2, 4]` to `vary`, or leave the launcher out
",
        ),
        (
            "vary: { ranks: [1] }\nlauncher: mpirun -n {n}",
            "error: `launcher` must contain `{ranks}` and no other braces
 --> study.yaml:4:11
  |
4 | launcher: mpirun -n {n}
  |           ^^^^^^^^^^^^^ expected a command such as `mpirun -n {ranks}`
",
        ),
        (
            "vary: { ranks: [1] }\nlauncher: [mpirun, -n, '{ranks}']",
            "error: `launcher` cannot be a list
 --> study.yaml:4:11
  |
4 | launcher: [mpirun, -n, '{ranks}']
  |           ^^^^^^^^^^^^^^^^^^^^^^^ expected a text
",
        ),
        (
            "vary: { ranks: [1] }\nlauncher: ./mpirun -n {ranks}",
            "error: `./mpirun` in the `launcher` may start any program
 --> study.yaml:4:11
  |
4 | launcher: ./mpirun -n {ranks}
  |           ^^^^^^^^^^^^^^^^^^^ expected `mpirun`, `mpiexec` or `srun` without a path, and plain options
  |
  = help: if you trust this command, let the study start it: `--allow-commands`
",
        ),
        (
            "vary: { ranks: [1] }\nlauncher: mpirun -n {ranks} rm",
            "error: `rm` in the `launcher` may start any program
 --> study.yaml:4:11
  |
4 | launcher: mpirun -n {ranks} rm
  |           ^^^^^^^^^^^^^^^^^^^^ expected `mpirun`, `mpiexec` or `srun` without a path, and plain options
  |
  = help: if you trust this command, let the study start it: `--allow-commands`
",
        ),
        #[cfg(not(feature = "mpi"))]
        (
            "vary: { ranks: [1] }\nlauncher: mpirun -n {ranks}",
            "error: this raycost was built without MPI, which ranks need
 --> study.yaml:4:11
  |
4 | launcher: mpirun -n {ranks}
  |           ^^^^^^^^^^^^^^^^^ starts ranks
  |
  = help: install MPI (on Debian, `apt-get install libopenmpi-dev libclang-dev`), then `cargo install --path . --features mpi`
",
        ),
    ] {
        let folder = folder(&format!("title: x\nscenes: [scene.yaml]\n{lines}\n"));
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2), "{lines}");
        assert_eq!(stderr_of(&refused), expected);
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn foreign_files_in_the_folder_stay_unchanged() {
    let folder = folder(STUDY);
    let out = folder.path().join("out");
    fs::create_dir_all(out.join("run")).unwrap();
    fs::write(out.join("run/mine.txt"), "mine").unwrap();
    assert_success(&run(folder.path(), &[]));
    assert_eq!(fs::read(out.join("run/mine.txt")).unwrap(), b"mine");

    fs::remove_file(out.join("runs.jsonl")).unwrap();
    fs::write(out.join("statistics.csv"), "mine").unwrap();
    fs::remove_file(out.join("statistics.json")).unwrap();
    for entry in fs::read_dir(&out).unwrap().flatten() {
        if entry.file_name().to_string_lossy().starts_with("plot-") {
            fs::remove_file(entry.path()).unwrap();
        }
    }
    let refused = run(folder.path(), &[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        stderr_of(&refused).contains("statistics.csv"),
        "{}",
        stderr_of(&refused)
    );
    assert_eq!(fs::read(out.join("statistics.csv")).unwrap(), b"mine");
}

#[test]
fn a_duplicate_run_is_refused() {
    let folder = folder(STUDY);
    assert_success(&run(folder.path(), &[]));
    let file = folder.path().join("out/runs.jsonl");
    let text = fs::read_to_string(&file).unwrap();
    let third = text.lines().nth(2).unwrap();
    fs::write(&file, format!("{text}{third}\n")).unwrap();
    let refused = run(folder.path(), &[]);
    assert_eq!(refused.status.code(), Some(2));
    let message = stderr_of(&refused);
    assert!(message.contains("is the same run as line 3"), "{message}");
    assert!(
        fs::read_to_string(&file)
            .unwrap()
            .ends_with(&format!("{third}\n"))
    );
}
