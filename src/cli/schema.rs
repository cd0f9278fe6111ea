//! `raycost schema`.

use super::{Failure, keyword};
use host::text;
use tools::schema::SchemaKind;

/// Print the JSON Schema of scene files or of studies
///
/// Editors use it to complete keys, to explain them and to mark mistakes.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
To use it in an editor with a YAML language server, write it to a file, and name that in
the first line of a scene:

  raycost schema > scene.schema.json
  # yaml-language-server: $schema=scene.schema.json")]
pub(super) struct SchemaArguments {
    /// Kind of the files
    #[arg(value_name = "KIND", default_value = "scene", value_parser = keyword::<SchemaKind>())]
    kind: SchemaKind,
}

pub(super) fn run(arguments: &SchemaArguments) -> Result<(), Failure> {
    let schema = arguments.kind.schema();
    Ok(text::print(&format!("{schema:#}\n"))?)
}
