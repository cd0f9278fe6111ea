//! The action of GitHub, `action.yml`: its steps, run by bash as GitHub runs them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value as Json;
use serde_yaml::Value;

use crate::common::scenes::SMALL_SCENE;
use crate::common::{assert_success, in_repository, raycost};

/// A checkout of a project whose program is a script, with two commits.
struct Checkout {
    folder: tempfile::TempDir,
    inputs: BTreeMap<String, String>,
    outputs: BTreeMap<String, String>,
}

/// The end of a run: the exit code of the step that failed, and all that the steps printed.
struct Ended {
    code: i32,
    text: String,
}

/// What the program of the project does more after the change.
const WORSE: &str = "if [ \"$2\" = --update ]; then set -- \"$@\" --acceleration=brute_force; fi\n";

impl Checkout {
    /// Commits the scene, its budget and the program, then `change`.
    fn new(change: impl Fn(&Path)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let project = folder.path().join("checkout/part");
        fs::create_dir_all(&project).unwrap();
        fs::create_dir(folder.path().join("temp")).unwrap();
        let scene = SMALL_SCENE.replace("name: ball", "name: ball <a & b>");
        fs::write(project.join("scene.yaml"), scene).unwrap();
        write_program(&project, "");
        let budget = ["budget", "scene.yaml", "--out", "kept.json"];
        let made = raycost().args(budget).current_dir(&project).output();
        assert_success(&made.unwrap());
        let mut checkout = Self {
            folder,
            inputs: BTreeMap::new(),
            outputs: BTreeMap::new(),
        };
        checkout.git(&["init", "--quiet"]);
        checkout.commit();
        let before = checkout.git(&["rev-parse", "HEAD"]);
        change(&project);
        checkout.commit();
        let inputs = [
            ("budget", "kept.json"),
            ("program", "./built"),
            ("build", "cp program.sh built && chmod +x built"),
            ("before", before.trim()),
        ];
        for (name, value) in inputs {
            checkout.set(name, value);
        }
        checkout
    }

    fn set(&mut self, input: &str, value: &str) {
        self.inputs
            .insert(format!("inputs.{input}"), value.to_owned());
    }

    /// The folder of the project in the checkout.
    fn project(&self) -> PathBuf {
        self.folder.path().join("checkout/part")
    }

    fn temp(&self) -> PathBuf {
        self.folder.path().join("temp")
    }

    /// The folder that the action uploads.
    fn out(&self, file: &str) -> PathBuf {
        self.temp().join(&self.inputs["inputs.name"]).join(file)
    }

    fn read(&self, file: &str) -> String {
        fs::read_to_string(self.out(file)).unwrap()
    }

    fn summary(&self) -> String {
        fs::read_to_string(self.folder.path().join("summary")).unwrap_or_default()
    }

    fn git(&self, arguments: &[&str]) -> String {
        let who = [
            "-c",
            "user.name=a",
            "-c",
            "user.email=a@b.c",
            "-c",
            "commit.gpgsign=false",
        ];
        let mut git = Command::new("git");
        let git = git.args(who).args(arguments).current_dir(self.project());
        let output = git.output().unwrap();
        assert_success(&output);
        String::from_utf8(output.stdout).unwrap()
    }

    fn commit(&self) {
        self.git(&["add", "--all"]);
        self.git(&["commit", "--quiet", "--allow-empty", "--message", "a"]);
    }

    /// Runs the steps until one fails.
    fn run(&mut self) -> Ended {
        let action: Value =
            serde_yaml::from_str(&fs::read_to_string(in_repository("action.yml")).unwrap())
                .unwrap();
        for (name, input) in action["inputs"].as_mapping().unwrap() {
            let default = self.filled(input["default"].as_str().unwrap());
            let name = format!("inputs.{}", name.as_str().unwrap());
            self.inputs.entry(name).or_insert(default);
        }
        let mut text = String::new();
        for step in action["runs"]["steps"].as_sequence().unwrap() {
            if !self.holds(&step["if"]) || step["run"].is_null() {
                assert!(step["run"].is_string() || step["uses"].is_string());
                continue;
            }
            let output = self.run_step(step);
            for stream in [&output.stdout, &output.stderr] {
                text += &String::from_utf8_lossy(stream);
            }
            if !output.status.success() && !step["continue-on-error"].as_bool().unwrap_or(false) {
                let code = output.status.code().unwrap();
                return Ended { code, text };
            }
        }
        Ended { code: 0, text }
    }

    fn run_step(&mut self, step: &Value) -> Output {
        assert_eq!(step["shell"], "bash");
        let script = self.folder.path().join("step.sh");
        fs::write(&script, step["run"].as_str().unwrap()).unwrap();
        let outputs = self.folder.path().join("outputs");
        fs::write(&outputs, "").unwrap();
        let mut bash = Command::new("bash");
        bash.args(["--noprofile", "--norc", "-eo", "pipefail"])
            .arg(&script);
        let programs = [self.folder.path().join("programs")].into_iter();
        let path = std::env::var_os("PATH").unwrap();
        let path = programs.chain(std::env::split_paths(&path));
        bash.env("PATH", std::env::join_paths(path).unwrap())
            .env("GITHUB_OUTPUT", &outputs)
            .env("GITHUB_STEP_SUMMARY", self.folder.path().join("summary"))
            .env("GITHUB_ACTION_PATH", in_repository(""))
            .env("RUNNER_TEMP", self.temp())
            .current_dir(self.project());
        for (name, value) in step["env"].as_mapping().into_iter().flatten() {
            bash.env(name.as_str().unwrap(), self.filled(value.as_str().unwrap()));
        }
        let output = bash.output().unwrap();
        let id = step["id"].as_str().unwrap_or_default();
        for line in fs::read_to_string(outputs).unwrap().lines() {
            let (name, value) = line.split_once('=').unwrap();
            let name = format!("steps.{id}.outputs.{name}");
            self.outputs.insert(name, value.to_owned());
        }
        output
    }

    /// Fills in expressions; those that only GitHub knows are empty.
    fn filled(&self, text: &str) -> String {
        let mut parts = text.split("${{ ");
        let mut filled = parts.next().unwrap().to_owned();
        for part in parts {
            let (expression, rest) = part.split_once(" }}").unwrap();
            let value = self.inputs.get(expression).or(self.outputs.get(expression));
            let is_of_github =
                expression.starts_with("github.") || expression.starts_with("steps.upload.");
            assert!(value.is_some() || is_of_github, "{expression}");
            filled += value.map_or("", String::as_str);
            filled += rest;
        }
        filled
    }

    /// Returns true if a step is to run.
    fn holds(&self, condition: &Value) -> bool {
        let Some(condition) = condition.as_str() else {
            return true;
        };
        let (name, value) = condition.split_once(" == ").unwrap();
        self.outputs.get(name).map(String::as_str) == Some(value.trim_matches('\''))
    }
}

/// Writes the source of the project's program, which does something more.
fn write_program(project: &Path, more: &str) {
    let raycost = env!("CARGO_BIN_EXE_raycost");
    let script = format!("#!/usr/bin/env bash\n{more}exec '{raycost}' \"$@\"\n");
    fs::write(project.join("program.sh"), script).unwrap();
}

#[test]
fn a_change_that_makes_the_program_do_more_is_caught_and_shown() {
    let mut checkout = Checkout::new(|project| write_program(project, WORSE));
    let ended = checkout.run();
    assert_eq!(ended.code, 3, "{}", ended.text);
    assert!(
        ended
            .text
            .contains("error: more work than the budget `kept.json` allows: "),
        "{}",
        ended.text
    );

    let summary = checkout.summary();
    for line in [
        "| whole picture | primitive_tests | ",
        "| object ball <a & b> | primitive_tests | ",
        "<details><summary>raycost diff: scene</summary>",
        "primitive tests ",
        "[Cost maps before and after]()",
    ] {
        assert!(summary.contains(line), "{line}: {summary}");
    }
    let page = checkout.read("index.html");
    let pictures: Vec<&str> = page
        .split("src=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap())
        .collect();
    assert_eq!(
        pictures,
        [
            "before/scene/cost.png",
            "after/scene/cost.png",
            "diff/scene/diff.png"
        ]
    );
    assert!(
        pictures
            .iter()
            .all(|picture| checkout.out(picture).is_file())
    );
    assert!(page.contains("ball &lt;a &amp; b>"), "{page}");
    let [before, after] = ["before", "after"].map(|when| {
        let summary: Json =
            serde_json::from_str(&checkout.read(&format!("{when}/scene/summary.json"))).unwrap();
        summary["acceleration"]["kind"].clone()
    });
    assert_eq!([before, after], ["bvh", "brute_force"]);
    let badge: Json = serde_json::from_str(&checkout.read("badge.json")).unwrap();
    assert_eq!(badge["color"], "red");
    let benchmark: Json = serde_json::from_str(&checkout.read("benchmark.json")).unwrap();
    assert!(benchmark.as_array().unwrap().len() > 10);
    assert_eq!(checkout.git(&["worktree", "list"]).lines().count(), 1);
}

#[test]
fn without_a_commit_before_the_change_is_caught_all_the_same() {
    for before in ["", "0000000000000000000000000000000000000000"] {
        let mut checkout = Checkout::new(|project| write_program(project, WORSE));
        checkout.git(&["remote", "add", "origin", "."]);
        checkout.set("before", before);
        let ended = checkout.run();
        assert_eq!(ended.code, 3, "{}", ended.text);
        let summary = checkout.summary();
        assert!(
            summary.contains("There is no commit to compare with."),
            "{summary}"
        );
        assert!(!checkout.out("index.html").exists() && !summary.contains("index.html"));
    }
}

#[test]
fn uses_with_names_of_their_own_share_a_job() {
    let mut checkout = Checkout::new(|project| write_program(project, WORSE));
    let action: Value =
        serde_yaml::from_str(&fs::read_to_string(in_repository("action.yml")).unwrap()).unwrap();
    let steps = action["runs"]["steps"].as_sequence().unwrap();
    let upload = steps.iter().find(|step| step["id"] == "upload").unwrap();
    assert_eq!(upload["with"]["name"], "${{ inputs.name }}");

    assert_eq!(checkout.run().code, 3);
    assert!(checkout.out("index.html").is_file());
    checkout.set("name", "second");
    checkout.set(
        "flags",
        "--allow primitive_tests=100000%\n--allow primitive_hits=1000%\n",
    );
    let ended = checkout.run();
    assert_eq!(ended.code, 0, "{}", ended.text);
    assert!(checkout.out("badge.json").is_file() && !checkout.out("index.html").exists());
}

#[test]
fn the_budget_may_have_an_absolute_path_and_flags_may_have_stars() {
    let mut checkout = Checkout::new(|project| write_program(project, WORSE));
    let budget = checkout.project().join("kept.json");
    checkout.set("budget", budget.to_str().unwrap());
    let ended = checkout.run();
    assert_eq!(ended.code, 3, "{}", ended.text);
    assert!(checkout.out("index.html").is_file(), "{}", ended.text);
    checkout.set("flags", "--allow *");
    let ended = checkout.run();
    assert_eq!(ended.code, 2, "{}", ended.text);
    assert!(
        ended.text.contains("invalid value '*' for '--allow"),
        "{}",
        ended.text
    );
}

#[test]
fn a_change_that_is_allowed_passes() {
    let mut checkout = Checkout::new(|project| write_program(project, WORSE));
    checkout.set(
        "flags",
        "--allow primitive_tests=100000% --allow primitive_hits=1000%",
    );
    let ended = checkout.run();
    assert_eq!(ended.code, 0, "{}", ended.text);
    assert!(checkout.summary().contains(" grew within what is allowed"));
}

#[test]
fn raycost_is_installed_and_no_change_passes() {
    let mut checkout = Checkout::new(|_| {});
    checkout.set("program", "");
    let programs = checkout.folder.path().join("programs");
    fs::create_dir(&programs).unwrap();
    let raycost = env!("CARGO_BIN_EXE_raycost");
    let cargo = format!(
        "#!/usr/bin/env bash\nset -e\ntest \"${{*:1:3}}\" = 'install --locked --path'\ntest \"$5\" = --root\n\
         test -f \"$4/Cargo.toml\"\nmkdir -p \"$6/bin\"\nln -s '{raycost}' \"$6/bin/raycost\"\n"
    );
    fs::write(programs.join("cargo"), cargo).unwrap();
    let executable = Command::new("chmod")
        .arg("+x")
        .arg(programs.join("cargo"))
        .status();
    assert!(executable.unwrap().success());
    let ended = checkout.run();
    assert_eq!(ended.code, 0, "{}", ended.text);
    assert_eq!(checkout.summary(), "### `scene.yaml`: the same totals\n\n");
    assert!(!checkout.out("index.html").exists() && checkout.out("after/scene/cost.png").is_file());
}

#[test]
fn another_picture_fails_with_2() {
    let mut checkout = Checkout::new(|project| {
        fs::write(
            project.join("scene.yaml"),
            SMALL_SCENE.replace("seed: 3", "seed: 4"),
        )
        .unwrap();
    });
    let ended = checkout.run();
    assert_eq!(ended.code, 2, "{}", ended.text);
    assert!(
        ended.text.contains("is of another config"),
        "{}",
        ended.text
    );
}
