//! A small SVG writer: text, lines, dots, in colours that have a counterpart on dark paper.
//!
//! Coordinates are pixels, y downwards. Text is not measured: labels are kept short and have room of their
//! own.

use std::fmt::Write;

pub(crate) const INK: &str = "#333333";
pub(crate) const FAINT: &str = "#707070";
pub(crate) const GRID: &str = "#e0e0e0";
pub(crate) const FINE_GRID: &str = "#f3f3f3";
/// The band up to the round-off level.
pub(crate) const BAND: &str = "#ddddd6";
const PAPER: &str = "#ffffff";

/// Methods, in every picture; distinct also where red and green look alike.
pub(crate) const EQUIP: &str = "#0072b2";
pub(crate) const GAUSS: &str = "#d55e00";
/// Bodies, orbits and other things side by side.
pub(crate) const COLOURS: [&str; 6] = [
    "#009e73", "#882255", "#3a9bd6", "#8c6d1f", "#6b6b6b", "#5b4ea3",
];

/// Colours on white paper, and what they are where the reader prefers dark paper. Programs that know no
/// styles draw the first.
const DARK: [(&str, &str); 13] = [
    (PAPER, "#16181c"),
    (INK, "#dadada"),
    (FAINT, "#a0a0a0"),
    (GRID, "#363a40"),
    (FINE_GRID, "#23262b"),
    (BAND, "#3d4045"),
    (EQUIP, "#4ea8e6"),
    (GAUSS, "#f58a3a"),
    (COLOURS[0], "#5fe0b8"),
    (COLOURS[1], "#c2689c"),
    (COLOURS[3], "#c9a648"),
    (COLOURS[4], "#a8a8a8"),
    (COLOURS[5], "#9d92e0"),
];

/// The style of dark paper, for a picture or for a page of them.
pub(crate) fn dark_style() -> String {
    let rules = DARK.map(|(light, dark)| {
        format!("[fill=\"{light}\"]{{fill:{dark}}}[stroke=\"{light}\"]{{stroke:{dark}}}")
    });
    format!("@media (prefers-color-scheme: dark){{{}}}", rules.concat())
}

#[derive(Debug, Clone)]
pub(crate) struct Svg {
    body: String,
    pub(crate) width: f64,
    pub(crate) height: f64,
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
    Wedge,
}

impl Mark {
    /// The corners of a regular polygon, from the one at this angle on, for a radius of 1.
    fn corners(self) -> impl Iterator<Item = (f64, f64)> {
        let (count, first, radius) = match self {
            Mark::Disc => (12, 0.0, 1.0),
            Mark::Square => (4, 45.0, 1.2),
            Mark::Diamond => (4, 0.0, 1.25),
            Mark::Triangle => (3, -90.0, 1.3),
            Mark::Wedge => (3, 90.0, 1.3),
        };
        (0..count).map(move |k| {
            let angle = f64::to_radians(first + 360.0 * f64::from(k) / f64::from(count));
            (radius * angle.cos(), radius * angle.sin())
        })
    }
}

impl Svg {
    pub(crate) fn new(width: f64, height: f64) -> Self {
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

    pub(crate) fn rectangle(
        &mut self,
        (x, y): (f64, f64),
        (width, height): (f64, f64),
        colour: &str,
    ) {
        self.push(format_args!(
            r#"<rect x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}" fill="{colour}"/>"#
        ));
    }

    /// Another picture, with its upper left corner here.
    pub(crate) fn place(&mut self, (x, y): (f64, f64), other: &Svg) {
        self.push(format_args!(
            "<g transform=\"translate({x:.1} {y:.1})\">\n{}</g>",
            other.body
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

    /// Marks of the given radius, filled or hollow.
    pub(crate) fn marks(
        &mut self,
        points: impl Iterator<Item = (f64, f64)>,
        (mark, is_hollow): (Mark, bool),
        radius: f64,
        colour: &str,
    ) {
        let mut path = String::new();
        for (x, y) in points {
            for (k, (right, down)) in mark.corners().enumerate() {
                let letter = if k == 0 { 'M' } else { 'L' };
                let (x, y) = (x + right * radius, y + down * radius);
                let _ = write!(path, "{letter}{x:.1} {y:.1}");
            }
            path.push('z');
        }
        if path.is_empty() {
            return;
        }
        let fill = if is_hollow { PAPER } else { colour };
        self.push(format_args!(
            r#"<path d="{path}" fill="{fill}" stroke="{colour}" stroke-width="1.3"/>"#
        ));
    }

    /// As a file.
    pub(crate) fn finish(self) -> String {
        self.element(
            "xmlns=\"http://www.w3.org/2000/svg\" ",
            &format!(
                "<style>{}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"{PAPER}\"/>\n",
                dark_style()
            ),
        )
    }

    /// As a part of a page that has the style of dark paper.
    pub(crate) fn inline(&self) -> String {
        self.element("", "")
    }

    fn element(&self, space: &str, before: &str) -> String {
        let Svg {
            body,
            width,
            height,
        } = self;
        format!(
            "<svg {space}viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n{before}{body}</svg>\n"
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
