//! The docs list every choice: each format of meshes, each cost metric and each
//! subcommand.

use clap::CommandFactory;
use import::read_mesh;
use raycost::cli::Cli;
use tracer::cost::Metric;

use crate::book::pages;

fn page(path: &str) -> String {
    let mut pages = pages().into_iter();
    pages.find(|(found, _)| found == path).unwrap().1
}

#[test]
fn the_scene_reference_lists_every_mesh_format() {
    let error = read_mesh("mesh.zzz".as_ref()).unwrap_err().to_string();
    let (_, formats) = error.split_once("ends in ").unwrap();
    let page = page("docs/meshes.md");
    for format in formats
        .split(" or ")
        .flat_map(|formats| formats.split(", "))
    {
        let name = format.trim_start_matches('.').to_uppercase();
        assert!(page.contains(&name), "docs/meshes.md does not list {name}");
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
