//! The probe, marks, ranges and long names are visible and work.

use std::fs;

use serde_json::json;

use super::{WINDOW, choose, point_at_pixel, probed};
use crate::common::chromium::Chromium;
use crate::view::{SIZE, render, rendered, rendered_at, viewed};

/// Clicks the center of a pixel of a pane.
fn click_pixel(browser: &mut Chromium, pane: &str, [x, y]: [u32; 2]) {
    let [left, top, width, height] = browser.place(&format!("{pane} canvas"));
    let at = |begin, size, i, n| begin + size * (f64::from(i) + 0.5) / f64::from(n);
    let (x, y) = (at(left, width, x, SIZE[0]), at(top, height, y, SIZE[1]));
    for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
        browser.point(kind, x, y);
    }
}

fn is_pinned(browser: &mut Chromium) -> bool {
    let pressed = browser.value("document.querySelector('#pin').getAttribute('aria-pressed')");
    pressed == json!("true")
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn a_click_pins_the_probe_until_escape_or_another_click() {
    let folder = rendered("seed_extended", &[]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let ring = "getComputedStyle(document.querySelector('#picture .cursor')).boxShadow";
    let free = browser.value(ring);
    click_pixel(&mut browser, "#picture", [7, 9]);
    assert!(is_pinned(&mut browser));
    assert_ne!(browser.value(ring), free, "the pin cannot be seen");
    browser.screenshot("pinned", false);
    point_at_pixel(&mut browser, "#map", [30, 20]);
    assert_eq!(browser.text("#probe h2"), "Pixel 7, 9");
    browser.press("Escape", false);
    assert!(!is_pinned(&mut browser));
    assert_eq!(browser.value(ring), free);
    point_at_pixel(&mut browser, "#map", [31, 20]);
    assert_eq!(browser.text("#probe h2"), "Pixel 31, 20");

    click_pixel(&mut browser, "#map", [31, 21]);
    click_pixel(&mut browser, "#map", [12, 13]);
    assert!(!is_pinned(&mut browser));
    assert_eq!(browser.text("#probe h2"), "Pixel 12, 13");

    // By keyboard: arrow keys move the pinned probe, which announces its changes.
    browser.value("document.querySelector('#picture .pane').focus()");
    browser.press("Enter", false);
    assert!(is_pinned(&mut browser));
    assert!(
        browser
            .text("#probe [aria-live]")
            .starts_with("Pinned. Pixel 12, 13")
    );
    browser.press("ArrowRight", false);
    point_at_pixel(&mut browser, "#picture", [30, 20]);
    assert_eq!(browser.text("#probe h2"), "Pixel 13, 13");
    browser.press("Enter", false);
    assert!(!is_pinned(&mut browser));
    browser.value("document.querySelector('#pin').click()");
    assert!(is_pinned(&mut browser));
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn a_single_marked_pixel_is_outlined() {
    // One of 480,000 pixels, each smaller than a pixel of the screen.
    let folder = rendered_at([800, 600], "seed_extended", &["--cost", "counters"]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    choose(&mut browser, "#array", "RGB.0");
    let mark = |browser: &mut Chromium, from: &str, to: &str| {
        for (id, value) in [("mark-from", from), ("mark-to", to)] {
            browser.value(&format!(
                "(() => {{
                    const field = document.getElementById('{id}');
                    field.value = '{value}';
                    field.dispatchEvent(new Event('change'));
                }})()"
            ));
        }
        browser.wait_until("true");
    };
    choose(&mut browser, "#array", "distance");
    // The farthest pixel of all.
    let farthest = browser.value(
        "document.querySelector('#range-all').click(); document.querySelector('#high').value",
    );
    let farthest: f64 = farthest.as_str().unwrap().parse().unwrap();
    mark(&mut browser, &(farthest * 0.99999).to_string(), "1e30");
    let said = browser.text("#marked");
    let (n, _) = said.split_once(" pixels").unwrap();
    assert!(n.parse::<u32>().unwrap() < 20, "{said}");
    for pane in ["#picture", "#map", "#cloud"] {
        let [left, top, width, height] = browser.place(&format!("{pane} canvas"));
        let shot = browser.screenshot("outlined", false);
        let within = |x: u32, y: u32| {
            let (x, y) = (f64::from(x), f64::from(y));
            x >= left && y >= top && x < left + width && y < top + height
        };
        let is_near = |a: u8, b: u8| a.abs_diff(b) <= 4;
        let is_outline =
            |[r, g, b, _]: [u8; 4]| is_near(r, 0x5f) && is_near(g, 0xe3) && is_near(b, 0xff);
        let n_outline = shot
            .enumerate_pixels()
            .filter(|(x, y, pixel)| within(*x, *y) && is_outline(pixel.0))
            .count();
        assert!(n_outline >= 12, "{pane}: {n_outline} pixels of outlines");
    }
    browser.value("document.querySelector('#clear').click()");
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn outliers_leave_the_histogram_and_the_colors_wide() {
    let folder = rendered("seed_extended", &["--spp", "2"]);
    // One pixel takes a second, as if it was interrupted.
    let frame = folder.path().join("frame.vti");
    let mut bytes = fs::read(&frame).unwrap();
    let times = super::array(&super::arrays(folder.path()), "time_ns").clone();
    let one = |i: usize| (times.values.at(i) as f32).to_le_bytes();
    let run = [one(600), one(601), one(602)].concat();
    let at = bytes.windows(run.len()).position(|window| window == run);
    let at = at.expect("the frame stores its times uncompressed");
    bytes[at..at + 4].copy_from_slice(&1e9_f32.to_le_bytes());
    fs::write(&frame, bytes).unwrap();
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let ends = |browser: &mut Chromium| {
        let high = "Number(document.querySelector('#high').value)";
        let axis = "Number(document.querySelector('#ruler .handle').getAttribute('aria-valuemax'))";
        [high, axis].map(|end| browser.value(end).as_f64().unwrap())
    };
    for log in [true, false] {
        let wanted = browser.value("document.querySelector('#log').checked") == json!(log);
        if !wanted {
            browser.value("document.querySelector('#log').click()");
        }
        browser.value("document.querySelector('#range-middle').click()");
        let [high, axis] = ends(&mut browser);
        assert!(high < 1e8 && axis < 1e8, "{log}: {high}, {axis}");
        let note = browser.text("#ruler-note");
        assert!(note.contains("up to 1 s"), "{note}");
        browser.screenshot(&format!("outlier-log-{log}"), false);
        browser.value("document.querySelector('#range-all').click()");
        let [high, axis] = ends(&mut browser);
        assert!((high / 1e9 - 1.0).abs() < 1e-3 && (axis / 1e9 - 1.0).abs() < 1e-3);
        assert!(!browser.text("#ruler-note").contains("up to"));
    }
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn long_names_stay_within_their_panels() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.yaml");
    let long = "a_name_without_any_space".repeat(10);
    let text = fs::read_to_string(crate::common::in_repository("configs/seed_extended.yaml"));
    let text = text.unwrap();
    let named = text.replacen("  - sphere:", &format!("  - name: {long}\n    sphere:"), 1);
    assert_ne!(named, text);
    fs::write(&scene, named).unwrap();
    let flags = ["--width", "40", "--height", "30", "--also", "objects"];
    render(&scene, folder.path(), &flags);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let objects = super::arrays(folder.path());
    let objects = &super::array(&objects, "object").values;
    let pixel = objects.iter().position(|object| object == 0.0).unwrap() as u32;
    point_at_pixel(&mut browser, "#picture", [pixel % SIZE[0], pixel / SIZE[0]]);
    assert!(browser.text("#probe [data-array=object]").contains(&long));
    browser.value(&format!(
        "Array.from(document.querySelectorAll('#objects tbody button')).find((b) => b.textContent === '{long}').click()"
    ));
    browser.wait_until("document.querySelector('#marked').textContent.includes('pixels')");
    for width in [1400, 800, 390] {
        browser.resize(width, 2600);
        browser.wait_until("true");
        browser.screenshot(&format!("long-names-{width}"), true);
        let outside = browser.value(
            "(() => {
                const outside = [];
                for (const panel of document.querySelectorAll('#probe, #ruler, .fields')) {
                    const { left, right } = panel.getBoundingClientRect();
                    for (const part of panel.querySelectorAll('td, th, data, .name + span, output, input, button')) {
                        if (part.getClientRects().length === 0) continue;
                        const place = part.getBoundingClientRect();
                        if (place.left < left - 1 || place.right > right + 1) outside.push(part.outerHTML);
                    }
                }
                if (document.documentElement.scrollWidth > innerWidth) outside.push('the page');
                return outside;
            })()",
        );
        assert_eq!(outside, json!([]), "{width}");
    }
    assert_eq!(probed(&mut browser, "object"), [0.0]);
    browser.assert_calm();
}
