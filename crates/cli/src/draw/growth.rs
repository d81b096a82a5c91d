//! The picture of `equip growth`: one panel for each eccentricity, error against revolutions on logarithmic
//! axes.

use crate::args::GrowthArgs;
use crate::draw::panel::{Axis, Panel};
use crate::draw::svg::{Anchor, FAINT, INK, Svg};
use equip_integrate::Certificate;

const EQUIP: &str = "#2b6a99";
const GAUSS: &str = "#c46b1f";
/// Patterns of the tolerances; there are no more of these than of patterns.
pub(crate) const DASHES: [&str; 6] = ["none", "6 4", "2 3", "12 3", "10 3 2 3", "1 6"];
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 270.0;
/// Left of the first panel, its distance from the legend, and the way to the next.
const FIRST: (f64, f64) = (92.0, 34.0);
const NEXT: (f64, f64) = (510.0, 370.0);

/// Width that the lines of text need.
const TEXT: f64 = 720.0;

/// One method on one orbit.
#[derive(Debug)]
pub(crate) struct Curve {
    pub(crate) eccentricity: String,
    pub(crate) tolerance: String,
    pub(crate) is_equip: bool,
    /// N and the error 0.3 revolutions after it.
    pub(crate) points: Vec<(u64, f64)>,
    /// Revolutions made.
    pub(crate) revolutions: f64,
    pub(crate) certificate: Certificate<f64>,
}

impl Curve {
    pub(crate) fn name(&self) -> &'static str {
        if self.is_equip { "EQUIP" } else { "Gauss" }
    }
}

pub(crate) fn draw(curves: &[Curve], args: &GrowthArgs) -> String {
    let panels = args.eccentricities.len();
    let (columns, rows) = (panels.min(2), panels.div_ceil(2));
    let width = (30.0 + NEXT.0 * columns as f64).max(TEXT);
    let names = (args.tolerances.iter().zip(DASHES)).flat_map(|(tolerance, dashes)| {
        [("EQUIP", EQUIP), ("Gauss", GAUSS)]
            .map(|(name, colour)| (format!("{name}, tolerance {tolerance}"), colour, dashes))
    });
    let (mut entries, mut left, mut legend) = (Vec::new(), 28.0, 78.0);
    for (label, colour, dashes) in names {
        let length = 60.0 + 7.5 * label.chars().count() as f64;
        if left + length > width {
            (left, legend) = (28.0, legend + 22.0);
        }
        entries.push(((left, legend), label, colour, dashes));
        left += length;
    }
    let top = legend + FIRST.1;
    let mut svg = Svg::new(width as u32, (top + NEXT.1 * rows as f64) as u32);
    svg.text(
        (28.0, 36.0),
        20,
        Anchor::Start,
        INK,
        "Kepler\u{2019}s problem: growth of the error",
    );
    let text = format!(
        "{} stages, variable steps; largest error of a component of q and p, 0.3 revolutions after the N-th",
        args.stages
    );
    svg.text((28.0, 58.0), 13, Anchor::Start, FAINT, &text);
    for ((left, y), label, colour, dashes) in &entries {
        let line = [(*left, *y), (left + 34.0, *y)];
        svg.dashed(line.into_iter(), colour, 2.0, dashes);
        svg.text((left + 40.0, y + 5.0), 13, Anchor::Start, INK, label);
    }
    let errors = || curves.iter().flat_map(|curve| &curve.points);
    let positive = errors().map(|point| point.1).filter(|&x| x > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, f64::MIN_POSITIVE), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    for (i, eccentricity) in args.eccentricities.iter().enumerate() {
        let panel = Panel {
            left: FIRST.0 + NEXT.0 * (i % 2) as f64,
            top: top + NEXT.1 * (i / 2) as f64,
            width: WIDTH,
            height: HEIGHT,
            x: Axis::decades_to(1.0, args.revolutions as f64, "revolutions N"),
            y: Axis::decades(low.min(high), high, "error"),
        };
        panel.draw_axes(&mut svg);
        let title = (panel.left + 14.0, panel.top + 22.0);
        svg.text(
            title,
            15,
            Anchor::Start,
            INK,
            &format!("e = {eccentricity}"),
        );
        for curve in curves.iter().filter(|c| c.eccentricity == *eccentricity) {
            one(&mut svg, &panel, curve, args);
        }
        slopes(&mut svg, &panel, args.revolutions as f64);
    }
    svg.finish()
}

fn one(svg: &mut Svg, panel: &Panel, curve: &Curve, args: &GrowthArgs) {
    let number = (args.tolerances.iter()).position(|t| *t == curve.tolerance);
    let dashes = DASHES[number.unwrap_or(0) % DASHES.len()];
    let colour = if curve.is_equip { EQUIP } else { GAUSS };
    let points = curve.points.iter().filter(|point| point.1 > 0.0);
    let points = points.map(|&(n, error)| panel.at((n as f64, error)));
    svg.dashed(points.clone(), colour, 1.6, dashes);
    svg.dots(points, colour, 4.0);
}

/// What growth like N and like N² looks like, in the lower right corner.
fn slopes(svg: &mut Svg, panel: &Panel, last: f64) {
    let from = (last / 10.0, 10f64.powf(panel.y.low + 0.6));
    for (power, label) in [(1, "N"), (2, "N\u{b2}")] {
        let to = (last, from.1 * 10f64.powi(power));
        svg.line(panel.at(from), panel.at(to), FAINT, 1.0);
        let (x, y) = panel.at(to);
        svg.text((x + 4.0, y + 4.0), 12, Anchor::Start, FAINT, label);
    }
}
