//! `raycost --version`: the build of this program, and the machine's instruction set.

use std::sync::LazyLock;

use crate::session::this_build;
use math::simd::Simd;

/// The cargo features, each true if this program was built with it.
const FEATURES: [(&str, bool); 3] = [
    ("hdf5", cfg!(feature = "hdf5")),
    ("mpi", cfg!(feature = "mpi")),
    ("profile", cfg!(feature = "profile")),
];

/// The version with commit, features, instruction set, compiler and profile, one line for each.
pub(super) static LONG: LazyLock<String> = LazyLock::new(|| {
    let build = this_build();
    let built_in = FEATURES.iter().filter(|(_, is_built_in)| *is_built_in);
    let features: Vec<&str> = built_in.map(|(name, _)| *name).collect();
    let features = match &features[..] {
        [] => "none".to_owned(),
        some => some.join(", "),
    };
    let lines = [
        build.version,
        format!("commit    {}", build.commit.as_deref().unwrap_or("unknown")),
        format!("features  {features}"),
        format!(
            "simd      {}, the best that this processor has",
            Simd::best()
        ),
        format!("compiler  {}", build.compiler),
        format!("profile   {}", build.profile),
    ];
    lines.join("\n")
});
