//! The picture of `equip growth`: one panel for each eccentricity, error against revolutions on logarithmic
//! axes.

use crate::args::GrowthArgs;
use crate::draw::panel::{Axis, Panel};
use crate::draw::svg::{Anchor, FAINT, INK, Svg};
use equip_integrate::Certificate;

const EQUIP: &str = "#2b6a99";
const GAUSS: &str = "#c46b1f";
/// Patterns of the tolerances, by turns.
const DASHES: [&str; 3] = ["none", "6 4", "2 3"];
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 270.0;
/// Left and top of the first panel, and the way to the next.
const FIRST: (f64, f64) = (92.0, 112.0);
const NEXT: (f64, f64) = (510.0, 370.0);

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
    let mut svg = Svg::new(30 + 510 * columns as u32, 112 + 370 * rows as u32);
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
    let mut left = 28.0;
    for (i, tolerance) in args.tolerances.iter().enumerate() {
        for (name, colour) in [("EQUIP", EQUIP), ("Gauss", GAUSS)] {
            let line = [(left, 78.0), (left + 34.0, 78.0)];
            svg.dashed(line.into_iter(), colour, 2.0, DASHES[i % DASHES.len()]);
            let label = format!("{name}, tolerance {tolerance}");
            svg.text((left + 40.0, 83.0), 13, Anchor::Start, INK, &label);
            left += 60.0 + 7.5 * label.chars().count() as f64;
        }
    }
    let errors = || curves.iter().flat_map(|curve| &curve.points);
    let positive = errors().map(|point| point.1).filter(|&x| x > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, f64::MIN_POSITIVE), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    for (i, eccentricity) in args.eccentricities.iter().enumerate() {
        let panel = Panel {
            left: FIRST.0 + NEXT.0 * (i % 2) as f64,
            top: FIRST.1 + NEXT.1 * (i / 2) as f64,
            width: WIDTH,
            height: HEIGHT,
            x: Axis::decades(1.0, args.revolutions as f64 * 0.75, "revolutions N"),
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
