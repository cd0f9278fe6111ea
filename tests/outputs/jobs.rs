//! Jobs of a program: what `raycost render` does, without a command line.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use raycost::job::{Finished, Job, Observer, Output, PartDone, PicturePart, Report};
use raycost::job::{SceneFile, SceneSource, Tiles, run};
use raycost::session::{Event, RenderError};
use tempfile::TempDir;

use crate::common::same_output::assert_same_output;
use crate::common::{assert_success, in_repository, raycost};

/// A folder for outputs.
struct Outputs(TempDir);

impl Outputs {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// A small picture whose cost is counted.
fn spheres() -> SceneFile {
    SceneFile::new(in_repository("configs/seed_extended.yaml"))
        .set("image.width=96")
        .set("image.height=64")
        .set("tiles.size=16")
        .set("cost=counters")
}

/// A sphere that shrinks in three frames.
fn shrinking(folder: &Path) -> SceneFile {
    let scene = folder.join("shrinking.yaml");
    let text = "
image: {width: 24, height: 16}
camera: {look_at: {eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40}}
materials: {gray: {color: [0.5, 0.5, 0.5]}}
objects: [{sphere: {center: [0, 0, 0], radius: 1}, material: gray}]
lights: []
cost: counters
animation:
  frames: 3
  keyframes:
    objects[0].sphere.radius: [{frame: 0, value: 1}, {frame: 2, value: 0.5}]
";
    std::fs::write(&scene, text).unwrap();
    SceneFile::new(scene)
}

fn done(job: &Job) -> Report {
    run(job, &mut ()).unwrap()
}

#[test]
fn parts_merge_into_the_whole_picture() {
    let (out, scene) = (Outputs::new(), spheres());
    done(&Job::new(&scene, out.path("whole")));
    let job = Job::new(&scene, out.path("parts"));
    for part in ["1/2", "2/2", "1/2"] {
        let tiles = Tiles::Part(part.parse().unwrap());
        let report = done(&Job {
            tiles,
            ..job.clone()
        });
        assert_eq!(report.n_rendered + report.n_kept, 1);
    }
    let again = Job {
        tiles: Tiles::Part("2/2".parse().unwrap()),
        ..job.clone()
    };
    assert_eq!(done(&again).n_kept, 1);
    let tiles = Tiles::Merged;
    assert_eq!(done(&Job { tiles, ..job }).n_rendered, 1);
    assert_same_output(&out.path("whole"), &out.path("parts"));
}

#[test]
fn the_command_line_merges_the_parts_of_a_program() {
    let (out, scene) = (Outputs::new(), spheres());
    done(&Job::new(&scene, out.path("whole")));
    for part in ["1/2", "2/2"] {
        done(&Job {
            tiles: Tiles::Part(part.parse().unwrap()),
            ..Job::new(&scene, out.path("parts"))
        });
    }
    let merged = raycost().arg("merge").arg(out.path("parts")).output();
    assert_success(&merged.unwrap());
    assert_same_output(&out.path("whole"), &out.path("parts"));
}

#[test]
fn a_job_continues_where_its_time_was_over() {
    let (out, scene) = (Outputs::new(), spheres());
    done(&Job::new(&scene, out.path("whole")));
    let missing = Job {
        tiles: Tiles::Missing,
        ..Job::new(&scene, out.path("resumed"))
    };
    let no_time = Job {
        timeout: Some(Duration::ZERO),
        ..missing.clone()
    };
    let report = done(&no_time);
    assert!(report.is_partial);
    assert_eq!(report.n_rendered, 0);
    let report = done(&missing);
    assert!(!report.is_partial);
    assert_eq!(report.n_rendered, 1);
    assert_same_output(&out.path("whole"), &out.path("resumed"));
}

#[test]
fn only_missing_frames_are_rendered() {
    let out = Outputs::new();
    let scene = shrinking(&out.path(""));
    let all = Job::new(&scene, out.path("frames"));
    let one = Job {
        frames: Some(1..=1),
        ..all.clone()
    };
    let report = done(&one);
    assert_eq!([report.n_rendered, report.n_kept], [1, 0]);
    assert_eq!(report.series.unwrap().n_missing, 2);
    let report = done(&all);
    assert_eq!([report.n_rendered, report.n_kept], [2, 1]);
    let series = report.series.unwrap();
    assert_eq!(series.n_missing, 0);
    for file in &series.written {
        assert!(out.path("frames").join(file).exists(), "{file}");
    }
    let picture = Job {
        output: Output::Picture(out.path("last.png")),
        frames: Some(2..=2),
        ..all
    };
    assert!(!done(&picture).is_animated);
    let [alone, frame] = ["last.png", "frames/frames/0002/image.png"].map(|file| out.path(file));
    let pixels = |file: &Path| image::open(file).unwrap().into_rgb8().into_raw();
    assert!(pixels(&alone) == pixels(&frame));
}

/// Counts what a job reports.
#[derive(Default)]
struct Counting {
    n_pixels: AtomicU64,
    finished: Vec<String>,
    /// True to end the job before it starts, or after a picture.
    ends: [bool; 2],
}

impl Counting {
    fn ended(is_end: bool) -> Result<(), RenderError> {
        let why = || io::Error::new(io::ErrorKind::BrokenPipe, "enough");
        is_end.then(why).map_or(Ok(()), |why| Err(why.into()))
    }
}

impl Observer for Counting {
    fn begin(&mut self) -> Result<(), RenderError> {
        Self::ended(self.ends[0])
    }

    fn event(&self, event: Event) {
        if let Event::Rendered(progress) = event {
            self.n_pixels
                .fetch_add(progress.n_pixels, Ordering::Relaxed);
        }
    }

    fn finished(&mut self, finished: Finished) -> Result<(), RenderError> {
        self.finished.push(match finished {
            Finished::Picture(picture) => format!("picture {}", picture.written.len()),
            Finished::OnlyPicture(picture) => format!("only {}", picture.path.display()),
            Finished::Part(part, PartDone::Rendered(n_tiles, _), _) => {
                format!("part {part}: {n_tiles}")
            }
            Finished::Part(..) | Finished::Kept(..) => "kept".to_owned(),
        });
        Self::ended(self.ends[1])
    }
}

#[test]
fn an_observer_sees_and_ends_a_job() {
    let (out, scene) = (Outputs::new(), spheres());
    let part: PicturePart = "1/4".parse().unwrap();
    let job = Job {
        tiles: Tiles::Part(part),
        ..Job::new(&scene, out.path("out"))
    };
    let mut counting = Counting::default();
    run(&job, &mut counting).unwrap();
    let n_tiles = counting.n_pixels.into_inner() / 256;
    assert!((1..24).contains(&n_tiles));
    assert_eq!(counting.finished, [format!("part 1/4: {n_tiles}")]);
    for (ends, n_finished) in [([true, false], 0), ([false, true], 1)] {
        let mut counting = Counting {
            ends,
            ..Counting::default()
        };
        let ended = run(&job, &mut counting);
        assert!(matches!(ended, Err(RenderError::Observer(_))), "{ended:?}");
        assert_eq!(counting.finished.len(), n_finished);
    }
}

#[test]
fn a_mistake_in_a_setting_is_shown() {
    let out = Outputs::new();
    let scene = spheres().set("image.widht=3");
    assert!(scene.flags().contains(&"--set=image.widht=3".to_owned()));
    let error = run(&Job::new(&scene, out.path("out")), &mut ()).unwrap_err();
    assert!(error.to_string().contains("unknown key `widht`"), "{error}");
    assert!(!out.path("out").exists());
}
