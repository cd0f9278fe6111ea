//! The flags that exclude each other: all that a part cannot have.

use super::RenderArguments;
use crate::cli::device::DeviceChoice;
use host::text::Diagnostic;
use scene::config::Traversal;

impl RenderArguments {
    /// Checks the flags, before the scene is read.
    ///
    /// # Errors
    /// The first two flags that exclude each other.
    pub(super) fn check_flags(&self) -> Result<(), Diagnostic> {
        let no_files = "a part writes none of the output files: leave the flag out";
        let to_merge = "give it to `raycost merge`, which writes the files";
        let part = ("part", self.part.is_some());
        let counters = ("hardware-counters", self.hardware_counters);
        let single = self.traversal == Some(Traversal::Single);
        let traversal = ("traversal single", single);
        let is_other = !matches!(self.device, None | Some(DeviceChoice::Processor));
        let device = ("device", is_other);
        let at_once = "a device traces all rays of a wave at once: leave `--traversal single` out";
        let pairs = [
            (device, traversal, at_once),
            (part, ("profile", self.profile), no_files),
            (part, counters, no_files),
            (part, ("format", self.run.format.is_some()), to_merge),
        ];
        let both = pairs.into_iter().find(|(one, other, _)| one.1 && other.1);
        if let Some(((first, _), (second, _), help)) = both {
            let message = format!("`--{first}` and `--{second}` exclude each other");
            return Err(Diagnostic::new(message).with_help(help));
        }
        if self.part.is_some() && self.scene.is_standard_input() {
            let message = "`--part` needs a scene in a file: `raycost merge` reads it again";
            return Err(Diagnostic::new(message).with_help("write the scene to a file"));
        }
        Ok(())
    }
}
