//! How ranks find out that they render the same picture.

use serde::{Deserialize, Serialize};

use super::RankFailure;
use crate::checkpoint::Header;
use crate::text::one_line;

/// The text of a scene that rank 0 has read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneText {
    /// Its name in messages: the path of its file.
    pub name: String,
    /// The text.
    pub text: String,
}

/// Who a rank is, and what it is about to render.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Hello {
    /// The name of its machine.
    pub host: String,
    /// Its number of threads.
    pub n_threads: u32,
    /// The scene on its command line.
    pub scene: String,
    /// The program, the flags, and a hash of the settings and of the contents of the files.
    pub header: Header,
}

impl Hello {
    /// Why this rank cannot help one that has said `leader`; `None` if it can.
    pub(super) fn fault(&self, leader: &Self) -> Option<RankFailure> {
        let [here, there] = [self, leader].map(|hello| &hello.header);
        let program = |header: &Header| match &header.commit {
            Some(commit) => format!("raycost {} ({commit})", header.raycost),
            None => format!("raycost {}", header.raycost),
        };
        let differ = |what: &str, [here, there]: [String; 2]| {
            let [here, there] = [here, there].map(|text| one_line(&text).into_owned());
            (here != there).then(|| format!("{what} `{here}`, and rank 0 `{there}`"))
        };
        let flags = |header: &Header| match header.flags.join(" ") {
            none if none.is_empty() => "no flags".to_owned(),
            some => some,
        };
        let message = differ("it is", [program(here), program(there)])
            .or_else(|| differ("it renders", [self.scene.clone(), leader.scene.clone()]))
            .or_else(|| differ("it has the flags", [flags(here), flags(there)]))
            .or_else(|| {
                let why = here.foreign_to(there).is_some();
                why.then(|| "the files of the scene differ from those of rank 0".to_owned())
            })?;
        Some(RankFailure::input(message))
    }
}
