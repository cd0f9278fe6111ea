//! Refuses what may not fit into memory, before it is allocated.

use crate::estimate::{Memory, has_bars, with_error};
use base::numbers::memory_sizes;
use host::text::Diagnostic;
use host::{memory_limit, resident_memory};
use scene::build::Geometries;
use scene::config::{Config, OptionalOutput, Repeats};
use scene::yaml::{Fault, FieldPath};
use tracer::accel::{Bvh, TooLarge};

pub use host::{available_memory as available, limit_memory as set_limit};

const MIB: u64 = 1 << 20;
/// Upper bound of the program's memory before rendering, without geometries, in bytes.
const PROGRAM: u64 = 32 * MIB;
/// The percentage of the available memory that a picture may take by default.
const SHARE: u64 = 75;

impl Memory {
    /// Estimates the memory of a still picture. If it may exceed the user's limit, by default three
    /// quarters of the available memory, the picture is rendered into files and written in bands of
    /// rows, if its outputs allow it and these need less.
    pub fn estimate_still(config: &Config, geometries: &Geometries) -> Self {
        let whole = Self::estimate(config, geometries);
        let limit = limit_of_still(memory_limit(), available(), geometries.n_bytes());
        let against_bands = reason_against_bands(config);
        if whole.at_most() <= limit || against_bands.is_some() {
            return Self {
                against_bands,
                ..whole
            };
        }
        whole.in_bands(config, limit)
    }

    /// Checks that `available` bytes suffice, and that a hierarchy can hold all primitives.
    ///
    /// # Errors
    /// A fault in the section that needs the most memory.
    pub fn check(&self, available: u64) -> Result<(), Fault> {
        let fewer = "reduce the `count` of generators, or use smaller files";
        if self.n_primitives > Bvh::MAX_PRIMITIVES {
            let most = Bvh::MAX_PRIMITIVES;
            let message = format!("the scene has {} primitives", self.n_primitives);
            let objects = FieldPath::default().key("objects");
            let expected = format!("expected at most {most}");
            return Err(Fault::at_key(objects, message, expected).with_help(fewer));
        }
        let needed = self.at_most();
        if needed <= available {
            return Ok(());
        }
        let [built, written] = self.stages();
        let others = written - self.film;
        // A smaller picture does not help if the build does not fit.
        let is_of_scene = with_error(built) > available || self.film <= others;
        let (section, what, mut help, n_bytes) = if is_of_scene {
            ("objects", "scene", fewer.to_owned(), built.max(others))
        } else {
            ("image", "image", self.image_advice(), self.film)
        };
        let limit = memory_limit();
        if let Some(limit) = limit {
            let enough = (limit.saturating_sub(available) + needed).div_ceil(MIB) + 1;
            help += &format!("; or give `--memory {enough}M` or more");
        }
        let [of_section, _] = memory_sizes([with_error(n_bytes), available]);
        let [needed, left] = memory_sizes([needed, available]);
        let left_of = limit.map_or("free", |_| "left of `--memory`");
        let message =
            format!("the {what} is too large: {needed} of memory are needed, {left} are {left_of}");
        let key = FieldPath::default().key(section);
        Err(Fault::at_key(key, message, format!("needs {of_section}")).with_help(help))
    }

    fn image_advice(&self) -> String {
        let repeats = match self.repeats {
            Repeats::Auto | Repeats::ONCE => "",
            Repeats::Exactly(_) => ", or fewer `--repeats`",
        };
        let bands = self.against_bands.map(|reason| format!("; {reason}"));
        let bands = bands.unwrap_or_default();
        format!("choose a smaller `width` or `height`{repeats}{bands}")
    }
}

/// Checks that the program itself fits into the memory that the user allows.
///
/// # Errors
/// It does not.
pub fn check_limit() -> Result<(), Diagnostic> {
    let sizes = memory_limit().zip(resident_memory());
    let Some((limit, program)) = sizes.filter(|(limit, program)| limit <= program) else {
        return Ok(());
    };
    let [limit, program] = memory_sizes([limit, program]);
    let message =
        format!("`--memory` allows {limit}, and the program itself takes {program} already");
    let help = format!(
        "give `--memory {}M` or more: `raycost check` says what a scene takes beside the program",
        PROGRAM / MIB
    );
    Err(Diagnostic::new(message).with_help(help))
}

/// Returns the fault of a hierarchy that turned out too large.
pub fn too_large(error: TooLarge) -> Fault {
    let objects = FieldPath::default().key("objects");
    Fault::at_key(objects, error.to_string(), "their hierarchy is too large")
        .with_help("reduce the `count` of generators, or use `acceleration: { quality: fast }`")
}

/// Returns why a picture cannot be larger than memory, with the remedy; `None` if it can.
fn reason_against_bands(config: &Config) -> Option<&'static str> {
    let has = |output| config.output.has(output);
    if has(OptionalOutput::Tests) {
        return Some("without the output `tests` it would be written in pieces");
    }
    if has(OptionalOutput::Lanes) {
        return Some("without the output `lanes` it would be written in pieces");
    }
    if has(OptionalOutput::Exr) {
        return Some("without `image.exr` it would be written in pieces");
    }
    if config.cost.has_time() && config.output.iter().any(OptionalOutput::needs_attribution) {
        return Some("with `--cost counters` it would be written in pieces");
    }
    (config.film.bits > 8 && has_bars(config))
        .then_some("with 8 bits, or without color bars, it would be written in pieces")
}

/// Returns the limit in bytes of a still picture beside `n_read` bytes of geometries: with a limit
/// set by the user, the same each time, whatever else the process holds.
fn limit_of_still(set: Option<u64>, available: u64, n_read: u64) -> u64 {
    match set {
        Some(limit) => available.min(limit.saturating_sub(PROGRAM + n_read)),
        None => available / 100 * SHARE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_too_large_only_if_a_smaller_one_would_fit() {
        let memory = Memory {
            film: 550 * MIB,
            scene: 100 * MIB,
            build: 500 * MIB,
            band_rows: None,
            attribution: 0,
            against_bands: None,
            n_primitives: 1,
            repeats: Repeats::ONCE,
        };
        let message = |available| memory.check(available).unwrap_err().message;
        assert!(message(600 * MIB).starts_with("the scene is too large"));
        assert!(message(780 * MIB).starts_with("the image is too large"));
        assert!(memory.check(820 * MIB).is_ok());
    }

    #[test]
    fn pieces_of_a_picture_depend_on_the_limit_and_not_on_chance() {
        let limit = 100 << 20;
        let of_process = |resident: u64| limit_of_still(Some(limit), limit - resident, 5 << 20);
        for resident in [(11 << 20) + 4096, 18 << 20, 30 << 20] {
            assert_eq!(of_process(resident), 63 << 20);
        }
        // A process that holds more than expected keeps the limit.
        assert_eq!(of_process(60 << 20), 40 << 20);
        assert_eq!(limit_of_still(Some(1 << 20), 1 << 20, 0), 0);
        assert_eq!(limit_of_still(None, 1000, 5 << 20), 750);
    }
}
