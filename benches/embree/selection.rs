//! The races selected by the command line.

use clap::Args;
use clap::builder::PossibleValuesParser;
use math::simd::Simd;

/// The race of the builds, among the races of rays.
pub const BUILD: &str = "build";

const RACES: [&str; 5] = [BUILD, "primary", "diffuse", "occlusion", "shadow"];

/// Embree's instruction sets, by raycost's names.
const ISAS: [&str; 2] = ["avx2", "avx512"];

/// All races if no option is given.
#[derive(Debug, Args)]
pub struct Selection {
    /// Use only the scenes whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    pub scene: String,
    /// Race only these
    #[arg(long, value_name = "RACE,…", value_delimiter = ',', value_parser = PossibleValuesParser::new(RACES))]
    only: Vec<String>,
    /// raycost's quality of the hierarchy
    #[arg(long, value_parser = ["fast", "high"])]
    quality: Option<String>,
    /// Numbers of threads
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2])]
    pub threads: Vec<usize>,
    /// The only instruction set of both kernels
    #[arg(long, value_parser = ISAS)]
    simd: Option<String>,
}

impl Selection {
    /// Returns true if the scene of this name takes part.
    pub fn has_scene(&self, name: &str) -> bool {
        name.contains(&self.scene)
    }

    /// Returns true if the builds, or the rays of this name, are raced.
    pub fn has_race(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|only| only == name)
    }

    /// Returns true if raycost's hierarchy of this quality takes part.
    pub fn has_quality(&self, name: &str) -> bool {
        self.quality.as_deref().is_none_or(|only| only == name)
    }

    /// Returns Embree's instruction sets.
    pub fn isas(&self) -> Vec<&'static str> {
        let wanted = self.simd.as_deref();
        let is_wanted = |isa: &&str| wanted.is_none_or(|only| only == *isa);
        ISAS.into_iter().filter(is_wanted).collect()
    }

    /// Returns raycost's instruction set.
    ///
    /// # Errors
    /// If the CPU does not have the selected one.
    pub fn simd(&self) -> Result<Simd, String> {
        let Some(only) = &self.simd else {
            return Ok(Simd::best());
        };
        let found = Simd::available()
            .into_iter()
            .find(|simd| simd.to_string() == *only);
        found.ok_or_else(|| format!("this CPU has no {only}"))
    }
}
