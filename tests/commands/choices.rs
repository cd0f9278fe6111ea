//! The docs list every choice: each key and keyword of scene files, each cost metric
//! and each subcommand.

use clap::CommandFactory;
use raycost::cli::Cli;
use scene::camera::Camera;
use scene::color::{ColorMap, ToneCurve, Transfer};
use scene::config::{
    CostMode, Object, Outputs, PixelArray, PixelFilter, PixelPattern, ShadingModel, TileOrder,
};
use scene::import::read_mesh;
use scene::light::Light;
use scene::material::{ArrayScale, Mapping, Texture};
use scene::picture::{TexelFilter, Wrap};
use scene::yaml::from_str;
use serde::de::DeserializeOwned;
use tracer::cost::Metric;
use vtk::Codec;

use crate::book::pages;

fn page(path: &str) -> String {
    let mut pages = pages().into_iter();
    pages.find(|(found, _)| found == path).unwrap().1
}

/// The choices that the error about the unknown choice `zzz` lists.
fn choices<T: DeserializeOwned>(yaml: &str) -> Vec<String> {
    let Err(error) = from_str::<T>(yaml) else {
        panic!("`{yaml}` is a choice")
    };
    let error = error.to_string();
    let quoted = error.split('`').skip(1).step_by(2);
    let choices: Vec<String> = quoted
        .filter(|word| *word != "zzz" && !word.starts_with('['))
        .map(str::to_owned)
        .collect();
    assert!(choices.len() > 1 || yaml.contains("color"), "{error}");
    choices
}

#[test]
fn the_scene_reference_lists_every_key_and_keyword() {
    let page = page("docs/scene.md");
    let found = [
        choices::<Camera>("zzz: {}"),
        choices::<Light>("zzz: {}"),
        choices::<Object>("zzz: {}"),
        choices::<Texture>("zzz: {} # of a color"),
        choices::<Mapping>("zzz"),
        choices::<Mapping>("{ zzz: {} }"),
        choices::<Wrap>("zzz"),
        choices::<TexelFilter>("zzz"),
        choices::<Outputs>("[zzz]"),
        choices::<PixelArray>("zzz"),
        choices::<PixelPattern>("zzz"),
        choices::<PixelFilter>("zzz"),
        choices::<ShadingModel>("zzz"),
        choices::<ToneCurve>("zzz"),
        choices::<Transfer>("zzz"),
        choices::<CostMode>("zzz"),
        choices::<TileOrder>("zzz"),
        choices::<Codec>("zzz"),
        choices::<ColorMap>("zzz"),
        choices::<ArrayScale>("zzz"),
    ];
    for choice in found.concat() {
        let is_listed =
            page.contains(&format!("`{choice}`")) || page.contains(&format!("`{choice}: "));
        assert!(is_listed, "docs/scene.md does not list `{choice}`");
    }
}

#[test]
fn the_scene_reference_lists_every_mesh_format() {
    let error = read_mesh("mesh.zzz".as_ref()).unwrap_err().to_string();
    let (_, formats) = error.split_once("ends in ").unwrap();
    let page = page("docs/scene.md");
    for format in formats
        .split(" or ")
        .flat_map(|formats| formats.split(", "))
    {
        let name = format.trim_start_matches('.').to_uppercase();
        assert!(page.contains(&name), "docs/scene.md does not list {name}");
    }
}

#[test]
fn the_output_reference_lists_every_cost_metric() {
    let page = page("docs/outputs.md");
    for metric in Metric::ALL {
        let name = format!("`{}`", metric.name);
        assert!(page.contains(&name), "docs/outputs.md does not list {name}");
    }
}

#[test]
fn the_book_shows_every_subcommand() {
    let text: String = pages().into_iter().map(|(_, text)| text).collect();
    for command in Cli::command().get_subcommands() {
        let name = format!("raycost {}", command.get_name());
        assert!(text.contains(&name), "no page shows `{name}`");
    }
}
