//! The sources of a crate, and what they import.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A path of names, `crate::a::B` being ["crate", "a", "B"].
type Names = Vec<String>;

/// One file: its text without comments, strings and test modules, cut into words.
struct Source {
    file: String,
    words: Vec<String>,
}

/// All files of a crate, by module: `a/b` is `a/b.rs` or `a/b/mod.rs`, `lib` the root.
pub(super) struct Crate {
    modules: BTreeMap<String, Source>,
}

impl Crate {
    pub(super) fn read(src: &Path) -> Self {
        let mut files = Vec::new();
        let mut folders = vec![src.to_path_buf()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|e| e == "rs") {
                    let name = path
                        .strip_prefix(src)
                        .unwrap()
                        .to_str()
                        .unwrap()
                        .replace('\\', "/");
                    files.push((name, std::fs::read_to_string(&path).unwrap()));
                }
            }
        }
        let files: Vec<_> = files
            .iter()
            .map(|(name, text)| (name.as_str(), text.as_str()))
            .collect();
        Self::of(&files)
    }

    /// A crate of these files, each given by its path below `src` and its text.
    pub(super) fn of(files: &[(&str, &str)]) -> Self {
        let module = |file: &str| {
            let name = file.trim_end_matches(".rs");
            name.strip_suffix("/mod").unwrap_or(name).to_string()
        };
        let source = |(file, text): &(&str, &str)| Source {
            file: file.to_string(),
            words: without_tests(words(text)),
        };
        Crate {
            modules: files.iter().map(|f| (module(f.0), source(f))).collect(),
        }
    }

    pub(super) fn modules(&self) -> impl Iterator<Item = &str> {
        self.modules.keys().map(String::as_str)
    }

    /// How many modules each folder has; a folder's own file counts in the folder above.
    pub(super) fn folders(&self) -> BTreeMap<String, usize> {
        let mut folders = BTreeMap::new();
        for module in self.modules() {
            let folder = module.rsplit_once('/').map_or("", |(folder, _)| folder);
            *folders.entry(folder.to_string()).or_insert(0) += 1;
        }
        folders
    }

    /// The crates of this workspace that each file names.
    pub(super) fn other_crates(&self) -> BTreeMap<&str, BTreeSet<String>> {
        let named = |source: &Source| {
            let names = source
                .words
                .iter()
                .filter_map(|word| word.strip_prefix("equip_"));
            // Macros of a crate and names of variables begin alike: only what a path begins with is a crate.
            let path = |name: &&str| {
                let word = format!("equip_{name}");
                source
                    .words
                    .windows(2)
                    .any(|w| w[0] == word && w[1] == "::")
            };
            names
                .filter(path)
                .map(String::from)
                .collect::<BTreeSet<_>>()
        };
        self.modules
            .values()
            .map(|s| (s.file.as_str(), named(s)))
            .collect()
    }

    /// The modules that a module imports from, itself excepted.
    pub(super) fn imports<'a>(&'a self, module: &'a str) -> BTreeSet<&'a str> {
        let mut found = BTreeSet::new();
        for names in paths(&self.modules[module].words) {
            if let Some(target) = self.resolve(module, &names, 0) {
                found.insert(target);
            }
        }
        found.remove(module);
        found
    }

    /// The root's name: `lib`, or `main` of a program.
    fn root(&self) -> &str {
        if self.modules.contains_key("lib") {
            "lib"
        } else {
            "main"
        }
    }

    fn child(&self, of: &str, name: &str) -> Option<&str> {
        let path = if of == self.root() {
            name.to_string()
        } else {
            format!("{of}/{name}")
        };
        self.modules
            .get_key_value(&path)
            .map(|(key, _)| key.as_str())
    }

    fn parent<'a>(&'a self, of: &'a str) -> &'a str {
        of.rsplit_once('/')
            .map_or(self.root(), |(parent, _)| parent)
    }

    /// The module that a path written in `from` leads to, through at most a few `pub use`.
    fn resolve<'a>(&'a self, from: &'a str, names: &[String], depth: usize) -> Option<&'a str> {
        let mut names = names;
        let mut at = from;
        match names[0].as_str() {
            "crate" => at = self.root(),
            "self" => {}
            "super" => at = self.parent(from),
            first => at = self.child(from, first)?,
        }
        names = &names[1..];
        while names.first().is_some_and(|name| name == "super") {
            at = self.parent(at);
            names = &names[1..];
        }
        while let Some(next) = names.first().and_then(|name| self.child(at, name)) {
            at = next;
            names = &names[1..];
        }
        let (Some(name), true) = (names.first(), depth < 4) else {
            return Some(at);
        };
        // What the file only passes on comes from elsewhere, perhaps from another crate.
        for passed in reexports(&self.modules[at].words) {
            if passed.last() == Some(name) && passed.len() > 1 {
                return self.resolve(at, &passed, depth + 1);
            }
        }
        Some(at)
    }
}

/// The words of a text: names, `::`, lifetimes left out, every other sign by itself; comments and strings
/// left out.
fn words(text: &str) -> Vec<String> {
    let text: Vec<char> = text.chars().collect();
    let at = |i: usize| text.get(i).copied().unwrap_or(' ');
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let (mut words, mut i) = (Vec::new(), 0);
    while i < text.len() {
        let c = text[i];
        if c == '/' && at(i + 1) == '/' {
            while i < text.len() && text[i] != '\n' {
                i += 1;
            }
        } else if c == '/' && at(i + 1) == '*' {
            while i < text.len() && !(text[i] == '*' && at(i + 1) == '/') {
                i += 1;
            }
            i += 2;
        } else if c == '"' {
            i += 1;
            while i < text.len() && text[i] != '"' {
                i += if text[i] == '\\' { 2 } else { 1 };
            }
            i += 1;
        } else if c == 'r'
            && (at(i + 1) == '"' || at(i + 1) == '#' && matches!(at(i + 2), '"' | '#'))
        {
            let hashes = text[i + 1..].iter().take_while(|&&c| c == '#').count();
            i += hashes + 2;
            let ends = |i: usize| at(i) == '"' && (1..=hashes).all(|k| at(i + k) == '#');
            while i < text.len() && !ends(i) {
                i += 1;
            }
            i += hashes + 1;
        } else if c == '\'' {
            // A character, or the beginning of a lifetime.
            if at(i + 1) == '\\' {
                i += 3;
                while i < text.len() && text[i] != '\'' {
                    i += 1;
                }
                i += 1;
            } else {
                i += if at(i + 2) == '\'' { 3 } else { 1 };
            }
        } else if is_name(c) {
            let from = i;
            while i < text.len() && is_name(text[i]) {
                i += 1;
            }
            words.push(text[from..i].iter().collect());
        } else if c == ':' && at(i + 1) == ':' {
            words.push("::".into());
            i += 2;
        } else {
            if !c.is_whitespace() {
                words.push(c.to_string());
            }
            i += 1;
        }
    }
    words
}

/// The end of the item that begins at `from`: behind its braces or its semicolon.
fn end_of_item(words: &[String], from: usize) -> usize {
    let mut depth = 0;
    for (i, word) in words.iter().enumerate().skip(from) {
        match word.as_str() {
            "{" => depth += 1,
            "}" if depth == 1 => return i + 1,
            "}" => depth -= 1,
            ";" if depth == 0 => return i + 1,
            _ => {}
        }
    }
    words.len()
}

/// The words without what is compiled for tests only.
fn without_tests(words: Vec<String>) -> Vec<String> {
    const TEST: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut i) = (Vec::new(), 0);
    while i < words.len() {
        if words[i..].iter().take(TEST.len()).eq(TEST.iter()) {
            i = end_of_item(&words, i + TEST.len());
        } else {
            kept.push(words[i].clone());
            i += 1;
        }
    }
    kept
}

/// All paths: those of `use` trees, and those in the code. Inside a module that stands in the file itself,
/// `super` is the file.
fn paths(words: &[String]) -> Vec<Names> {
    let mut all = Vec::new();
    let (mut i, mut depth, mut inside) = (0, 0, Vec::new());
    while i < words.len() {
        let first = all.len();
        let begins = i == 0 || words[i - 1] != "::" && words[i - 1] != ".";
        let is_path = begins && words.get(i + 1).is_some_and(|w| w == "::");
        match words[i].as_str() {
            "use" if begins => i = tree(words, i + 1, &mut Vec::new(), &mut all),
            "mod" if words.get(i + 2).is_some_and(|w| w == "{") => {
                depth += 1;
                inside.push(depth);
                i += 3;
            }
            "{" => {
                depth += 1;
                i += 1;
            }
            "}" => {
                if inside.last() == Some(&depth) {
                    inside.pop();
                }
                depth -= 1;
                i += 1;
            }
            _ if is_path => {
                let mut names = vec![words[i].clone()];
                let is_next = |i: usize| {
                    words.get(i + 1).is_some_and(|w| w == "::")
                        && words.get(i + 2).is_some_and(|w| is_name(w))
                };
                while is_next(i) {
                    names.push(words[i + 2].clone());
                    i += 2;
                }
                all.push(names);
                i += 1;
            }
            _ => i += 1,
        }
        for path in &mut all[first..] {
            let own = path
                .iter()
                .take(inside.len())
                .take_while(|name| *name == "super")
                .count();
            if own > 0 {
                path.drain(..own);
                path.insert(0, "self".into());
            }
        }
    }
    all
}

fn is_name(word: &str) -> bool {
    word.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// The paths of a `use` tree from word `i` on, each behind `prefix`; returns where the tree ends.
fn tree(words: &[String], mut i: usize, prefix: &mut Names, all: &mut Vec<Names>) -> usize {
    let length = prefix.len();
    while let Some(word) = words.get(i) {
        match word.as_str() {
            "::" => i += 1,
            "{" => {
                i += 1;
                while words.get(i).is_some_and(|w| w != "}") {
                    i = tree(words, i, &mut prefix.clone(), all);
                    if words.get(i).is_some_and(|w| w == ",") {
                        i += 1;
                    }
                }
                i += 1;
                prefix.truncate(length);
                return i;
            }
            "as" => i += 2,
            "," | "}" | ";" => break,
            name => {
                prefix.push(name.to_string());
                i += 1;
            }
        }
    }
    if !prefix.is_empty() {
        all.push(prefix.clone());
    }
    i
}

/// The paths of `pub use` alone.
fn reexports(words: &[String]) -> Vec<Names> {
    let mut all = Vec::new();
    for i in 1..words.len() {
        if words[i] == "use" && (words[i - 1] == "pub" || words[i - 1] == ")") {
            tree(words, i + 1, &mut Vec::new(), &mut all);
        }
    }
    all
}
