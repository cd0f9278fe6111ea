//! The vector instructions and the places of threads, which do not change the results.

use base::{Keyword, keywords};
use host::text::Diagnostic;
use math::simd::Simd;

keywords! {
    /// A set of vector instructions.
    pub enum SimdSet {
        /// The instructions that every processor has
        Portable = "portable",
        /// 8 numbers at a time, on x86-64
        Avx2 = "avx2",
        /// 16 numbers at a time, on x86-64
        Avx512 = "avx512",
    }
}

keywords! {
    /// Where the threads may run.
    #[derive(Default)]
    pub enum Pinning {
        /// Where the system puts them
        #[default]
        None = "none",
        /// Each on one CPU: one thread per core before two share one. On Linux
        Cores = "cores",
    }
}

impl SimdSet {
    /// Returns the instructions of this set.
    ///
    /// # Errors
    /// The processor does not have them.
    pub fn detect(self) -> Result<Simd, Diagnostic> {
        let name = self.name();
        let available = Simd::available();
        let found = available.iter().find(|simd| simd.to_string() == name);
        found.copied().ok_or_else(|| {
            Diagnostic::new(format!("this processor has no {name} instructions")).with_help(
                format!("leave out `--simd`, or use `--simd {}`", Simd::best()),
            )
        })
    }
}
