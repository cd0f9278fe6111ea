//! `raycost render --profile`: with the feature `profile` it writes a flame
//! graph and changes nothing else; without, it says so.

mod common;

use std::path::Path;
use std::process::Output;

use common::in_repository;

/// Renders a scene of the repository in a folder, with flags.
fn render(folder: &Path, flags: &[&str]) -> Output {
    common::raycost()
        .arg("render")
        .arg(in_repository("configs/hall_of_mirrors.yaml"))
        // With one thread, and without times, all files are the same each time.
        .args(["--out=out", "--threads=1", "--cost=counters"])
        .args(flags)
        .current_dir(folder)
        .output()
        .unwrap()
}

#[cfg(not(feature = "profile"))]
#[test]
fn without_a_profiler_it_says_how_to_build_one() {
    let folder = tempfile::tempdir().unwrap();
    let output = render(folder.path(), &["--profile"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    let expected = "error: this raycost was built without a profiler\n";
    assert!(message.starts_with(expected), "{message}");
    assert!(message.contains("--features profile"), "{message}");
    assert!(output.stdout.is_empty() && !folder.path().join("out").exists());
}

#[cfg(feature = "profile")]
mod built {
    use std::collections::BTreeMap;
    use std::fs;

    use quick_xml::events::Event;

    use super::*;

    /// Profiles that are taken until all that is expected was seen.
    const MAX_PROFILES: usize = 20;

    /// The files of a folder by name, without the two that hold times.
    fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
        let entries = fs::read_dir(folder.join("out")).unwrap();
        let files = entries.map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, fs::read(path).unwrap())
        });
        files.filter(|(name, _)| name != "summary.json").collect()
    }

    #[test]
    fn a_profile_is_one_more_file_and_goes_with_the_next_run() {
        let folder = tempfile::tempdir().unwrap();
        assert!(render(folder.path(), &["--profile"]).status.success());
        let mut with = files(folder.path());
        let summary = fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
        assert!(summary.contains("\"file\": \"profile.svg\""), "{summary}");
        assert!(with.remove("profile.svg").is_some());

        assert!(render(folder.path(), &[]).status.success());
        let without = files(folder.path());
        assert!(with.keys().eq(without.keys()), "{:?}", without.keys());
        for (name, bytes) in &without {
            assert!(with[name] == *bytes, "sampling changes {name}");
        }
    }

    /// What the boxes of a flame graph say: the function, and its samples.
    fn boxes(svg: &str) -> Vec<String> {
        let mut reader = quick_xml::Reader::from_str(svg);
        let mut titles: Vec<String> = Vec::new();
        let mut is_title = false;
        loop {
            let text = match reader.read_event().unwrap() {
                Event::Start(tag) => {
                    is_title = tag.name().as_ref() == b"title";
                    if is_title {
                        titles.push(String::new());
                    }
                    continue;
                }
                Event::End(_) => {
                    is_title = false;
                    continue;
                }
                Event::Text(text) => text.decode().unwrap().into_owned(),
                Event::GeneralRef(name) => match name.as_ref() {
                    b"lt" => "<".to_owned(),
                    b"gt" => ">".to_owned(),
                    _ => "&".to_owned(),
                },
                Event::Eof => return titles,
                _ => continue,
            };
            if is_title {
                titles.last_mut().unwrap().push_str(&text);
            }
        }
    }

    #[test]
    fn the_flame_graph_shows_who_renders_and_who_writes() {
        let folder = tempfile::tempdir().unwrap();
        let flags = ["--profile", "--width=1600", "--height=1000", "--spp=1"];
        let expected = ["Accel::", "StreamRenderer::shade", "appended::write"];
        // Hundreds of samples each; the faster the machine, the fewer.
        let mut found = Vec::new();
        for _ in 0..MAX_PROFILES {
            let output = render(folder.path(), &flags);
            assert!(output.status.success(), "{output:?}");
            let svg = fs::read_to_string(folder.path().join("out/profile.svg")).unwrap();
            found.extend(boxes(&svg));
            let is_found = |function| found.iter().any(|text: &String| text.contains(function));
            if expected.into_iter().all(is_found) {
                // Only a thread that waits shows the scheduler.
                let is_rayon = |text: &&String| text.trim_start_matches('<').starts_with("rayon");
                let n_rayon = found.iter().filter(is_rayon).count();
                assert!(20 * n_rayon < found.len(), "{found:#?}");
                let is_handler = |text: &String| text.contains("pprof::");
                assert!(!found.iter().any(is_handler), "{found:#?}");
                return;
            }
        }
        panic!("not all of {expected:?} in {found:#?}");
    }
}
