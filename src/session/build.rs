//! The build of this program.

use output::summary::Build;

/// Describes this build: version, commit, compiler, profile and flags.
pub fn this_build() -> Build {
    Build {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: option_env!("RAYCOST_COMMIT").map(str::to_owned),
        compiler: env!("RAYCOST_COMPILER").to_owned(),
        profile: env!("RAYCOST_PROFILE").to_owned(),
        flags: env!("RAYCOST_FLAGS").to_owned(),
    }
}
