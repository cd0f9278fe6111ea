//! What the program says to a new user: of several mistakes at a time, of files of other
//! programs, and of scenes without a mistake that show nothing.

use std::fs;
use std::path::Path;
use std::process::Output;

use raycost::Session;
use raycost::session::RenderError;

use crate::common::{assert_success, in_repository, raycost};

/// A scene in which one sphere fills the middle of the picture.
const FINE: &str = "\
image: { width: 40, height: 30 }
camera: { look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 } }
materials: { red: { color: [1, 0, 0] } }
lights: [{ point: { position: [5, 5, 5] } }]
objects: [{ sphere: { center: [0, 0, 0], radius: 1 }, material: red }]
";

struct Folder(tempfile::TempDir);

impl Folder {
    /// A folder with a scene.
    fn with(scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.yaml"), scene).unwrap();
        Self(folder)
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = raycost();
        let output = command.current_dir(self.path()).args(arguments).output();
        output.unwrap()
    }

    /// What a command prints that ends well.
    fn text(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_success(&output);
        String::from_utf8(output.stdout).unwrap()
    }

    /// The message of a command that ends with 2.
    fn error(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        error
    }
}

/// The hints of `raycost check`, which are those of `raycost render`.
fn hints(scene: &str) -> Vec<String> {
    let folder = Folder::with(scene);
    let of = |arguments: &[&str]| -> Vec<String> {
        let report = folder.text(arguments);
        let hints = report
            .lines()
            .filter_map(|line| line.strip_prefix("hint    "));
        hints.map(str::to_owned).collect()
    };
    let checked = of(&["check", "scene.yaml"]);
    assert_eq!(checked, of(&["render", "scene.yaml"]));
    assert_eq!(checked, of(&["render", "scene.yaml", "-o", "a.png"]));
    checked
}

#[test]
fn mistakes_in_all_sections_are_reported_at_a_time() {
    let scene = FINE
        .replace("width: 40", "width: 40px")
        .replace("color", "colour")
        .replace("radius: 1", "radius: -1");
    let error = Folder::with(&scene).error(&["check", "scene.yaml"]);
    let places: Vec<&str> = error
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("--> scene.yaml:"))
        .collect();
    assert_eq!(places, ["1:17", "3:21", "5:50"], "{error}");
    // The message of a mistake is the same beside others.
    for (right, wrong) in [("color", "colour"), ("radius: 1", "radius: -1")] {
        let one = Folder::with(&FINE.replace(right, wrong)).error(&["check", "scene.yaml"]);
        assert!(error.contains(one.trim_end()), "{error} lacks {one}");
    }
    let parts = Folder::with(&format!("include: [part.yaml]\n{}", &scene));
    fs::write(
        parts.path().join("part.yaml"),
        "shading: { max_depht: 3 }\n",
    )
    .unwrap();
    let error = parts.error(&["check", "scene.yaml"]);
    assert_eq!(error.matches("error: ").count(), 4, "{error}");
    assert!(error.contains("--> part.yaml:1:12"), "{error}");
}

#[test]
fn at_most_ten_mistakes_are_reported() {
    let red = "red: { color: [1, 0, 0] }";
    let many: Vec<String> = (0..20).map(|i| format!("m{i}: {{ colour: 1 }}")).collect();
    let scene = FINE.replace(red, &format!("{red}, {}", many.join(", ")));
    let error = Folder::with(&scene).error(&["check", "scene.yaml"]);
    assert_eq!(error.matches("error: unknown key `colour`").count(), 10);
    let last = error.trim_end().lines().last();
    assert_eq!(
        last,
        Some("error: there are more mistakes, in what follows")
    );
}

#[test]
fn an_animation_prints_a_hint_of_each_kind_once() {
    let moving = "
animation:
  frames: 5
  keyframes:
    objects[0].sphere.center:
      - { frame: 1, value: [0, 0, 0] }
      - { frame: 2, value: [90, 0, 0] }
";
    let blue = "{ blue: { color: 1 }, ";
    let scene = FINE.replace("materials: { ", &format!("materials: {blue}")) + moving;
    let folder = Folder::with(&scene);
    let text = folder.text(&["render", "scene.yaml"]);
    let hints: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("hint    "))
        .collect();
    let expected = [
        "frame 0: no object has the material `blue`",
        "frame 2: the camera sees no object: check `eye`, `target` and the places of the objects",
    ];
    assert_eq!(hints, expected, "{text}");
}

#[test]
fn a_file_of_another_program_is_named_with_the_way_out() {
    let folder = Folder::with(FINE);
    for (file, format) in [
        ("a.fbx", "FBX"),
        ("b.BLEND", "Blender"),
        ("c.dae", "COLLADA"),
    ] {
        let error = folder.error(&["render", file]);
        assert!(
            error.contains(&format!("does not read {format} files")),
            "{error}"
        );
        assert!(error.contains("export glTF (.glb) or OBJ"), "{error}");
    }
}

#[test]
fn a_file_in_the_place_of_another_thing_is_recognized() {
    let folder = Folder::with(FINE);
    let scene = folder.path().join("scene.yaml");
    fs::copy(&scene, folder.path().join("my first scene.yaml")).unwrap();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    let [render, check] = ["render", "check"];
    for (arguments, part) in [
        (&["scene.yaml"][..], "raycost render scene.yaml`"),
        (
            &[render, "my", "first", "scene.yaml"],
            "'my first scene.yaml'",
        ),
        (&[render, "scene.yml"], "did you mean `scene.yaml`?"),
        (&[render, "~/scene.yaml"], "write the whole path"),
        (
            &[render, "nowhere/scene.yaml"],
            "there is no folder `nowhere`",
        ),
        (&[check, "scenes"], "a YAML file in it"),
    ] {
        let error = folder.error(arguments);
        assert!(error.contains(part), "{arguments:?}: {error}");
    }
}

#[test]
fn a_command_with_what_another_one_takes_says_what_would_be_right() {
    let folder = Folder::with(FINE);
    for (name, text) in [
        ("two.yaml", FINE),
        ("study.yaml", "title: a study\nscenes: [scene.yaml]\n"),
        ("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    for (arguments, part) in [
        (
            &["study", "scene.yaml"][..],
            "to render it: `raycost render scene.yaml`",
        ),
        (
            &["render", "study.yaml"],
            "to run it: `raycost study study.yaml`",
        ),
        (
            &["trace", "study.yaml", "--pixel=1,1"],
            "to run it: `raycost study study.yaml`",
        ),
        (
            &["view", "scene.yaml"],
            "render it, `raycost render scene.yaml`, and name the folder",
        ),
        (
            &["merge", "scene.yaml"],
            "`scene.yaml` is a file, not the folder of an output",
        ),
        (
            &["states", "scene.yaml"],
            "`scene.yaml` is a file, not the folder of an output",
        ),
        (
            &["render", "scene.yaml", "two.yaml"],
            "once for each: `raycost render two.yaml`",
        ),
        (&["render", "bal.obj"], "did you mean `ball.obj`?"),
        (
            &["render", "scene.yaml", "--up=z"],
            "`--up` is for a mesh without a scene",
        ),
        (
            &["render", "scene.yaml", "--width", "640x400"],
            "`--width 640 --height 400`",
        ),
        (
            &["render", "scene.yaml", "--height", "0"],
            "a whole number from 1 to 65535",
        ),
        (
            &["render", "scene.yaml", "--seed", "-1"],
            "a whole number from 0 to 18446744073709551615",
        ),
        (
            &["render", "scene.yaml", "--spp", "-1"],
            "-1 is not in 1..=65536",
        ),
    ] {
        let error = folder.error(arguments);
        assert!(error.contains(part), "{arguments:?}: {error}");
        assert_eq!(error.matches("error: ").count(), 1, "{error}");
    }
    assert!(!folder.path().join("out").exists());
    let json = folder.text(&["render", "scene.yaml", "--samples=2", "--quiet", "--json"]);
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(summary["image"]["samples_per_pixel"], 2);
}

#[test]
fn a_folder_keeps_the_output_of_its_scene() {
    let folder = Folder::with(FINE);
    let path = folder.path();
    fs::create_dir(path.join("other")).unwrap();
    fs::copy(path.join("scene.yaml"), path.join("other/scene.yaml")).unwrap();
    for format in ["obj", "OBJ"] {
        let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        fs::write(path.join("scene").with_extension(format), mesh).unwrap();
    }
    fn render<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
        let small = [
            "--cost=counters",
            "--spp=1",
            "--width=8",
            "--height=6",
            "--quiet",
        ];
        [&["render", scene], &small[..], more].concat()
    }
    folder.text(&render("scene.yaml", &[]));
    folder.text(&render("./scene.yaml", &[]));
    let error = folder.error(&render("other/scene.yaml", &[]));
    assert!(
        error.contains("`out/scene` has the output of another scene, `./scene.yaml`"),
        "{error}"
    );
    assert!(error.contains("`--out out/scene-2`"), "{error}");
    let error = folder.error(&["trace", "other/scene.yaml", "--pixel=1,1"]);
    assert!(error.contains("another scene"), "{error}");
    folder.text(&render("other/scene.yaml", &["--out=out/scene"]));
    // The scene that was rendered last is gone.
    fs::remove_dir_all(path.join("other")).unwrap();
    folder.text(&render("scene.yaml", &[]));
    for mesh in ["scene.obj", "scene.OBJ"] {
        folder.text(&render(mesh, &[]));
        assert!(
            path.join("out")
                .join(mesh.replace('.', "_"))
                .join("image.png")
                .exists()
        );
    }
}

/// The states of a moved output name its files, and the picture names no folder.
#[test]
fn states_are_written_anew_where_a_folder_has_moved() {
    let folder = Folder::with(FINE);
    let path = folder.path();
    let small = [
        "--cost=counters",
        "--spp=1",
        "--width=8",
        "--height=6",
        "--quiet",
    ];
    for out in ["old & first", "second"] {
        folder.text(&[&["render", "scene.yaml", "--out", out], &small[..]].concat());
    }
    let picture = |out: &str| fs::read(path.join(out).join("image.png")).unwrap();
    assert_eq!(picture("old & first"), picture("second"));
    let moved = path.join("new & last");
    fs::rename(path.join("old & first"), &moved).unwrap();
    let own = moved.join("mine.pvsm");
    fs::write(&own, "<Element value=\"/nowhere/frame.vti\"/>").unwrap();
    let state = || fs::read_to_string(moved.join("heatmap.pvsm")).unwrap();
    assert!(state().contains("/old &amp; first/frame.vti\""));
    assert_eq!(
        folder.text(&["states", "new & last"]),
        "wrote   3 states in new & last\n"
    );
    assert!(state().contains("/new &amp; last/frame.vti\"") && !state().contains("/old &amp;"));
    folder.text(&["check", "new & last"]);
    assert_eq!(
        folder.text(&["states", "new & last"]),
        "states  new & last needs none anew\n"
    );
    assert!(fs::read_to_string(own).unwrap().contains("/nowhere/"));
}

/// A folder from elsewhere has links in the places of a state and of frames.
#[test]
#[cfg(unix)]
fn states_behind_links_stay_as_they_are() {
    use std::os::unix::fs::symlink;

    let folder = Folder::with(FINE);
    let path = folder.path();
    let small = ["--spp=1", "--width=8", "--height=6", "--quiet"];
    folder.text(&[&["render", "scene.yaml", "--out", "old"], &small[..]].concat());
    fs::rename(path.join("old"), path.join("mine")).unwrap();
    let states = || ["geometry", "heatmap", "overview"].map(|state| format!("{state}.pvsm"));
    let texts = || states().map(|state| fs::read_to_string(path.join("mine").join(state)).unwrap());
    let before = texts();
    let frames = path.join("linked/frames");
    fs::create_dir(path.join("linked")).unwrap();
    symlink(path, &frames).unwrap();
    folder.text(&["states", "linked"]);
    fs::remove_file(&frames).unwrap();
    fs::create_dir(&frames).unwrap();
    symlink(path.join("mine"), frames.join("0001")).unwrap();
    folder.text(&["states", "linked"]);
    assert_eq!(texts(), before);
    // The others are written, and listed.
    let file = path.join("mine/heatmap.pvsm");
    let aside = path.join("heatmap.pvsm");
    fs::rename(&file, &aside).unwrap();
    symlink(&aside, &file).unwrap();
    let output = folder.run(&["states", "mine"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(fs::read_to_string(&aside).unwrap(), before[1]);
    fs::remove_file(&file).unwrap();
    fs::rename(&aside, &file).unwrap();
    folder.text(&["check", "mine"]);
    assert_ne!(texts()[2], before[2]);
}

/// A limit for the length of files lets the run write one of three states.
#[test]
#[cfg(unix)]
fn states_that_a_run_could_not_write_are_written_by_the_next() {
    let folder = Folder::with(FINE);
    let path = folder.path();
    let small = ["--spp=1", "--width=8", "--height=6", "--quiet"];
    folder.text(&[&["render", "scene.yaml", "--out", "old"], &small[..]].concat());
    fs::rename(path.join("old"), path.join("new")).unwrap();
    let states = || ["geometry", "heatmap", "overview"].map(|state| format!("new/{state}.pvsm"));
    let kibibytes = states().map(|state| fs::metadata(path.join(state)).unwrap().len() / 1024);
    assert!(kibibytes[0] + 2 < kibibytes[1].min(kibibytes[2]));
    let script = format!(
        "ulimit -f {}; exec '{}' states new",
        kibibytes[0] + 2,
        env!("CARGO_BIN_EXE_raycost")
    );
    let mut limited = std::process::Command::new("bash");
    let limited = limited.args(["-c", &script]).current_dir(path).output();
    assert_eq!(limited.unwrap().status.code(), Some(1));
    let is_moved = |state: &String| {
        fs::read_to_string(path.join(state))
            .unwrap()
            .contains("/new/")
    };
    assert_eq!(states().each_ref().map(is_moved), [true, false, false]);
    assert_eq!(folder.text(&["states", "new"]), "wrote   2 states in new\n");
    folder.text(&["check", "new"]);
}

#[test]
fn a_trace_without_pixels_names_both_ways_to_choose_them() {
    let error = Folder::with(FINE).error(&["trace", "scene.yaml"]);
    assert!(error.contains("<--pixel <X,Y>|--hottest <N>>"), "{error}");
}

#[test]
fn each_damaged_file_has_its_line() {
    let folder = Folder::with(FINE);
    folder.text(&["render", "scene.yaml", "--out", "out"]);
    for file in ["image.png", "cost.png"] {
        fs::write(folder.path().join("out").join(file), "").unwrap();
    }
    let error = folder.error(&["check", "out"]);
    assert!(!error.contains("\\n"), "{error}");
    for file in ["image.png", "cost.png"] {
        let is_its_line = |line: &str| line.contains(&format!("{file}: "));
        assert_eq!(
            error.lines().filter(|line| is_its_line(line)).count(),
            1,
            "{error}"
        );
    }
}

#[test]
fn a_black_picture_gets_a_hint() {
    assert_eq!(hints(FINE), [""; 0]);
    let dark = FINE.replace("[{ point: { position: [5, 5, 5] } }]", "[]");
    let dark = format!("{dark}shading: {{ ambient: 0 }}\n");
    let [hint] = &hints(&dark)[..] else { panic!() };
    assert!(hint.contains("nothing shines"), "{hint}");
    let away = FINE.replace("target: [0, 0, 0]", "target: [0, 0, 9]");
    let [hint] = &hints(&away)[..] else { panic!() };
    assert!(hint.starts_with("the camera sees no object"), "{hint}");
    let inside = FINE.replace("radius: 1", "radius: 6");
    let inside = format!("{inside}shading: {{ ambient: 0 }}\n");
    let [hint] = &hints(&inside)[..] else {
        panic!()
    };
    assert!(
        hint.contains("the eye is inside `objects[0]`, a `sphere`"),
        "{hint}"
    );
}

#[test]
fn a_picture_that_is_hardly_meant_gets_a_hint() {
    let floor = "objects: [{ plane: { point: [0, -1, 0], normal: [0, 1, 0] }, material: red }, ";
    let fine = FINE.replace("objects: [", floor);
    let eye = "eye: [0, 0, 5], target: [0, 0, 0]";
    let lamp = "point: { position: [5, 5, 5] }";
    let inside = "point: { position: [0.1, 0.5, 0] }";
    assert_eq!(hints(&fine), [""; 0]);
    for (scene, expected) in [
        (
            fine.replace("fov_y_deg: 40", "fov_y_deg: 0.7"),
            "the angle of view is 0.7 degrees: if these are radians, write 40.1",
        ),
        (
            fine.replace(eye, "eye: [0, -2, 5], target: [0, 4, 0]"),
            "`objects[0]`, a `plane`, fills the picture: the eye may be behind it",
        ),
        (
            fine.replace(eye, "eye: [0, 0, 0.5], target: [0, 0, 0]"),
            "the eye is inside `objects[1]`, a `sphere`, which fills the picture",
        ),
        (
            fine.replace(lamp, inside),
            "`lights[0]` is inside `objects[1]`, which its light does not leave",
        ),
        (
            format!("{FINE}background: 1\nfilm: {{ exposure: 20 }}\n")
                .replace("[1, 0, 0]", "[1, 1, 1]"),
            "the picture is white",
        ),
        (
            fine.replace("[{ point", "[] # ") + "shading: { ambient: 0 }\nbackground: 0.5\n",
            "what the camera sees is black: nothing shines",
        ),
        (
            fine.replace("material: red }", "material: red, name: a }"),
            "`objects[0]` and `objects[1]` are both named `a`",
        ),
    ] {
        let hints = hints(&scene);
        assert!(
            hints.iter().any(|hint| hint.starts_with(expected)),
            "{expected}: {hints:?}"
        );
    }
    // A room around eye and light, and a light in glass.
    let room = fine.replace("radius: 1", "radius: 9");
    assert_eq!(hints(&room), [""; 0]);
    let glass = "dielectric: { index: 1.5 }";
    let bulb = fine
        .replace(lamp, inside)
        .replace("color: [1, 0, 0]", glass)
        + "background: 0.5\n";
    assert_eq!(hints(&bulb), [""; 0]);
}

#[test]
fn a_material_that_no_object_has_gets_a_hint() {
    let scene = FINE.replace("red: {", "blue: { color: 0.5 }, red: {");
    assert_eq!(hints(&scene), ["no object has the material `blue`"]);
}

#[test]
fn boxes_of_a_hierarchy_are_left_out_where_there_is_none() {
    let folder = Folder::with(&format!("{FINE}output: [bvh, objects]\n"));
    let note = "note    `bvh` is left out: `brute_force` has no hierarchy\n";
    let brute_force = ["scene.yaml", "--acceleration", "brute_force"];
    let checked = folder.text(&[&["check"], &brute_force[..]].concat());
    assert!(checked.contains(note), "{checked}");
    let rendered = folder.text(&[&["render", "--out=out"], &brute_force[..]].concat());
    assert!(rendered.contains(note), "{rendered}");
    let out = folder.path().join("out");
    assert!(out.join("objects.csv").exists() && !out.join("bvh.vtu").exists());
    let with_one = folder.text(&["render", "scene.yaml", "--out=out"]);
    assert!(!with_one.contains("left out") && out.join("bvh.vtu").exists());
}

#[test]
fn an_eye_that_is_too_far_away_gets_a_note() {
    let view = |camera: &str| {
        let own = "look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }";
        let scene = FINE.replace(own, camera);
        Folder::with(&scene).text(&["check", "scene.yaml"])
    };
    let parallel = |far: &str| {
        view(&format!(
            "orthographic: {{ eye: [0, 3{far}, 4{far}], target: [0, 0, 0], height: 3 }}"
        ))
    };
    assert!(!parallel("").contains("the eye is so far"));
    assert!(!parallel("00").contains("the eye is so far"));
    assert!(parallel("00000").contains("note    the eye is so far"));
    let narrow = "look_at: { eye: [0, 3e5, 4e5], target: [0, 0, 0], fov_y_deg: 0.001 }";
    assert!(view(narrow).contains("note    the eye is so far"));
}

#[test]
fn a_main_that_returns_an_error_prints_its_message() {
    let folder = Folder::with(&FINE.replace("radius: 1", "radius: -1"));
    let error = Session::open(folder.path().join("scene.yaml")).unwrap_err();
    let (debug, display) = (format!("{error:?}"), error.to_string());
    assert_eq!(format!("error: {debug}"), display);
    assert_eq!(format!("{:?}", RenderError::Scene(error)), debug);
}

#[test]
fn a_new_scene_names_the_schema_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let new = |file: &str| {
        let mut command = raycost();
        let output = command
            .current_dir(folder.path())
            .args(["new", file])
            .output();
        let output = output.unwrap();
        assert_success(&output);
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(new("a.yaml").starts_with("wrote   a.yaml, scene.schema.json\n"));
    assert!(new("b.yaml").starts_with("wrote   b.yaml\n"));
    let schema = fs::read(folder.path().join("scene.schema.json")).unwrap();
    assert_eq!(schema, raycost().arg("schema").output().unwrap().stdout);
    let scene = fs::read_to_string(folder.path().join("a.yaml")).unwrap();
    let first = "# yaml-language-server: $schema=scene.schema.json\n";
    assert!(scene.starts_with(first), "{scene}");
}

#[test]
fn messages_about_long_words_are_short() {
    let long = "x".repeat(100_000);
    let scene = in_repository("configs/seed_sphere.yaml");
    let scene = scene.to_str().unwrap();
    let yaml = format!("{long}.yaml");
    for words in [
        vec![&*long],
        vec![&yaml],
        vec!["render", &yaml],
        vec!["render", scene, "--width", &long],
        vec!["render", scene, "--out", &long],
        vec!["render", scene, &long],
        vec!["check", scene, "--set", &long],
        vec!["view", &long],
        vec!["diff", &long, &long],
        vec!["study", &long],
        vec!["new", &long],
        vec!["trace", scene, "--pixel", &long],
    ] {
        let output = raycost().args(&words).output().unwrap();
        let length = output.stderr.len();
        assert!(
            !output.status.success() && (20..3000).contains(&length),
            "{:?}: {length}",
            words[0]
        );
    }
}
