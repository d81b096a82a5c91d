//! A small SVG writer: text, lines, dots.
//!
//! Coordinates are pixels, y downwards. Text is not measured: labels are kept short and have room of their
//! own.

use std::fmt::Write;

pub(crate) const INK: &str = "#333333";
pub(crate) const FAINT: &str = "#777777";
const PAPER: &str = "#ffffff";

#[derive(Debug)]
pub(crate) struct Svg {
    body: String,
    width: u32,
    height: u32,
}

/// Where the given point of a text is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    Disc,
    Square,
    Diamond,
    Triangle,
}

impl Svg {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        Svg {
            body: String::new(),
            width,
            height,
        }
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String does not fail.
        let _ = writeln!(self.body, "{element}");
    }

    pub(crate) fn text(
        &mut self,
        (x, y): (f64, f64),
        size: u32,
        anchor: Anchor,
        colour: &str,
        text: &str,
    ) {
        let (anchor, text) = (anchor.name(), escape(text));
        self.push(format_args!(
            r#"<text x="{x:.1}" y="{y:.1}" font-size="{size}" text-anchor="{anchor}" fill="{colour}">{text}</text>"#
        ));
    }

    /// Text that reads upwards.
    pub(crate) fn upward_text(&mut self, (x, y): (f64, f64), size: u32, text: &str) {
        let text = escape(text);
        self.push(format_args!(
            r#"<text transform="translate({x:.1} {y:.1}) rotate(-90)" font-size="{size}" text-anchor="middle" fill="{INK}">{text}</text>"#
        ));
    }

    /// 10 to an integer power.
    pub(crate) fn power(&mut self, (x, y): (f64, f64), size: u32, anchor: Anchor, exponent: i32) {
        let (anchor, small, up) = (anchor.name(), size - 3, f64::from(size) * 0.4);
        let exponent = exponent.to_string().replace('-', "\u{2212}");
        self.push(format_args!(
            r#"<text x="{x:.1}" y="{y:.1}" font-size="{size}" text-anchor="{anchor}" fill="{INK}">10<tspan dy="{:.1}" font-size="{small}">{exponent}</tspan></text>"#,
            -up
        ));
    }

    pub(crate) fn line(&mut self, from: (f64, f64), to: (f64, f64), colour: &str, width: f64) {
        self.push(format_args!(
            r#"<line x1="{:.1}" y1="{:.1}" x2="{:.1}" y2="{:.1}" stroke="{colour}" stroke-width="{width}"/>"#,
            from.0, from.1, to.0, to.1
        ));
    }

    pub(crate) fn dot(&mut self, (x, y): (f64, f64), radius: f64, colour: &str) {
        self.push(format_args!(
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="{colour}"/>"#
        ));
    }

    /// A line through points; those within a third of a pixel of the last one drawn are left out.
    pub(crate) fn polyline(
        &mut self,
        points: impl Iterator<Item = (f64, f64)>,
        colour: &str,
        width: f64,
    ) {
        self.dashed(points, colour, width, "none");
    }

    /// The same with a pattern of dashes, `none` for a full line.
    pub(crate) fn dashed(
        &mut self,
        points: impl Iterator<Item = (f64, f64)>,
        colour: &str,
        width: f64,
        dashes: &str,
    ) {
        let (mut path, mut last) = (String::new(), None);
        for (x, y) in points {
            if last.is_some_and(|(a, b): (f64, f64)| (a - x).abs() < 0.33 && (b - y).abs() < 0.33) {
                continue;
            }
            let _ = write!(
                path,
                "{}{x:.1} {y:.1}",
                if last.is_none() { "M" } else { "L" }
            );
            last = Some((x, y));
        }
        self.push(format_args!(
            r#"<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}" stroke-linejoin="round"/>"#
        ));
    }

    /// A cloud of round dots.
    pub(crate) fn dots(
        &mut self,
        points: impl Iterator<Item = (f64, f64)>,
        colour: &str,
        diameter: f64,
    ) {
        let mut path = String::new();
        for (x, y) in points {
            let _ = write!(path, "M{x:.1} {y:.1}h0");
        }
        self.push(format_args!(
            r#"<path d="{path}" fill="none" stroke="{colour}" stroke-width="{diameter}" stroke-linecap="round"/>"#
        ));
    }

    /// Filled marks of the given radius.
    pub(crate) fn marks(
        &mut self,
        points: impl Iterator<Item = (f64, f64)>,
        mark: Mark,
        radius: f64,
        colour: &str,
    ) {
        let mut path = String::new();
        for (x, y) in points {
            let _ = match mark {
                Mark::Disc => write!(path, "M{x:.1} {y:.1}h0"),
                Mark::Square => {
                    let r = 0.88 * radius;
                    write!(
                        path,
                        "M{:.1} {:.1}h{:.1}v{:.1}h{:.1}z",
                        x - r,
                        y - r,
                        2.0 * r,
                        2.0 * r,
                        -2.0 * r
                    )
                }
                Mark::Diamond => {
                    let r = 1.25 * radius;
                    write!(
                        path,
                        "M{:.1} {y:.1}l{r:.1} {:.1}l{r:.1} {r:.1}l{:.1} {r:.1}z",
                        x - r,
                        -r,
                        -r
                    )
                }
                Mark::Triangle => {
                    let r = 1.2 * radius;
                    write!(
                        path,
                        "M{x:.1} {:.1}l{r:.1} {:.1}h{:.1}z",
                        y - r,
                        1.8 * r,
                        -2.0 * r
                    )
                }
            };
        }
        if mark == Mark::Disc {
            let width = 2.0 * radius;
            self.push(format_args!(
                r#"<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-linecap="round"/>"#
            ));
        } else {
            self.push(format_args!(r#"<path d="{path}" fill="{colour}"/>"#));
        }
    }

    pub(crate) fn finish(self) -> String {
        let Svg {
            body,
            width,
            height,
        } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"{PAPER}\"/>\n{body}</svg>\n"
        )
    }
}

pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn text_cannot_break_the_markup() {
        assert_eq!(escape("a<b & c>d"), "a&lt;b &amp; c&gt;d");
    }
}
