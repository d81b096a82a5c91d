//! [`Figure`]: panels with a title and one legend, as a picture, as a part of a page, or as a page.

use crate::draw::page::page;
use crate::draw::svg::{Anchor, BAND, FAINT, INK, Mark, Svg, escape};
use crate::text::lines;
use std::path::Path;

/// Width of a sample in the legend, and height of a row of samples or text.
const SAMPLE: f64 = 34.0;
const ROW: f64 = 22.0;

/// How a curve is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Look {
    pub(crate) colour: &'static str,
    pub(crate) dashes: &'static str,
    pub(crate) width: f64,
    pub(crate) mark: Option<Mark>,
}

impl Look {
    /// A full line without marks.
    pub(crate) fn line(colour: &'static str) -> Self {
        Look {
            colour,
            dashes: "none",
            width: 1.6,
            mark: None,
        }
    }

    /// A mark without a line.
    pub(crate) fn mark(colour: &'static str, mark: Mark) -> Self {
        let (width, mark) = (0.0, Some(mark));
        Look {
            width,
            mark,
            ..Look::line(colour)
        }
    }

    /// The band up to the round-off level.
    pub(crate) fn band() -> Self {
        Look {
            width: 11.0,
            ..Look::line(BAND)
        }
    }

    fn sample(&self) -> Svg {
        let mut svg = Svg::new(SAMPLE, 14.0);
        if self.width > 0.0 {
            let line = [(0.0, 7.0), (SAMPLE, 7.0)].into_iter();
            svg.dashed(line, self.colour, self.width, self.dashes);
        }
        if let Some(mark) = self.mark {
            let middle = [(SAMPLE / 2.0, 7.0)].into_iter();
            svg.marks(middle, (mark, false), 4.0, self.colour);
        }
        svg
    }
}

/// Panels with a title and one legend.
#[derive(Debug)]
pub(crate) struct Figure {
    pub(crate) title: String,
    /// A line below the title.
    pub(crate) facts: String,
    pub(crate) legend: Vec<(String, Look)>,
    pub(crate) panels: Vec<Svg>,
}

impl Figure {
    /// The text of a file of this name: a page if it ends in `.html`, else a picture.
    pub(crate) fn file(&self, path: &Path) -> String {
        if path.extension().is_some_and(|end| end == "html") {
            page(&self.title, &self.html())
        } else {
            self.svg()
        }
    }

    /// A picture with two panels side by side, or three if that fills the rows.
    pub(crate) fn svg(&self) -> String {
        let size = |of: fn(&Svg) -> f64| self.panels.iter().map(of).fold(0.0, f64::max);
        let (wide, high) = (size(|p| p.width), size(|p| p.height));
        let columns = match self.panels.len() {
            6 | 9 => 3,
            count => count.clamp(1, 2),
        };
        let width = wide * columns as f64;
        let mut facts = lines("", 0, &self.facts, ((width - 40.0) / 6.7).ceil() as usize);
        facts.retain(|line| !line.is_empty());
        let mut y = 34.0 + ROW * facts.len() as f64;
        // Where the entries of the legend stand.
        let (mut x, mut entries) = (24.0, Vec::new());
        y += if self.legend.is_empty() { 0.0 } else { 26.0 };
        for (name, look) in &self.legend {
            let length = SAMPLE + 34.0 + 7.4 * name.chars().count() as f64;
            if x > 24.0 && x + length > width {
                (x, y) = (24.0, y + ROW);
            }
            entries.push(((x, y), name, look));
            x += length;
        }
        let top = y + 8.0;
        let rows = self.panels.len().div_ceil(columns) as f64;
        let mut svg = Svg::new(width, top + rows * high);
        svg.text((24.0, 32.0), 18, Anchor::Start, INK, &self.title);
        for (k, line) in facts.iter().enumerate() {
            let y = 34.0 + ROW * (k + 1) as f64;
            svg.text((24.0, y), 13, Anchor::Start, FAINT, line);
        }
        for (k, panel) in self.panels.iter().enumerate() {
            let (column, row) = (k % columns, k / columns);
            svg.place((wide * column as f64, top + high * row as f64), panel);
        }
        for ((x, y), name, look) in entries {
            svg.place((x, y - 12.0), &look.sample());
            svg.text((x + SAMPLE + 8.0, y), 14, Anchor::Start, INK, name);
        }
        svg.finish()
    }

    /// A part of a page: panels stand side by side as far as the window is wide.
    pub(crate) fn html(&self) -> String {
        let entry = |(name, look): &(String, Look)| {
            format!(
                "<span>{} {}</span> ",
                look.sample().inline().trim(),
                escape(name)
            )
        };
        let legend: String = self.legend.iter().map(entry).collect();
        let panels: String = self.panels.iter().map(Svg::inline).collect();
        format!(
            "<figure>\n<figcaption><b>{}</b> <small>{}</small></figcaption>\n<p class=\"legend\">{legend}</p>\n\
             <div class=\"panels\">\n{panels}</div>\n</figure>\n",
            escape(&self.title),
            escape(&self.facts)
        )
    }
}
