//! Values that options of several commands read.

use std::path::{Path, PathBuf};

/// Reads whole numbers from `low` to `high`; others are refused with these.
pub(super) fn whole(low: u64, high: u64) -> impl Fn(&str) -> Result<u64, String> + Clone {
    move |text| match text.trim().parse() {
        Ok(number) if (low..=high).contains(&number) => Ok(number),
        _ if high == u64::MAX => Err(format!("a whole number, {low} or more")),
        _ => Err(format!("a whole number from {low} to {high}")),
    }
}

/// Reads a number of stages; the method refuses those that it does not take.
pub(super) fn stages(text: &str) -> Result<usize, &'static str> {
    let number = text.trim().parse();
    number.map_err(|_| "a whole number in the range of the method, from 2 on for EQUIP")
}

/// Reads the name of a picture: an SVG file, or a page if it ends in `.html`.
pub(super) fn picture(text: &str) -> Result<PathBuf, &'static str> {
    let end = Path::new(text).extension();
    if end.is_some_and(|end| end != "svg" && end != "html") {
        return Err("pictures are SVG files or HTML pages; end the name in .svg or .html");
    }
    Ok(text.into())
}
