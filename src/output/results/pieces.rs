//! The files that list pieces: `frame.pvti` and `hits.pvtu`.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::writers::is_piece;
use host::files;
use host::text::Diagnostic;
use vtk::read::{extent_of, size_of_extent};

/// Maximum number of bytes of a list; a picture has a few hundred pieces.
const MAX_LIST: u64 = 1 << 22;

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

#[derive(Deserialize)]
struct ListElement {
    #[serde(rename = "@raycost_run")]
    run: Option<String>,
    #[serde(rename = "PImageData")]
    image: Option<PiecesElement>,
    #[serde(rename = "PUnstructuredGrid")]
    grid: Option<PiecesElement>,
}

#[derive(Deserialize)]
struct PiecesElement {
    #[serde(rename = "@WholeExtent")]
    extent: Option<String>,
    #[serde(rename = "Piece", default)]
    pieces: Vec<PieceElement>,
}

#[derive(Deserialize)]
struct PieceElement {
    #[serde(rename = "@Source")]
    source: String,
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
        let list: ListElement = quick_xml::de::from_str(&text)
            .map_err(|error| this.foreign(&format!("it is damaged: {error}")))?;
        let Some(pieces) = list.image.or(list.grid) else {
            return Err(this.foreign("it lists no pieces of an image or a cloud"));
        };
        let names = pieces.pieces.iter().map(|piece| &piece.source);
        if names.len() == 0 || !names.clone().all(|name| is_piece(name)) {
            return Err(this.foreign("its pieces do not make a picture"));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        this.paths = names.map(|name| folder.join(name)).collect();
        this.run = list.run;
        this.size = pieces
            .extent
            .as_deref()
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
