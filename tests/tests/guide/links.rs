//! Links and headings of pages in Markdown.

use std::collections::BTreeSet;

/// The lines of a page that are not in blocks of code.
pub(super) fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    page.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// A line without the code in it, of which the quotes stay.
pub(super) fn without_code(line: &str) -> String {
    let parts = line.split('`').enumerate();
    let parts: Vec<&str> = parts
        .map(|(i, part)| if i % 2 == 0 { part } else { "" })
        .collect();
    parts.join("`")
}

/// Where the links and pictures of a page lead.
pub(super) fn links(page: &str) -> Vec<String> {
    // A text may be broken between its lines, and code in it has brackets of its own.
    let text: Vec<String> = prose(page).map(without_code).collect();
    let text = text.join(" ");
    let found = text.split("](").skip(1);
    found
        .filter_map(|behind| Some(behind.split_once(')')?.0.trim().to_owned()))
        .collect()
}

/// The anchors of the headings of a page.
pub(super) fn anchors(page: &str) -> BTreeSet<String> {
    let headings = prose(page).filter(|line| line.starts_with('#'));
    headings
        .map(|line| {
            let title = line.trim_start_matches('#').trim().to_lowercase();
            let kept = title
                .chars()
                .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

#[test]
fn links_and_headings_are_found() {
    let page =
        "# A `b`, c's\n[x\ny](a.md#z) `[n](o)` ![p](q.svg)\n```sh\n# no\n[n](o)\n```\n## 3. E-f\n";
    assert_eq!(links(page), ["a.md#z", "q.svg"]);
    let found: Vec<String> = anchors(page).into_iter().collect();
    assert_eq!(found, ["3-e-f", "a-b-cs"]);
}
