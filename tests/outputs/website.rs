//! The website that mdBook makes of the documents, in a real browser.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::chromium::Chromium;

/// Pictures that are not shown, by their addresses.
const MISSING_PICTURES: &str = "Array.from(document.images)\
    .filter((image) => !image.complete || image.naturalWidth === 0)\
    .map((image) => image.src)";
/// The addresses that the links of the text lead to.
const LINKS: &str = "Array.from(document.querySelectorAll('main a[href]'), (link) => link.href)";

fn strings(browser: &mut Chromium, expression: &str) -> Vec<String> {
    serde_json::from_value(browser.value(expression)).unwrap()
}

/// The pages of the book, without those that repeat them.
fn pages(website: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(website).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let is_page = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap();
        name.ends_with(".html") && !["404.html", "print.html", "toc.html"].contains(&name)
    };
    let mut pages: Vec<PathBuf> = files.filter(is_page).collect();
    pages.sort();
    pages
}

#[test]
#[ignore = "needs mdBook and Chromium: run tests/with-mdbook"]
fn every_page_shows_its_pictures_and_its_links_lead_somewhere() {
    let website = std::env::var("RAYCOST_WEBSITE").expect("run tests/with-mdbook");
    let website = fs::canonicalize(website).unwrap();
    let pages = pages(&website);
    assert!(pages.len() >= 20, "{pages:?}");
    let mut browser = Chromium::start([1280, 900]);
    let mut n_links = 0;
    for page in &pages {
        let name = page.file_name().unwrap().to_str().unwrap();
        let ready = "document.readyState === 'complete'";
        let here = format!("location.pathname.endsWith('/{name}') && {ready}");
        browser.visit(page, &here);
        let missing = strings(&mut browser, MISSING_PICTURES);
        assert!(missing.is_empty(), "{name}: {missing:?}");
        for link in strings(&mut browser, LINKS) {
            let Some(path) = link.strip_prefix("file://") else {
                assert!(link.starts_with("https://"), "{name}: {link}");
                continue;
            };
            let (file, anchor) = path.split_once('#').unwrap_or((path, ""));
            assert!(Path::new(file).is_file(), "{name}: {link}");
            assert!(
                file.starts_with(website.to_str().unwrap()),
                "{name}: {link}"
            );
            let text = fs::read_to_string(file).unwrap_or_default();
            let is_there = anchor.is_empty() || text.contains(&format!("id=\"{anchor}\""));
            assert!(is_there, "{name}: {link}");
            n_links += 1;
        }
        browser.assert_calm();
    }
    assert!(n_links > 100, "{n_links}");
}
