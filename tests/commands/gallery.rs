//! The gallery shows every scene of `configs/`, and what it says of their objects is true.

use std::cell::LazyCell;
use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::common::{config, in_repository};

/// Samples per pixel of the renderings.
const N_SAMPLES: u32 = 4;

/// The sections of the gallery by the names of their scenes.
fn sections() -> BTreeMap<String, String> {
    let text = fs::read_to_string(in_repository("docs/gallery.md")).unwrap();
    let sections = text.split("\n### `").skip(1);
    sections
        .map(|section| {
            let (name, rest) = section.split_once('`').unwrap();
            (name.to_owned(), rest.to_owned())
        })
        .collect()
}

#[test]
fn every_scene_has_a_section_with_its_picture() {
    let sections = sections();
    for entry in fs::read_dir(in_repository("configs")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            let name = path.file_stem().unwrap().to_str().unwrap();
            let section = sections
                .get(name)
                .unwrap_or_else(|| panic!("`{name}` is not shown"));
            let picture = format!("](images/gallery/{name}.webp)");
            assert!(section.contains(&picture), "{name}");
            assert!(
                section.contains(&format!("Try `raycost render configs/{name}.yaml")),
                "{name}"
            );
        }
    }
}

/// Counters per pixel of each object, by its name and the kind of rays, from `objects.csv`.
struct Costs(BTreeMap<(String, String), BTreeMap<String, f64>>);

/// Renders a small picture of a scene.
fn render(scene: &str, flags: &[&str]) -> tempfile::TempDir {
    let image = config(scene).image;
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_raycost"))
        .arg("render")
        .arg(in_repository(&format!("configs/{scene}.yaml")))
        .args(["--quiet", "--cost=counters", "--width=80"])
        .arg(format!("--height={}", 80 * image.height / image.width))
        .arg(format!("--spp={N_SAMPLES}"))
        .args(flags)
        .arg("--out")
        .arg(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{scene}: {said}");
    folder
}

/// Renders a frame of an animation; returns the sum of a counter.
fn sum_of_frame(scene: &str, frame: &str, counter: &str) -> f64 {
    let folder = render(scene, &["--frames", frame]);
    let name = format!("frames/{:04}/summary.json", frame.parse::<u32>().unwrap());
    let summary = fs::read(folder.path().join(name)).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    summary["cost"]["totals"][counter].as_f64().unwrap()
}

impl Costs {
    fn measure(scene: &str) -> Self {
        let folder = render(scene, &["--also=objects"]);
        let table = fs::read_to_string(folder.path().join("objects.csv")).unwrap();
        let mut lines = table.lines().map(|line| line.split(',').collect());
        let head: Vec<&str> = lines.next().unwrap();
        // A name may have commas: the other columns are counted from both ends.
        let n_after = head.len() - 3;
        let mut costs = BTreeMap::new();
        for row in lines {
            let (name, after) = (&row[2..row.len() - n_after], &row[row.len() - n_after..]);
            if row[0] != "object" || after[0] != "primary" {
                continue;
            }
            let values = head[3..].iter().zip(after).skip(2);
            let values =
                values.map(|(column, value)| ((*column).to_owned(), value.parse().unwrap()));
            let name = name.join(",").trim_matches('"').to_owned();
            costs.insert((name, after[1].to_owned()), values.collect());
        }
        Self(costs)
    }

    /// A counter per pixel of an object, such as `node_visits` or `diffuse_rays`.
    fn per_pixel(&self, counter: &str, object: &str) -> f64 {
        if object == "samples" {
            return f64::from(N_SAMPLES);
        }
        let (kind, column) = match counter.strip_suffix("_rays") {
            Some(kind) => (kind, "rays"),
            None => ("all", counter),
        };
        let row = self.0.get(&(object.to_owned(), kind.to_owned()));
        let row = row.unwrap_or_else(|| panic!("there is no object `{object}`"));
        assert!(row["pixels"] > 20.0, "`{object}` is hardly seen");
        row[column] / row["pixels"]
    }
}

/// A claim reads `node_visits: glass cow > 1.5 * clay cow`, or `node_visits: frame 19 > 2 * frame 0`.
#[test]
fn the_claims_are_true() {
    let mut n_claims = 0;
    for (scene, section) in sections() {
        let claims = section.split("<!-- claim: ").skip(1);
        let claims: Vec<&str> = claims
            .map(|rest| rest.split_once(" -->").unwrap().0)
            .collect();
        if claims.is_empty() {
            continue;
        }
        let costs = LazyCell::new(|| Costs::measure(&scene));
        let cost = |counter: &str, subject: &str| match subject.strip_prefix("frame ") {
            Some(frame) => sum_of_frame(&scene, frame, counter),
            None => costs.per_pixel(counter, subject),
        };
        for claim in claims {
            let (counter, rest) = claim.split_once(": ").unwrap();
            let (left, right) = rest.split_once(" * ").unwrap();
            let (left, is_greater, factor) = match left.split_once(" > ") {
                Some((left, factor)) => (left, true, factor),
                None => {
                    let (left, factor) = left.split_once(" < ").unwrap();
                    (left, false, factor)
                }
            };
            let ratio = cost(counter, left) / cost(counter, right);
            let factor: f64 = factor.parse().unwrap();
            assert_eq!(
                ratio > factor,
                is_greater,
                "{scene}: {claim}: it is {ratio}"
            );
            n_claims += 1;
        }
    }
    assert!(n_claims > 30, "{n_claims}");
}
