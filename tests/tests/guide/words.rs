//! Texts that users read, in pages and sources, and words in them.

use super::links::{prose, without_code};

/// Words that have a better one of the field.
pub(super) const WORDS: [&str; 10] = [
    "sweep",
    "slope",
    "carried",
    "in floors",
    "α's",
    "is off",
    "beside",
    "goes on",
    "asked for",
    "dear",
];

/// Those of them that count in the plural as well.
const NOUNS: [&str; 2] = ["sweep", "slope"];

/// How often a word is in a text, in capitals or not.
pub(super) fn count(text: &str, word: &str) -> usize {
    let text = text.replace('’', "'").to_lowercase();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let is_of_word = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .filter(|(at, _)| {
            let behind = &text[at + word.len()..];
            let behind = match NOUNS.contains(&word) {
                true => behind.strip_prefix('s').unwrap_or(behind),
                false => behind,
            };
            !text[..*at].ends_with(is_of_word) && !behind.starts_with(is_of_word)
        })
        .count()
}

/// The text of a page, without code.
pub(super) fn of_page(page: &str) -> Vec<String> {
    let lines: Vec<String> = prose(page)
        .map(|line| without_code(&without_targets(line)))
        .collect();
    vec![lines.join(" ")]
}

/// A line whose links do not say where they lead.
fn without_targets(line: &str) -> String {
    let mut parts = line.split("](");
    let mut all = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        all += "]";
        all += part.split_once(')').map_or("", |(_, behind)| behind);
    }
    all
}

/// Literals of a source in Rust, and the comments on what is public, or on everything (`help`): those of the
/// options of a program are its help. Tests at the end do not count.
pub(super) fn of_rust(source: &str, help: bool) -> Vec<String> {
    let tests = source.find("\n#[cfg(test)]\nmod ");
    // A file of tests that is only named here does not end it.
    let end = tests.filter(|&at| {
        source[at..]
            .lines()
            .nth(2)
            .is_some_and(|line| line.ends_with('{'))
    });
    let source = &source[..end.unwrap_or(source.len())];
    let mut all = literals(source, "//");
    let mut comment = Vec::new();
    for line in source.lines().map(str::trim) {
        if let Some(text) = line.strip_prefix("///") {
            comment.push(text);
        } else if !line.starts_with('#') && !comment.is_empty() {
            if help || line.starts_with("pub ") || line.starts_with(char::is_uppercase) {
                all.extend(of_page(&comment.join("\n")));
            }
            comment.clear();
        }
    }
    all
}

/// Literals of a source in Python, docstrings among them, and comments that document (`#:`).
pub(super) fn of_python(source: &str) -> Vec<String> {
    let mut all = literals(source, "#");
    let comments = source
        .lines()
        .filter_map(|line| line.trim().strip_prefix("#:"));
    all.extend(comments.map(str::to_owned));
    all
}

/// All literals in double quotes, one, three or with `#`, of a language whose comments begin so.
fn literals(source: &str, comment: &str) -> Vec<String> {
    let (mut all, mut rest) = (Vec::new(), source);
    while let Some(next) = rest.chars().next() {
        let before = source.len() - rest.len();
        if rest.starts_with(comment) {
            rest = rest.find('\n').map_or("", |end| &rest[end..]);
        } else if rest.starts_with("'\"'") || rest.starts_with("b'\"'") {
            rest = &rest[3..];
        } else if next == '"' {
            let hashes = source[..before]
                .chars()
                .rev()
                .take_while(|&c| c == '#')
                .count();
            let is_raw = source[..before - hashes].ends_with('r');
            let (open, close) = match rest.starts_with("\"\"\"") {
                true => (3, "\"\"\"".to_owned()),
                false => (
                    1,
                    format!("\"{}", "#".repeat(if is_raw { hashes } else { 0 })),
                ),
            };
            let end = end_of(&rest[open..], &close, is_raw);
            all.push(rest[open..][..end].replace("\\\n", " ").replace("\\n", " "));
            rest = rest[open..].get(end + close.len()..).unwrap_or("");
        } else {
            rest = &rest[next.len_utf8()..];
        }
    }
    all
}

/// Where a literal ends.
fn end_of(text: &str, close: &str, is_raw: bool) -> usize {
    let mut at = 0;
    while at < text.len() && !text[at..].starts_with(close) {
        let mut next = text[at..].chars();
        let is_escape = next.next() == Some('\\') && !is_raw;
        if is_escape {
            next.next();
        }
        at = text.len() - next.as_str().len();
    }
    at
}

#[test]
fn words_are_counted_as_words() {
    let text = "Besides, beside\n a Slope, slopes_x; slopes, is\noff, α’s and α's; dearly dear";
    let found: Vec<usize> = WORDS.iter().map(|word| count(text, word)).collect();
    assert_eq!(found, [0, 2, 0, 0, 2, 1, 1, 0, 0, 1]);
}

#[test]
fn texts_are_found() {
    let source = "/// Public\n/// twice.\n#[must_use]\npub fn f(c: char) { g(\"a \\\" b\", r#\"c \" d\"#, '\"'); } // \"no\"\n\
        /// Not public.\nfn g() {}\n/// `code` A case.\nCase,\n#[cfg(test)]\nmod tests {\n \"no\"";
    let found = of_rust(source, false);
    assert_eq!(
        found,
        ["a \\\" b", "c \" d", " Public  twice.", " `` A case."]
    );
    assert_eq!(of_rust(source, true).len(), 5);
    let source = "def f():\n    \"\"\"Does\n    it.\"\"\"  # \"no\"\n    #: Its \"value\".\n    return \"x\"\n";
    assert_eq!(of_python(source), ["Does\n    it.", "x", " Its \"value\"."]);
    let page = "A [b](sweep.md) `c`\n```\nsweep\n```\nd";
    assert_eq!(of_page(page), ["A [b] `` d"]);
}
