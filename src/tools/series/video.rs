//! The frames' pictures as a video, by ffmpeg.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

use super::{FRAMES, FrameSeries, VIDEO};
use host::files;
use host::folder::{Replace, Scratch, WriteError, write_file};
use host::text::shell_word;

/// The program.
const FFMPEG: &str = "ffmpeg";

/// The outcome of encoding the video.
#[derive(Debug)]
pub enum Video {
    /// The video was written, as a file of this name.
    Written(&'static str),
    /// ffmpeg is not installed; the command that makes the video elsewhere.
    NoFfmpeg(String),
    /// ffmpeg failed: its last message, and the command.
    Failed(String, String),
}

impl FrameSeries {
    /// Makes a video of all frames, whose numbers start with 0 and leave out none, in a folder that
    /// [`refuse_foreign`](Self::refuse_foreign) has accepted.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_video(&self, folder: &Path, fps: f32) -> Result<Video, WriteError> {
        let arguments = self.arguments(fps);
        let words: Vec<String> = arguments.iter().map(Path::new).map(shell_word).collect();
        let by_hand = format!(
            "(cd {} && {FFMPEG} {} {VIDEO})",
            shell_word(folder),
            words.join(" ")
        );
        let scratch = Scratch::create(folder)?;
        let file = scratch.path().join(VIDEO);
        let file = std::path::absolute(&file).unwrap_or(file);
        let mut command = Command::new(FFMPEG);
        command.current_dir(folder).args(&arguments).arg(&file);
        command.stdin(Stdio::null()).stdout(Stdio::null());
        let output = match command.stderr(Stdio::piped()).output() {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Ok(Video::NoFfmpeg(by_hand));
            }
            other => other,
        };
        let why = match output {
            Err(error) => error.to_string(),
            Ok(output) if output.status.success() => {
                write_file(&folder.join(VIDEO), Replace::Known, |out| {
                    io::copy(&mut files::open(&file)?, out).map(drop)
                })?;
                return Ok(Video::Written(VIDEO));
            }
            Ok(output) => {
                let text = String::from_utf8_lossy(&output.stderr).into_owned();
                let last = text.lines().rfind(|line| !line.trim().is_empty());
                last.unwrap_or("it says nothing").to_owned()
            }
        };
        Ok(Video::Failed(why, by_hand))
    }

    /// Returns ffmpeg's arguments before the name of the file. H.264 in 4:2:0, which all players
    /// show, needs even sides.
    fn arguments(&self, fps: f32) -> Vec<String> {
        let n_frames = self.n_frames();
        let arguments = format!(
            "-y -loglevel error -framerate {fps} -i {FRAMES}/%04d/image.png -frames:v {n_frames} \
             -vf pad=ceil(iw/2)*2:ceil(ih/2)*2 -c:v libx264 -crf 18 -pix_fmt yuv420p \
             -movflags +faststart"
        );
        arguments.split(' ').map(str::to_owned).collect()
    }
}
