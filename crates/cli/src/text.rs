//! Numbers and lines of text that fit the terminal.

use std::io::{self, Write, stderr, stdout};

/// Columns of a line at most.
pub(crate) const WIDTH: usize = 100;

/// The words of `text` on lines of at most [`WIDTH`] columns: the first begins with `label`, filled up to
/// `indent`, the others with as many blanks.
pub(crate) fn wrapped(label: &str, indent: usize, text: &str) -> String {
    lines(label, indent, text, WIDTH).join("\n")
}

/// The same with lines of at most `width` columns. A word that is longer than a line has one of its own.
pub(crate) fn lines(label: &str, indent: usize, text: &str, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = format!("{label:<indent$}");
    let mut is_empty = true;
    for word in text.split_whitespace() {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(std::mem::replace(&mut line, " ".repeat(indent)));
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line += word;
        is_empty = false;
    }
    line.truncate(line.trim_end().len());
    lines.push(line);
    lines
}

/// The same text, with numbers of more than 60 places, which are zeros mostly, in powers of ten.
pub(crate) fn without_long_numbers(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, from) = rest.split_at(start);
        let is_part = |c: char| c.is_ascii_digit() || c == '.';
        let length = from.find(|c| !is_part(c)).unwrap_or(from.len());
        let (number, after) = from.split_at(length);
        short += before;
        match number.parse::<f64>() {
            Ok(x) if length > LONGEST && !after.starts_with('e') => short += &format!("{x:e}"),
            _ => short += number,
        }
        rest = after;
    }
    short + rest
}

/// The symbol of a parameter: its number as a subscript, and Greek letters as such.
pub(crate) fn symbol(name: &str) -> String {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let greek = match letters {
        "mu" => "\u{3bc}",
        "omega" => "\u{3c9}",
        "alpha" => "\u{3b1}",
        "beta" => "\u{3b2}",
        "epsilon" => "\u{3b5}",
        "lambda" => "\u{3bb}",
        "energy" => "E",
        other => other,
    };
    let lowered = |c: char| char::from_u32(0x2080 + c.to_digit(10)?);
    let digits = name[letters.len()..].chars().filter_map(lowered);
    greek.chars().chain(digits).collect()
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

/// Three digits, or nothing.
pub(crate) fn three_digits(x: f64) -> String {
    match x {
        x if !x.is_finite() => String::new(),
        x if (0.1..1e4).contains(&x) => {
            let decimals = (2.0 - x.log10().floor()).clamp(0.0, 3.0) as usize;
            format!("{x:.decimals$}")
        }
        x => format!("{x:.2e}"),
    }
}

/// The standard output. Its first error is kept until [`Print::end`]: every other fault comes before it.
#[derive(Debug, Default)]
pub(crate) struct Print(Option<io::Error>);

impl Print {
    pub(crate) fn end(mut self) -> io::Result<()> {
        self.flush()?;
        self.0.map_or(Ok(()), Err)
    }
}

impl Write for Print {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        if self.0.is_none() {
            self.0 = stdout().write_all(text).err();
        }
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.0.is_none() {
            self.0 = stdout().flush().err();
        }
        Ok(())
    }
}

/// Prints a line to the standard error. A line that cannot be printed is no error of the run.
pub(crate) fn say(line: &str) {
    let _ = writeln!(stderr(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::{significant, three_digits, without_long_numbers, wrapped};

    #[test]
    fn three_digits_are_enough() {
        let texts = [0.012345, 0.12345, 1.2345, 123.45, 12345.0, f64::NAN].map(three_digits);
        assert_eq!(texts, ["1.23e-2", "0.123", "1.23", "123", "1.23e4", ""]);
    }

    #[test]
    fn words_stay_whole_and_lines_short() {
        let text = wrapped("label", 8, &"word ".repeat(40));
        assert!(text.lines().all(|line| line.chars().count() <= 100));
        assert!(text.starts_with("label   word") && text.contains("\n        word"));
        assert_eq!(text.matches("word").count(), 40);
        assert_eq!(wrapped("a", 2, ""), "a");
    }

    #[test]
    fn numbers_of_many_zeros_are_written_in_powers_of_ten() {
        let long = format!("h = {}, t = -{}: no", 1e300, 2.5e-200);
        assert_eq!(without_long_numbers(&long), "h = 1e300, t = -2.5e-200: no");
        let wide = "-0.500000000000000000000000000000030814879110195774 and 5e-1, 3.";
        assert_eq!(without_long_numbers(wide), wide);
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
