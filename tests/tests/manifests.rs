//! Do the manifests say what a registry wants to know, and are packages made of what they name?
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

/// The manifests of all members of the workspace, by their folders.
fn manifests() -> Vec<(String, String)> {
    let mut folders = ["tests", "benches", "python", "web"]
        .map(str::to_owned)
        .to_vec();
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        folders.push(format!("crates/{name}"));
    }
    let all = folders.into_iter();
    all.map(|folder| (folder.clone(), text(&format!("{folder}/Cargo.toml"))))
        .collect()
}

fn is_published(manifest: &str) -> bool {
    !manifest.lines().any(|line| line == "publish = false")
}

/// The value of `key = "value"`.
fn value<'a>(manifest: &'a str, key: &str) -> Option<&'a str> {
    let line = manifest.lines().find(|line| line.starts_with(key))?;
    line.split('"').nth(1)
}

#[test]
fn every_package_says_what_it_is() {
    let all = manifests();
    assert!(all.iter().filter(|(_, m)| is_published(m)).count() > 10);
    for (folder, manifest) in &all {
        if !is_published(manifest) {
            continue;
        }
        assert!(value(manifest, "description").is_some_and(|d| d.len() > 20));
        for key in [
            "version",
            "edition",
            "rust-version",
            "license",
            "authors",
            "keywords",
            "categories",
        ] {
            let line = format!("{key}.workspace = true");
            assert!(manifest.contains(&line), "{folder}: {line} is missing");
        }
        // A path is left out of a package, and a version takes its place: those of the workspace have one.
        assert!(!manifest.contains("path = \"../"), "{folder}");
    }
    let shared = text("Cargo.toml");
    let version = value(&shared, "version").unwrap();
    let paths = shared.lines().filter(|line| line.contains("{ path = "));
    assert!(paths.clone().count() > 10);
    for line in paths {
        assert!(line.contains(&format!("version = \"{version}\"")), "{line}");
    }
    // What a registry takes at most.
    let list = |key: &str| {
        let line = shared.lines().find(|line| line.starts_with(key)).unwrap();
        line.matches('"').count() / 2
    };
    assert!((1..=5).contains(&list("keywords")) && (1..=5).contains(&list("categories")));
}

/// A link to a place where the project is not leads nowhere: until it has an address no manifest names one.
#[test]
fn no_manifest_names_a_repository() {
    let all = manifests().into_iter();
    for (place, manifest) in all.chain([("the root".to_owned(), text("Cargo.toml"))]) {
        let names_one = |line: &&str| line.starts_with("repository");
        assert_eq!(manifest.lines().find(names_one), None, "{place}");
    }
    assert_eq!(value(&text("CITATION.cff"), "repository-code"), None);
}

/// `.ci/package` leaves out what is not published, and nothing else.
#[test]
fn every_published_crate_is_packaged() {
    let script = text(".ci/package");
    let words: Vec<&str> = script.split_whitespace().collect();
    let excluded: BTreeSet<&str> = words
        .windows(2)
        .filter(|pair| pair[0] == "--exclude")
        .map(|pair| pair[1])
        .collect();
    let all = manifests();
    let unpublished = all.iter().filter(|(_, m)| !is_published(m));
    let names: BTreeSet<&str> = unpublished
        .map(|(_, manifest)| value(manifest, "name").unwrap())
        .collect();
    assert_eq!(excluded, names);
}

/// At the root `cargo run` means the program, and there is one of it.
#[test]
fn cargo_run_means_the_program() {
    let shared = text("Cargo.toml");
    assert!(shared.contains("default-members = [\"crates/cli\"]"));
    assert!(text("crates/cli/Cargo.toml").contains("default-run = \"equip\""));
}
