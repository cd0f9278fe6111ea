//! Checks the arrays that `output` and `metrics` name against the other settings.

use super::{Config, CostMode, OptionalOutput, PixelArray};
use crate::yaml::{Fault, FieldPath};
use base::Keyword;

impl Config {
    /// Checks that a rendering with these settings has all chosen arrays, and that each is
    /// chosen once.
    ///
    /// # Errors
    /// The fault of the key `arrays` of the section `output`, or of an item.
    pub fn check_arrays(&self) -> Result<(), Fault> {
        let Some(chosen) = self.output.arrays() else {
            return Ok(());
        };
        let path = || FieldPath::default().key("output").key("arrays");
        if chosen.is_empty() {
            let message = "`output.arrays` cannot be an empty list";
            return Err(Fault::new(path(), message, "expected at least one array")
                .with_help("leave out `arrays` for all arrays"));
        }
        for (index, &array) in chosen.iter().enumerate() {
            let name = array.name();
            let fault = |message, expected| Fault::new(path().index(index), message, expected);
            if chosen[..index].contains(&array) {
                let message = format!("`output.arrays` has `{name}` twice");
                return Err(fault(message, "expected each array once"));
            }
            if let Some([what, help]) = lacks(array, self) {
                let message = format!("the array `{name}` requires {what}");
                return Err(fault(message, "this rendering does not have it").with_help(help));
            }
        }
        Ok(())
    }

    /// Checks the names of all metrics, and that a rendering with these settings has their arrays.
    ///
    /// # Errors
    /// The fault of the first wrong one.
    pub fn check_metrics(&self) -> Result<(), Fault> {
        for metric in self.metrics.list() {
            let path = || FieldPath::default().key("metrics").key(&metric.name);
            if let Some([message, expected]) = metric.name_fault() {
                return Err(Fault::at_key(path(), message, expected));
            }
            for part in metric.parts {
                if let Some([what, help]) = lacks(part, self) {
                    let name = part.name();
                    let message = format!("the metric `{}` requires {what}", metric.name);
                    let expected = format!("this rendering does not have `{name}`");
                    return Err(Fault::new(path(), message, expected).with_help(help));
                }
            }
        }
        Ok(())
    }
}

impl Config {
    /// Checks that pixels have enough samples to show their noise, if it is requested, and the cost
    /// that their efficiency is computed from.
    ///
    /// # Errors
    /// The fault of the section `output`.
    pub(super) fn check_noise(&self) -> Result<(), Fault> {
        if !self.output.has(OptionalOutput::Noise) {
            return Ok(());
        }
        let fault = |message: &str, found: String, help: &str| {
            let output = FieldPath::default().key("output");
            Err(Fault::at_key(output, message, found).with_help(help))
        };
        if self.image.samples_per_pixel < 2 {
            let message = "`noise` requires at least 2 samples per pixel: one alone has no spread";
            return fault(message, "requests `noise`".to_owned(), "use `--spp 16`");
        }
        let Some(cost) = self.output.noise.cost else {
            return Ok(());
        };
        let name = cost.name();
        match lacks(cost, self) {
            Some([what, help]) => {
                let message = format!("the efficiency by `{name}` requires {what}");
                fault(&message, "names it".to_owned(), &help)
            }
            None => Ok(()),
        }
    }
}

/// Returns the missing condition for a rendering with these settings to have the array, and the
/// setting that fulfills it; `None` if the array is available.
pub(super) fn lacks(array: PixelArray, config: &Config) -> Option<[String; 2]> {
    let cost = config.cost;
    let lacks = |what: &str, help: &str| Some([what.to_owned(), help.to_owned()]);
    let asks_for = |output: OptionalOutput| {
        let name = output.name();
        let help = format!("add `also: [{name}]` to `output`, or `--also {name}`");
        (!config.output.has(output)).then(|| [format!("the output `{name}`"), help])
    };
    match array {
        PixelArray::Rgb | PixelArray::Normals | PixelArray::Distance | PixelArray::Footprint => {
            None
        }
        PixelArray::PixelX | PixelArray::PixelY | PixelArray::Pixel | PixelArray::Horizon => None,
        PixelArray::Object | PixelArray::Material => None,
        PixelArray::Instance if config.has_instances() => None,
        PixelArray::Instance => lacks("instances", "only scenes with `instances` have it"),
        PixelArray::TimeNs => (!cost.has_time()).then(|| missing_mode(CostMode::Time, cost)),
        PixelArray::TimeMadNs if !cost.has_time() => Some(missing_mode(CostMode::Time, cost)),
        PixelArray::TimeMadNs if config.repeats.has_spread() => None,
        PixelArray::TimeMadNs => lacks("repeats", "use `repeats: auto` or `--repeats 10`"),
        PixelArray::Samples if cost.has_counters() && config.image.adaptive.is_none() => lacks(
            "adaptive sampling",
            "only scenes with `image.adaptive` have it: all pixels have as many samples",
        ),
        PixelArray::Radiance => asks_for(OptionalOutput::Radiance),
        PixelArray::Noise => asks_for(OptionalOutput::Noise),
        PixelArray::Efficiency if cost.has_counters() => asks_for(OptionalOutput::Noise),
        PixelArray::IdleLanes | PixelArray::Cycles | PixelArray::Sm if cost.has_counters() => {
            asks_for(OptionalOutput::Lanes)
        }
        PixelArray::RaysByBounce => asks_for(OptionalOutput::Bounces),
        PixelArray::Group => asks_for(OptionalOutput::Groups),
        PixelArray::BoxTests
        | PixelArray::BoxHits
        | PixelArray::PrimitiveHits
        | PixelArray::InstanceVisits => asks_for(OptionalOutput::Tests),
        _ if cost.has_counters() => None,
        _ => Some(missing_mode(CostMode::Counters, cost)),
    }
}

/// Returns the missing condition for an array of this mode in another mode of `cost`, and the
/// setting that fulfills it.
fn missing_mode(mode: CostMode, found: CostMode) -> [String; 2] {
    let [mode, found] = [mode, found].map(CostMode::name);
    [
        format!("`cost: {mode}`, and `cost` is `{found}`"),
        format!("use `--cost {mode}`, or leave it out"),
    ]
}
