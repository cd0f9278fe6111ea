//! The page works by keyboard, and is legible in each color scheme and at each width.

use super::{OBJECTS, WINDOW, choose, n_colors};
use crate::common::chromium::Chromium;
use crate::common::replace_file;
use crate::view::{SIZE, rendered, rendered_at, viewed};

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn tab_reaches_every_control() {
    let folder = rendered("seed_extended", &[]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    // Tab reaches every control in the order of the page, with a visible focus.
    let mut reached = Vec::new();
    for _ in 0..30 {
        browser.press("Tab", false);
        let focused = browser.value(
            "(() => {
                const at = document.activeElement;
                const { outlineStyle } = getComputedStyle(at.querySelector('path') ? at.querySelector('path') : at);
                const { strokeWidth } = getComputedStyle(at.querySelector('path') ?? at);
                if (outlineStyle === 'none' && strokeWidth !== '3.5px') return 'no ring: ' + at.outerHTML;
                return at.id || at.getAttribute('aria-label');
            })()",
        );
        reached.push(focused.as_str().unwrap_or_default().to_owned());
    }
    let position = |name: &str| {
        let position = reached.iter().position(|reached| reached.starts_with(name));
        position.unwrap_or_else(|| panic!("{name} is not in {reached:?}"))
    };
    let order = [
        "array",
        "color-map",
        "log",
        "Picture",
        "Map",
        "Low end",
        "High end",
        "low",
        "high",
    ];
    let positions: Vec<usize> = order.into_iter().map(position).collect();
    assert!(positions.is_sorted(), "{reached:?}");
    for name in [
        "mark-from",
        "mark-to",
        "pin",
        "range-",
        "fit",
        "clear",
        "Hit points",
        "cloud-picture",
    ] {
        position(name);
    }
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn keys_move_the_probe_the_color_range_and_the_cloud() {
    let folder = rendered("seed_extended", &[]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    browser.value("document.querySelector('#map .pane').focus()");
    let pixel = |browser: &mut Chromium| browser.text("#probe h2");
    let hottest = browser.value("document.querySelector('#hottest ol button').textContent");
    let hottest = hottest.as_str().unwrap();
    assert_eq!(pixel(&mut browser), format!("Pixel {hottest}"));
    let (x, y) = hottest.split_once(", ").unwrap();
    let [x, y]: [u32; 2] = [x, y].map(|number| number.parse().unwrap());
    browser.press("ArrowRight", false);
    browser.press("ArrowUp", true);
    let [x, y] = [(x + 1).min(SIZE[0] - 1), y.saturating_sub(10)];
    assert_eq!(pixel(&mut browser), format!("Pixel {x}, {y}"));
    assert!(browser.text("#probe [aria-live]").contains("Time"));
    browser.press("+", false);
    assert!(
        browser
            .value("document.querySelector('#map canvas').style.transform")
            .to_string()
            .contains("scale(1.5)")
    );

    browser.value("document.querySelector('#ruler .handle').focus()");
    let low = "Number(document.querySelector('#ruler .handle').getAttribute('aria-valuenow'))";
    let before = browser.value(low).as_f64().unwrap();
    browser.press("ArrowRight", false);
    browser.press("ArrowRight", false);
    assert!(browser.value(low).as_f64().unwrap() > before);

    let canvas = browser.place("#cloud canvas");
    let before = browser.screenshot("cloud-before", false);
    browser.value("document.querySelector('#cloud canvas').focus()");
    for _ in 0..5 {
        browser.press("ArrowRight", false);
    }
    browser.wait_until("true");
    let after = browser.screenshot("cloud-turned", false);
    assert!(n_colors(&before, canvas) > 20 && before != after);
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn picture_and_map_stand_side_by_side() {
    let folder = rendered("seed_extended", &[]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    for width in [1100, 1280, 1400, 1920] {
        browser.resize(width, 900);
        let [picture, map] = ["#picture .pane", "#map .pane"].map(|pane| browser.place(pane));
        assert_eq!(picture[1..], [map[1], map[2], map[3]], "{width}");
    }
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn the_cloud_rotates_and_changes_its_colors() {
    let folder = rendered_at([200, 150], "seed_extended", &[]);
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let canvas = browser.place("#cloud canvas");
    browser.wait_until("true");
    let [x, y] = [canvas[0] + canvas[2] / 2.0, canvas[1] + canvas[3] / 2.0];
    let mut shots = vec![browser.screenshot("cloud", false)];
    let mut shoot = |browser: &mut Chromium, name: &str| {
        browser.wait_until("true");
        let shot = browser.screenshot(name, false);
        assert!(n_colors(&shot, canvas) > 20, "{name}");
        assert!(!shots.contains(&shot), "{name} changes nothing");
        shots.push(shot);
    };
    browser.value("document.querySelector('#cloud-picture').click()");
    shoot(&mut browser, "cloud-picture");
    browser.drag([x, y], [x + 150.0, y + 40.0]);
    shoot(&mut browser, "cloud-orbit");
    browser.value("document.querySelector('#cloud-picture').click()");
    choose(&mut browser, "#array", "distance");
    choose(&mut browser, "#color-map", "Viridis");
    browser.place("#cloud canvas");
    shoot(&mut browser, "cloud-distance");
    browser.assert_calm();
}

#[test]
#[ignore = "needs Chromium: run tests/with-chromium"]
fn text_has_enough_contrast_in_each_scheme_and_width() {
    let folder = rendered_at([400, 300], "seed_extended", &[]);
    replace_file(folder.path(), "objects.csv", OBJECTS.as_bytes());
    let mut browser = Chromium::open(&viewed(folder.path()), WINDOW);
    let mut backgrounds = Vec::new();
    for (scheme, [width, height]) in [
        ("light", [1400, 1900]),
        ("dark", [1400, 1900]),
        ("light", [390, 3000]),
        ("dark", [800, 2400]),
    ] {
        browser.prefer(scheme);
        browser.resize(width, height);
        browser.wait_until("true");
        browser.screenshot(&format!("{scheme}-{width}"), true);
        let overflow = browser.value("document.documentElement.scrollWidth - innerWidth");
        assert!(
            overflow.as_i64().unwrap() <= 0,
            "{scheme} {width}: {overflow}"
        );
        for selector in [
            "h1",
            "#facts",
            "figcaption",
            ".hint",
            "#probe td",
            "#probe tr.shown td",
            "#marked",
            "select",
        ] {
            let colors = browser.value(&format!(
                "(() => {{
                    let at = document.querySelector('{selector}');
                    const {{ color }} = getComputedStyle(at);
                    const clear = (element) => getComputedStyle(element).backgroundColor === 'rgba(0, 0, 0, 0)';
                    while (clear(at) && at.parentElement) at = at.parentElement;
                    return [color, getComputedStyle(at).backgroundColor];
                }})()"
            ));
            let [ink, paper]: [String; 2] = serde_json::from_value(colors).unwrap();
            assert!(
                contrast(&ink, &paper) >= 4.5,
                "{scheme} {selector}: {ink} on {paper}"
            );
        }
        backgrounds
            .push(browser.value("getComputedStyle(document.documentElement).backgroundColor"));
    }
    assert_ne!(backgrounds[0], backgrounds[1]);
    browser.assert_calm();
}

/// The contrast ratio of two CSS colors as defined by WCAG 2.
fn contrast(a: &str, b: &str) -> f64 {
    let luminance = |color: &str| {
        let channels = color
            .trim_start_matches(|c: char| !c.is_ascii_digit())
            .trim_end_matches(')');
        let linear = channels.split(',').take(3).map(|n| {
            let c = n.trim().parse::<f64>().unwrap() / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        });
        linear
            .zip([0.2126, 0.7152, 0.0722])
            .map(|(c, weight)| c * weight)
            .sum::<f64>()
    };
    let [low, high] = {
        let mut two = [luminance(a), luminance(b)];
        two.sort_by(f64::total_cmp);
        two
    };
    (high + 0.05) / (low + 0.05)
}
