//! Every scene in `configs/` renders, and says what to look at.

use std::fs;

use crate::common::{config, film, in_repository};

fn names() -> Vec<String> {
    let entries = fs::read_dir(in_repository("configs")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let yaml = paths.filter(|path| {
        path.extension()
            .is_some_and(|extension| extension == "yaml")
    });
    yaml.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect()
}

#[test]
fn every_scene_renders_something() {
    assert!(names().len() >= 6);
    for name in names() {
        let mut config = config(&name);
        (config.image.width, config.image.height) = (80, 60);
        config.image.samples_per_pixel = config.image.samples_per_pixel.min(16);
        let film = film(&config, 2);
        let n_pixels = 80 * 60;
        let mut colors: Vec<[u8; 3]> = film.values(|strip| &strip.rgb).collect();
        colors.sort_unstable();
        colors.dedup();
        assert!(colors.len() > 50, "{name} has {} colors", colors.len());
        assert!(
            film.n_hits() > n_pixels / 5,
            "{name} has {} hits",
            film.n_hits()
        );
    }
}

#[test]
fn every_scene_begins_with_what_to_look_at() {
    for name in names() {
        let text = fs::read_to_string(in_repository(&format!("configs/{name}.yaml"))).unwrap();
        let comment: Vec<&str> = text
            .lines()
            .take_while(|line| line.starts_with('#'))
            .collect();
        let says_where = comment.iter().any(|line| line.contains("Look at"));
        assert!(comment.len() >= 3 && says_where, "{name}: {comment:?}");
    }
}
