//! The rays of pixels as trees for the terminal.

use std::time::Duration;

use clap::builder::styling::{AnsiColor, Style};
use glam::Vec3;

use base::numbers::{count, counted, duration};
use host::text::truncated;
use output::writers::Traced;
use render::attribution::{ObservedPixel, RayTree, TracedRay};
use scene::config::Config;
use tracer::cost::RayKind;
use world::scene::LightOrigin;

/// Greatest number of pixels that are shown.
const MAX_PIXELS: usize = 3;
/// Greatest number of rays of a pixel that are shown.
const MAX_RAYS: usize = 40;
/// Greatest number of characters of a name.
const MAX_NAME_CHARS: usize = 24;

const BOLD: Style = Style::new().bold();
const DIMMED: Style = Style::new().dimmed();

/// Traced pixels and the scene's config, which names the objects that their rays hit.
pub(super) struct Trees<'a> {
    config: &'a Config,
    traced: &'a Traced<'a>,
}

/// A line of the table.
struct TreeRow {
    /// The branches of the tree before the first cell.
    branches: String,
    /// The first cell and its style.
    first: (String, Style),
    /// The other cells: the hit object, the numbers, and the color.
    cells: Vec<String>,
}

impl<'a> Trees<'a> {
    pub(super) fn new(config: &'a Config, traced: &'a Traced<'a>) -> Self {
        Self { config, traced }
    }

    /// Returns the trees of the first pixels, with styles.
    pub(super) fn text(&self) -> String {
        let (shown, others) = {
            let n = MAX_PIXELS.min(self.traced.pixels.len());
            self.traced.pixels.split_at(n)
        };
        let tables = shown
            .iter()
            .map(|pixel| in_columns(&self.table(pixel)) + "\n");
        let mut text: String = tables.collect();
        if !others.is_empty() {
            let n = counted(others.len() as u64, "more pixel");
            text += &format!("and {n} in rays.vtp\n\n");
        }
        text
    }

    /// Returns the table of a pixel: a header, the rays, and their sums.
    fn table(&self, pixel: &ObservedPixel) -> Vec<TreeRow> {
        let ((x, y), tree) = (pixel.place, &pixel.tree);
        let mut header = vec!["meets", "distance", "nodes", "tests"];
        if self.traced.is_timed {
            header.push("time");
        }
        header.extend(["red", "green", "blue"]);
        let mut rows = vec![TreeRow {
            branches: String::new(),
            first: (format!("pixel {x},{y}"), BOLD),
            cells: header.into_iter().map(str::to_owned).collect(),
        }];
        rows.extend(self.rays(tree));
        rows.extend(self.sums(tree));
        rows
    }

    /// Returns the rays, each above the rays that start from its hit.
    fn rays(&self, tree: &RayTree) -> Vec<TreeRow> {
        let mut children = vec![Vec::new(); tree.rays.len()];
        let mut next = Vec::new();
        for (number, ray) in tree.rays.iter().enumerate() {
            match ray.parent {
                Some(parent) => children[parent as usize].push(number),
                None => next.push((number, String::new(), String::new())),
            }
        }
        next.reverse();
        let mut rows = Vec::new();
        while let Some((number, branches, below)) = next.pop() {
            if rows.len() == MAX_RAYS {
                let n = counted((tree.rays.len() - rows.len()) as u64, "more ray");
                rows.push(TreeRow::from_text(format!("and {n} in rays.vtp")));
                break;
            }
            rows.push(self.ray(&tree.rays[number], branches, tree));
            for (i, &child) in children[number].iter().rev().enumerate() {
                let [branch, trunk] = if i == 0 {
                    ["└─ ", "   "]
                } else {
                    ["├─ ", "│  "]
                };
                next.push((child, below.clone() + branch, below.clone() + trunk));
            }
        }
        rows
    }

    fn ray(&self, ray: &TracedRay, branches: String, tree: &RayTree) -> TreeRow {
        let is_shadow = ray.kind == RayKind::Shadow;
        let distance = ray.end().unwrap_or(ray.t_max);
        let distance = self.traced.scene.space.world_length(distance);
        let mut cells = vec![self.meets(ray), significant(distance)];
        cells.extend(self.costs([ray.node_visits, ray.primitive_tests], ray.time_ns));
        cells.extend(match (is_shadow, ray.contribution) {
            (true, Vec3::ZERO) => Default::default(),
            (true, part) => part.to_array().map(|channel| format!("({channel:.3})")),
            (false, color) => channels(color),
        });
        let has_samples = tree.rays.last().is_some_and(|last| last.sample > 0);
        let sample = if ray.parent.is_none() && has_samples {
            format!(", sample {}", ray.sample)
        } else {
            String::new()
        };
        TreeRow {
            branches,
            first: (
                format!("{}{sample}", ray.kind.name()),
                color(ray.kind).on_default(),
            ),
            cells,
        }
    }

    /// Returns the light with this index.
    fn light(&self, index: u32) -> String {
        match self.traced.scene.lights.origin(index) {
            LightOrigin::Surfaces(material) => format!("lamp of {}", self.material(material.0)),
            LightOrigin::Background => "background".to_owned(),
            LightOrigin::Sun => "sun".to_owned(),
            LightOrigin::Listed => format!("light {index}"),
        }
    }

    /// Returns the name of the object that the ray hit.
    fn meets(&self, ray: &TracedRay) -> String {
        if ray.particle.is_some() {
            return "fog".to_owned();
        }
        let met = ray.hit.map(|hit| {
            let primitive = &self.traced.scene.primitives[hit.primitive as usize];
            let mut object = self.object(primitive.object.0);
            if let Some(instance) = hit.instance {
                object += &format!(", instance {}", instance.0);
            }
            (object, self.material(primitive.material.0))
        });
        let light = ray
            .light
            .map_or("a light".to_owned(), |light| self.light(light));
        match (ray.kind, met) {
            (RayKind::Shadow, None) => light,
            (RayKind::Shadow, Some((object, _))) => format!("{object}, before {light}"),
            (_, None) => "background".to_owned(),
            (_, Some((object, material))) => format!("{object} ({material})"),
        }
    }

    fn object(&self, id: u32) -> String {
        truncated(
            &self.config.objects[id as usize].label(id as usize),
            MAX_NAME_CHARS,
        )
    }

    fn material(&self, id: u32) -> String {
        let material = self.config.materials.get_index(id as usize);
        material.map_or_else(
            || id.to_string(),
            |(name, _)| truncated(name, MAX_NAME_CHARS),
        )
    }

    /// Returns the sums over all rays, and the color in the picture.
    fn sums(&self, tree: &RayTree) -> Vec<TreeRow> {
        let cost = tree.cost();
        let time_ns = tree.rays.iter().map(|ray| ray.time_ns).sum();
        let mut cells = vec![String::new(), String::new()];
        cells.extend(self.costs([cost.node_visits, cost.primitive_tests], time_ns));
        cells.extend(channels(tree.color()));
        let n_rays = counted(tree.rays.len() as u64, "ray");
        let sums = TreeRow {
            first: (n_rays, BOLD),
            cells,
            ..TreeRow::from_text(String::new())
        };
        let model = self.config.shading.model;
        let limit = self.config.film.sample_limit(model);
        let limited = tree.limited_color(limit);
        let [red, green, blue] = self.config.film.development(model).rgb8(limited);
        let shown = format!("#{red:02x}{green:02x}{blue:02x} in the picture");
        let remark = if limited.abs_diff_eq(tree.color(), 1e-5) {
            shown
        } else {
            format!("{shown}, each sample limited to {limit}")
        };
        vec![sums, TreeRow::from_text(remark)]
    }

    fn costs<N: Into<u64>>(&self, counts: [N; 2], time_ns: f32) -> Vec<String> {
        let counts = counts.map(|n| count(n.into()));
        let time = || duration(Duration::from_nanos(time_ns as u64));
        let time = self.traced.is_timed.then(time);
        counts.into_iter().chain(time).collect()
    }
}

impl TreeRow {
    /// Returns a remark below the table.
    fn from_text(text: String) -> Self {
        Self {
            branches: String::new(),
            first: (text, DIMMED),
            cells: Vec::new(),
        }
    }
}

/// Returns the color of a kind of rays, the terminal's nearest to the color in `rays.pvsm`.
fn color(kind: RayKind) -> AnsiColor {
    match kind {
        RayKind::Camera => AnsiColor::Blue,
        RayKind::Shadow => AnsiColor::Yellow,
        RayKind::Reflection => AnsiColor::Red,
        RayKind::Refraction => AnsiColor::Green,
        RayKind::Diffuse => AnsiColor::Cyan,
    }
}

fn channels(color: Vec3) -> [String; 3] {
    color.to_array().map(|channel| format!("{channel:.3} "))
}

/// Formats a number with fewer decimals the larger it is; empty for infinity.
fn significant(number: f32) -> String {
    match number {
        n if n.is_infinite() => String::new(),
        n if n >= 100.0 => format!("{n:.0}"),
        n if n >= 10.0 => format!("{n:.1}"),
        n if n >= 0.01 => format!("{n:.2}"),
        n => format!("{n:.0e}"),
    }
}

/// Aligns rows in columns: the first two flush left, the numbers flush right.
fn in_columns(rows: &[TreeRow]) -> String {
    let cell = |row: &TreeRow, i: usize| row.cells.get(i).map_or(0, |cell| cell.chars().count());
    let n_columns = rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..n_columns)
        .map(|i| rows.iter().map(|row| cell(row, i)).max().unwrap_or(0))
        .collect();
    let with_cells = rows.iter().filter(|row| !row.cells.is_empty());
    let first = with_cells.map(TreeRow::first_width).max().unwrap_or(0);
    let mut lines = String::new();
    for row in rows {
        let (text, style) = &row.first;
        let mut line = String::new();
        for (i, (cell, width)) in row.cells.iter().zip(&widths).enumerate() {
            line += &match i {
                0 => format!("  {cell:<width$}"),
                _ => format!("  {cell:>width$}"),
            };
        }
        let blanks = if line.is_empty() {
            0
        } else {
            first - row.first_width()
        };
        let line = format!("{:blanks$}{}", "", line.trim_end());
        lines += &format!("{}{style}{text}{style:#}{line}\n", row.branches);
    }
    lines
}

impl TreeRow {
    fn first_width(&self) -> usize {
        self.branches.chars().count() + self.first.0.chars().count()
    }
}
