//! The error messages for broken scenes: each mistake in `tests/broken/*.txt` gives
//! exactly its message.
//!
//! A case is a title, YAML and the message:
//!
//! ```text
//! ===== a sphere without size
//! objects: [{ sphere: { center: [0, 0, 0], radius: 0 }, material: red }]
//! -----
//! error: `objects[0].sphere.radius` cannot be `0`
//!  --> scene.yaml:1:50
//! …
//! ```
//!
//! The sections that a case does not give stand below it as in [`FINE`], so
//! that it shows its mistake alone; a title that ends in "(whole file)" keeps
//! them out. To add a case, write its title and YAML, run
//! `RAYCOST_BLESS=1 cargo test --test commands errors::`, and judge what it wrote.

use std::path::PathBuf;

use host::text::Diagnostic;
use output::estimate::Memory;
use scene::build::{Geometries, Timeline};
use scene::config::Config;
use scene::yaml::Source;

/// A scene without a mistake, a section a line.
const FINE: &str = "\
image: { width: 4, height: 3 }
camera: { look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 } }
materials: { red: { color: [1, 0, 0] } }
lights: [{ point: { position: [5, 5, 5] } }]
objects: [{ sphere: { center: [0, 0, 0], radius: 1 }, material: red }]
";

/// Words that mean nothing to somebody who writes YAML.
const JARGON: &[&str] = &[
    "u8",
    "u32",
    "u64",
    "i64",
    "i128",
    "u128",
    "f32",
    "f64",
    "usize",
    "struct",
    "enum",
    "variant",
    "tuple",
    "sequence",
    "identifier",
    "serializ",
    "scalar",
    "expected ,",
    "``",
    "None",
    "Some(",
];

const TITLE: &str = "===== ";
const ARROW: &str = "-----\n";

struct Case {
    title: String,
    yaml: String,
    message: String,
}

impl Case {
    fn of(part: &str) -> Self {
        let (title, rest) = part.split_once('\n').unwrap();
        let (yaml, message) = rest.split_once(ARROW).unwrap_or((rest, ""));
        // A new case has no message yet, and a blank line behind it.
        let lines = yaml.trim_end_matches('\n').split_inclusive('\n');
        Self {
            title: title.to_owned(),
            yaml: lines
                .map(|line| line.trim_end_matches('\n').to_owned() + "\n")
                .collect(),
            message: message.trim_end().to_owned(),
        }
    }

    /// The case as a scene of its own.
    fn scene(&self) -> String {
        let mut scene = self.yaml.clone();
        if !self.title.ends_with("(whole file)") {
            let is_missing = |section: &&str| {
                let key = &section[..=section.find(':').unwrap()];
                !self.yaml.lines().any(|line| line.starts_with(key))
            };
            scene.extend(FINE.split_inclusive('\n').filter(is_missing));
        }
        scene
    }
}

/// The files of cases: path, text before the first case, and cases.
fn files() -> Vec<(PathBuf, String, Vec<Case>)> {
    let entries = std::fs::read_dir(crate::common::in_repository("tests/broken")).unwrap();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let (head, cases) = text.split_once(TITLE).unwrap();
        let cases = cases.split(&format!("\n{TITLE}")).map(Case::of).collect();
        (path, head.to_owned(), cases)
    };
    entries.map(|entry| read(entry.unwrap().path())).collect()
}

fn cases() -> impl Iterator<Item = Case> {
    files().into_iter().flat_map(|(_, _, cases)| cases)
}

/// Checks a scene as `raycost check` does, with this many bytes of available memory.
fn check(text: &str, available: u64) -> Result<(), Diagnostic> {
    let source = Source::new("scene.yaml", text);
    let mut config: Config = source.parse()?;
    let mut check = || {
        config.check_arrays()?;
        config.check_metrics()?;
        Timeline::parse(&config, source.folder())?;
        let geometries = Geometries::read(&mut config, source.folder(), available)?;
        Memory::estimate(&config, &geometries).check(available)?;
        scene::build::scene(&config, geometries).map(drop)
    };
    check().map_err(|fault| source.point_at(fault))
}

/// The message of a broken scene, without blanks at the ends of its lines.
fn message(text: &str) -> String {
    let diagnostic = match check(text, 1 << 30) {
        Ok(()) => return "nothing wrong".to_owned(),
        Err(diagnostic) => diagnostic.to_string(),
    };
    let lines: Vec<&str> = diagnostic.lines().map(str::trim_end).collect();
    lines.join("\n")
}

#[test]
fn the_scene_around_the_mistakes_is_fine() {
    check(FINE, 1 << 30).unwrap();
}

#[test]
fn each_mistake_gets_its_message() {
    let bless = std::env::var_os("RAYCOST_BLESS").is_some();
    let mut n_cases = 0;
    for (path, mut text, cases) in files() {
        n_cases += cases.len();
        for case in &cases {
            let (title, yaml, expected) = (&case.title, &case.yaml, &case.message);
            let found = message(&case.scene());
            assert!(
                bless || found == *expected,
                "{title}: not\n{expected}\nbut\n{found}"
            );
            text += &format!("{TITLE}{title}\n{yaml}{ARROW}{found}\n\n");
        }
        if bless {
            std::fs::write(path, text.trim_end().to_owned() + "\n").unwrap();
        }
    }
    assert!(n_cases > 200);
}

#[test]
fn no_message_contains_terms_of_the_implementation() {
    for case in cases() {
        // The line shown is the user's own.
        let shown = |line: &&str| !line.starts_with(|c: char| c.is_ascii_digit());
        let words: String = case.message.lines().filter(shown).collect();
        assert!(words.starts_with("error: "), "{}: {words}", case.title);
        let jargon = JARGON.iter().find(|jargon| words.contains(**jargon));
        assert_eq!(jargon, None, "{}: {words}", case.title);
    }
}

#[test]
fn line_ends_of_other_systems_change_no_message() {
    for case in cases() {
        for end in ["\r\n", "\r"] {
            let scene = case.scene().replace('\n', end);
            assert_eq!(message(&scene), case.message, "{} with {end:?}", case.title);
        }
    }
}

#[test]
fn what_memory_cannot_hold_is_refused() {
    let image = FINE.replace("width: 4, height: 3", "width: 60000, height: 60000");
    let cloud = cloud_of(20_000_000);
    for (scene, what, line, help) in [
        (image, "image", 1, "choose a smaller `width` or `height`"),
        (
            cloud,
            "scene",
            5,
            "reduce the `count` of generators, or use smaller files",
        ),
    ] {
        let error = check(&scene, 3 << 30).unwrap_err().to_string();
        let title = format!("error: the {what} is too large: ");
        assert!(error.starts_with(&title), "{error}");
        assert!(
            error.contains(" GiB of memory are needed, 3.0 GiB are free\n"),
            "{error}"
        );
        assert!(
            error.contains(&format!("--> scene.yaml:{line}:1\n")),
            "{error}"
        );
        assert!(error.ends_with(&format!("= help: {help}")), "{error}");
    }
}

/// The fine scene with so many spheres.
fn cloud_of(n_spheres: u32) -> String {
    let cloud = format!(
        "sphere_cloud: {{ count: {n_spheres}, min: [0, 0, 0], max: [1, 1, 1], radius: 1 }}"
    );
    FINE.replace("sphere: { center: [0, 0, 0], radius: 1 }", &cloud)
}

#[test]
fn more_primitives_than_a_hierarchy_can_hold_are_refused() {
    let error = check(&cloud_of(1_000_000_000), u64::MAX)
        .unwrap_err()
        .to_string();
    let title = "error: the scene has 1000000000 primitives\n --> scene.yaml:5:1\n";
    assert!(error.starts_with(title), "{error}");
    assert!(error.contains("expected at most 268435456"), "{error}");
}

/// Values nested by brackets, by dashes, by indentation, and by aliases of aliases.
fn nested(n_levels: usize) -> [String; 5] {
    let indented = (0..n_levels).map(|n| format!("\n{}a:", " ".repeat(n + 1)));
    let alias = |n: usize| {
        format!(
            "x{n}: &x{n} [{}]\n",
            if n == 0 {
                "1".into()
            } else {
                format!("*x{}", n - 1)
            }
        )
    };
    [
        format!(
            "objects: {}1{}\n",
            "[".repeat(n_levels),
            "]".repeat(n_levels)
        ),
        format!(
            "objects: {}1{}\n",
            "{a: ".repeat(n_levels),
            "}".repeat(n_levels)
        ),
        format!("objects:\n  {}1\n", "- ".repeat(n_levels)),
        format!("objects:{} 1\n", indented.collect::<String>()),
        (0..n_levels).map(alias).collect(),
    ]
}

#[test]
fn deep_values_are_one_mistake() {
    let too_deep = "error: lists and mappings are nested too deeply\n";
    for n_levels in [128, 1_000, 20_000] {
        for text in nested(n_levels) {
            // Indentation by the level takes the square of their number.
            if text.len() > 1 << 20 {
                continue;
            }
            let message = message(&text);
            assert!(message.starts_with(too_deep), "{n_levels}: {message}");
            assert!(
                message.contains("^ expected at most 128 levels\n"),
                "{message}"
            );
            assert!(message.lines().all(|line| line.len() < 160), "{message}");
        }
    }
    for text in nested(127) {
        assert!(!message(&text).contains("nested"), "{}", message(&text));
    }
}

#[test]
fn a_long_line_is_cut_to_the_mistake() {
    let spheres = "{ sphere: { center: [0, 0, 0], radius: 1 }, material: red }, ".repeat(5000);
    let sphere = "{ sphere: { center: [0, 0, 0], radius: big }, material: red }";
    let message = message(&FINE.replace("objects: [", &format!("objects: [{spheres}{sphere}, ")));
    let position = "objects: [".len() + spheres.len() + sphere.find("big").unwrap() + 1;
    assert!(
        message.contains(&format!("--> scene.yaml:5:{position}\n")),
        "{message}"
    );
    let snippet: Vec<&str> = message.lines().skip(3).take(2).collect();
    assert!(snippet[0].len() < 160, "{message}");
    let caret = snippet[1].find("^^^").unwrap();
    assert_eq!(&snippet[0][caret..caret + 3], "big", "{message}");
}

#[test]
fn many_aliases_get_another_message_than_an_endless_file() {
    let steps = "*step, ".repeat(1000);
    let balls = "*ball, ".repeat(1000);
    let objects = format!(
        "objects: [&ball {{ sphere: {{ center: [0, 0, 0], radius: 1 }}, material: red, \
         transform: [&step {{ scale: 1 }}, {steps}] }}, {balls}]\n"
    );
    let message = message(&FINE.replace(FINE.lines().last().unwrap(), &objects));
    assert!(message.contains("expand to too many values"), "{message}");
}
