//! The picture of a run: orbit or phase portrait on the left, the energy defect over time on the right; below
//! them Lyapunov exponent and MEGNO if they were asked for.

use crate::draw::panel::{Axis, Panel};
use crate::draw::samples::{Envelope, Path};
use crate::draw::svg::{Anchor, FAINT, INK, Svg};
use crate::run::comparison::Comparison;
use crate::run::finished::Finished;
use crate::run::watch::Watch;
use crate::text::brief;
use equip_scalar::Float;
use equip_scenes::{Instance, View};

/// Muted colours, distinct also where red and green look alike: the first is that of the run.
const COLOURS: [&str; 6] = [
    "#2b6a99", "#c46b1f", "#4f8f6b", "#8d6a9f", "#b0485c", "#6b6b6b",
];
const GAUSS: &str = COLOURS[1];
const WIDTH: u32 = 1040;
const HEIGHT: u32 = 480;
const TOP: f64 = 108.0;
const SIDE: f64 = 300.0;
/// What the panels of the chaos indicators add.
const MORE: u32 = 390;
/// Up to this many steps, each is marked by a dot on its curve.
const FEW: usize = 400;

/// The components of y = (q, p) that the scene's picture is made of, two for each path.
pub(crate) fn components(instance: &Instance) -> Vec<usize> {
    match instance.view() {
        View::PhasePlane => vec![0, 1],
        View::Paths(pairs) => pairs.into_iter().flat_map(|(x, y)| [x, y]).collect(),
        View::Profile => Vec::new(),
    }
}

/// The picture as the text of an SVG file.
pub(crate) fn draw<T: Float>(
    finished: &Finished<'_, T>,
    watch: &Watch<'_, T>,
    comparison: Option<&Comparison>,
    curve: Option<&Path>,
) -> String {
    let more = if watch.follows_chaos { MORE } else { 0 };
    let mut svg = Svg::new(WIDTH, HEIGHT + more);
    let (instance, certificate) = (finished.instance, finished.run.certificate());
    svg.text((28.0, 36.0), 20, Anchor::Start, INK, instance.scene().title);
    let mut facts: Vec<_> = instance
        .parameters()
        .map(|(n, v)| format!("{n} = {v}"))
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
    svg.text(
        (28.0, 60.0),
        14,
        Anchor::Start,
        FAINT,
        &facts.join("  \u{b7}  "),
    );
    match instance.view() {
        View::Profile => profile(&mut svg, watch.start.0, finished),
        view => paths(&mut svg, instance, (&watch.picture.path, curve), &view),
    }
    let scale = certificate
        .energy
        .as_ref()
        .map_or(0.0, |e| e.start.to_f64().abs());
    let epsilon: f64 = T::EPSILON.to_f64();
    let floor = if scale > 0.0 {
        epsilon * scale
    } else {
        epsilon
    };
    let name = certificate.method.to_string();
    let name = name.split(',').next().unwrap_or_default();
    let end = certificate.end.to_f64();
    let time = labelled("time t", instance.units().time);
    energies(
        &mut svg,
        &watch.picture.energy,
        name,
        comparison,
        Axis::between(end.min(0.0), end.max(0.0), &time),
        floor,
    );
    if watch.follows_chaos {
        let since = if end < 0.0 {
            "time since the start"
        } else {
            "time t"
        };
        let time = labelled(since, instance.units().time);
        chaos(&mut svg, &watch.picture.chaos, end.abs(), &time);
    }
    svg.finish()
}

fn left_panel(x: Axis, y: Axis) -> Panel {
    Panel {
        left: 92.0,
        top: TOP,
        width: 340.0,
        height: SIDE,
        x,
        y,
    }
}

/// Paths of bodies, or the phase portrait of one degree of freedom: the curve, with a dot for each of few
/// steps, or dots alone where there is no curve.
fn paths(svg: &mut Svg, instance: &Instance, drawn: (&Path, Option<&Path>), view: &View) {
    let (path, curve) = drawn;
    let count = components(instance).len() / 2;
    let plane = *view == View::PhasePlane;
    let (x, y) = match view {
        View::PhasePlane => ("q", "p"),
        _ if count > 1 => ("x", "y"),
        _ => ("q\u{2081}", "q\u{2082}"),
    };
    let all = || {
        let both = curve.into_iter().chain([path]);
        both.flat_map(|path| (0..count).flat_map(|i| path.pairs(i)))
    };
    let unit = if plane { "" } else { instance.units().length };
    let [x, y] = [x, y].map(|what| labelled(what, unit));
    let x = Axis::around(all().map(|point| point.0), &x);
    let y = Axis::around(all().map(|point| point.1), &y);
    let mut panel = left_panel(x, y);
    if !plane {
        panel.same_units();
    }
    panel.draw_axes(svg);
    for i in 0..count {
        let colour = COLOURS[i % COLOURS.len()];
        let points = path.pairs(i).map(|point| panel.at(point));
        // Points of steps are not joined: the line would not be the path.
        match curve {
            Some(curve) => {
                if points.clone().count() <= FEW {
                    svg.dots(points, colour, 3.0);
                }
                let points = curve.pairs(i).map(|point| panel.at(point));
                svg.polyline(points, colour, 1.2);
            }
            None => svg.dots(points, colour, 1.6),
        }
        if let Some(start) = path.pairs(i).next() {
            svg.dot(panel.at(start), 4.0, INK);
        }
    }
    svg.dot((panel.left + 6.0, TOP - 18.0), 4.0, INK);
    let every = match (curve, path.stride()) {
        (Some(_), _) | (None, 1) => String::new(),
        (None, stride) => format!(", one step in {stride} drawn"),
    };
    svg.text(
        (panel.left + 18.0, TOP - 13.0),
        14,
        Anchor::Start,
        INK,
        &format!("start{every}"),
    );
}

/// q_i against i, at the start and at the end.
fn profile<T: Float>(svg: &mut Svg, start: &[T], finished: &Finished<'_, T>) {
    let (end, last, _) = finished.run.last();
    let states = [(start, FAINT), (last, COLOURS[0])];
    let all = states
        .iter()
        .flat_map(|(q, _)| q.iter().map(|x| x.to_f64()));
    let y = Axis::around(all, "q\u{1d62}");
    let panel = left_panel(Axis::between(0.0, (start.len() + 1) as f64, "i"), y);
    panel.draw_axes(svg);
    for (k, (q, colour)) in states.into_iter().enumerate() {
        let points = q
            .iter()
            .enumerate()
            .map(|(i, x)| panel.at(((i + 1) as f64, x.to_f64())));
        svg.polyline(points.clone(), colour, 1.5);
        if q.len() <= 64 {
            svg.dots(points, colour, 5.0);
        }
        let left = panel.left + 120.0 * k as f64;
        legend(
            svg,
            left,
            colour,
            &format!("t = {}", brief(if k == 0 { 0.0 } else { end.to_f64() })),
        );
    }
}

/// |H − H_ref| over time, zero at the bottom line.
fn energies(
    svg: &mut Svg,
    energy: &Envelope,
    name: &str,
    comparison: Option<&Comparison>,
    x: Axis,
    floor: f64,
) {
    let mut curves = vec![(energy, COLOURS[0], name.to_owned())];
    if let Some(comparison) = comparison {
        let short = if comparison.complete {
            ""
        } else {
            ", ended early"
        };
        let label = format!("{}{short}", comparison.label);
        curves.insert(0, (&comparison.energy, GAUSS, label));
    }
    let all = curves
        .iter()
        .flat_map(|(curve, ..)| curve.points().iter().map(|point| point.1));
    let (low, high) = all
        .filter(|&x| x.is_finite() && x > 0.0)
        .fold((f64::INFINITY, floor), |(low, high), x| {
            (low.min(x), high.max(x))
        });
    let y = Axis::decades(
        low.clamp(floor * 0.1, high),
        high,
        "energy defect |H \u{2212} H(0)|",
    );
    let panel = Panel {
        left: 560.0,
        top: TOP,
        width: 448.0,
        height: SIDE,
        x,
        y,
    };
    panel.draw_axes(svg);
    for (curve, colour, _) in &curves {
        svg.polyline(
            curve.points().iter().map(|&point| panel.at(point)),
            colour,
            1.2,
        );
    }
    let mut left = panel.left;
    for (_, colour, label) in curves.iter().rev() {
        legend(svg, left, colour, label);
        left += 60.0 + 8.0 * label.chars().count() as f64;
    }
}

/// λ(t), which falls like ln t/t for regular motion, and MEGNO, which stays near 2.
fn chaos(svg: &mut Svg, seen: &Path, end: f64, time: &str) {
    let positive = || seen.pairs(0).filter(|&(t, x)| t > 0.0 && x > 0.0);
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::MIN_POSITIVE), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    };
    let first = positive().map(|point| point.0).fold(end, f64::min);
    let (low, high) = match positive().next() {
        Some(_) => range(&mut positive().map(|point| point.1)),
        None => (1e-3, 1.0),
    };
    let top = TOP + f64::from(MORE);
    let exponent = Panel {
        top,
        x: Axis::decades_to(first, end, time),
        y: Axis::decades(low.min(high), high, "Lyapunov exponent \u{3bb}(t)"),
        ..left_panel(Axis::between(0.0, 1.0, ""), Axis::between(0.0, 1.0, ""))
    };
    exponent.draw_axes(svg);
    for stretch in positive_stretches(seen.pairs(0)) {
        let points = stretch.iter().map(|&point| exponent.at(point));
        match stretch.len() {
            1 => svg.dots(points, COLOURS[0], 1.5),
            _ => svg.polyline(points, COLOURS[0], 1.5),
        }
    }
    let values = seen.pairs(1).map(|point| point.1).chain([0.0, 2.0]);
    let megno = Panel {
        left: 560.0,
        top,
        width: 448.0,
        height: SIDE,
        x: Axis::between(0.0, end, time),
        y: Axis::around(values, "MEGNO, mean over time"),
    };
    megno.draw_axes(svg);
    svg.polyline(
        [(0.0, 2.0), (end, 2.0)].map(|p| megno.at(p)).into_iter(),
        FAINT,
        1.0,
    );
    let points = seen.pairs(1).map(|point| megno.at(point));
    svg.polyline(points, COLOURS[0], 1.5);
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

fn legend(svg: &mut Svg, left: f64, colour: &str, label: &str) {
    svg.line((left, TOP - 18.0), (left + 26.0, TOP - 18.0), colour, 3.0);
    svg.text((left + 34.0, TOP - 13.0), 14, Anchor::Start, INK, label);
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
