//! Several studies in one command.

use std::fs;
use std::path::Path;
use std::process::Output;

use scene::yaml::{self, Source, json_of, to_yaml};
use serde_json::Value;
use tools::study::{FlagFactor, StudyPlan};

use super::{STUDY, folder, stderr_of};
use crate::common::{assert_success, in_repository, raycost};

/// Runs `raycost study` with these arguments in a folder.
fn study(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = raycost();
    let command = command.current_dir(folder).arg("study");
    command.args(arguments).output().unwrap()
}

#[test]
fn several_studies_each_have_a_folder() {
    let folder = folder(STUDY);
    let path = folder.path();
    fs::write(path.join("other.yaml"), STUDY.replace("small", "second")).unwrap();
    assert_success(&study(path, &["study.yaml", "other.yaml", "--quick"]));
    let held = |name: &str| fs::read_to_string(path.join("out/studies").join(name)).unwrap();
    for name in ["study-quick", "other-quick"] {
        assert_eq!(held(&format!("{name}/runs.jsonl")).lines().count(), 17);
    }
    let statistics: Value = serde_json::from_str(&held("other-quick/statistics.json")).unwrap();
    assert_eq!(statistics["title"], "A second study");

    // A folder selects all of its studies.
    fs::create_dir_all(path.join("configs/studies")).unwrap();
    let there = STUDY.replace("scene.yaml", "../../scene.yaml");
    fs::write(path.join("configs/studies/third.yaml"), &there).unwrap();
    assert_success(&study(
        path,
        &["configs/studies", "other.yaml", "--out", "all"],
    ));
    assert!(path.join("all/third/runs.jsonl").exists());
    assert!(path.join("all/other/statistics.csv").exists());
    // No argument selects `configs/studies`.
    assert_success(&study(path, &[]));
    assert!(path.join("out/studies/third/runs.jsonl").exists());
}

#[test]
fn a_mistake_in_one_of_several_studies_stops_all() {
    let folder = folder(STUDY);
    let path = folder.path();
    let refused = |arguments: &[&str], expected: &str| {
        let refused = study(path, arguments);
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(
            stderr_of(&refused).contains(expected),
            "{}",
            stderr_of(&refused)
        );
    };
    fs::write(path.join("broken.yaml"), "title: x\nscenes: []").unwrap();
    refused(&["study.yaml", "broken.yaml"], "cannot be an empty list");
    fs::create_dir_all(path.join("a")).unwrap();
    refused(&["a"], "`a` has no study");
    fs::copy(path.join("study.yaml"), path.join("a/study.yaml")).unwrap();
    refused(&["study.yaml", "a"], "would both write to");
    refused(&[], "there is no folder `configs/studies` here");
    refused(&["nothing.yaml"], "there is no study `nothing.yaml`");
    assert!(!path.join("out").exists(), "nothing is measured");

    // RunLog of others, in the last of the folders.
    let theirs = path.join("out/studies/study/runs.jsonl");
    fs::create_dir_all(theirs.parent().unwrap()).unwrap();
    fs::write(&theirs, "the notes of somebody\n").unwrap();
    fs::copy(path.join("study.yaml"), path.join("first.yaml")).unwrap();
    refused(&["first.yaml", "study.yaml"], "holds no results");
    let first = fs::read_to_string(path.join("out/studies/first/runs.jsonl")).unwrap();
    assert_eq!(first.lines().count(), 1, "nothing is measured");
    assert_eq!(
        fs::read_to_string(&theirs).unwrap(),
        "the notes of somebody\n"
    );
}

#[test]
fn the_page_on_studies_lists_all_factors() {
    let page = fs::read_to_string(in_repository("docs/study.md")).unwrap();
    for name in FlagFactor::NAMES {
        assert!(page.contains(&format!("`{name}`")), "{name} is missing");
    }
}

#[test]
fn the_studies_of_the_repository_are_valid() {
    let folders = [
        "configs/studies",
        "configs/studies/ranks",
        "configs/studies/16_cores",
    ];
    let entries = folders.map(|folder| fs::read_dir(in_repository(folder)).unwrap());
    let paths = entries
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().path());
    for path in paths.filter(|path| path.is_file()) {
        let source = Source::read(&path).unwrap();
        let plan: StudyPlan = source.parse().unwrap_or_else(|error| panic!("{error}"));
        let written = to_yaml(&json_of(&plan).unwrap());
        assert_eq!(yaml::from_str::<StudyPlan>(&written).unwrap(), plan);
        assert!(!plan.plots.is_empty() && plan.quick.is_some(), "{path:?}");
        plan.check()
            .unwrap_or_else(|fault| panic!("{path:?}: {fault:?}"));
        for point in plan.points().iter().chain(&plan.into_quick().points()) {
            let scene = path.with_file_name("").join(&point.scene);
            assert!(scene.exists(), "{scene:?}");
        }
    }
}
