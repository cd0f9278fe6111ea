//! A budget holds the totals of `summary.json`, passes on every number of threads, and fails for any
//! growth of the work.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::{Value, json};

use crate::common::scenes::SMALL_SCENE as SCENE;
use crate::common::{assert_success, in_repository, raycost};
use tools::budget::{CostBudget, SceneBudget};

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.yaml"), SCENE).unwrap();
    folder
}

fn budget(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = raycost();
    let command = command.arg("budget").args(arguments);
    command.current_dir(folder).output().unwrap()
}

/// Runs the command, which has to succeed; returns what it prints.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = budget(folder, arguments);
    assert_success(&output);
    assert!(output.stderr.is_empty());
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the command, which has to fail; returns what it prints and its message.
fn failed(folder: &Path, arguments: &[&str], exit_code: i32) -> [String; 2] {
    let output = budget(folder, arguments);
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(output.status.code(), Some(exit_code), "{out}{err}");
    [out, err]
}

/// The message of a refusal.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let [out, message] = failed(folder, arguments, 2);
    assert_eq!(out, "");
    message
}

fn read(folder: &Path, file: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(file)).unwrap()).unwrap()
}

/// Changes the file of the scene.
fn replace(folder: &Path, from: &str, to: &str) {
    assert!(SCENE.contains(from));
    fs::write(folder.join("scene.yaml"), SCENE.replace(from, to)).unwrap();
}

#[test]
fn the_totals_are_those_of_the_summary_and_the_sums_over_objects_and_kinds_of_rays() {
    let folder = folder();
    let folder = folder.path();
    let size = ["--width=60", "--height=50", "--spp=2"];
    let wrote = printed(folder, &[&["scene.yaml"][..], &size].concat());
    assert!(wrote.starts_with("wrote   budget.json ("), "{wrote}");
    assert!(wrote.ends_with("): the totals of 1 scene\n"), "{wrote}");
    let render = ["render", "scene.yaml", "--also=tests,objects", "--out=out"];
    let mut command = raycost();
    let output = command.args(render).args(size).current_dir(folder).output();
    assert_success(&output.unwrap());

    let scene = &read(folder, "budget.json")["scenes"][0];
    let summary = read(folder, "out/summary.json");
    assert_eq!(scene["image"], summary["image"]);
    let mut expected = summary["cost"]["totals"].clone();
    expected.as_object_mut().unwrap().shift_remove("time_ns");
    assert_eq!(scene["totals"], expected);
    assert!(expected["box_tests"].as_u64() > expected["node_visits"].as_u64());

    let mut rows = csv::Reader::from_path(folder.join("out/objects.csv")).unwrap();
    let names = rows.headers().unwrap().clone();
    let at = |name| names.iter().position(|other| other == name).unwrap();
    let mut n_rows = 0;
    for row in rows.records().map(Result::unwrap) {
        let [kind, name, charge, rays] =
            ["kind", "name", "charge", "ray_kind"].map(|key| &row[at(key)]);
        if kind != "object" || charge != "primary" || rays == "all" {
            continue;
        }
        for counter in ["rays", "node_visits", "primitive_tests"] {
            let total = &scene["objects"][name][rays][counter];
            let expected: u64 = row[at(counter)].parse().unwrap();
            assert_eq!(
                total.as_u64().unwrap_or(0),
                expected,
                "{name} {rays} {counter}"
            );
        }
        n_rows += 1;
    }
    assert_eq!(n_rows, 4 * 5);
    let objects = scene["objects"].as_object().unwrap();
    assert_eq!(
        objects.keys().collect::<Vec<_>>(),
        ["ball", "plane 1", "sphere_cloud 2", "nothing"]
    );
    let kinds = objects
        .values()
        .flat_map(|kinds| kinds.as_object().unwrap().values());
    let visits: u64 = kinds
        .map(|rays| rays["node_visits"].as_u64().unwrap())
        .sum();
    assert_eq!(json!(visits), scene["totals"]["node_visits"]);
}

#[test]
fn a_budget_has_the_same_bytes_on_every_number_of_threads_and_passes() {
    let folder = folder();
    let folder = folder.path();
    let scenes = [
        "scene.yaml",
        &in_repository("configs/hopper.yaml").display().to_string(),
    ];
    let flags = ["--width=24", "--height=18", "--quiet"];
    let files = ["1", "2"].map(|threads| {
        let out = format!("{threads}.json");
        let run = ["--threads", threads, "--out", &out];
        assert_eq!(printed(folder, &[&scenes, &flags[..], &run].concat()), "");
        fs::read(folder.join(out)).unwrap()
    });
    assert!(files[0] == files[1]);
    printed(folder, &[&scenes[..], &flags].concat());
    let expected = format!(
        "scene.yaml --width=24 --height=18: the same totals\n\
         {} --width=24 --height=18: the same totals\n",
        scenes[1]
    );
    for threads in ["--threads=1", "--threads=2"] {
        // Settings that change neither the picture nor the work.
        let other = ["--tile-size=8", "--cost=time", "--repeats=2"];
        assert_eq!(printed(folder, &["--check", threads]), expected);
        printed(folder, &[&["--check", threads][..], &other].concat());
    }
}

/// Nothing is rendered before a scene that cannot be read, or a mesh that is not there.
#[test]
fn all_scenes_are_checked_before_the_first_is_rendered() {
    let folder = folder();
    let folder = folder.path();
    let keep = ["--keep=kept", "--quiet"];
    let message = refused(
        folder,
        &[&["scene.yaml", "missing.yaml"], &keep[..]].concat(),
    );
    let expected = "error: cannot read the scene `missing.yaml`: ";
    assert!(message.starts_with(expected), "{message}");
    let mesh = format!("{SCENE}  - mesh: {{ file: none.obj }}\n    material: red\n");
    fs::write(folder.join("mesh.yaml"), mesh).unwrap();
    let message = refused(folder, &[&["scene.yaml", "mesh.yaml"], &keep[..]].concat());
    assert!(message.contains("none.obj"), "{message}");
    let crop = ["--crop=30,20,5,5", "--set=image.width=34"];
    let message = refused(folder, &[&["scene.yaml", "scene.yaml"], &crop[..]].concat());
    assert!(message.contains("--crop"), "{message}");

    printed(folder, &["scene.yaml", "--quiet"]);
    fs::write(folder.join("other.yaml"), SCENE).unwrap();
    printed(folder, &["scene.yaml", "other.yaml", "--quiet"]);
    fs::remove_file(folder.join("other.yaml")).unwrap();
    let message = refused(folder, &["--check", "--keep=kept"]);
    assert!(
        message.starts_with("error: cannot read the scene `other.yaml`: "),
        "{message}"
    );
    assert!(!folder.join("kept").exists());
}

#[test]
fn a_budget_of_a_frame_has_the_totals_of_that_frame() {
    let folder = folder();
    let folder = folder.path();
    let scene = in_repository("configs/hopper.yaml").display().to_string();
    for hierarchy in ["rebuild", "refit"] {
        let set = format!("--set=animation.hierarchy={hierarchy}");
        let size = [&set, "--width=24", "--height=18", "--quiet"];
        printed(folder, &[&[&scene, "--frame=3"][..], &size].concat());
        let render = [
            "render",
            &scene,
            "--frames=3",
            "--also=tests",
            "--out",
            hierarchy,
        ];
        let mut command = raycost();
        let output = command.args(render).args(size).current_dir(folder).output();
        assert_success(&output.unwrap());
        let summary = read(folder, &format!("{hierarchy}/frames/0003/summary.json"));
        let mut expected = summary["cost"]["totals"].clone();
        expected.as_object_mut().unwrap().shift_remove("time_ns");
        let scene = &read(folder, "budget.json")["scenes"][0];
        assert_eq!((&scene["totals"], &scene["frame"]), (&expected, &json!(3)));
        let text = printed(folder, &["--check"]);
        assert!(text.ends_with(" --frame=3: the same totals\n"), "{text}");
    }
}

/// `RAYCOST_BLESS=1` measures the scenes anew.
#[test]
fn the_scenes_of_this_project_keep_to_their_budget() {
    let file = "tests/budget.json";
    let folder = in_repository("");
    if std::env::var_os("RAYCOST_BLESS").is_some() {
        printed(&folder, &["--update", file]);
    }
    let output = budget(&folder, &["--check", file]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    assert!(
        report
            .lines()
            .all(|line| line.ends_with(": the same totals")),
        "{report}"
    );
}

#[test]
fn more_work_for_the_same_picture_ends_with_3_and_a_table() {
    let folder = folder();
    let folder = folder.path();
    replace(folder, "materials", "acceleration: bvh\nmaterials");
    printed(folder, &["scene.yaml"]);
    replace(folder, "materials", "acceleration: brute_force\nmaterials");
    let [table, message] = failed(folder, &["--check"], 3);
    let lines: Vec<&str> = table.lines().collect();
    assert!(
        lines[0].starts_with("scene.yaml: ") && lines[0].contains(" totals grew"),
        "{table}"
    );
    let words = |line: &str| {
        line.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        words(lines[1]),
        ["part", "counter", "budget", "now", "change"]
    );
    assert_eq!(
        words(lines[2])[..3],
        ["whole", "picture", "primitive_tests"]
    );
    let n = lines[0].split_whitespace().nth(1).unwrap();
    let expected = format!(
        "error: more work than the budget `budget.json` allows: {n} totals grew\n |\n = help: if the growth is \
         meant, `raycost budget --update budget.json`, or allow some by `--allow`\n"
    );
    assert_eq!(message, expected);

    // The same by a flag, and from totals that were measured before.
    replace(folder, "materials", "acceleration: bvh\nmaterials");
    let by_flag = failed(
        folder,
        &["--check", "budget.json", "--acceleration=brute_force"],
        3,
    );
    assert_eq!(by_flag[1], expected);
    printed(
        folder,
        &["--update", "--acceleration=brute_force", "--out=now.json"],
    );
    assert_eq!(
        read(folder, "now.json")["scenes"][0]["flags"],
        json!(["--acceleration=brute_force"])
    );
    let measured = ["--check", "--measured=now.json"];
    assert_eq!(failed(folder, &measured, 3), by_flag);

    allows_counters_one_by_one(folder, &measured);
}

/// Growth that is allowed passes, counter by counter.
fn allows_counters_one_by_one(folder: &Path, measured: &[&str]) {
    let counters = [
        "node_visits",
        "primitive_tests",
        "box_tests",
        "box_hits",
        "primitive_hits",
    ];
    let check = |limit: &str, n: usize| {
        let allow = counters[..n]
            .iter()
            .map(|counter| format!("--allow={counter}={limit}"));
        let allow: Vec<String> = allow.collect();
        let allow: Vec<&str> = allow.iter().map(String::as_str).collect();
        budget(folder, &[measured, &allow].concat())
    };
    let passed = check("100000%", counters.len());
    assert_success(&passed);
    let text = String::from_utf8(passed.stdout).unwrap();
    assert!(
        text.contains(" totals grew within what is allowed"),
        "{text}"
    );
    assert!(text.contains(" % (allowed)\n"), "{text}");
    assert_eq!(check("0.001%", counters.len()).status.code(), Some(3));
    assert_eq!(check("100000%", 1).status.code(), Some(3));
}

#[test]
fn a_gain_passes_and_an_update_keeps_it() {
    let folder = folder();
    let folder = folder.path();
    // A hierarchy saves tests, and has the node visits that there are none of without it.
    printed(folder, &["scene.yaml", "--acceleration=brute_force"]);
    let before = read(folder, "budget.json");
    let [table, _] = failed(folder, &["--check", "--acceleration=high"], 3);
    assert!(
        table.contains(" new\n") && table.contains(" shrank\n"),
        "{table}"
    );
    printed(
        folder,
        &["--update", "--acceleration=high", "--out=high.json"],
    );
    assert_eq!(read(folder, "budget.json"), before);
    printed(folder, &["--update", "--acceleration=high", "--quiet"]);
    assert_eq!(read(folder, "budget.json"), read(folder, "high.json"));

    let mut less = read(folder, "budget.json")["scenes"].take();
    less[0]["totals"]["box_hits"] = json!(less[0]["totals"]["box_hits"].as_u64().unwrap() - 1);
    let now: Vec<SceneBudget> = serde_json::from_value(less).unwrap();
    CostBudget::new(now)
        .write(&folder.join("less.json"))
        .unwrap();
    let text = printed(folder, &["--check", "--measured=less.json"]);
    let update = "update the budget to keep the gain: raycost budget --update budget.json\n";
    assert!(
        text.starts_with("scene.yaml --acceleration=high: 1 total shrank\n"),
        "{text}"
    );
    assert!(
        text.ends_with(update) && text.contains("  -1  -0.02 %\n"),
        "{text}"
    );
    let [_, message] = failed(
        folder,
        &["--check", "less.json", "--measured=budget.json"],
        3,
    );
    assert!(
        message.contains("the budget `less.json` allows: 1 total grew\n"),
        "{message}"
    );
}

#[test]
fn a_budget_of_another_picture_is_refused() {
    let folder = folder();
    let folder = folder.path();
    printed(folder, &["scene.yaml"]);
    let help = "\n |\n = help: a budget compares the work of one picture: if the new one is meant, \
                `raycost budget --update`\n";
    let message = refused(folder, &["--check", "--seed=4"]);
    let of_seed =
        "error: the budget of `scene.yaml --seed=4` is of another picture: image.seed: 0 → 4";
    assert_eq!(message, format!("{of_seed}{help}"));
    let message = refused(folder, &["--check", "--width=20", "--spp=4"]);
    let of_size = "error: the budget of `scene.yaml --width=20 --spp=4` is of another picture: \
                   image.width: 50 → 20, image.samples_per_pixel: 1 → 4";
    assert_eq!(message, format!("{of_size}{help}"));
    for (flag, changed) in [
        ("--crop=1,2,40,30", "image.window: null → {"),
        (
            "--until-noise=0.02",
            "image.adaptive: null → {\"noise\":0.02,",
        ),
        (
            "--set=image.sampler=sobol",
            "image.sampler: null → \"sobol\"",
        ),
    ] {
        let message = refused(folder, &["--check", "--width=50", "--height=50", flag]);
        assert!(message.contains(changed), "{message}");
    }
    let message = refused(folder, &["--check", "--set=background=0.2"]);
    let of_config = "is of another config: the scene, or a file that it names, has changed";
    assert_eq!(
        message,
        format!("error: the budget of `scene.yaml --set=background=0.2` {of_config}{help}")
    );
    replace(folder, "reflection: 0.3", "reflection: 0.2");
    let message = refused(folder, &["--check"]);
    assert_eq!(
        message,
        format!("error: the budget of `scene.yaml` {of_config}{help}")
    );
    let message = refused(folder, &["--check", "--measured=none.json", "--seed=3"]);
    assert!(
        message.starts_with("error: flags that change a scene need a rendering"),
        "{message}"
    );
    let message = refused(folder, &["--check", "--measured=none.json"]);
    assert!(
        message.starts_with("error: cannot read `none.json`: "),
        "{message}"
    );

    fs::write(folder.join("scene.yaml"), SCENE).unwrap();
    printed(folder, &["scene.yaml", "scene.yaml", "--out=two.json"]);
    let message = refused(folder, &["--check", "two.json", "--measured=budget.json"]);
    assert!(
        message.contains("of 2 scenes, the measured totals are of 1 scene\n"),
        "{message}"
    );
    fs::rename(folder.join("scene.yaml"), folder.join("other.yaml")).unwrap();
    printed(folder, &["other.yaml", "--out=other.json"]);
    let message = refused(folder, &["--check", "--measured=other.json"]);
    assert!(
        message.starts_with("error: the budget is of `scene.yaml`, not of `other.yaml`\n"),
        "{message}"
    );
    let message = refused(folder, &["--check"]);
    assert!(
        message.starts_with("error: cannot read the scene `scene.yaml`: "),
        "{message}"
    );
}

#[test]
fn a_file_that_is_not_a_budget_of_this_version_is_refused() {
    let folder = folder();
    let folder = folder.path();
    let message = refused(folder, &["--check"]);
    assert!(
        message.starts_with("error: cannot read `budget.json`: "),
        "{message}"
    );
    assert!(
        message.ends_with("= help: write one: `raycost budget SCENE`\n"),
        "{message}"
    );
    printed(folder, &["scene.yaml"]);
    let text = fs::read_to_string(folder.join("budget.json")).unwrap();
    let check = |text: &str| {
        fs::write(folder.join("budget.json"), text).unwrap();
        refused(folder, &["--check"])
    };

    let anew = "\n |\n = help: measure it anew: `raycost budget SCENE --out budget.json`\n";
    let message = check(&text.replace("\"raycost_budget\": 1", "\"raycost_budget\": 2"));
    let version = "error: `budget.json` has version 2 of budgets, this raycost has 1";
    assert_eq!(message, format!("{version}{anew}"));
    let message = check(&text.replace("\"rays\": ", "\"rays\": 1"));
    assert_eq!(
        message,
        format!("error: `budget.json` was changed after raycost wrote it{anew}")
    );
    let message = check(&text.replace("\"totals\"", "\"totale\""));
    assert!(
        message.starts_with("error: `budget.json` is not a budget: unknown field `totale`"),
        "{message}"
    );
    assert!(message.contains("--> budget.json:"), "{message}");
    let message = check(SCENE);
    let expected = "\
error: `budget.json` is not a budget: expected value at line 2 column 1
 --> budget.json:2:1
  |
2 | image: { width: 50, height: 40 }
  | ^ not as raycost writes it
  |
  = help: write one: `raycost budget SCENE`
";
    assert_eq!(message, expected);
    for n in (0..text.len() - 1).step_by(97) {
        assert!(check(&text[..n]).starts_with("error: `budget.json` is not a budget: "));
    }

    // The file of another program stays.
    fs::write(folder.join("budget.json"), "{}\n").unwrap();
    let [_, message] = failed(folder, &["scene.yaml"], 1);
    assert!(
        message.contains("raycost did not write the file that is there"),
        "{message}"
    );
    assert_eq!(fs::read(folder.join("budget.json")).unwrap(), b"{}\n");
}

#[test]
fn a_budget_replaces_no_other_file_of_raycost() {
    let folder = folder();
    let folder = folder.path();
    let mut render = raycost();
    let render = render.args(["render", "scene.yaml", "--quiet", "--out=out"]);
    assert_success(&render.current_dir(folder).output().unwrap());
    let before = fs::read(folder.join("out/summary.json")).unwrap();
    let message = refused(folder, &["scene.yaml", "--out=out/summary.json"]);
    assert!(
        message.contains("choose another file with `--out`"),
        "{message}"
    );
    assert_eq!(fs::read(folder.join("out/summary.json")).unwrap(), before);
}

#[test]
fn scenes_with_one_folder_for_their_files_are_refused() {
    let folder = folder();
    let folder = folder.path();
    fs::copy(folder.join("scene.yaml"), folder.join("scene.yml")).unwrap();
    let keep = ["scene.yaml", "scene.yml", "--keep=kept"];
    let message = refused(folder, &keep);
    let begin = "error: `--keep` has one folder, `scene`, for `scene.yaml` and `scene.yml`\n";
    assert!(message.starts_with(begin), "{message}");
    printed(folder, &["scene.yaml", "scene.yml"]);
    let message = refused(folder, &["--check", "--keep=kept"]);
    assert!(message.starts_with(begin), "{message}");
    assert!(!folder.join("kept").exists());
    fs::rename(folder.join("scene.yml"), folder.join("a \"<b>.yml")).unwrap();
    printed(folder, &["scene.yaml", "a \"<b>.yml", "--keep=kept"]);
    assert!(folder.join("kept/a---b-/summary.json").is_file());
}

#[test]
fn a_wrong_command_line_is_refused() {
    let folder = folder();
    let folder = folder.path();
    for (arguments, expected) in [
        (
            &["--check", "--allow=node_visits"][..],
            "expected a counter and a percentage",
        ),
        (
            &["--check", "--allow=node_visit=1%"],
            "`node_visit` is not a counter: did you mean `node_visits`?",
        ),
        (
            &["--check", "--allow=time_ns=1%"],
            "`time_ns` is not a counter: expected one of node_visits, ",
        ),
        (
            &["--check", "--allow=rays=1"],
            "expected a percentage of at least 0",
        ),
        (&["scene.yaml", "--allow=rays=1%"], "--check"),
        (
            &["scene.yaml", "--format=badge"],
            "`--format badge` shows the result of a check",
        ),
        (
            &["scene.yaml", "--also=tests"],
            "this command does not write optional outputs",
        ),
        (&["-"], "a budget cannot measure standard input again"),
        (
            &["scene.yaml", "--frame=1"],
            "there is no frame 1: the scene is a still",
        ),
        (
            &["--check", "budget.json", "other.json"],
            "cannot be used with",
        ),
        (&["--check", "--out=other.json"], "cannot be used with"),
        (&[], "<SCENE>"),
        (
            &["--check", "budget.json", "--measured=now.json"],
            "cannot read `budget.json`",
        ),
    ] {
        let message = refused(folder, arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(!folder.join("budget.json").exists());
}

#[test]
fn other_formats_are_read_by_other_programs() {
    let folder = folder();
    let folder = folder.path();
    let json = |text: String| serde_json::from_str::<Value>(&text).unwrap();
    let written = json(printed(folder, &["scene.yaml", "--format=benchmark-json"]));
    let checked = json(printed(folder, &["--check", "--format=benchmark-json"]));
    assert_eq!(written, checked);
    let scene = &read(folder, "budget.json")["scenes"][0];
    let totals = scene["totals"].as_object().unwrap();
    let entries = written.as_array().unwrap();
    assert_eq!(entries.len(), totals.len());
    for (entry, (counter, total)) in entries.iter().zip(totals) {
        let expected = json!({
            "name": format!("scene.yaml: {counter}"), "unit": counter.replace('_', " "), "value": total,
            "extra": format!("seed 0, config {}", scene["config"].as_str().unwrap()),
        });
        assert_eq!(*entry, expected);
    }
    let badge = |message: &str, color: &str| json!({ "schemaVersion": 1, "label": "render cost", "message": message, "color": color });
    let passed = printed(folder, &["--check", "--format=badge"]);
    assert_eq!(json(passed), badge("within budget", "brightgreen"));
    printed(
        folder,
        &["--update", "--acceleration=brute_force", "--out=now.json"],
    );
    let check = ["--check", "--measured=now.json", "--format"];
    let [markdown, message] = failed(folder, &[&check[..], &["markdown"]].concat(), 3);
    let n = message
        .split(" allows: ")
        .nth(1)
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap();
    let [text, _] = failed(folder, &[&check[..], &["badge"]].concat(), 3);
    assert_eq!(json(text), badge(&format!("{n} totals grew"), "red"));
    let begin = format!("### `scene.yaml --acceleration=brute_force`: {n} totals grew");
    assert!(markdown.starts_with(&begin), "{markdown}");
    assert!(
        markdown.contains("\n| part | counter | budget | now | change | |\n"),
        "{markdown}"
    );
    assert!(
        markdown.contains("\n| whole picture | primitive_tests | "),
        "{markdown}"
    );
}
