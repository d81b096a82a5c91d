//! The tables of the page.

use super::accuracy::Time;
use super::measure::{Curve, Point};
use super::results::{Results, times};
use crate::commands::growth;
use crate::draw::page::table;
use crate::draw::svg::escape;

/// Three digits, or nothing.
pub(super) fn brief(x: f64) -> String {
    match x {
        x if !x.is_finite() => String::new(),
        x if (0.1..1e4).contains(&x) => {
            let decimals = (2.0 - x.log10().floor()).clamp(0.0, 3.0) as usize;
            format!("{x:.decimals$}")
        }
        x => format!("{x:.2e}"),
    }
}

/// Uncorrected steps: Gauss corrects none, which is no news.
fn uncorrected(is_equip: bool, count: u64) -> String {
    if is_equip {
        count.to_string()
    } else {
        "–".into()
    }
}

/// Runs with step control: errors after the `numbers` of revolutions.
pub(super) fn growth(curves: &[&growth::Curve], numbers: &[u64]) -> String {
    let mut heads: Vec<String> = ["method", "e", "tolerance"].map(Into::into).into();
    heads.extend(numbers.iter().map(|n| format!("error after {n}")));
    let more = [
        "max |ΔH/H₀|",
        "in round-off levels",
        "steps per revolution",
        "uncorrected steps",
        "CPU ms per revolution",
    ];
    heads.extend(more.map(Into::into));
    let row = |curve: &&growth::Curve| {
        let c = &curve.certificate;
        let mut cells = vec![
            format!("{}(8)", curve.name()),
            escape(&curve.eccentricity),
            escape(&curve.tolerance),
        ];
        cells.extend(
            numbers
                .iter()
                .map(|&n| format!("{:.1e}", curve.error_after(n))),
        );
        let energy = curve.energies.last().copied().unwrap_or(f64::NAN);
        cells.extend([
            format!("{energy:.1e}"),
            c.energy_in_floors.map_or("–".into(), |x| format!("{x:.1}")),
            format!("{:.1}", c.counts.steps as f64 / curve.revolutions),
            uncorrected(curve.is_equip, c.counts.uncorrected()),
            brief(curve.milliseconds / curve.revolutions),
        ]);
        cells
    };
    table(
        "numbers",
        &heads,
        &curves.iter().map(row).collect::<Vec<_>>(),
    )
}

/// Milliseconds to each error.
pub(super) fn accuracies(result: &Results) -> String {
    let mut heads = vec!["method".to_owned()];
    heads.extend(result.targets.iter().map(|t| format!("{t:.0e}")));
    let all: Vec<(&Curve, Vec<Time>)> = result
        .curves
        .iter()
        .map(|c| (c, times(c, result.targets)))
        .collect();
    let quickest = |k: usize, which: fn(&Curve) -> bool| {
        let chosen = all.iter().filter(|(curve, _)| which(curve));
        let column = chosen.filter_map(|(_, times)| times[k].milliseconds());
        column.fold(f64::INFINITY, f64::min)
    };
    let cell = |k: usize, time: &Time| {
        let text = match time {
            Time::NotReached => return "–".to_owned(),
            Time::AtMost(ms) => format!("≤ {}", brief(*ms)),
            Time::Interpolated(ms) => brief(*ms),
        };
        let ms = time.milliseconds();
        if ms == Some(quickest(k, |_| true)) {
            format!("<span class=\"first\">{text}</span>")
        } else if ms == Some(quickest(k, |c| c.contender.is_equip)) {
            format!("<span class=\"keeps\">{text}</span>")
        } else {
            text
        }
    };
    let rows: Vec<Vec<String>> = all
        .iter()
        .map(|(curve, times)| {
            let mut cells = vec![escape(&curve.contender.name())];
            cells.extend(times.iter().enumerate().map(|(k, time)| cell(k, time)));
            cells
        })
        .collect();
    table("numbers", &heads, &rows)
}

/// All runs of a scene.
pub(super) fn runs(result: &Results) -> String {
    let mut heads: Vec<String> = [
        "method",
        "order",
        "setting",
        "steps",
        "uncorrected",
        "error",
        "max |ΔH|",
    ]
    .map(Into::into)
    .into();
    heads.extend(result.invariants.iter().map(|name| escape(name)));
    heads.extend(
        [
            "∇H",
            "∇H per step",
            "iterations per step",
            "ms, median",
            "least",
            "most",
            "repeats",
        ]
        .map(Into::into),
    );
    let per_step = |count: u64, steps: u64| format!("{:.1}", count as f64 / steps.max(1) as f64);
    let row = |curve: &Curve, point: &Point| {
        let o = &point.outcome;
        let setting = if curve.contender.adapts {
            format!("tolerance {:.0e}", point.setting)
        } else {
            format!("{} steps", point.setting)
        };
        let mut cells = vec![
            escape(&curve.contender.name()),
            curve.contender.order().to_string(),
            setting,
            o.steps.to_string(),
            uncorrected(curve.contender.is_equip, o.uncorrected),
            format!("{:.1e}", o.error),
            format!("{:.1e}", o.energy),
        ];
        cells.extend(o.invariants.iter().map(|x| format!("{x:.1e}")));
        let (least, most) = point.spread();
        cells.extend([
            o.gradients.to_string(),
            per_step(o.gradients, o.steps),
            per_step(o.iterations, o.steps),
            brief(point.median()),
            brief(least),
            brief(most),
            point.milliseconds.len().to_string(),
        ]);
        cells
    };
    let rows: Vec<_> = result
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(move |point| row(curve, point)))
        .collect();
    table("numbers", &heads, &rows)
}

#[cfg(test)]
mod tests {
    use super::brief;

    #[test]
    fn three_digits() {
        let texts = [0.012345, 0.12345, 1.2345, 123.45, 12345.0, f64::NAN].map(brief);
        assert_eq!(texts, ["1.23e-2", "0.123", "1.23", "123", "1.23e4", ""]);
    }
}
