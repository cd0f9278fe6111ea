//! The settings that `raycost render` and `raycost merge` share.

use crate::cli::keyword;
use base::keywords;
use base::numbers::parse_bytes;
use host::text::Diagnostic;
use output::limits;
use vtk::hdf;

/// How to run, and what to write beside the usual files.
#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct RunArguments {
    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,

    /// Use at most this much memory, such as 4G or 500M [default: three quarters of what is
    /// available]. A picture that needs more is written in pieces
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes)]
    memory: Option<u64>,

    /// Also write cloud and frame in this format; an animation has one file each for all frames.
    /// Needs a build with `--features hdf5`
    #[arg(long, value_name = "FORMAT", value_parser = keyword::<ExtraFormat>())]
    pub(super) format: Option<ExtraFormat>,

    /// Flush the files to the disk before they replace older ones, so that they survive
    /// a power cut
    #[arg(long)]
    pub(super) sync: bool,

    /// Print only errors
    #[arg(long, short)]
    pub(super) quiet: bool,
}

keywords! {
    /// A format of cloud and frame besides VTK's XML files.
    pub(super) enum ExtraFormat {
        /// VTK's format in HDF5
        Vtkhdf = "vtkhdf",
    }
}

impl RunArguments {
    /// Limits the memory of this process.
    pub(super) fn limit_memory(&self) {
        if let Some(limit) = self.memory {
            limits::set_limit(limit);
        }
    }

    /// Checks that this program can write the requested format.
    ///
    /// # Errors
    /// A format that this program was built without.
    pub(super) fn check_format(&self) -> Result<(), Diagnostic> {
        if self.format.is_none() || hdf::IS_BUILT {
            return Ok(());
        }
        let message = "this raycost was built without HDF5, which `--format vtkhdf` needs";
        let help = "install libhdf5 with its headers (on Debian, `apt-get install libhdf5-dev`), \
                    then `cargo install --path . --features hdf5`";
        Err(Diagnostic::new(message).with_help(help))
    }
}
