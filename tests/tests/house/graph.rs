//! Which file imports from which: circles and floors.

use super::sources::Crate;
use std::collections::{BTreeMap, BTreeSet};

pub(super) struct Graph<'a> {
    imports: BTreeMap<&'a str, BTreeSet<&'a str>>,
}

impl<'a> Graph<'a> {
    pub(super) fn of(krate: &'a Crate) -> Self {
        Graph {
            imports: krate
                .modules()
                .map(|module| (module, krate.imports(module)))
                .collect(),
        }
    }

    /// All that can be reached from a module by one import or more.
    fn reached(&self, from: &str) -> BTreeSet<&'a str> {
        let mut found = BTreeSet::new();
        let mut open: Vec<&str> = self.imports[from].iter().copied().collect();
        while let Some(module) = open.pop() {
            if found.insert(module) {
                open.extend(&self.imports[module]);
            }
        }
        found
    }

    /// The sets of files that import each other.
    pub(super) fn circles(&self) -> Vec<Vec<&'a str>> {
        let reached: BTreeMap<_, _> = self.imports.keys().map(|&m| (m, self.reached(m))).collect();
        let mut circles: Vec<Vec<&str>> = Vec::new();
        for (&module, from_here) in &reached {
            if from_here.contains(module) && !circles.iter().flatten().any(|&m| m == module) {
                let both = |m: &&str| from_here.contains(m) && reached[m].contains(module);
                circles.push(reached.keys().copied().filter(both).collect());
            }
        }
        circles
    }

    /// The folder of a module; a folder's own file is in it, and files beside the root are in none.
    fn folder(&self, module: &'a str) -> Option<&'a str> {
        match self.imports.keys().any(|m| is_within(m, module)) {
            true => Some(module),
            false => module.rsplit_once('/').map(|(folder, _)| folder),
        }
    }

    /// The pairs of folders each of which imports from the other. Of a folder's own file it does not count
    /// what it imports from folders within: they are there for it.
    pub(super) fn folders_both_ways(&self) -> Vec<[&'a str; 2]> {
        let mut arrows = BTreeSet::new();
        for (&module, others) in &self.imports {
            for &other in others.iter().filter(|other| !is_within(other, module)) {
                if let (Some(from), Some(to)) = (self.folder(module), self.folder(other)) {
                    arrows.insert([from, to]);
                }
            }
        }
        let is_pair = |&[a, b]: &[&str; 2]| a < b && arrows.contains(&[b, a]);
        arrows.iter().copied().filter(is_pair).collect()
    }

    /// The longest chain of imports, from the ground up. A circle is one floor; the root, which names what is
    /// to be seen from outside, is none.
    pub(super) fn longest_chain(&self) -> Vec<String> {
        let circles = self.circles();
        let circle = |m: &str| circles.iter().find(|c| c.contains(&m));
        let mut chains: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        let mut open: Vec<&str> = self.imports.keys().copied().collect();
        // A module is done when all that it imports from, its circle excepted, is done.
        while !open.is_empty() {
            let before = open.len();
            open.retain(|&module| {
                let floor = circle(module).cloned().unwrap_or_else(|| vec![module]);
                let below = floor
                    .iter()
                    .flat_map(|m| &self.imports[m])
                    .filter(|m| !floor.contains(m));
                let below: Option<Vec<_>> = below.map(|m| chains.get(m)).collect();
                let Some(below) = below else { return true };
                let mut chain = below
                    .into_iter()
                    .max_by_key(|c| c.len())
                    .cloned()
                    .unwrap_or_default();
                chain.push(floor.join("+"));
                chains.insert(module, chain);
                false
            });
            assert!(open.len() < before, "circles are one floor each");
        }
        let inside = chains
            .into_iter()
            .filter(|(module, _)| !matches!(*module, "lib" | "main"));
        inside
            .map(|(_, chain)| chain)
            .max_by_key(Vec::len)
            .unwrap_or_default()
    }
}

fn is_within(module: &str, folder: &str) -> bool {
    let rest = module.strip_prefix(folder);
    rest.is_some_and(|rest| rest.starts_with('/'))
}
