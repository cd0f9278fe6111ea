//! `profile.svg`: the functions that the run spent its time in, as a flame graph.

use super::file::{FileContent, OutputFile};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "profile.svg",
    is_wanted: |request| request.is_profiled,
    content: FileContent::Written(|job, out| match job.rendering.profiler {
        Some(profiler) => profiler.write(job.rendering.name, job.run, out),
        None => Ok(()),
    }),
};
