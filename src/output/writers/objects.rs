//! `objects.csv`: the cost of each object and each material.

use std::io::{self, Write};

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use host::text::text_cell;
use render::attribution::{AttributedCost, AttributionRule, CostAttribution, Work};
use scene::config::OptionalOutput;
use tracer::cost::{Metric, RayKind};

/// The file.
pub const FILE: OutputFile = OutputFile {
    name: "objects.csv",
    is_wanted: |request| request.has(OptionalOutput::Objects),
    content: FileContent::Written(|job, out| match job.rendering.attribution {
        Some(attribution) => write(job.rendering, attribution, out),
        None => Ok(()),
    }),
};

/// The name of the last entry, the cost of rays without a hit.
const NOTHING: &str = "nothing";

/// Returns the number of rows per object or material.
pub(crate) fn rows_per_thing() -> usize {
    AttributionRule::ALL.len() * (1 + RayKind::ALL.len())
}

/// The metrics of a row, after the number of pixels; their shares of the whole picture are at the
/// end of the row. Times come last.
const COUNTED: [Metric; 3] = [Metric::RAYS, Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS];

/// The objects or the materials, with their costs.
pub struct Group<'a> {
    /// `object` or `material`.
    pub kind: &'static str,
    /// The name of each entry, in order, "nothing" last.
    pub names: Vec<String>,
    /// The costs of the entries.
    pub accounts: &'a [AttributedCost],
}

impl<'a> Group<'a> {
    /// Returns the objects, then the materials.
    pub fn all(rendering: &RenderingView, attribution: &'a CostAttribution) -> [Self; 2] {
        let config = rendering.config;
        let nothing = || std::iter::once(NOTHING.to_owned());
        let objects = config.object_labels();
        let materials = config.materials.keys().cloned();
        [
            Self {
                kind: "object",
                names: objects.chain(nothing()).collect(),
                accounts: &attribution.objects,
            },
            Self {
                kind: "material",
                names: materials.chain(nothing()).collect(),
                accounts: &attribution.materials,
            },
        ]
    }
}

/// Writes a row for each object and material, each attribution rule and each kind of ray; times
/// only if they were measured.
fn write(
    rendering: &RenderingView,
    attribution: &CostAttribution,
    out: &mut impl Write,
) -> io::Result<()> {
    let times = Metric::measured_by(rendering.film.cost);
    let mut table = Table {
        rows: csv::Writer::from_writer(out),
        metrics: COUNTED.into_iter().chain(times).collect(),
        n_samples: rendering.film.n_samples,
    };
    table.write_names()?;
    for group in Group::all(rendering, attribution) {
        let accounts = group.accounts.iter();
        let whole = accounts.fold(AttributedCost::default(), |sum, account| sum.with(*account));
        for (id, (name, account)) in group.names.iter().zip(group.accounts).enumerate() {
            let id = if id + 1 == group.accounts.len() {
                "-1".to_owned()
            } else {
                id.to_string()
            };
            table.write_thing([group.kind, &id, &text_cell(name)], account, &whole)?;
        }
    }
    table.rows.flush()
}

struct Table<W: Write> {
    rows: csv::Writer<W>,
    metrics: Vec<Metric>,
    /// Samples of every pixel; 0 if the number varies.
    n_samples: u32,
}

impl<W: Write> Table<W> {
    fn write_names(&mut self) -> io::Result<()> {
        let words = ["kind", "id", "name", "charge", "ray_kind"].map(str::to_owned);
        let metrics = self.metrics.iter().map(|metric| metric.name);
        let numbers: Vec<&str> = std::iter::once("pixels").chain(metrics).collect();
        let names = numbers.iter().map(|name| (*name).to_owned());
        let shares = numbers.iter().map(|name| format!("{name}_share"));
        let row = words.into_iter().chain(names).chain(shares);
        Ok(self.rows.write_record(row)?)
    }

    /// Writes the rows of an object or a material; `words` are its kind, id and name, and `whole`
    /// is the total cost.
    fn write_thing(
        &mut self,
        words: [&str; 3],
        account: &AttributedCost,
        whole: &AttributedCost,
    ) -> io::Result<()> {
        for charge in AttributionRule::ALL {
            let whole = self.numbers(whole, whole.all(charge));
            for kind in std::iter::once(None).chain(RayKind::ALL.map(Some)) {
                let ray_kind = kind.map_or("all", RayKind::name);
                let work = match kind {
                    None => account.all(charge),
                    Some(kind) => account.work(charge, kind),
                };
                let numbers = self.numbers(account, work);
                let words = words.into_iter().chain([charge.name(), ray_kind]);
                let shares = numbers.iter().zip(&whole).map(|(n, all)| share(*n, *all));
                let row = words
                    .map(str::to_owned)
                    .chain(numbers.iter().map(f64::to_string))
                    .chain(shares);
                self.rows.write_record(row)?;
            }
        }
        Ok(())
    }

    /// Returns the number of pixels, then all metrics.
    fn numbers(&self, account: &AttributedCost, work: Work) -> Vec<f64> {
        let n_pixels = match self.n_samples {
            0 => account.n_pixels(),
            n => account.n_samples() as f64 / f64::from(n),
        };
        let values = self.metrics.iter().map(|&metric| work.get(metric));
        std::iter::once(n_pixels).chain(values).collect()
    }
}

/// Formats a share from 0 to 1.
fn share(n: f64, whole: f64) -> String {
    match whole {
        0.0 => "0".to_owned(),
        whole => format!("{:.6}", n / whole),
    }
}
