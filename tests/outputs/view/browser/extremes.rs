//! Renderings that are tiny, large, without cost, or have hostile names.

use std::fs;

use serde_json::json;

use super::{WINDOW, array, arrays, choose, probed};
use crate::common::chromium::Chromium;
use crate::common::replace_file;
use crate::view::{render, rendered, viewed};

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn a_rendering_without_cost_shows_its_geometry() {
    let folder = rendered("seed_sphere", &["--no-cost"]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    assert_eq!(browser.text("#map-title"), "Distance");
    assert!(browser.text("#notes").contains("without `--no-cost`"));
    assert!(
        browser
            .text("#objects .placeholder")
            .contains("--also objects")
    );
    browser.screenshot("no-cost", false);
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn pixels_of_a_window_have_their_places_in_the_picture() {
    let folder = rendered("seed_extended", &["--cost=counters", "--crop=9,4,20,15"]);
    let visits = array(&arrays(folder.path()), "node_visits").values.clone();
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    for [x, y] in [[0, 0], [7, 11], [19, 14]] {
        let share = |i: usize, n: f64| (i as f64 + 0.5) / n;
        point_at_share(&mut browser, share(x, 20.0), share(y, 15.0));
        let title = format!("Pixel {}, {}", 9 + x, 4 + y);
        assert_eq!(browser.text("#probe h2"), title);
        assert_eq!(probed(&mut browser, "node_visits"), [visits.at(y * 20 + x)]);
    }
    browser.value("document.querySelector('#hottest li button').click()");
    let title = browser.text("#probe h2");
    let place = browser.text("#hottest li button");
    assert_eq!(title, format!("Pixel {place}"));
    browser.screenshot("window", false);
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn an_empty_rendering_and_a_single_pixel_are_shown() {
    let sphere = "{ center: [0, 0, 0], radius: 0.001 }";
    for (name, flags) in [
        ("empty", ["--width", "9", "--height", "4"]),
        ("pixel", ["--width", "1", "--height", "1"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.yaml");
        fs::write(&scene, small_scene(sphere, "plain")).unwrap();
        render(&scene, folder.path(), &flags);
        let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
        browser.screenshot(name, false);
        let placeholder = browser.place("#cloud .placeholder");
        assert!(
            placeholder[3] > 0.0
                && browser
                    .text("#cloud .placeholder")
                    .contains("no hit points")
        );
        browser.assert_calm();
    }
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn names_in_the_scene_are_never_markup() {
    let evil = "</script><script>document.title = 'owned'</script><b>{{script}}&amp;";
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("<b>scene & {{about}}.yaml");
    fs::write(
        &scene,
        small_scene("{ center: [0, 0, 0], radius: 1 }", evil),
    )
    .unwrap();
    render(&scene, folder.path(), &["--width", "20", "--height", "20"]);
    // The name of an array may be hostile, too.
    let frame = folder.path().join("frame.vti");
    let bytes = fs::read(&frame).unwrap();
    let name = b"Name=\"shadow_rays\"";
    let at = bytes.windows(name.len()).position(|window| window == name);
    let (before, after) = bytes.split_at(at.unwrap());
    let evil_name = b"Name=\"&quot;&gt;&lt;b&gt;.0\"";
    let changed = [before, evil_name, &after[name.len()..]].concat();
    replace_file(folder.path(), "frame.vti", &changed);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    assert_eq!(browser.text("h1"), "<b>scene & {{about}}");
    point_at_share(&mut browser, 0.5, 0.5);
    let values = browser.text("#probe tbody");
    assert!(
        values.contains(evil) && values.contains("\"><b>.0"),
        "{values}"
    );
    choose(&mut browser, "#array", "\"><b>.0");
    assert_eq!(browser.text("#map-title"), "\"><b>.0");
    assert_eq!(
        browser.value("document.querySelectorAll('b').length"),
        json!(0)
    );
    assert_ne!(browser.value("document.title"), json!("owned"));
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn a_large_rendering_is_subsampled_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.yaml");
    fs::write(
        &scene,
        small_scene("{ center: [0, 0, 0], radius: 1.5 }", "plain"),
    )
    .unwrap();
    render(
        &scene,
        folder.path(),
        &["--width", "2400", "--height", "1600", "--cost", "counters"],
    );
    let arrays = arrays(folder.path());
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let notes = browser.text("#notes");
    assert!(notes.contains("2,400 x 1,600 pixels"), "{notes}");
    assert!(notes.contains("hit points, at the shown pixels"), "{notes}");
    let [width, height] = [0, 1].map(|axis| {
        let n = browser.value(&format!(
            "JSON.parse(document.getElementById('about').textContent).size[{axis}]"
        ));
        n.as_u64().unwrap()
    });
    assert!(width * height > 2_000_000 && width * height <= 1920 * 1080);
    point_at_share(&mut browser, 0.431, 0.507);
    let title = browser.text("#probe h2");
    let (x, y) = title
        .strip_prefix("Pixel ")
        .unwrap()
        .split_once(", ")
        .unwrap();
    let [x, y]: [usize; 2] = [x, y].map(|n| n.parse().unwrap());
    assert!(x.abs_diff(1034) <= 2 && y.abs_diff(811) <= 2, "{title}");
    let distance = array(&arrays, "distance").values.at(y * 2400 + x);
    assert_eq!(probed(&mut browser, "distance"), [distance]);
    browser.screenshot("large", true);
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn the_cloud_of_a_whole_picture_has_all_points() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.yaml");
    fs::write(
        &scene,
        small_scene("{ center: [0, 0, 0], radius: 10 }", "plain"),
    )
    .unwrap();
    let flags = ["--width", "800", "--height", "550"];
    render(&scene, folder.path(), &flags);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    assert_eq!(browser.text("#notes"), "");
    let cloud = browser.value("JSON.parse(document.getElementById('about').textContent).cloud");
    assert_eq!(cloud, json!({ "n": 440_000, "n_all": 440_000 }));
    browser.assert_calm();
}

fn small_scene(sphere: &str, material: &str) -> String {
    let material = json!(material);
    format!(
        "
image: {{ width: 9, height: 9 }}
camera:
  look_at: {{ eye: [0, 0, 5], target: [0, 0.01, 0], fov_y_deg: 40 }}
materials:
  {material}: {{ color: 1 }}
lights: []
objects:
  - sphere: {sphere}
    name: {material}
    material: {material}
"
    )
}

/// Moves the pointer to a position given as fractions of the picture's size.
fn point_at_share(browser: &mut Chromium, x: f64, y: f64) {
    let [left, top, width, height] = browser.place("#picture canvas");
    browser.point("mouseMoved", left + x * width, top + y * height);
}
