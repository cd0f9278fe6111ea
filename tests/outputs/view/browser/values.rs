//! The page shows the values of the files.

use serde_json::json;

use super::{OBJECTS, WINDOW, array, arrays, choose, pixels, point_at_pixel, probed};
use crate::common::chromium::Chromium;
use crate::common::replace_file;
use crate::view::{SIZE, rendered, viewed};
use output::results::LoadedArray;

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn values_under_the_pointer_are_those_of_the_arrays() {
    let folder = rendered("seed_extended", &["--spp", "3"]);
    let arrays = arrays(folder.path());
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let [width, height] = SIZE;
    for (i, pane) in ["#picture", "#map"]
        .into_iter()
        .cycle()
        .take(20)
        .enumerate()
    {
        let i = i as u32;
        let [x, y] = [i * 13 % width, i * 7 % height];
        point_at_pixel(&mut browser, pane, [x, y]);
        let pixel = (y * width + x) as usize;
        for LoadedArray {
            name,
            n_components: n,
            values,
        } in &arrays
        {
            let expected: Vec<f64> = (n * pixel..n * (pixel + 1)).map(|i| values.at(i)).collect();
            let found = probed(&mut browser, name);
            let same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
            assert_eq!(found.len(), expected.len());
            assert!(
                found.iter().zip(&expected).all(same),
                "{name} at {x}, {y}: {found:?}, {expected:?}"
            );
        }
        assert_eq!(browser.text("#probe h2"), format!("Pixel {x}, {y}"));
    }
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn the_panes_show_the_picture_and_the_array() {
    let folder = rendered("seed_extended", &[]);
    let arrays = arrays(folder.path());
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let rgb = array(&arrays, "RGB").values.bytes().to_vec();
    let shown: Vec<u8> = pixels(&mut browser, "#picture")
        .into_iter()
        .flat_map(|[r, g, b, _]| [r, g, b])
        .collect();
    assert_eq!(shown, rgb);

    // Inferno grows lighter: a more expensive pixel is never darker.
    for (name, n_least) in [("time_ns", 10), ("node_visits", 3)] {
        choose(&mut browser, "#array", name);
        let lightness = |[r, g, b, _]: [u8; 4]| {
            0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
        };
        let map: Vec<f64> = pixels(&mut browser, "#map")
            .into_iter()
            .map(lightness)
            .collect();
        let mut pairs: Vec<(f64, f64)> = array(&arrays, name).values.iter().zip(map).collect();
        pairs.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert!(
            pairs.windows(2).all(|two| two[0].1 <= two[1].1 + 2.0),
            "{name}"
        );
        pairs.dedup_by_key(|(_, lightness)| *lightness as i64);
        assert!(pairs.len() >= n_least, "{name}: {} colors", pairs.len());
    }
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn every_array_is_in_the_menu_and_has_a_map() {
    let folder = rendered("seed_extended", &[]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let entries =
        browser.value("Array.from(document.querySelectorAll('#array option'), (o) => o.value)");
    let entries: Vec<String> = serde_json::from_value(entries).unwrap();
    for LoadedArray {
        name, n_components, ..
    } in arrays(folder.path())
    {
        let keys: Vec<String> = match n_components {
            1 => vec![name],
            n => (0..n).map(|i| format!("{name}.{i}")).collect(),
        };
        assert!(keys.iter().all(|key| entries.contains(key)), "{keys:?}");
    }
    for entry in entries {
        choose(&mut browser, "#array", &entry);
        browser.wait_until(&format!(
            "document.querySelector('#array').value === '{entry}'"
        ));
        let label = browser.value("document.querySelector('#array').selectedOptions[0].text");
        assert_eq!(json!(browser.text("#map-title")), label);
        browser.value("document.querySelector('#log').click()");
        browser.value("document.querySelector('#log').click()");
    }
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn the_page_opens_with_the_metric_of_the_cost_map() {
    let own = "metrics={ tests_per_ray: primitive_tests / rays }";
    for (flags, first) in [
        (&["--cost=time"][..], "time_ns"),
        (&["--cost=counters"], "node_visits"),
        (&["--cost=time", "--set", own], "tests_per_ray"),
        (&["--cost=none"], "distance"),
    ] {
        let folder = rendered("seed_extended", flags);
        let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
        browser.wait_until(&format!(
            "document.querySelector('#array').value === '{first}'"
        ));
        browser.assert_calm();
    }
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn a_range_of_the_histogram_marks_its_pixels() {
    let folder = rendered("seed_extended", &[]);
    let arrays = arrays(folder.path());
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    choose(&mut browser, "#array", "rays");
    let plain = pixels(&mut browser, "#picture");
    let [left, top, width, height] = browser.place("#ruler .field");
    let y = top + height / 2.0;
    browser.drag([left + width * 0.3, y], [left + width, y]);
    browser.wait_until("true");
    let number = |browser: &mut Chromium, id: &str| -> f64 {
        let value = browser.value(&format!("document.getElementById('{id}').value"));
        value.as_str().unwrap().parse().unwrap()
    };
    let (from, to) = (
        number(&mut browser, "mark-from"),
        number(&mut browser, "mark-to"),
    );
    let is_marked: Vec<bool> = array(&arrays, "rays")
        .values
        .iter()
        .map(|n| n >= from && n <= to)
        .collect();
    let n = is_marked.iter().filter(|marked| **marked).count();
    assert!(n > 50 && n < is_marked.len() - 50, "{from} to {to}: {n}");
    assert!(
        browser.text("#marked").starts_with(&format!("{n} pixels")),
        "{}",
        browser.text("#marked")
    );
    // Marked pixels are blue and green, the others gray.
    let marked = pixels(&mut browser, "#picture");
    let colored = marked.iter().map(|[r, _, b, _]| b > &(r + 40));
    assert!(colored.eq(is_marked));
    browser.screenshot("marked", false);
    browser.value("document.querySelector('#clear').click()");
    browser.wait_until("true");
    assert_eq!(pixels(&mut browser, "#picture"), plain);
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn the_table_sorts_filters_and_marks() {
    let folder = rendered("seed_extended", &[]);
    replace_file(folder.path(), "objects.csv", OBJECTS.as_bytes());
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let names = |browser: &mut Chromium| {
        let names = browser.value(
            "Array.from(document.querySelectorAll('#objects tbody button'), (b) => b.textContent)",
        );
        serde_json::from_value::<Vec<String>>(names).unwrap()
    };
    let evil = "<img src=x onerror=alert(1)>";
    assert_eq!(names(&mut browser), [evil, "blue ball", "unnamed"]);
    let sort_by = |browser: &mut Chromium, column: &str| {
        browser.value(&format!(
            "Array.from(document.querySelectorAll('#objects th button')).find((b) => b.textContent.startsWith('{column}')).click()"
        ));
    };
    sort_by(&mut browser, "rays");
    assert_eq!(names(&mut browser), [evil, "blue ball", "unnamed"]);
    sort_by(&mut browser, "rays");
    let first = browser.text("#objects tbody tr td:last-child");
    assert_eq!(first, "1 ms 10.0 %");
    assert_eq!(names(&mut browser), ["unnamed", "blue ball", evil]);
    let sorted =
        browser.value("document.querySelectorAll('#objects th[aria-sort=ascending]').length");
    assert_eq!(sorted, json!(1));
    browser.value("document.querySelector('#objects tbody button').click()");
    browser.wait_until("document.querySelector('#marked').textContent.includes('pixels')");
    let objects = array(&arrays(folder.path()), "object")
        .values
        .iter()
        .filter(|&object| object == 2.0)
        .count();
    assert!(
        browser
            .text("#marked")
            .contains(&format!(" {objects} pixels")),
        "{}",
        browser.text("#marked")
    );
    choose(&mut browser, "#objects select", "material");
    assert_eq!(names(&mut browser), ["blue"]);
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn the_most_expensive_pixels_are_marked_shown_and_traced() {
    let folder = rendered("seed_extended", &["--cost=counters"]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let visits = array(&arrays(folder.path()), "node_visits").values.clone();
    let mut pixels: Vec<usize> = (0..visits.iter().count()).collect();
    pixels.sort_by(|&a, &b| visits.at(b).total_cmp(&visits.at(a)).then(a.cmp(&b)));
    let [x, y] = [pixels[0] as u32 % SIZE[0], pixels[0] as u32 / SIZE[0]];
    browser.value("document.querySelector('#hottest > button').click()");
    browser.wait_until("document.querySelector('#marked').textContent.includes('3 pixels')");
    let text = browser.text("#hottest li");
    assert!(
        text.starts_with(&format!("{x}, {y} Node visits: ")),
        "{text}"
    );
    assert!(text.contains("raycost trace "), "{text}");
    assert!(text.ends_with(&format!(" --pixel {x},{y}")), "{text}");
    browser.value("document.querySelector('#hottest li button').click()");
    assert_eq!(browser.text("#probe h2"), format!("Pixel {x}, {y}"));
    browser.screenshot("hottest", true);
    browser.value("document.querySelector('#hottest > button').click()");
    browser.wait_until("!document.querySelector('#marked').textContent.includes('3 pixels')");
    browser.assert_calm();
}
