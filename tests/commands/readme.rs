//! What the README shows is what happens.

use std::process::Command;

use crate::common::{film, in_repository, parse};
use raycost::config::Config;
use raycost::yaml::Source;

/// The blocks of the README that begin with three backquotes and `language`.
fn blocks(language: &str) -> Vec<String> {
    let readme = std::fs::read_to_string(in_repository("README.md")).unwrap();
    let opening = format!("```{language}\n");
    let block = |rest: &str| rest.split_once("```").unwrap().0.to_owned();
    readme.split(&opening).skip(1).map(block).collect()
}

fn scene() -> String {
    blocks("yaml")
        .first()
        .expect("the README shows a scene")
        .clone()
}

#[test]
fn the_scene_renders() {
    let mut config = parse(&scene());
    (config.image.width, config.image.height) = (64, 48);
    assert!(film(&config, 1).n_hits() > 1000);
}

#[test]
fn the_files_of_the_second_scene_are_read() {
    let scene = scene();
    let (before, _) = scene.split_once("objects:").unwrap();
    let mut config = parse(&format!("{before}{}", blocks("yaml")[1]));
    (config.image.width, config.image.height) = (64, 48);
    assert!(film(&config, 1).n_hits() > 300);
}

#[test]
fn the_error_is_the_one_that_the_mistake_gives() {
    let broken = scene().replace("radius: 0.8", "radios: 0.8");
    let error = Source::new("scene.yaml", broken)
        .parse::<Config>()
        .unwrap_err();
    let shown = blocks("text");
    assert_eq!(shown, [format!("{error}\n")]);
}

#[test]
fn the_commands_run() {
    let folder = tempfile::tempdir().unwrap();
    let commands = blocks("sh").join("\n");
    let arguments = commands.lines().filter_map(|line| {
        let line = line.split(['#', '>']).next()?.trim();
        line.strip_prefix("cargo run --release -- ")
            .or(line.strip_prefix("raycost "))
    });
    let mut n_commands = 0;
    for arguments in arguments {
        let output = Command::new(env!("CARGO_BIN_EXE_raycost"))
            .args(
                arguments
                    .split_whitespace()
                    .map(|word| match word.starts_with("configs/") {
                        true => in_repository(word).into_os_string(),
                        false => word.into(),
                    }),
            )
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{arguments}: {output:?}");
        n_commands += 1;
    }
    assert!(n_commands >= 2);
}

#[test]
fn the_tables_name_every_scene_and_array() {
    let readme = std::fs::read_to_string(in_repository("README.md")).unwrap();
    for entry in std::fs::read_dir(in_repository("configs")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(readme.contains(&format!("| `{name}` |")), "{name}");
    }
    for column in raycost::film::columns(raycost::config::CostMode::Time, 2) {
        assert!(
            readme.contains(&format!("`{}`", column.name)),
            "{}",
            column.name
        );
    }
}
