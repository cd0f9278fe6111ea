//! `bvh.vtu`, `surface.vtu` and `objects.csv` hold the cost attribution: as the formats
//! say, and as VTK reads them.

use std::collections::HashMap;
use std::fs::{self, File};
use std::path::Path;

use bytemuck::NoUninit;

use crate::common::data_set::{Array, DataSet, units};
use crate::common::kept::kept;
use crate::common::{assert_success, config, in_repository, parse, raycost, with_cost};
use glam::Vec3;
use output::writers::{write_nodes, write_surface};
use render::attribution::{Hierarchy, Visits};
use scene::config::{BvhLimits, Config, CostMode};
use tracer::cost::RayKind;
use vtk::Codec;
use world::geometry::{RenderSpace, Shape};
use world::scene::Scene;

read_both_ways! {
    triangles: small("spot", CostMode::Time);
    boxes_and_a_disk: small("blocks", CostMode::Counters);
    spheres_and_triangles: small("trellis", CostMode::Time);
    an_ellipsoid: small("textures", CostMode::Counters);
    a_plane_alone: parse(PLANE);
}

const PLANE: &str = "
image: { width: 20, height: 10 }
camera:
  look_at: { eye: [0, 1, 5], target: [0, 0, 0], fov_y_deg: 40 }
materials:
  gray: { color: 0.5 }
lights: []
objects:
  - plane: { point: [0, 0, 0], normal: [0, 1, 0] }
    material: gray
";

fn small(name: &str, cost: CostMode) -> Config {
    let mut config = with_cost(config(name), cost);
    (config.image.width, config.image.height) = (40, 30);
    config.image.samples_per_pixel = 1;
    config
}

/// Writes the two files of a scene and compares what `read` finds in them.
fn check(config: &Config, read: fn(&Path) -> DataSet) {
    let (scene, _, attribution) = kept(config, 2);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file.vtu");
    let create = || File::create(&file).unwrap();
    let hierarchy = attribution.hierarchy.unwrap();
    let all = BvhLimits::default();
    let some = BvhLimits {
        max_depth: 2,
        min_visits: 20,
    };
    for limits in [all, some] {
        write_nodes(
            &hierarchy,
            None,
            RenderSpace::default(),
            limits,
            config.cost,
            Codec::None,
            &mut create(),
        )
        .unwrap();
        assert_eq!(read(&file), expected_nodes(&hierarchy, limits, config.cost));
    }
    let visits = attribution.primitives.unwrap();
    write_surface(&scene, &visits, config.cost, Codec::None, &mut create()).unwrap();
    let expected = expected_surface(&scene, &visits, config.cost);
    assert_eq!(read(&file), expected);
}

fn expected_nodes(hierarchy: &Hierarchy, limits: BvhLimits, cost: CostMode) -> DataSet {
    let costs = hierarchy.costs();
    let shown: Vec<usize> = (0..hierarchy.nodes.len())
        .filter(|&i| hierarchy.nodes[i].depth <= limits.max_depth)
        .filter(|&i| hierarchy.visits[i].n >= limits.min_visits)
        .collect();
    let node = |i: &usize| hierarchy.nodes[*i];
    let visits = |i: &usize| hierarchy.visits[*i];
    let is_empty = shown.is_empty();
    let shown = || shown.iter();
    let mut arrays = vec![
        array("node", "UInt32", shown().map(|i| node(i).id)),
        array("depth", "UInt32", shown().map(|i| node(i).depth)),
        array("is_leaf", "UInt8", shown().map(|i| node(i).is_leaf as u8)),
        array(
            "primitives",
            "UInt32",
            shown().map(|i| node(i).n_primitives),
        ),
        array("sah_cost", "Float32", shown().map(|i| node(i).sah_cost)),
        array("measured_cost", "Float32", shown().map(|i| costs[*i])),
    ];
    arrays.extend(visit_arrays(["visits", "wasted_visits"], cost, || {
        shown().map(visits)
    }));
    if !is_empty {
        let epo = shown().map(|i| node(i).epo.unwrap());
        let at = arrays.len() - usize::from(cost == CostMode::Time);
        arrays.insert(at, array("epo", "Float32", epo));
    }
    let (mut points, n) = (Vec::new(), shown().len());
    for i in shown() {
        let bounds = node(i).bounds;
        for z in [bounds.min.z, bounds.max.z] {
            for y in [bounds.min.y, bounds.max.y] {
                points.extend([bounds.min.x, bounds.max.x].map(|x| [x, y, z]));
            }
        }
    }
    let voxels = std::iter::repeat_n((8, 11), n);
    grid(arrays, points, voxels)
}

/// The summary rates the hierarchy as `bvh.vtu` does its root; overlap only if it is measured.
#[test]
fn the_summary_has_the_overlap_of_the_root() {
    for (scene, also, has_overlap) in [
        ("trellis", "bvh", true),
        ("trellis", "objects", false),
        ("herd", "bvh", false),
    ] {
        let out = tempfile::tempdir().unwrap();
        let mut command = raycost();
        let command = command
            .arg("render")
            .arg(in_repository(&format!("configs/{scene}.yaml")))
            .args([
                "--quiet",
                "--cost=counters",
                "--spp=1",
                "--width=16",
                "--height=12",
            ])
            .arg(format!("--also={also}"))
            .arg("--out")
            .arg(out.path());
        assert_success(&command.output().unwrap());
        let text = fs::read(out.path().join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let bvh = &summary["acceleration"]["bvh"];
        assert_eq!(bvh["epo"].is_number(), has_overlap, "{scene} {also}: {bvh}");
        assert!(bvh["leaf_cost"].as_f64() < bvh["sah_cost"].as_f64());
        if has_overlap {
            let nodes = DataSet::read(&out.path().join("bvh.vtu"));
            for name in ["sah_cost", "epo"] {
                let root = nodes.array(name).f32s().next().map(f64::from);
                let found = bvh[name].as_f64().unwrap() as f32;
                assert_eq!(root, Some(found.into()), "{name}");
            }
        }
    }
}

/// The arrays of visits and hits; times last.
fn visit_arrays<I: Iterator<Item = Visits>>(
    [n, wasted]: [&str; 2],
    cost: CostMode,
    visits: impl Fn() -> I,
) -> Vec<Array> {
    let mut arrays = vec![
        array(n, "UInt64", visits().map(|visits| visits.n)),
        array("hits", "UInt64", visits().map(|visits| visits.n_hits)),
        array(
            wasted,
            "UInt64",
            visits().map(|visits| visits.n - visits.n_hits),
        ),
    ];
    if cost == CostMode::Time {
        let time_ns = |visits: Visits| (visits.time_ps as f64 / 1000.0) as f32;
        arrays.push(array("time_ns", "Float32", visits().map(time_ns)));
    }
    arrays
}

fn expected_surface(scene: &Scene, visits: &[Visits], cost: CostMode) -> DataSet {
    let all = scene.primitives.iter().enumerate();
    let shown: Vec<_> = all
        .filter(|(_, primitive)| !primitive.is_unbounded())
        .collect();
    let shown = || shown.iter();
    let radius = |primitive: &world::scene::Primitive| match primitive.world_shape() {
        Some(Shape::Sphere(sphere)) => scene.space.world_length(sphere.radius),
        _ => 0.0,
    };
    let mut arrays = vec![
        array("primitive", "UInt32", shown().map(|(i, _)| *i as u32)),
        array("object", "Int32", shown().map(|(_, p)| p.object.0 as i32)),
        array(
            "material",
            "Int32",
            shown().map(|(_, p)| p.material.0 as i32),
        ),
        array("radius", "Float32", shown().map(|(_, p)| radius(p))),
    ];
    arrays.extend(visit_arrays(["tests", "wasted_tests"], cost, || {
        shown().map(|(i, _)| visits[*i])
    }));
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for (_, primitive) in shown() {
        let patch = primitive.patch().unwrap();
        let in_world = |corner: &Vec3| scene.space.world_point(*corner).as_vec3().to_array();
        points.extend(patch.corners().iter().map(in_world));
        let cell_type = match primitive.world_shape() {
            Some(Shape::Sphere(_)) => 1,
            Some(Shape::Triangle(_)) => 5,
            Some(Shape::Disk(_)) => 7,
            Some(Shape::Cuboid(_)) => 12,
            // Placed by a transform: a box has eight corners.
            _ if patch.corners().len() == 8 => 12,
            _ => 6,
        };
        cells.push((patch.corners().len() as i32, cell_type));
        // The drawn shape is at the primitive's position.
        let bounds = primitive.bounds();
        let slack = 1e-4 * (bounds.max - bounds.min).length();
        for corner in patch.corners() {
            assert!(corner.cmpge(bounds.min - slack).all(), "{primitive:?}");
            assert!(corner.cmple(bounds.max + slack).all(), "{primitive:?}");
            let (nearest, _) = primitive.project(*corner);
            let is_on_it = nearest.distance(*corner) <= slack;
            assert!(is_on_it || cell_type == 1, "{primitive:?}: {corner}");
        }
    }
    grid(arrays, points, cells.into_iter())
}

/// A grid of cells, each with so many points, in their order, and a type.
fn grid(
    mut arrays: Vec<Array>,
    points: Vec<[f32; 3]>,
    cells: impl Iterator<Item = (i32, u8)> + Clone,
) -> DataSet {
    let ends = cells.clone().scan(0, |end, (n, _)| {
        *end += n;
        Some(*end)
    });
    let n_points = points.len();
    arrays.push(Array {
        n_components: 3,
        ..array("Points", "Float32", points.into_iter())
    });
    arrays.push(array("connectivity", "Int32", 0..n_points as i32));
    arrays.push(array("offsets", "Int32", ends));
    arrays.push(array("types", "UInt8", cells.clone().map(|(_, kind)| kind)));
    DataSet {
        kind: "UnstructuredGrid".to_owned(),
        n_points,
        n_cells: Some(cells.count()),
        extent: None,
        origin: None,
        spacing: None,
        normals: None,
        texts: units(&arrays, unit),
        time: None,
        arrays,
    }
}

/// The unit of an array with this name.
fn unit(name: &str) -> Option<String> {
    match name {
        "radius" | "Points" => Some("world units".to_owned()),
        _ => name.ends_with("_ns").then(|| "ns".to_owned()),
    }
}

fn array<T: NoUninit>(name: &str, scalar: &str, values: impl Iterator<Item = T>) -> Array {
    let values: Vec<T> = values.collect();
    Array {
        name: name.to_owned(),
        scalar: scalar.to_owned(),
        n_components: 1,
        bytes: bytemuck::cast_slice(&values).to_vec(),
    }
}

/// Renders a small picture with all outputs of a cost attribution; returns its
/// standard output.
fn render(scene: &str, out: &Path, flags: &[&str]) -> String {
    let output = raycost()
        .args(["render", "--width=40", "--height=30", "--spp=2"])
        .args(["--also=objects,surface,bvh", "--out"])
        .arg(out)
        .args(flags)
        .arg(in_repository("configs").join(scene))
        .output()
        .unwrap();
    assert_success(&output);
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn threads_change_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let [one, many] = ["1", "3"].map(|n_threads| {
        let out = folder.path().join(n_threads);
        let threads = format!("--threads={n_threads}");
        render("trellis.yaml", &out, &["--cost=counters", &threads]);
        out
    });
    for file in ["objects.csv", "surface.vtu", "bvh.vtu"] {
        let [one, many] = [&one, &many].map(|out| fs::read(out.join(file)).unwrap());
        assert!(one == many && one.len() > 1000, "{file}");
    }
}

#[test]
fn files_that_are_no_longer_requested_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    render("blocks.yaml", folder.path(), &[]);
    let charged = [
        "objects.csv",
        "surface.vtu",
        "surface.pvsm",
        "bvh.vtu",
        "bvh.pvsm",
    ];
    let is_there = |file: &&str| folder.path().join(file).exists();
    assert!(charged.iter().all(is_there));
    let plain = raycost()
        .args(["render", "--width=40", "--height=30", "--out"])
        .arg(folder.path())
        .arg(in_repository("configs/blocks.yaml"))
        .output();
    assert_success(&plain.unwrap());
    assert!(!charged.iter().any(is_there));
}

type Row = HashMap<String, String>;

fn rows(out: &Path) -> Vec<Row> {
    let mut file = csv::Reader::from_path(out.join("objects.csv")).unwrap();
    file.deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

#[test]
fn the_rows_of_the_table_sum_up_to_the_summary() {
    check_sums("time");
}

#[test]
fn the_rows_sum_up_to_times_of_single_rays_too() {
    check_sums("single_ray_time");
}

/// Checks the sums of `objects.csv` in a mode of `cost`.
fn check_sums(cost: &str) {
    let time = "time_ns";
    let folder = tempfile::tempdir().unwrap();
    render("hall_of_mirrors.yaml", folder.path(), &["--cost", cost]);
    let rows = rows(folder.path());
    let summary = fs::read(folder.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    let totals = &summary["cost"]["totals"];
    // Two objects and nothing, four materials and nothing.
    assert_eq!(rows.len(), (3 + 5) * 2 * (1 + RayKind::ALL.len()));
    for kind in ["object", "material"] {
        for charge in ["primary", "hit"] {
            let group = |ray_kind: &str| {
                let of_group = |row: &&Row| {
                    row["kind"] == kind && row["charge"] == charge && row["ray_kind"] == ray_kind
                };
                rows.iter().filter(of_group).collect::<Vec<_>>()
            };
            let sum = |ray_kind: &str, column: &str| {
                let rows = group(ray_kind);
                rows.iter().map(|row| number(row, column)).sum::<f64>()
            };
            for column in ["rays", "node_visits", "primitive_tests"] {
                assert_eq!(sum("all", column), totals[column].as_f64().unwrap());
            }
            let time_ns = totals[time].as_f64().unwrap();
            // The table has whole nanoseconds.
            let rounding = 0.5 * group("all").len() as f64 + 1e-6 * time_ns;
            assert!((sum("all", time) - time_ns).abs() <= rounding);
            for ray_kind in ["camera", "shadow", "reflection", "refraction", "diffuse"] {
                let rays = totals[format!("{ray_kind}_rays")].as_f64().unwrap();
                assert_eq!(sum(ray_kind, "rays"), rays);
            }
            assert_eq!(sum("all", "pixels"), 40.0 * 30.0);
            for column in ["pixels", "rays", "node_visits", "primitive_tests", time] {
                let whole = sum("all", &format!("{column}_share"));
                assert!((whole - 1.0).abs() < 1e-5, "{column}: {whole}");
            }
            let nothing = group("all")
                .into_iter()
                .find(|row| row["name"] == "nothing");
            assert_eq!(nothing.unwrap()["id"], "-1");
        }
    }
    let names: Vec<&str> = rows.iter().map(|row| row["name"].as_str()).collect();
    assert!(names.contains(&"mirrors") && names.contains(&"plane 1") && names.contains(&"copper"));
}

/// In fog the scene has one more material, of the particles, which no ray is charged to.
#[test]
fn the_rows_sum_up_in_fog() {
    let folder = tempfile::tempdir().unwrap();
    let fog = "fog={mean_free_path: 4, color: 0.5}";
    for (scene, setting) in [
        ("hall_of_mirrors", "shading={model: path}"),
        ("blocks", "fog.color=1"),
    ] {
        let flags = ["--cost=counters", "--set", fog, "--set", setting];
        render(&format!("{scene}.yaml"), folder.path(), &flags);
        for kind in ["object", "material"] {
            let rows = rows(folder.path());
            let mut all = rows
                .iter()
                .filter(|row| row["kind"] == kind && row["ray_kind"] == "all");
            let whole: f64 = all.clone().map(|row| number(row, "rays_share")).sum();
            // By both rules.
            assert!((whole - 2.0).abs() < 1e-5, "{scene}, {kind}: {whole}");
            let last = all.next_back().unwrap();
            assert_eq!((&*last["name"], &*last["id"]), ("nothing", "-1"));
        }
    }
}

#[test]
fn unmeasured_times_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    render("blocks.yaml", folder.path(), &["--cost=counters"]);
    let rows = rows(folder.path());
    assert!(rows[0].contains_key("rays_share"));
    assert!(!rows[0].keys().any(|column| column.contains("time")));
}

#[test]
fn the_terminal_lists_the_most_expensive_and_sums_up_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let said = render("blocks.yaml", folder.path(), &["--cost=counters"]);
    let table = said.split_once("        object").unwrap().1;
    let (objects, materials) = table.split_once("        material").unwrap();
    let rows: Vec<&str> = objects.lines().skip(1).collect();
    assert_eq!(rows.len(), 11, "{said}");
    assert!(rows[10].contains(" 2 more objects "), "{said}");
    let shares: Vec<[f64; 3]> = rows
        .iter()
        .map(|row| {
            let words: Vec<&str> = row.split_whitespace().collect();
            let share = |from_end: usize| words[words.len() - from_end].parse().unwrap();
            [share(6), share(4), share(2)]
        })
        .collect();
    assert!(shares[..10].is_sorted_by(|a, b| a[1] >= b[1]), "{said}");
    for i in 0..3 {
        let whole: f64 = shares.iter().map(|shares| shares[i]).sum();
        assert!((whole - 100.0).abs() < 1.0, "{said}");
    }
    assert!(materials.contains("glass"), "{said}");
}
