//! Do the pages of the guide lead where they say, are all of them in its list of chapters, and are texts for
//! users written in the words of the field?
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

mod links;
mod words;

use links::{anchors, links};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use words::{WORDS, count, of_page, of_python, of_rust};

fn root() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap().to_path_buf()
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

/// Files below a folder whose names end so, by their paths from the root, those that builds made excepted.
fn files(below: &str, end: &str) -> Vec<String> {
    let (mut found, mut folders) = (Vec::new(), vec![root().join(below)]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                folders.push(path);
            } else if name.ends_with(end) {
                let path = path.strip_prefix(root()).unwrap();
                found.push(path.to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

/// The documents for readers, by their paths from the root.
fn documents() -> Vec<String> {
    let mut all = vec!["README.md".to_owned(), "CHANGELOG.md".into()];
    all.push("python/README.md".into());
    all.extend(files("docs", ".md"));
    all.extend(files("python/docs", ".md"));
    all
}

fn none(wrong: &[String]) {
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
}

/// The folder of a page and a link in it, as a path from the root; `None` if it leads out of the project.
fn target(page: &str, link: &str) -> Option<String> {
    let mut parts: Vec<&str> = page.split('/').collect();
    parts.pop();
    for part in link.split('/').filter(|part| !part.is_empty()) {
        match part {
            "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    Some(parts.join("/"))
}

#[test]
fn every_page_is_a_chapter() {
    let summary = read("docs/SUMMARY.md");
    let entries = links(&summary);
    let chapters: BTreeSet<String> = entries
        .iter()
        .filter_map(|link| target("docs/SUMMARY.md", link))
        .collect();
    assert_eq!(chapters.len(), entries.len(), "a chapter is there twice");
    let mut pages: BTreeSet<String> = files("docs", ".md").into_iter().collect();
    pages.remove("docs/SUMMARY.md");
    assert!(pages.len() > 40, "{} pages", pages.len());
    assert_eq!(chapters, pages);
}

/// Files and headings that links name are there. A link from the guide to another folder names no page: the
/// book, in which pages end in `.html`, has only its own.
#[test]
fn every_link_leads_somewhere() {
    let (mut found, mut wrong) = (0, Vec::new());
    for page in documents() {
        for link in links(&read(&page)) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            found += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let place = match file {
                "" => Some(page.clone()),
                file => target(&page, file),
            };
            let Some(place) = place.filter(|place| root().join(place).exists()) else {
                wrong.push(format!("{page}: {link}"));
                continue;
            };
            let folder = root().join(&place);
            let text = match folder.is_dir() {
                true => format!("{place}/README.md"),
                false => place.clone(),
            };
            if !anchor.is_empty() && !anchors(&read(&text)).contains(anchor) {
                wrong.push(format!("{page}: {link}: no such heading"));
            }
            let leaves = page.starts_with("docs/") && !place.starts_with("docs/");
            if leaves && place.ends_with(".md") {
                wrong.push(format!("{page}: {link}: name its folder, not the page"));
            }
            if page.starts_with("docs/") && place == "docs/SUMMARY.md" {
                wrong.push(format!("{page}: {link}: no page of the book"));
            }
        }
    }
    assert!(found > 100, "{found} links");
    none(&wrong);
}

/// Words that stood for terms of the field, each at most three times in all.
#[test]
fn texts_for_users_are_written_in_the_words_of_the_field() {
    const MOST: usize = 3;
    let mut texts: Vec<(String, Vec<String>)> = Vec::new();
    for page in documents() {
        texts.push((page.clone(), of_page(&read(&page))));
    }
    for file in files("crates", ".rs")
        .into_iter()
        .chain(files("python/src", ".rs"))
        .chain(files("web/src", ".rs"))
    {
        if file.contains("/src/") {
            texts.push((
                file.clone(),
                of_rust(&read(&file), file.contains("cli/src/args")),
            ));
        }
    }
    for file in files("python/package", ".py")
        .into_iter()
        .chain(files("python/package", ".pyi"))
    {
        texts.push((file.clone(), of_python(&read(&file))));
    }
    texts.push(("web/page".into(), of_page(&read("web/page/index.html"))));
    for file in files("python/notebooks", ".ipynb") {
        // Pictures are long lines.
        let text = read(&file);
        let lines = text.lines().filter(|line| line.len() < 2000);
        texts.push((file.clone(), lines.map(str::to_owned).collect()));
    }
    let all: usize = texts.iter().map(|(_, parts)| parts.len()).sum();
    assert!(all > 2000, "{all} texts");
    let mut wrong = Vec::new();
    for word in WORDS {
        let mut places = Vec::new();
        for (file, parts) in &texts {
            let uses: usize = parts.iter().map(|part| count(part, word)).sum();
            if uses > 0 {
                places.push(format!("{uses} in {file}"));
            }
        }
        let uses = texts
            .iter()
            .flat_map(|(_, parts)| parts)
            .map(|part| count(part, word));
        if uses.sum::<usize>() > MOST {
            wrong.push(format!("{word:?}: {}", places.join(", ")));
        }
    }
    none(&wrong);
}
