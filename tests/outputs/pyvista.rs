//! The plot of the book, by PyVista.

use std::fs;

use image::RgbaImage;

use crate::common::paraview::{folder, on_virtual_screen, render};
use crate::common::{assert_success, in_repository};

/// The part of a screenshot that is not background.
fn covered(picture: &RgbaImage) -> f64 {
    let background = *picture.get_pixel(0, 0);
    let shown = picture.pixels().filter(|&&pixel| pixel != background);
    shown.count() as f64 / (picture.width() * picture.height()) as f64
}

/// The cloud of a scene with an infinite plane fills the view.
#[test]
#[ignore = "needs PyPI's pyvista: run tests/with-paraview"]
fn the_plot_of_the_book_shows_the_cloud() {
    let book = fs::read_to_string(in_repository("docs/outputs.md")).unwrap();
    let (_, block) = book.split_once("```python\n").unwrap();
    let (plot, _) = block.split_once("```").unwrap();
    assert_eq!(plot.lines().count(), 6, "the book shows it in six lines");

    let folder = folder("pyvista");
    let out = render(&in_repository("configs/seed_extended.yaml"), "pyvista", &[]);
    let shown = |name: &str, plot: &str| {
        let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
        let plot = plot.replace("out/seed_extended", out.to_str().unwrap());
        let mut command = on_virtual_screen();
        command.args([&python, "-c", &plot.replace("cloud.png", name)]);
        command.env("PYVISTA_OFF_SCREEN", "true");
        assert_success(&command.current_dir(&folder).output().unwrap());
        image::open(folder.join(name)).unwrap().into_rgba8()
    };
    let picture = shown("cloud.png", plot);
    let colors: std::collections::HashSet<_> = picture.pixels().collect();
    assert!(colors.len() > 100, "{} colors", colors.len());
    assert!(covered(&picture) > 0.05, "{}", covered(&picture));
    // With the horizon, nothing of the scene is seen.
    let naive = shown("horizon.png", &plot.replace("(near,", "(hits,"));
    assert!(covered(&naive) < 0.5 * covered(&picture));
}
