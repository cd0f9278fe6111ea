//! Two outputs of the same size → what changed from the first, A, to the
//! second, B.
//!
//! Takes two folders that `raycost render` wrote; gives a [`Diff`], which tells
//! of itself on the terminal, as JSON and in the files of [`write()`]. Counters
//! are exact: any change of them is one of the work. Times are noisy: whether
//! they changed is asked of the repeats.

mod measure;
mod noise;
mod group;
mod picture;
mod settings;
mod reached;
mod side;
mod change;
mod gate;
mod report;
mod json;
mod map;
mod volume;
mod state;
mod files;

pub use change::Change;
pub use files::{refuse_foreign, write};
pub use gate::{Gate, Limit};
pub use group::Rectangle;
pub use json::to_json;
pub use measure::{Measure, ratio};
pub use noise::{Noise, Test};
pub use picture::PictureDifference;
pub use report::report;
pub use settings::Setting;
pub use side::Side;

use group::{Groups, sorted};

use crate::text::Diagnostic;

/// What changed from A to B.
#[derive(Debug)]
pub struct Diff {
    /// Columns and rows of both.
    pub size: [u32; 2],
    /// What the whole frame costs.
    pub totals: Totals,
    /// Whether the time changed by more than noise; `None` unless both have it.
    pub noise: Option<Noise>,
    /// The change of what is shown: the time, or node visits or primitive tests,
    /// whichever changed more.
    pub change: Change,
    /// What the camera sees, object by object, the greatest change first.
    pub objects: Vec<Group>,
    /// What any ray meets, object by object, the greatest change first; empty
    /// unless both have `objects.csv`.
    pub reached: Vec<Group>,
    /// The tiles of B, the greatest change first.
    pub tiles: Vec<Group>,
    /// How far the pictures are apart.
    pub picture: PictureDifference,
    /// Pixels where the camera sees another object.
    pub n_other_objects: u64,
    /// What was asked for otherwise.
    pub settings: Vec<Setting>,
    /// What machine or program are not the same.
    pub machine: Vec<Setting>,
}

/// One cost of some pixels, in A and in B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Total {
    /// Which cost.
    pub measure: Measure,
    /// A's and B's.
    pub cost: [f64; 2],
}

/// The costs that both outputs have, in the order of [`Measure::ALL`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Totals(pub Vec<Total>);

/// Pixels that belong together, and their costs.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// What it is called.
    pub name: String,
    /// Where it is; of a tile.
    pub bounds: Option<Rectangle>,
    /// Its costs.
    pub totals: Totals,
}

impl Totals {
    /// A's and B's value of a measure, if they have it.
    pub fn cost(&self, measure: Measure) -> Option<[f64; 2]> {
        self.total(measure).map(|total| total.cost)
    }

    /// The total of a measure, if both have it.
    pub fn total(&self, measure: Measure) -> Option<&Total> {
        self.0.iter().find(|total| total.measure == measure)
    }

    /// Node visits and primitive tests together.
    pub fn steps(&self) -> [f64; 2] {
        let costs = [Measure::NODE_VISITS, Measure::PRIMITIVE_TESTS];
        let [visits, tests] = costs.map(|measure| self.cost(measure).unwrap_or_default());
        [visits[0] + tests[0], visits[1] + tests[1]]
    }

    /// What tells most of the cost: the time, or [`Self::steps`] where a time
    /// is missing.
    pub fn main(&self) -> [f64; 2] {
        self.cost(Measure::TIME).unwrap_or_else(|| self.steps())
    }
}

impl Group {
    /// B - A of what tells most of the cost.
    pub fn change(&self) -> f64 {
        let [a, b] = self.totals.main();
        b - a
    }
}

impl Diff {
    /// B over A of a cost of the whole frame, the only one that is shown
    /// anywhere: of the time the Hodges-Lehmann estimate, which lies within the
    /// interval that stands beside it, wherever there are repeats to estimate
    /// from; of the rest, and of times without repeats, the ratio of the sums.
    pub fn ratio(&self, total: &Total) -> f64 {
        let test = self.noise.as_ref().and_then(Noise::test);
        match test {
            Some(test) if total.measure == Measure::TIME => test.ratio.estimate,
            _ => ratio(total.cost),
        }
    }

    /// Compares two outputs.
    ///
    /// # Errors
    /// What keeps them from being compared, and what to do about it.
    pub fn of(sides: &[Side; 2]) -> Result<Self, Diagnostic> {
        let size = common_size(sides)?;
        let measures = common_measures(sides)?;
        let [a, b] = sides;
        let mut groups = Groups::of(sides)?;
        let mut totals = Totals::default();
        for measure in measures {
            let values = [a.values(measure)?, b.values(measure)?];
            let cost = values.each_ref().map(|values| {
                let values = values.iter();
                values.fold(0.0, |sum, &value| measure.add(sum, value))
            });
            totals.0.push(Total { measure, cost });
            groups.add(measure, &values);
        }
        let shown = shown_measure(&totals);
        let change = Change::of(shown, &[a.values(shown)?, b.values(shown)?]);
        let noise = match totals.cost(Measure::TIME) {
            Some(_) => Some(Noise::of(&a.repeats()?, &b.repeats()?)),
            None => None,
        };
        Ok(Self {
            size,
            totals,
            noise,
            change,
            objects: sorted(groups.objects(sides)),
            reached: sorted(reached::groups(sides)?),
            tiles: sorted(groups.tiles(size)),
            picture: PictureDifference::of(&a.colors()?, &b.colors()?),
            n_other_objects: groups.n_other_objects,
            settings: settings::of_run(a.summary(), b.summary()),
            machine: settings::of_machine(a.summary(), b.summary()),
        })
    }
}

/// The time or, where one is missing, that of node visits and primitive tests
/// which changed more. What one side has nothing of is not shown: without a
/// hierarchy, say, there are no node visits.
fn shown_measure(totals: &Totals) -> Measure {
    let is_in_both = |total: &&Total| total.cost.iter().all(|&cost| cost > 0.0);
    let change = |total: &Total| (total.cost[1] - total.cost[0]).abs();
    let steps = [Measure::PRIMITIVE_TESTS, Measure::NODE_VISITS];
    let in_both = || totals.0.iter().filter(is_in_both);
    let shown = in_both().find(|total| total.measure == Measure::TIME);
    let shown = shown.or_else(|| {
        let steps = in_both().filter(|total| steps.contains(&total.measure));
        steps.max_by(|x, y| change(x).total_cmp(&change(y)))
    });
    let shown = shown.or(totals.0.first());
    shown.map_or(Measure::NODE_VISITS, |total| total.measure)
}

/// The costs that both outputs have.
///
/// # Errors
/// If there are none.
fn common_measures(sides: &[Side; 2]) -> Result<Vec<Measure>, Diagnostic> {
    for side in sides {
        if !Measure::ALL.iter().any(|measure| side.has(*measure)) {
            let message = format!("`{}` holds no cost to compare", side.name());
            let help = "render it again without `--no-cost`";
            return Err(Diagnostic::new(message).with_help(help));
        }
    }
    let is_common = |measure: &Measure| sides.iter().all(|side| side.has(*measure));
    Ok(Measure::ALL.into_iter().filter(is_common).collect())
}

fn common_size([a, b]: &[Side; 2]) -> Result<[u32; 2], Diagnostic> {
    if a.size() == b.size() {
        return Ok(a.size());
    }
    let pixels = |side: &Side| {
        let [width, height] = side.size();
        format!("`{}` has {width} x {height}", side.name())
    };
    let [width, height] = a.size();
    let message = format!(
        "the pictures differ in size: {}, {} pixels",
        pixels(a),
        pixels(b)
    );
    let help = format!("render B again with `--width {width} --height {height}`");
    Err(Diagnostic::new(message).with_help(help))
}
