//! The vector instructions and the places of threads, which do not change the results.

use base::serde_keywords;
use base::text::{Diagnostic, keyword_name};
use math::simd::Simd;

/// A set of vector instructions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum SimdSet {
    /// The instructions that every processor has
    Portable,
    /// 8 numbers at a time, on x86-64
    Avx2,
    /// 16 numbers at a time, on x86-64
    Avx512,
}

/// Where the threads may run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Pinning {
    /// Where the system puts them
    #[default]
    None,
    /// Each on one CPU: one thread per core before two share one. On Linux
    Cores,
}

impl SimdSet {
    /// Returns the instructions of this set.
    ///
    /// # Errors
    /// The processor does not have them.
    pub fn detect(self) -> Result<Simd, Diagnostic> {
        let name = keyword_name(&self);
        let available = Simd::available();
        let found = available.iter().find(|simd| simd.to_string() == name);
        found.copied().ok_or_else(|| {
            Diagnostic::new(format!("this processor has no {name} instructions")).with_help(
                format!("leave out `--simd`, or use `--simd {}`", Simd::best()),
            )
        })
    }
}

serde_keywords!(SimdSet, Pinning);
