//! Numbers and lines of text that fit the terminal.

/// Columns of a line at most.
pub(crate) const WIDTH: usize = 100;

/// The words of `text` on lines of at most [`WIDTH`] columns: the first begins with `label`, filled up to
/// `indent`, the others with as many blanks. A word that is longer than a line has one of its own.
pub(crate) fn wrapped(label: &str, indent: usize, text: &str) -> String {
    let mut lines = String::new();
    let mut line = format!("{label:<indent$}");
    let mut is_empty = true;
    for word in text.split_whitespace() {
        let length = line.chars().count() + usize::from(!is_empty) + word.chars().count();
        if !is_empty && length > WIDTH {
            lines += &line;
            lines.push('\n');
            line = " ".repeat(indent);
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line += word;
        is_empty = false;
    }
    lines + line.trim_end()
}

/// A number in at most five digits.
pub(crate) fn brief(x: f64) -> String {
    significant(x, 5)
}

/// A number in at most so many digits, all of them significant.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    let rounded = format!("{x:.0$e}", digits.saturating_sub(1))
        .parse()
        .unwrap_or(x);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::{significant, wrapped};

    #[test]
    fn words_stay_whole_and_lines_short() {
        let text = wrapped("label", 8, &"word ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= 100));
        assert!(text.starts_with("label   word") && text.contains("\n        word"));
        assert_eq!(text.matches("word").count(), 40);
        assert_eq!(wrapped("a", 2, ""), "a");
    }

    #[test]
    fn small_numbers_keep_their_digits() {
        assert_eq!(significant(1.234567891e-9, 7), "1.234568e-9");
        assert_eq!(significant(0.05, 7), "0.05");
        assert_eq!(significant(628.3185307179587, 7), "628.3185");
        assert_eq!(significant(-2.5e12, 7), "-2.5e12");
        assert_eq!(significant(0.0, 7), "0");
    }
}
