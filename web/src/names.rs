//! The names of the components of (q, p).

/// The component of (q, p) that a name stands for, with m degrees of freedom.
pub(crate) fn component(name: &str, m: usize) -> Option<usize> {
    if let Some(letter) = letters(m).iter().position(|letter| *letter == name) {
        return Some(letter);
    }
    let (first, number) = name.split_at_checked(1)?;
    let offset = match first {
        "q" => 0,
        "p" => m,
        _ => return None,
    };
    let is_plain = number.starts_with(|c: char| matches!(c, '1'..='9'));
    let i: usize = number.parse().ok().filter(|_| is_plain)?;
    (1..=m).contains(&i).then(|| offset + i - 1)
}

/// Names without numbers, in the order of (q, p).
fn letters(m: usize) -> &'static [&'static str] {
    match m {
        1 => &["q", "p"],
        2 => &["x", "y", "px", "py"],
        3 => &["x", "y", "z", "px", "py", "pz"],
        _ => &[],
    }
}

/// The names that a formula may have.
pub(crate) fn listed(m: usize) -> String {
    match m {
        0 => "pi".to_owned(),
        1 => "q or p".to_owned(),
        2 | 3 => format!(
            "q1 to q{m} and p1 to p{m}, or {} in their place",
            letters(m).join(", ")
        ),
        _ => format!("q1 to q{m} and p1 to p{m}"),
    }
}
