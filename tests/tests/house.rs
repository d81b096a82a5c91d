//! Does the house stand as docs/architecture.md draws it: imports point downward, no circles, few floors,
//! small rooms?
//!
//! Read from the sources: every `use` and every path that begins with `crate`, `super`, `self`, the name of a
//! child module or the name of another crate of this workspace. A name that a file only passes on (`pub use`)
//! counts as the file it comes from. Test modules and comments do not count.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

mod graph;
mod sources;
mod texts;

use graph::Graph;
use sources::Crate;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use texts::{rust_files, wide_comments};

/// The crates from the ground up; a crate imports from lower levels only.
const LEVELS: [&[&str]; 8] = [
    &["scalar"],
    &["tableau", "linear", "jit", "tables"],
    &["autodiff"],
    &["iterate", "scenes"],
    &["solver"],
    &["integrate"],
    &["equip"],
    &["cli"],
];

/// Folders that are lists of like things, and may be longer than [`MOST_FILES`].
const LISTS: &[(&str, &str)] = &[("scenes", "scenes")];

const MOST_FLOORS: usize = 8;
const MOST_FILES: usize = 12;
const MOST_LINES: usize = 400;
const MOST_COLUMNS: usize = 110;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All crates of `crates/`, by the names of their folders.
fn crates() -> BTreeMap<String, Crate> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        if folder.join("src").is_dir() {
            let name = folder.file_name().unwrap().to_str().unwrap().to_string();
            all.insert(name, Crate::read(&folder.join("src")));
        }
    }
    assert!(
        all.len() >= 7,
        "the crates are looked for in the right place"
    );
    all
}

/// The crates, and the programs beside them.
fn rooms() -> BTreeMap<String, Crate> {
    let mut rooms = crates();
    let mut beside = ["benches/peers/src", "tests/src", "web/src"]
        .map(|folder| root().join(folder))
        .to_vec();
    for entry in std::fs::read_dir(root().join("benches/src")).unwrap() {
        let folder = entry.unwrap().path();
        if folder.join("main.rs").exists() {
            beside.push(folder);
        }
    }
    for folder in beside {
        let name = folder.strip_prefix(root()).unwrap().display().to_string();
        rooms.insert(name, Crate::read(&folder));
    }
    rooms
}

fn level(name: &str) -> usize {
    LEVELS
        .iter()
        .position(|level| level.contains(&name))
        .unwrap_or_else(|| {
            panic!("crates/{name} has no level: add it to LEVELS and to docs/architecture.md")
        })
}

fn none(wrong: &[String]) {
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
}

#[test]
fn imports_between_crates_point_downward() {
    let mut wrong = Vec::new();
    for (name, krate) in crates() {
        for (file, others) in krate.other_crates() {
            for other in others {
                if other != name && level(&other) >= level(&name) {
                    wrong.push(format!(
                        "crates/{name}/src/{file} imports from crates/{other}"
                    ));
                }
            }
        }
    }
    none(&wrong);
}

#[test]
fn no_circles() {
    let mut wrong = Vec::new();
    for (name, krate) in rooms() {
        for circle in Graph::of(&krate).circles() {
            wrong.push(format!("{name}: {}", circle.join(" ")));
        }
    }
    none(&wrong);
}

/// Two folders of a crate do not import from each other.
#[test]
fn folders_import_one_way() {
    let mut wrong = Vec::new();
    for (name, krate) in rooms() {
        for [one, other] in Graph::of(&krate).folders_both_ways() {
            wrong.push(format!("{name}: {one} and {other} import from each other"));
        }
    }
    none(&wrong);
}

#[test]
fn at_most_eight_floors() {
    let mut wrong = Vec::new();
    for (name, krate) in rooms() {
        let tower = Graph::of(&krate).longest_chain();
        if tower.len() > MOST_FLOORS {
            wrong.push(format!(
                "{name}: {} floors, {}",
                tower.len(),
                tower.join(" <- ")
            ));
        }
    }
    none(&wrong);
}

#[test]
fn at_most_a_dozen_files_a_folder() {
    let mut wrong = Vec::new();
    for (name, krate) in rooms() {
        for (folder, files) in krate.folders() {
            if files > MOST_FILES && !LISTS.contains(&(name.as_str(), folder.as_str())) {
                wrong.push(format!("{name}: {files} files in src/{folder}"));
            }
        }
    }
    none(&wrong);
}

/// All Rust files, those of tests, benches and the page too.
fn texts() -> Vec<(String, String)> {
    let mut texts = Vec::new();
    for folder in ["crates", "tests", "benches", "web"] {
        for file in rust_files(&root().join(folder)) {
            let name = file.strip_prefix(root()).unwrap().display().to_string();
            texts.push((name, std::fs::read_to_string(&file).unwrap()));
        }
    }
    texts
}

#[test]
fn files_of_at_most_400_lines() {
    let mut wrong = Vec::new();
    for (file, text) in texts() {
        let lines = text.lines().count();
        if lines > MOST_LINES {
            wrong.push(format!("{lines} lines in {file}"));
        }
    }
    none(&wrong);
}

/// rustfmt breaks code, and leaves comments as they are.
#[test]
fn comments_of_at_most_110_columns() {
    let mut wrong = Vec::new();
    for (file, text) in texts() {
        for line in wide_comments(&text, MOST_COLUMNS) {
            wrong.push(format!("{file}:{line}"));
        }
    }
    none(&wrong);
}

/// The programs of the page of recipes are examples to be run as well, word by word.
#[test]
fn recipes_are_examples() {
    let page = std::fs::read_to_string(root().join("docs/recipes.md")).unwrap();
    let examples = root().join("crates/equip/examples");
    for name in [
        "rigid_body",
        "spins",
        "friction",
        "any_equations",
        "sensitivities",
    ] {
        let text = std::fs::read_to_string(examples.join(format!("{name}.rs"))).unwrap();
        let (_, program) = text.split_once("\n\n").unwrap();
        let block = format!("```rust\n{program}```\n");
        assert!(
            page.contains(&block),
            "{name} is not the program of docs/recipes.md"
        );
    }
}

/// The pages that lead through the sources lead to files that are there, and to names that are in them; a
/// path that does not begin at the root stands in a folder of the one before it.
#[test]
fn every_pointer_of_the_architecture_page_is_true() {
    let pages = ["architecture", "adding-a-method"];
    let pages = pages.map(|name| std::fs::read_to_string(root().join(format!("docs/{name}.md"))));
    let page: String = pages.into_iter().map(Result::unwrap).collect();
    let (mut found, mut wrong) = (0, Vec::new());
    for row in page.lines() {
        let (mut before, mut sources) = (PathBuf::new(), String::new());
        let words = row.split(|c: char| !(c.is_ascii_alphanumeric() || "/._".contains(c)));
        for word in words.filter(|word| word.ends_with(".rs") || word.ends_with(".py")) {
            let place = before
                .ancestors()
                .skip(1)
                .map(|folder| folder.join(word))
                .chain([PathBuf::from(word)])
                .find(|path| root().join(path).is_file());
            found += 1;
            match place {
                Some(path) => {
                    sources += &std::fs::read_to_string(root().join(&path)).unwrap();
                    before = path;
                }
                None => wrong.push(format!("{word}, in: {row}")),
            }
        }
        let is_of_names = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let all: BTreeSet<&str> = sources.split(|c| !is_of_names(c)).collect();
        let last = row.rsplit('|').nth(1).unwrap_or_default();
        let in_code = last.split('`').skip(1).step_by(2);
        let names = in_code.flat_map(|code| code.split(|c| !is_of_names(c)));
        for name in names.filter(|name| !name.is_empty() && !sources.is_empty()) {
            if !all.contains(name) {
                wrong.push(format!("`{name}`, in: {row}"));
            }
        }
    }
    assert!(found > 100, "{found} pointers");
    none(&wrong);
}

/// A folder on the list is long enough to need it.
#[test]
fn lists_are_long() {
    let all = crates();
    for (name, folder) in LISTS {
        let files = all[*name].folders().get(*folder).copied().unwrap_or(0);
        assert!(files > MOST_FILES, "{name}/{folder} need not be on LISTS");
    }
}

/// What the measure is told apart by, on sources that are wrong in every way.
#[test]
fn the_measure_measures() {
    let krate = Crate::of(&[
        (
            "lib.rs",
            "mod a;\nmod b;\nmod c;\npub use a::A;\npub use b::deep::D;",
        ),
        (
            "a.rs",
            "//! crate::c is only spoken of\nuse crate::{D, c::C as _};\n#[cfg(test)]\nmod tests { use crate::b::B; }",
        ),
        (
            "b.rs",
            "pub mod deep;\npub struct B;\nfn f() -> &'static str { \"crate::a\" }",
        ),
        ("b/deep.rs", "use super::B;\npub struct D;"),
        (
            "c.rs",
            "pub struct C;\nfn f() { crate::A::new(); let _ = equip_solver::x(); }",
        ),
    ]);
    let graph = Graph::of(&krate);
    assert_eq!(graph.circles(), [["a", "c"]]);
    // b, b/deep, {a, c}.
    assert_eq!(graph.longest_chain(), ["b", "b/deep", "a+c"]);
    assert_eq!(krate.folders()[""], 4);
    assert_eq!(
        krate.other_crates()["c.rs"].iter().collect::<Vec<_>>(),
        ["solver"]
    );
    // d.rs imports from the folder within, which is no pair.
    let krate = Crate::of(&[
        ("lib.rs", "mod a;\nmod d;"),
        ("a/mod.rs", "pub mod b;\npub mod c;"),
        ("a/b.rs", "pub struct B;"),
        ("a/c.rs", "use super::b::B;\nuse crate::d::f::F;"),
        ("d.rs", "mod f;\nmod g;\nmod k;\nuse g::h::H;"),
        ("d/f.rs", "pub struct F;"),
        ("d/g.rs", "pub mod h;"),
        ("d/g/h.rs", "use super::super::f::F;\npub struct H;"),
        ("d/k.rs", "use crate::a::b::B;"),
    ]);
    let graph = Graph::of(&krate);
    assert!(graph.circles().is_empty());
    assert_eq!(graph.folders_both_ways(), [["a", "d"]]);
    let text =
        "//! long enough\n//! | long row\n//! $$ a\n//! = long b $$\n//! ok\nlet long_code = 1;";
    assert_eq!(wide_comments(text, 10), [1]);
}
