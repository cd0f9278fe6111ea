//! The README and the book are right: every command runs, every scene and study
//! parses, every link has a target.

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_yaml::{Mapping, Value};

use crate::common::{film, in_repository, parse};
use render::film::columns;
use scene::config::{Config, CostMode, Repeats};
use scene::yaml::{Document, Source};
use tools::study::StudyPlan;

/// The README and all pages of the book, by their paths in the repository.
pub fn pages() -> Vec<(String, String)> {
    let mut paths = vec!["README.md".to_owned(), "paraview/README.md".to_owned()];
    for entry in fs::read_dir(in_repository("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.ends_with(".md") {
            paths.push(format!("docs/{name}"));
        }
    }
    paths.sort();
    let page = |path: String| {
        let text = fs::read_to_string(in_repository(&path)).unwrap();
        (path, text)
    };
    paths.into_iter().map(page).collect()
}

/// The fenced blocks of a page in `language`.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let opening = format!("```{language}\n");
    let block = |rest: &str| rest.split_once("```").unwrap().0.to_owned();
    page.split(&opening).skip(1).map(block).collect()
}

fn readme() -> String {
    fs::read_to_string(in_repository("README.md")).unwrap()
}

fn scene() -> String {
    let blocks = blocks(&readme(), "yaml");
    blocks.first().expect("the README shows a scene").clone()
}

#[test]
fn the_readme_is_short() {
    assert!(readme().lines().count() <= 150);
}

/// The tests run the examples.
#[test]
fn rust_in_the_book_is_part_of_an_example() {
    let examples = fs::read_dir(in_repository("examples")).unwrap();
    // A folder is an example of several files, which no page shows.
    let examples: Vec<String> = examples
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    for (path, text) in pages() {
        for block in blocks(&text, "rust") {
            let is_example = examples.iter().any(|example| example.contains(&block));
            assert!(is_example, "{path}:\n{block}");
        }
    }
}

#[test]
fn the_scene_renders() {
    let mut config = parse(&scene());
    (config.image.width, config.image.height) = (64, 48);
    assert!(film(&config, 1).n_hits() > 1000);
}

/// The README's scene with some of its sections replaced, materials added.
fn with_sections(sections: &Mapping) -> String {
    let mut whole: Mapping = serde_yaml::from_str(&scene()).unwrap();
    for (key, section) in sections {
        match (whole.get_mut(key), section) {
            (Some(Value::Mapping(old)), Value::Mapping(new)) if key == "materials" => {
                old.extend(new.clone());
            }
            _ => {
                whole.insert(key.clone(), section.clone());
            }
        }
    }
    serde_yaml::to_string(&whole).unwrap()
}

/// The config of a scene that would lie in `configs`.
fn in_configs(text: &str) -> Config {
    let path = in_repository("configs/of_the_book.yaml");
    let source = Source::new(path.display().to_string(), text);
    let document = Document::new(source, Config::MERGING);
    let config = document.and_then(|document| document.parse());
    config.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_scene_and_study_parses_and_its_files_are_read() {
    let folder = in_repository("configs/studies");
    for (path, text) in pages() {
        for block in blocks(&text, "yaml") {
            let sections: Mapping = serde_yaml::from_str(&block).unwrap();
            if sections.contains_key("scenes") {
                let file = folder.join("of_the_book.yaml");
                let source = Source::new(file.display().to_string(), block.as_str());
                let plan: Result<StudyPlan, _> = source.parse();
                let plan = plan.unwrap_or_else(|error| panic!("{path}: {error}"));
                let checked = plan.check().map_err(|fault| source.point_at(fault));
                checked.unwrap_or_else(|error| panic!("{path}: {error}"));
                let suspect = plan.launcher.as_ref().and_then(|one| one.suspect());
                assert_eq!(suspect, None, "{path}");
                continue;
            }
            let mut config = in_configs(&with_sections(&sections));
            (config.image.width, config.image.height) = (64, 48);
            assert!(film(&config, 1).n_hits() > 100, "{path}:\n{block}");
        }
    }
}

#[test]
fn the_error_is_the_one_that_the_mistake_gives() {
    let page = fs::read_to_string(in_repository("docs/scene.md")).unwrap();
    let scene = blocks(&page, "yaml").remove(0);
    let broken = scene.replace("radius: 0.8", "radios: 0.8");
    let error = Source::new("scene.yaml", broken)
        .parse::<Config>()
        .unwrap_err();
    assert_eq!(blocks(&page, "text"), [format!("{error}\n")]);
}

/// Each page's commands run in order in a folder of their own, by a real shell; pages run beside
/// each other. Programs that are not built here have stand-ins that check what they can.
#[cfg(unix)]
#[test]
fn the_commands_run() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = folder.path().join("configs");
    copy_with_one_sample(&in_repository("configs"), &scenes);
    let run = |page| run_commands(page, &scenes);
    let n_commands: usize = pages().into_par_iter().map(run).sum();
    assert!(n_commands >= 20, "{n_commands}");
}

/// Copies a folder of scenes with one sample per pixel; links to its other files.
#[cfg(unix)]
fn copy_with_one_sample(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let from = entry.unwrap().path();
        let to = to.join(from.file_name().unwrap());
        if from.is_dir() {
            copy_with_one_sample(&from, &to);
        } else if from
            .extension()
            .is_some_and(|extension| extension == "yaml")
        {
            let text = fs::read_to_string(from).unwrap();
            let parts = text.split("samples_per_pixel: ");
            let rests: Vec<&str> = parts
                .map(|part| part.trim_start_matches(char::is_numeric))
                .collect();
            fs::write(to, rests.join("samples_per_pixel: 1")).unwrap();
        } else {
            std::os::unix::fs::symlink(from, to).unwrap();
        }
    }
}

/// Runs the commands of a page on these scenes, with few samples; returns their number.
#[cfg(unix)]
fn run_commands((path, text): (String, String), scenes: &Path) -> usize {
    let script = blocks(&text, "sh").join("\n");
    if script.is_empty() {
        return 0;
    }
    let few_samples = script.replace("--spp 16", "--spp 1");
    let few = few_samples.replace("--repeats 5", "--repeats 2");
    run_script(&path, &few, scenes);
    let is_command = |line: &&str| !line.is_empty() && !line.starts_with('#');
    script.lines().filter(is_command).count()
}

/// Runs commands of a page in a new folder, whose `configs` are these scenes; returns what they
/// print to both streams.
#[cfg(unix)]
fn run_script(path: &str, script: &str, scenes: &Path) -> String {
    let folder = tempfile::tempdir().unwrap();
    let stand_ins = stand_ins(folder.path(), scenes);
    let mut paths = vec![stand_ins];
    paths.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap()));
    let output = std::process::Command::new("bash")
        .args(["-euo", "pipefail", "-c", &format!("exec 2>&1\n{script}")])
        .current_dir(folder.path())
        .env("PATH", std::env::join_paths(paths).unwrap())
        .env("HOME", folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{path}: {said}");
    said
}

/// A block behind `<!-- output of: COMMANDS -->` shows some lines of what they print, in their order.
#[cfg(unix)]
#[test]
fn shown_outputs_are_those_of_the_commands() {
    let mut n_lines = 0;
    for (path, text) in pages() {
        for rest in text.split("<!-- output of: ").skip(1) {
            let (commands, shown) = rest.split_once(" -->\n").unwrap();
            let printed = run_script(&path, commands, &in_repository("configs"));
            let mut printed_lines = printed.lines().map(without_times);
            let shown = blocks(shown, "text").remove(0);
            let is_shown = |line: &&str| line.trim() != "..." && !line.starts_with("$ ");
            for line in shown.lines().filter(is_shown) {
                let found = printed_lines.any(|printed| printed == without_times(line));
                assert!(found, "{path}: {line}\nis not in order in:\n{printed}");
                n_lines += 1;
            }
        }
    }
    assert!(n_lines > 15, "{n_lines}");
}

/// Readers of a book of twice this length did not find what they needed.
#[test]
fn the_book_stays_short() {
    let all = pages().into_iter();
    let book: Vec<_> = all.filter(|(path, _)| path.starts_with("docs/")).collect();
    let words = book.iter().map(|(_, text)| text.split_whitespace().count());
    let n_words: usize = words.sum();
    assert!(n_words <= 26_000, "{n_words} words");
    assert!(book.len() <= 25, "{} pages with the list", book.len());
}

/// The words of a line without times, rates and numbers of threads, which are others on each machine.
#[cfg(unix)]
fn without_times(line: &str) -> String {
    let units = ["ns", "µs", "ms", "s", "Mrays/s", "threads", "thread"];
    let words: Vec<&str> = line.split_whitespace().collect();
    let is_unit = |word: &str| units.contains(&word.trim_end_matches([',', ';']));
    let is_kept = |&at: &usize| {
        let is_of_unit = words.get(at + 1).is_some_and(|next| is_unit(next));
        !is_unit(words[at]) && !is_of_unit
    };
    let kept = (0..words.len()).filter(is_kept).map(|at| words[at]);
    kept.collect::<Vec<_>>().join(" ")
}

/// Fills a folder with what the pages' commands find in the repository, and these scenes;
/// returns the folder of programs to run instead of those of the same name.
#[cfg(unix)]
fn stand_ins(folder: &Path, scenes: &Path) -> PathBuf {
    let raycost = env!("CARGO_BIN_EXE_raycost");
    std::os::unix::fs::symlink(scenes, folder.join("configs")).unwrap();
    let programs = folder.join("programs");
    let cargo = "case \"$*\" in
        'run --release -- '*) shift 3; exec raycost \"$@\" ;;
        'run --release --features profile -- '*' --profile') shift 5; exec raycost \"${@:1:$#-1}\" ;;
        install* | test* | bench* | fuzz*) ;;
        *) echo \"cargo $*: unknown\" >&2; exit 1 ;;
        esac";
    for (name, script) in [
        ("programs/cargo", cargo),
        ("programs/paraview", "test -s \"${1#--state=}\""),
        ("programs/perf", ""),
        ("programs/mpirun", "test \"$1\" = -n; shift 2; exec \"$@\""),
        ("programs/google-pprof", ""),
        // The reader's own ray tracer, of the picture of `seed_extended`.
        (
            "mine",
            "cp out/seed_extended/image.png mine.png
            printf 'Pf\\n400 300\\n-1.0\\n' > times.pfm
            head -c 480000 /dev/zero | tr '\\0' '?' >> times.pfm",
        ),
        (
            "target/release/raycost",
            &format!("exec '{raycost}' \"$@\""),
        ),
        ("programs/raycost", &format!("exec '{raycost}' \"$@\"")),
    ] {
        write_program(&folder.join(name), script);
    }
    for script in scripts() {
        write_program(&folder.join(script), "");
    }
    write_program(&folder.join("docs/measure"), "mkdir -p out/results");
    programs
}

/// The executable files of the repository's folders, by their paths.
#[cfg(unix)]
fn scripts() -> Vec<PathBuf> {
    use std::os::unix::fs::PermissionsExt;

    let folders = [
        ".ci",
        "tests",
        "docs",
        "fuzz",
        "benches/numpy",
        "benches/povray",
        "benches/instructions",
    ];
    let entries = folders
        .iter()
        .flat_map(|name| fs::read_dir(in_repository(name)).unwrap());
    let is_script = |path: &PathBuf| {
        let metadata = path.metadata().unwrap();
        metadata.is_file() && metadata.permissions().mode() & 0o111 != 0
    };
    let root = in_repository("");
    entries
        .map(|entry| entry.unwrap().path())
        .filter(is_script)
        .map(|path| path.strip_prefix(&root).unwrap().to_owned())
        .collect()
}

#[cfg(unix)]
fn write_program(path: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;

    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, format!("#!/usr/bin/env bash\n{script}\n")).unwrap();
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn every_link_within_the_repository_leads_to_a_file_or_a_heading() {
    for (path, text) in pages() {
        let page = in_repository(&path);
        for target in text.split("](").skip(1) {
            let target = target.split(')').next().unwrap();
            if target.contains("://") {
                continue;
            }
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let file = match file {
                "" => page.clone(),
                file => page.parent().unwrap().join(file),
            };
            assert!(file.exists(), "{path}: {target}");
            if !heading.is_empty() {
                let text = fs::read_to_string(&file).unwrap();
                let found = headings(&text).any(|anchor| anchor == heading);
                assert!(found, "{path}: {target}");
            }
        }
    }
}

/// The anchors of a page's headings, as GitHub and mdBook make them.
fn headings(page: &str) -> impl Iterator<Item = String> {
    let lines = page.lines().filter(|line| line.starts_with('#'));
    lines.map(|line| {
        let text = line.trim_start_matches('#').trim().to_lowercase();
        let is_kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
        text.chars()
            .filter(is_kept)
            .collect::<String>()
            .replace(' ', "-")
    })
}

#[test]
fn the_contents_list_every_page() {
    let contents = fs::read_to_string(in_repository("docs/SUMMARY.md")).unwrap();
    for (path, _) in pages() {
        if let Some(name) = path.strip_prefix("docs/") {
            let is_listed = contents.contains(&format!("]({name})"));
            assert!(is_listed || name == "SUMMARY.md", "{name}");
        }
    }
}

#[test]
fn the_tables_name_every_array() {
    let outputs = fs::read_to_string(in_repository("docs/outputs.md")).unwrap();
    for column in columns(CostMode::Time, Repeats::Auto) {
        let is_named = outputs.contains(&format!("`{}`", column.name));
        assert!(is_named, "{}", column.name);
    }
}
