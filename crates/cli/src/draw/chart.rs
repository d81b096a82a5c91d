//! Panels side by side with one legend above.

use crate::draw::panel::{Axis, Panel};
use crate::draw::svg::{Anchor, FAINT, INK, Mark, Svg};

/// Height of the panels, their distance from the left edge, and the room between them.
const SIDE: f64 = 360.0;
const LEFT: f64 = 86.0;
const BETWEEN: f64 = 100.0;
/// Width of an entry of the legend, and height of a row.
const ENTRY: f64 = 222.0;
const ROW: f64 = 24.0;
/// Radius of the marks.
const RADIUS: f64 = 2.8;

/// How a curve is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Look {
    pub(crate) colour: String,
    pub(crate) dashes: &'static str,
    pub(crate) width: f64,
    pub(crate) mark: Mark,
}

/// A point of two positive figures; the first one's repeats lie between `least` and `most`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) least: f64,
    pub(crate) most: f64,
}

impl Spot {
    /// A point without spread.
    pub(crate) fn exact(x: f64, y: f64) -> Self {
        let (least, most) = (x, x);
        Spot { x, y, least, most }
    }
}

/// A named line through points.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) look: Look,
    /// For each panel its points.
    pub(crate) points: Vec<Vec<Spot>>,
}

/// What the axes of a panel are.
pub(crate) type Labels<'a> = (&'a str, &'a str);

/// Panels side by side with one legend above; a line through a mark is the spread of its repeats.
pub(crate) fn draw(title: &str, labels: &[Labels<'_>], lines: &[Line]) -> String {
    // One panel alone may be wider.
    let wide = if labels.len() == 1 { 820.0 } else { 350.0 };
    let apart = wide + BETWEEN;
    let width = LEFT + apart * labels.len() as f64 - BETWEEN + 34.0;
    let columns = ((width - 24.0) / ENTRY) as usize;
    let rows = lines.len().div_ceil(columns);
    let top = 62.0 + ROW * rows as f64 + 14.0;
    let mut svg = Svg::new(width as u32, (top + SIDE + 62.0) as u32);
    svg.text((24.0, 34.0), 19, Anchor::Start, INK, title);
    for (i, line) in lines.iter().enumerate() {
        let (x, y) = (
            24.0 + ENTRY * (i % columns) as f64,
            62.0 + ROW * (i / columns) as f64,
        );
        let look = &line.look;
        let sample = [(x, y), (x + 34.0, y)].into_iter();
        svg.dashed(sample, &look.colour, look.width + 0.4, look.dashes);
        let middle = [(x + 17.0, y)].into_iter();
        svg.marks(middle, look.mark, RADIUS + 1.0, &look.colour);
        svg.text((x + 42.0, y + 5.0), 14, Anchor::Start, INK, &line.name);
    }
    for (k, (x, y)) in labels.iter().enumerate() {
        let shown = |line: &Line| -> Vec<Spot> {
            let real = |p: &&Spot| p.x.is_finite() && p.x > 0.0 && p.y.is_finite();
            let points = line.points.get(k).into_iter().flatten();
            points.filter(real).copied().collect()
        };
        let all: Vec<_> = lines.iter().flat_map(&shown).collect();
        let left = LEFT + apart * k as f64;
        if all.is_empty() {
            svg.text((left, top + 40.0), 14, Anchor::Start, FAINT, "no point");
            continue;
        }
        let panel = Panel {
            left,
            top,
            width: wide,
            height: SIDE,
            x: axis(all.iter().map(|p| p.x), x),
            y: axis(all.iter().map(|p| p.y), y),
        };
        panel.draw_axes(&mut svg);
        // What is zero stands on the lower edge.
        let at = |x: f64, p: &Spot| panel.at((x, p.y.max(1e-300)));
        for line in lines {
            let (look, points) = (&line.look, shown(line));
            for p in points.iter().filter(|p| p.most > p.least) {
                svg.line(at(p.least, p), at(p.most, p), &look.colour, 0.5);
            }
            let places = points.iter().map(|p| at(p.x, p));
            svg.dashed(places.clone(), &look.colour, look.width, look.dashes);
            svg.marks(places, look.mark, RADIUS, &look.colour);
        }
    }
    svg.finish()
}

/// A little more than the positive values.
fn axis(values: impl Iterator<Item = f64>, label: &str) -> Axis {
    let positive = values.filter(|x| *x > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), x| {
        (l.min(x), h.max(x))
    });
    if high > 0.0 {
        Axis::powers(low, high, label)
    } else {
        Axis::powers(1e-17, 1e-15, label)
    }
}
