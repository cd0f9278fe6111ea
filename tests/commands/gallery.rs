//! The gallery shows every scene of `configs/`, and its numbers are those of a rendering.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::rc::Rc;

use serde_json::Value;

use crate::common::data_set::DataSet;
use crate::common::{config, in_repository};
use crate::figures::compare;
use crate::figures::quoted::{Quote, documents};

/// Width of the renderings, which docs/gallery.md states.
const WIDTH: u32 = 120;
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

/// The counters of one rendering.
struct Costs {
    /// Counters and numbers of pixels of each object, by its name and the kind of rays, from `objects.csv`; none for an
    /// animation.
    objects: BTreeMap<(String, String), BTreeMap<String, f64>>,
    totals: Value,
    /// The medians of [`SAMPLES`], if they are written, over the pixels of each object and of the `picture`.
    medians: BTreeMap<(&'static str, String), f64>,
}

impl Costs {
    /// Renders a small picture of a scene.
    fn measure(scene: &str, flags: &[String]) -> Self {
        let image = config(scene).image;
        let folder = tempfile::tempdir().unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_raycost"));
        command
            .arg("render")
            .arg(in_repository(&format!("configs/{scene}.yaml")))
            .args(["--quiet", "--cost=counters", "--also=objects"])
            .args(flags)
            .arg("--out")
            .arg(folder.path());
        // Idle lanes depend on the size: of the pixels of a warp.
        if !flags.iter().any(|flag| flag == "--also=lanes") {
            command.arg(format!("--width={WIDTH}"));
            command.arg(format!("--height={}", WIDTH * image.height / image.width));
        }
        if !flags.iter().any(|flag| flag.starts_with("--spp")) {
            command.arg(format!("--spp={N_SAMPLES}"));
        }
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{scene}: {said}");
        let frames = fs::read_dir(folder.path().join("frames")).ok();
        let frame = frames.map(|mut frames| frames.next().unwrap().unwrap().path());
        let folder = frame.unwrap_or(folder.path().to_owned());
        let summary = fs::read(folder.join("summary.json")).unwrap();
        let mut summary: Value = serde_json::from_slice(&summary).unwrap();
        Self {
            objects: read_objects(&fs::read_to_string(folder.join("objects.csv")).unwrap()),
            medians: read_medians(&folder.join("frame.vti")),
            totals: summary["cost"]["totals"].take(),
        }
    }

    /// A counter per pixel of an object, such as `node_visits` or `diffuse_rays`.
    fn per_pixel(&self, counter: &str, object: &str) -> f64 {
        let (kind, column) = match counter.strip_suffix("_rays") {
            Some(kind) => (kind, "rays"),
            None => ("all", counter),
        };
        let row = self.objects.get(&(object.to_owned(), kind.to_owned()));
        let row = row.unwrap_or_else(|| panic!("there is no object `{object}`"));
        assert!(row["pixels"] > 20.0, "`{object}` is hardly seen");
        row[column] / row["pixels"]
    }
}

/// The rows of objects by what is seen first.
fn read_objects(table: &str) -> BTreeMap<(String, String), BTreeMap<String, f64>> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let head = reader.headers().unwrap().clone();
    let mut objects = BTreeMap::new();
    for row in reader.records().map(Result::unwrap) {
        if &row[0] != "object" || &row[3] != "primary" {
            continue;
        }
        let values = head.iter().zip(&row).skip(5);
        let values = values.map(|(column, value)| (column.to_owned(), value.parse().unwrap()));
        objects.insert((row[2].to_owned(), row[4].to_owned()), values.collect());
    }
    objects
}

fn read_medians(frame: &Path) -> BTreeMap<(&'static str, String), f64> {
    let frame = DataSet::read(frame);
    let objects: Vec<i32> = frame.array("object").i32s().collect();
    let names = frame.texts("object_names").iter().zip(0..);
    let names = names.map(|(name, object)| (name.as_str(), Some(object)));
    let mut medians = BTreeMap::new();
    for (name, object) in names.chain([("picture", None)]) {
        for (array, _) in SAMPLES {
            let Some(found) = frame.arrays.iter().find(|found| found.name == array) else {
                continue;
            };
            let pixels = found.f32s().zip(&objects);
            let values = pixels.filter(|(value, at)| {
                !value.is_nan() && object.is_none_or(|object| **at == object)
            });
            let mut values: Vec<f32> = values.map(|(value, _)| value).collect();
            values.sort_by(f32::total_cmp);
            if let Some(median) = values.get(values.len() / 2) {
                medians.insert((array, name.to_owned()), f64::from(*median));
            }
        }
    }
    medians
}

/// Arrays, and the values of `--also` that write them.
const SAMPLES: [(&str, &str); 3] = [
    ("noise", "noise"),
    ("efficiency", "noise"),
    ("idle_lanes", "lanes"),
];

/// The renderings of scenes by their flags, each made once.
#[derive(Default)]
struct Renderings(RefCell<BTreeMap<(String, String), Rc<Costs>>>);

impl Renderings {
    /// The counter of a subject: an object; `picture`; `frame N`; `samples`. Flags of the rendering follow ` with `. Of
    /// [`SAMPLES`], the median.
    fn cost(&self, scene: &str, counter: &str, subject: &str) -> f64 {
        let (subject, flags) = subject.split_once(" with ").unwrap_or((subject, ""));
        let frame = subject.strip_prefix("frame ");
        let flags = frame.map_or(flags.to_owned(), |frame| format!("--frames={frame}"));
        if let Some((array, also)) = SAMPLES.into_iter().find(|(array, _)| *array == counter) {
            let costs = self.render(scene, &format!("--also={also} {flags}"));
            return costs.medians[&(array, subject.to_owned())];
        }
        let costs = self.render(scene, &flags);
        match subject {
            "samples" => f64::from(N_SAMPLES),
            "picture" => costs.totals[counter].as_f64().unwrap(),
            _ if frame.is_some() => costs.totals[counter].as_f64().unwrap(),
            object => costs.per_pixel(counter, object),
        }
    }

    fn render(&self, scene: &str, flags: &str) -> Rc<Costs> {
        let mut made = self.0.borrow_mut();
        let costs = made.entry((scene.to_owned(), flags.to_owned()));
        let flags = flags.split("--").skip(1);
        let flags: Vec<String> = flags.map(|flag| format!("--{}", flag.trim_end())).collect();
        Rc::clone(costs.or_insert_with(|| Rc::new(Costs::measure(scene, &flags))))
    }
}

/// A number reads `<!-- ratio: node_visits, glass cow / clay cow -->2.0<!-- /ratio -->`.
#[test]
fn every_number_is_that_of_a_rendering() {
    let gallery = documents()
        .into_iter()
        .filter(|document| document.name() == "gallery.md");
    let gallery: Vec<_> = gallery.collect();
    let sections: Vec<(usize, &str)> = gallery[0].text.match_indices("\n### ").collect();
    let renderings = Renderings::default();
    compare(&gallery, "ratio", |quote: &Quote| {
        let (at, title) = sections
            .iter()
            .rfind(|(at, _)| *at < quote.range.start)
            .unwrap();
        let section = &gallery[0].text[at + title.len()..];
        let scene = section.split('`').nth(1).unwrap();
        let (counter, subjects) = quote.name.split_once(", ").unwrap();
        let (above, below) = subjects.split_once(" / ").unwrap();
        let [above, below] = [above, below].map(|of| renderings.cost(scene, counter, of));
        number(above / below)
    });
}

/// Two significant digits, or as many as show a small difference from 1.
fn number(ratio: f64) -> String {
    let n_decimals = match ratio {
        10.0.. => 0,
        1.0 => 0,
        _ if (ratio - 1.0).abs() < 0.005 => 3,
        _ if (ratio - 1.0).abs() < 0.05 || ratio < 1.0 => 2,
        _ => 1,
    };
    format!("{ratio:.n_decimals$}")
}
