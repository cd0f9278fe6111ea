//! The files that list pieces: `frame.pvti` and `hits.pvtu`.

use std::path::{Path, PathBuf};

use crate::writers::is_piece;
use host::files;
use host::provenance::KEY;
use host::text::Diagnostic;
use vtk::read::{extent_of, parse, size_of_extent};

/// Maximum number of bytes of a list; a picture has a few hundred pieces.
const MAX_LIST: u64 = 1 << 22;
/// Maximum number of tags and texts of a list, and of attributes per element.
const MAX_EVENTS: usize = 1 << 16;
const MAX_ATTRIBUTES: usize = 16;

/// The pieces of a file.
#[derive(Debug)]
pub(super) struct PieceList {
    path: PathBuf,
    /// The run that wrote it.
    pub(super) run: Option<String>,
    /// Columns and rows, if it is an image.
    pub(super) size: Option<[u32; 2]>,
    /// The files of the pieces, at least one.
    pub(super) paths: Vec<PathBuf>,
}

impl PieceList {
    /// Opens the list at `path`; `None` for a file that is not a list, by its extension.
    ///
    /// # Errors
    /// The list cannot be read, or was not written by raycost.
    pub(super) fn open(path: &Path) -> Result<Option<Self>, Diagnostic> {
        let extension = path.extension().unwrap_or_default();
        if extension != "pvti" && extension != "pvtu" {
            return Ok(None);
        }
        let text = files::read_text(path, MAX_LIST).map_err(|error| {
            Diagnostic::new(format!("cannot read `{}`: {error}", path.display()))
        })?;
        let mut this = Self {
            path: path.to_owned(),
            run: None,
            size: None,
            paths: Vec::new(),
        };
        let (list, _) = parse(text.as_bytes(), MAX_EVENTS, MAX_ATTRIBUTES)
            .map_err(|fault| this.foreign(&format!("it is damaged: {fault}")))?;
        let pieces = list.child("PImageData").or(list.child("PUnstructuredGrid"));
        let Some(pieces) = pieces else {
            return Err(this.foreign("it lists no pieces of an image or a cloud"));
        };
        let names = pieces.children_named("Piece");
        let names = names.map(|piece| piece.attribute("Source").unwrap_or_default());
        let names: Vec<&str> = names.collect();
        if names.is_empty() || !names.iter().all(|name| is_piece(name)) {
            return Err(this.foreign("its pieces do not make a picture"));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        this.paths = names.iter().map(|name| folder.join(name)).collect();
        this.run = list.attribute(KEY).map(str::to_owned);
        this.size = pieces
            .attribute("WholeExtent")
            .and_then(extent_of)
            .map(size_of_extent);
        Ok(Some(this))
    }

    /// Returns the error for a list that raycost did not write.
    pub(super) fn foreign(&self, why: &str) -> Diagnostic {
        let shown = self.path.display();
        Diagnostic::new(format!("`{shown}` is not as raycost writes it: {why}"))
            .with_help("render the scene again; files that other programs saved are not read")
    }
}
