//! An output file: its name, the condition to write it, and its writer.

use std::io::{self, Write};
use std::path::Path;

use super::RenderingView;
use super::fields;
use super::states::States;
use host::folder::{FileWriter, Staging, WriteError, Written};
use host::provenance::{RunId, stamped};
use render::film::{Column, written_columns};
use render::instruments::Stages;
use scene::config::{Config, OptionalOutput};
use tracer::cost::Metric;
use vtk::{Codec, Encoding, Field};

/// A file of the output folder, defined in its own source file; [`files`](super::files) lists all.
#[derive(Debug, Clone, Copy)]
pub struct OutputFile {
    /// Name in the folder.
    pub name: &'static str,
    pub(super) is_wanted: fn(&Request) -> bool,
    pub(super) content: FileContent,
}

/// The content of an output file.
#[derive(Debug, Clone, Copy)]
pub(super) enum FileContent {
    /// Written by a function.
    Written(fn(&WriterInput, &mut FileWriter) -> io::Result<()>),
    /// Written by a function that creates the file itself.
    AtPath(fn(&WriterInput, &Path) -> io::Result<()>),
    /// A ParaView state: a template whose keys [`States`] fills in.
    State(&'static str),
}

/// The settings that decide which files a run writes.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// The scene file's settings.
    pub config: &'a Config,
    /// True if a profiler watches the run.
    pub is_profiled: bool,
    /// True if cloud and frame are also written as VTKHDF.
    pub vtkhdf: bool,
    /// True if the picture is larger than memory: cloud and frame are written in pieces.
    pub is_stored: bool,
}

/// Inputs of a writer.
pub(super) struct WriterInput<'a> {
    pub(super) rendering: &'a RenderingView<'a>,
    /// The stages that have ended.
    pub(super) stages: &'a Stages,
    pub(super) states: &'a States<'a>,
    /// The ID to store in the file.
    pub(super) run: RunId,
    /// The files of earlier groups.
    pub(super) written: &'a [Written],
}

impl OutputFile {
    /// Returns true if a run writes the file.
    pub fn is_wanted(&self, request: &Request) -> bool {
        (self.is_wanted)(request)
    }

    /// Writes the new file.
    pub(super) fn stage(
        &self,
        job: &WriterInput,
        staging: &Staging,
    ) -> Result<Written, WriteError> {
        match self.content {
            FileContent::Written(write) => staging.stage(self.name, |out| write(job, out)),
            FileContent::AtPath(write) => staging.stage_at(self.name, |path| write(job, path)),
            FileContent::State(template) => staging.stage(self.name, |out| {
                let state = job.states.filled(template);
                let comment = job.partial_comment();
                out.write_all(stamped(&format!("{state}{comment}"), job.run).as_bytes())
            }),
        }
    }
}

impl Request<'_> {
    /// Returns true if the optional output is requested.
    pub(super) fn has(&self, output: OptionalOutput) -> bool {
        self.config.output.has(output)
    }

    /// Returns true if cloud and frame have all these arrays.
    pub(super) fn has_arrays(&self, names: &[&str]) -> bool {
        self.config.output.written_arrays().has_all(names)
    }

    /// Returns the number of costs per pixel in the frame.
    pub(super) fn n_costs(&self) -> usize {
        let is_cost = |column: &Column| {
            let mut metrics = Metric::with_own(self.config.metrics);
            metrics.any(|metric| metric.name == column.name)
        };
        written_columns(self.config).filter(is_cost).count()
    }

    /// Returns true if node visits, primitive tests and rays are counted.
    pub(super) fn has_counters(&self) -> bool {
        self.config.cost.has_counters()
    }
}

impl WriterInput<'_> {
    /// Reserves space for this many bytes of arrays, unless they are compressed.
    pub(super) fn reserve(&self, n_bytes: u64, out: &FileWriter) {
        if self.rendering.config.compress == Codec::None {
            out.reserve(n_bytes);
        }
    }

    /// Returns an XML comment on the missing parts; empty if there are none.
    fn partial_comment(&self) -> String {
        let partial = self.rendering.partial;
        partial.map_or(String::new(), |partial| format!("<!-- {partial} -->\n"))
    }

    /// Returns the encoding of VTK files.
    pub(super) fn encoding(&self) -> Encoding {
        let rendering = self.rendering;
        let mut fields = fields::run(&[rendering.name], self.run);
        fields.extend(fields::camera(&rendering.image_plane()));
        let partial = rendering.partial.map(|partial| partial.to_string());
        fields.extend(partial.map(|partial| Field::texts("partial", [partial])));
        fields.extend(rendering.frame.map(|frame| fields::time(frame.time)));
        Encoding {
            codec: rendering.config.compress,
            run: Some(self.run),
            fields,
        }
    }

    /// Returns the encoding of VTK files that hold the pixels.
    pub(super) fn encoding_of_pixels(&self) -> Encoding {
        let mut encoding = self.encoding();
        (encoding.fields).extend(fields::names(self.rendering.config));
        (encoding.fields).extend(fields::cost_range(self.rendering.survey));
        encoding
    }
}
