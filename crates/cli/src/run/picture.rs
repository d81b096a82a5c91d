//! The picture of a run: orbit or phase portrait, and the relative energy error over time; Lyapunov exponent
//! and MEGNO if they were requested.

use crate::draw::figure::{Figure, Look};
use crate::draw::panel::{Axis, Panel, range};
use crate::draw::samples::{Envelope, Path as Curve};
use crate::draw::svg::{COLOURS, EQUIP, FAINT, GAUSS, INK, Mark};
use crate::run::comparison::Comparison;
use crate::run::finished::Finished;
use crate::run::watch::Watch;
use crate::text::{brief, symbol};
use equip_scalar::Float;
use equip_scenes::{Instance, View};
use std::path::Path;

/// Up to this many steps, each is marked by a dot on its curve.
const FEW: usize = 400;
/// Points of a curve of the energy at most.
const MOST_POINTS: usize = 250;

/// The components of y = (q, p) that the scene's picture is made of, two for each path.
pub(crate) fn components(instance: &Instance) -> Vec<usize> {
    match instance.view() {
        View::PhasePlane => vec![0, 1],
        View::Paths(pairs) => pairs.into_iter().flat_map(|(x, y)| [x, y]).collect(),
        View::Profile => Vec::new(),
    }
}

/// The text of the file that `watch` is to draw to: a picture, or a page.
pub(crate) fn draw<T: Float>(
    finished: &Finished<'_, T>,
    watch: &Watch<'_, T>,
    comparison: Option<&Comparison>,
    curve: Option<&Curve>,
) -> String {
    let (instance, certificate) = (finished.instance, finished.run.certificate());
    let mut figure = Figure {
        title: instance.scene().title.into(),
        facts: facts(finished),
        legend: Vec::new(),
        panels: Vec::new(),
    };
    match instance.view() {
        View::Profile => profile(&mut figure, watch.start.0, finished),
        view => paths(&mut figure, instance, (&watch.picture.path, curve), &view),
    }
    let end = certificate.end.to_f64();
    let unit = instance.units().time;
    let time = Axis::between(end.min(0.0), end.max(0.0), &labelled("time t", unit));
    energies(
        &mut figure,
        finished,
        &watch.picture.energy,
        comparison,
        time,
    );
    if watch.follows_chaos {
        let since = if end < 0.0 {
            "time since the start"
        } else {
            "time t"
        };
        chaos(
            &mut figure,
            &watch.picture.chaos,
            end.abs(),
            &labelled(since, unit),
        );
    }
    let file = watch.plot.as_deref().unwrap_or(Path::new(""));
    figure.file(file)
}

/// Parameters, steps and method.
fn facts<T: Float>(finished: &Finished<'_, T>) -> String {
    let (instance, certificate) = (finished.instance, finished.run.certificate());
    let parameters = instance.parameters();
    let mut facts: Vec<_> = parameters
        .map(|(name, value)| format!("{} = {}", symbol(name), value.replace('-', "\u{2212}")))
        .collect();
    let mut sizes = match &certificate.variable_steps {
        None => brief(certificate.step.to_f64()),
        Some(sizes) => {
            let [low, high] = [sizes.smallest, sizes.largest].map(|h| brief(h.to_f64()));
            format!("{low} to {high}")
        }
    };
    let unit = instance.units().time;
    if !unit.is_empty() {
        sizes = format!("{sizes} {unit}");
    }
    facts.push(format!("{} steps of {sizes}", certificate.counts.steps));
    facts.push(format!("{} in {}", certificate.method, T::NAME));
    facts.join(" \u{b7} ")
}

/// Paths of bodies, or the phase portrait of one degree of freedom: the curve, with a dot for each of few
/// steps, or dots alone where there is no curve.
fn paths(figure: &mut Figure, instance: &Instance, drawn: (&Curve, Option<&Curve>), view: &View) {
    let (path, curve) = drawn;
    let count = components(instance).len() / 2;
    let plane = *view == View::PhasePlane;
    let (heading, x, y) = match view {
        View::PhasePlane => ("Phase portrait", "q", "p"),
        _ if count > 1 => ("Paths", "x", "y"),
        _ => ("Path", "q\u{2081}", "q\u{2082}"),
    };
    let all = || {
        let both = curve.into_iter().chain([path]);
        both.flat_map(|path| (0..count).flat_map(|i| path.pairs(i)))
    };
    let unit = if plane { "" } else { instance.units().length };
    let [x, y] = [x, y].map(|what| labelled(what, unit));
    let x = Axis::around(all().map(|point| point.0), &x);
    let y = Axis::around(all().map(|point| point.1), &y);
    let mut panel = Panel::new(x, y);
    if !plane {
        panel.same_units();
    }
    let heading = match (curve, path.stride()) {
        (Some(_), _) => heading.to_owned(),
        (None, 1) => format!("{heading}, each step"),
        (None, stride) => format!("{heading}, one step in {stride}"),
    };
    let mut svg = panel.svg(&heading);
    for i in 0..count {
        let colour = if count > 1 {
            COLOURS[i % COLOURS.len()]
        } else {
            EQUIP
        };
        let points = path.pairs(i).map(|point| panel.at(point));
        // Points of steps are not joined: the line would not be the path.
        match curve {
            Some(curve) => {
                if points.clone().count() <= FEW {
                    svg.dots(points, colour, 3.4);
                }
                let points = curve.pairs(i).map(|point| panel.at(point));
                svg.polyline(points, colour, 1.2);
            }
            None => svg.dots(points, colour, 1.8),
        }
        if let Some(start) = path.pairs(i).next() {
            svg.dot(panel.at(start), 4.0, INK);
        }
    }
    figure.panels.push(svg);
    let start = ("initial state".into(), Look::mark(INK, Mark::Disc));
    figure.legend.push(start);
}

/// q_i against i, at the start and at the end.
fn profile<T: Float>(figure: &mut Figure, start: &[T], finished: &Finished<'_, T>) {
    let (end, last, _) = finished.run.last();
    let states = [(start, FAINT, 0.0), (last, COLOURS[0], end.to_f64())];
    let all = (states.iter()).flat_map(|(q, ..)| q.iter().map(|x| x.to_f64()));
    let y = Axis::around(all, "q\u{1d62}");
    let panel = Panel::new(Axis::between(0.0, (start.len() + 1) as f64, "i"), y);
    let mut svg = panel.svg("Profile");
    for (q, colour, time) in states {
        let points = q
            .iter()
            .enumerate()
            .map(|(i, x)| panel.at(((i + 1) as f64, x.to_f64())));
        svg.polyline(points.clone(), colour, 1.5);
        if q.len() <= 64 {
            svg.dots(points, colour, 5.0);
        }
        let time = format!("q at t = {}", brief(time));
        figure.legend.push((time, Look::line(colour)));
    }
    figure.panels.push(svg);
}

/// |ΔH/H₀| over time, or |ΔH| where H₀ is small compared with round-off. Exact zeros are left out.
fn energies<T: Float>(
    figure: &mut Figure,
    finished: &Finished<'_, T>,
    energy: &Envelope,
    comparison: Option<&Comparison>,
    time: Axis,
) {
    let legend = &mut figure.legend;
    let certificate = finished.run.certificate();
    let start = (certificate.energy.as_ref()).map_or(0.0, |e| e.start.to_f64().abs());
    let epsilon = T::EPSILON.to_f64();
    let level = certificate
        .energy_round_off
        .map(|level| level.round_off.to_f64());
    let level = level.filter(|level| *level > 0.0 && level.is_finite());
    let round_off = level.unwrap_or(epsilon * if start > 0.0 { start } else { 1.0 });
    let is_relative = start > 0.0 && round_off < epsilon.sqrt() * start;
    let (unit, heading, label) = if is_relative {
        (start, "Relative energy error", "|\u{394}H/H\u{2080}|")
    } else {
        (1.0, "Energy error", "|\u{394}H|")
    };
    let method = certificate.method.to_string();
    let method = method.split(',').next().unwrap_or_default();
    let is_gauss = method == "Gauss";
    let mut curves = vec![(
        energy.coarse(MOST_POINTS),
        if is_gauss { GAUSS } else { EQUIP },
    )];
    legend.push((method.to_owned(), Look::line(curves[0].1)));
    if let Some(comparison) = comparison {
        let short = if comparison.complete {
            ""
        } else {
            ", ended early"
        };
        curves.insert(0, (comparison.energy.coarse(MOST_POINTS), GAUSS));
        legend.push((format!("{}{short}", comparison.label), Look::line(GAUSS)));
    }
    legend.push(("round-off level of H".into(), Look::band()));
    for (points, _) in &mut curves {
        points.retain(|point| point.1.is_finite() && point.1 > 0.0);
        points.iter_mut().for_each(|point| point.1 /= unit);
    }
    let round_off = round_off / unit;
    let all = curves.iter().flat_map(|(points, _)| points);
    let all = range(all.map(|point| point.1).chain([round_off]));
    let shown = all.map(|(low, high)| (low.max(1e-3 * round_off), high));
    let y = Axis::powers(shown, 0.25, label);
    let mut panel = Panel::new(time, y);
    panel.round_off = Some(round_off);
    let mut svg = panel.svg(heading);
    for (points, colour) in &curves {
        svg.polyline(points.iter().map(|&point| panel.at(point)), colour, 1.3);
    }
    figure.panels.push(svg);
}

/// λ(t), which falls like ln t/t for regular motion, and MEGNO, which stays near 2.
fn chaos(figure: &mut Figure, seen: &Curve, end: f64, time: &str) {
    let positive = || seen.pairs(0).filter(|&(t, x)| t > 0.0 && x > 0.0);
    let axis = |of: fn((f64, f64)) -> f64, margin, label| {
        Axis::powers(range(positive().map(of)), margin, label)
    };
    let exponent = Panel::new(
        axis(|point| point.0, 0.0, time),
        axis(|point| point.1, 0.25, "\u{3bb}(t) per unit of time"),
    );
    let mut svg = exponent.svg("Lyapunov exponent");
    for stretch in positive_stretches(seen.pairs(0)) {
        let points = stretch.iter().map(|&point| exponent.at(point));
        match stretch.len() {
            1 => svg.dots(points, EQUIP, 1.5),
            _ => svg.polyline(points, EQUIP, 1.5),
        }
    }
    figure.panels.push(svg);
    let values = seen.pairs(1).map(|point| point.1).chain([0.0, 2.0]);
    let megno = Panel::new(
        Axis::between(0.0, end, time),
        Axis::around(values, "mean MEGNO"),
    );
    let mut svg = megno.svg("MEGNO, 2 for regular motion");
    let two = [(0.0, 2.0), (end, 2.0)].map(|p| megno.at(p));
    svg.polyline(two.into_iter(), FAINT, 1.2);
    let points = seen.pairs(1).map(|point| megno.at(point));
    svg.polyline(points, EQUIP, 1.5);
    figure.panels.push(svg);
}

/// The stretches in which both coordinates are positive, as on logarithmic axes: a line must not join what
/// lies on both sides of others.
fn positive_stretches(points: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let points: Vec<_> = points.collect();
    points
        .split(|&(x, y)| !(x > 0.0 && y > 0.0))
        .filter(|stretch| !stretch.is_empty())
        .map(<[_]>::to_vec)
        .collect()
}

/// What an axis shows, with its unit if it has one.
fn labelled(what: &str, unit: &str) -> String {
    if unit.is_empty() {
        what.to_owned()
    } else {
        format!("{what} / {unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::positive_stretches;

    #[test]
    fn a_line_is_broken_where_the_exponent_is_not_positive() {
        let points = [
            (0.0, 1.0),
            (1.0, 1.0),
            (2.0, 2.0),
            (3.0, -1.0),
            (4.0, 0.0),
            (5.0, 3.0),
        ];
        let expected = [vec![(1.0, 1.0), (2.0, 2.0)], vec![(5.0, 3.0)]];
        assert_eq!(positive_stretches(points.into_iter()), expected);
    }
}
