//! Charts: lines through marks on logarithmic axes, in panels with one legend.

use crate::draw::figure::{Figure, Look};
use crate::draw::panel::{self, Axis, Panel};
use crate::draw::svg::{Anchor, FAINT, Svg};

/// Radius of the marks.
const RADIUS: f64 = 3.4;
/// Decades that the axes are longer than the lines at each end.
const MARGIN: (f64, f64) = (0.1, 0.25);

/// A point of two positive figures; the first one's repeats lie between `least` and `most`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) is_hollow: bool,
}

impl Spot {
    /// A point without spread.
    pub(crate) fn exact(x: f64, y: f64) -> Self {
        Spot {
            x,
            y,
            least: x,
            most: x,
            is_hollow: false,
        }
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

/// What a panel shows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Plot {
    pub(crate) heading: String,
    /// Labels of the axes. Axes of the same label have the same range.
    pub(crate) x: String,
    pub(crate) y: String,
    /// What is below is round-off.
    pub(crate) round_off: Option<f64>,
    /// Whether growth like x and like x² is drawn for comparison.
    pub(crate) has_derivatives: bool,
}

impl Plot {
    pub(crate) fn new(heading: &str, x: &str, y: &str) -> Self {
        let [heading, x, y] = [heading, x, y].map(str::to_owned);
        Plot {
            heading,
            x,
            y,
            ..Plot::default()
        }
    }
}

/// Panels with one legend; a line through a mark is the spread of its repeats. Points at zero, which have no
/// place on a logarithmic axis, are left out.
pub(crate) fn chart(title: &str, facts: &str, plots: &[Plot], lines: &[Line]) -> Figure {
    let shown = |line: &Line, k: usize| -> Vec<Spot> {
        let real = |x: f64| x.is_finite() && x > 0.0;
        let points = line.points.get(k).into_iter().flatten();
        points.filter(|p| real(p.x) && real(p.y)).copied().collect()
    };
    // The range of all panels that `is_like` this one.
    let range = |is_like: &dyn Fn(&Plot) -> bool, of: fn(&Spot) -> f64, round_off: bool| {
        let like = (0..plots.len()).filter(|&k| is_like(&plots[k]));
        let values = like.flat_map(|k| {
            let round_off = plots[k].round_off.filter(|_| round_off);
            let spots = lines.iter().flat_map(move |line| shown(line, k));
            spots.map(|spot| of(&spot)).chain(round_off)
        });
        panel::range(values)
    };
    let panel = |k: usize| -> Svg {
        let plot = &plots[k];
        let x = range(&|other| other.x == plot.x, |p| p.x, false);
        let y = range(&|other| other.y == plot.y, |p| p.y, true);
        let mut panel = Panel::new(
            Axis::powers(x, MARGIN.0, &plot.x),
            Axis::powers(y, MARGIN.1, &plot.y),
        );
        panel.round_off = plot.round_off;
        let mut svg = panel.svg(&plot.heading);
        if let Some((low, high)) = x
            && plot.has_derivatives
            && high > low
        {
            slopes(&mut svg, &panel, high);
        }
        for line in lines {
            let (look, points) = (&line.look, shown(line, k));
            for p in points.iter().filter(|p| p.most > p.least) {
                let [from, to] = [p.least, p.most].map(|x| panel.at((x, p.y)));
                svg.line(from, to, look.colour, 0.7);
            }
            let place = |p: &Spot| panel.at((p.x, p.y));
            svg.dashed(
                points.iter().map(place),
                look.colour,
                look.width,
                look.dashes,
            );
            for (is_hollow, mark) in [(false, look.mark), (true, look.mark)] {
                let places = points.iter().filter(|p| p.is_hollow == is_hollow);
                if let Some(mark) = mark {
                    svg.marks(places.map(place), (mark, is_hollow), RADIUS, look.colour);
                }
            }
        }
        svg
    };
    let mut legend: Vec<_> = (lines.iter())
        .map(|line| (line.name.clone(), line.look.clone()))
        .collect();
    if plots.iter().any(|plot| plot.round_off.is_some()) {
        legend.push(("round-off level of H".into(), Look::band()));
    }
    Figure {
        title: title.into(),
        facts: facts.into(),
        legend,
        panels: (0..plots.len()).map(panel).collect(),
    }
}

/// What growth like x and like x² looks like, over the last decade in the lower right corner.
fn slopes(svg: &mut Svg, panel: &Panel, last: f64) {
    let from = (last / 10.0, 10_f64.powf(panel.y.low + 0.3));
    for (power, label) in [(1, "N"), (2, "N\u{b2}")] {
        let to = (last, from.1 * 10_f64.powi(power));
        svg.line(panel.at(from), panel.at(to), FAINT, 1.0);
        let (x, y) = panel.at(to);
        svg.text((x + 4.0, y + 4.0), 12, Anchor::Start, FAINT, label);
    }
}
