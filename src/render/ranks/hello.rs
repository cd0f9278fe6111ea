//! Checks that all ranks render the same picture.

use serde::{Deserialize, Serialize};

use super::RankFailure;
use host::text::one_line;

/// The text of a scene that rank 0 has read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneText {
    /// Name of the scene in messages: the path of its file.
    pub name: String,
    /// The text.
    pub text: String,
}

/// The task that rank 0 gives to all others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Order {
    /// Render a picture without others: a still, or this frame of an animation.
    Still(Option<u32>),
    /// Render this frame of an animation; other frames may follow.
    Frame(u32),
    /// Leave: all pictures are rendered.
    Leave,
}

/// Identity of a rank and of its rendering, before the scene is read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Hello {
    /// The name of the rank's machine.
    pub host: String,
    /// The CPUs on which each thread may run, such as `0-3,8`, if the system reports them.
    pub affinity: Vec<Option<String>>,
    /// The scene on its command line.
    pub scene: String,
    /// The program with its version and its commit.
    pub program: String,
    /// The flags that change the picture or its costs.
    pub flags: Vec<String>,
}

impl Hello {
    /// Returns the reason why this rank cannot help one that has sent `leader`, or `None` if it
    /// can.
    pub(super) fn fault(&self, leader: &Self) -> Option<RankFailure> {
        let differ = |what: &str, [here, there]: [&str; 2]| {
            let [here, there] = [one_line(here), one_line(there)];
            (here != there).then(|| format!("{what} `{here}`, and rank 0 `{there}`"))
        };
        let flags = |hello: &Self| match hello.flags.join(" ") {
            none if none.is_empty() => "no flags".to_owned(),
            some => some,
        };
        let message = differ("it is", [&self.program, &leader.program])
            .or_else(|| differ("it renders", [&self.scene, &leader.scene]))
            .or_else(|| differ("it has the flags", [&flags(self), &flags(leader)]))?;
        Some(RankFailure::input(message))
    }
}
