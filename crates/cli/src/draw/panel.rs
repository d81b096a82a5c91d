//! Panels with linear or logarithmic axes.

use crate::draw::svg::{Anchor, BAND, FAINT, FINE_GRID, GRID, INK, Svg};

/// Width and height of a panel with its labels.
pub(crate) const CELL: (f64, f64) = (450.0, 360.0);
/// Room around the frame: left, top, right, below.
const ROOM: (f64, f64, f64, f64) = (84.0, 34.0, 24.0, 62.0);

/// The smallest and the largest value.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, x| {
        let (low, high) = range.unwrap_or((x, x));
        Some((low.min(x), high.max(x)))
    })
}

/// An axis from `low` to `high`; a logarithmic one holds decimal logarithms.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    pub(crate) low: f64,
    pub(crate) high: f64,
    logarithmic: bool,
    label: String,
}

impl Axis {
    fn new(low: f64, high: f64, logarithmic: bool, label: &str) -> Self {
        let label = label.to_owned();
        Axis {
            low,
            high,
            logarithmic,
            label,
        }
    }

    /// From the smallest to the largest finite value, and a little more on either side.
    pub(crate) fn around(values: impl Iterator<Item = f64>, label: &str) -> Self {
        let (low, high) = range(values.filter(|x| x.is_finite())).unwrap_or((0.0, 1.0));
        let margin = if high > low { 0.04 * (high - low) } else { 1.0 };
        Axis::new(low - margin, high + margin, false, label)
    }

    /// Exactly from `low` to `high`.
    pub(crate) fn between(low: f64, high: f64, label: &str) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Axis::new(low, high, false, label)
    }

    /// Logarithmic, from `margin` decades below the range to as many above it, both positive; a decade and a
    /// half at least.
    pub(crate) fn powers(range: Option<(f64, f64)>, margin: f64, label: &str) -> Self {
        let (low, high) = range.unwrap_or((0.1, 1.0));
        let (low, high) = (low.log10() - margin, high.log10() + margin);
        let more = (0.75 - (high - low) / 2.0).max(0.0);
        Axis::new(low - more, high + more, true, label)
    }

    fn widen(&mut self, factor: f64) {
        let (middle, half) = ((self.low + self.high) / 2.0, (self.high - self.low) / 2.0);
        (self.low, self.high) = (middle - half * factor, middle + half * factor);
    }

    /// Where x is, from 0 at the low end to 1 at the high end; values beyond the ends stick to them.
    fn place(&self, x: f64) -> f64 {
        let x = if self.logarithmic { x.log10() } else { x };
        ((x - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Where 2, 3, … 9 times the powers of ten are, if the axis is logarithmic and short enough for them.
    fn between_decades(&self) -> Vec<f64> {
        if !self.logarithmic || self.high - self.low > 5.5 {
            return Vec::new();
        }
        let decades = self.low.floor() as i32..=self.high.floor() as i32;
        decades
            .flat_map(|d| (2..10).map(move |k| f64::from(d) + f64::from(k).log10()))
            .filter(|x| (self.low..self.high).contains(x))
            .collect()
    }

    /// Where 2 and 5 times the powers of ten are, with these numbers, if the axis is logarithmic and so short
    /// that it needs them.
    fn twos_and_fives(&self) -> Vec<(f64, String)> {
        if !self.logarithmic || self.high - self.low > 2.8 {
            return Vec::new();
        }
        let decades = self.low.floor() as i32..=self.high.floor() as i32;
        decades
            .flat_map(|d| [2, 5].map(|k| (k, d)))
            .map(|(k, d)| {
                let text = match d {
                    -3..=3 => format!("{:.*}", (-d).max(0) as usize, f64::from(k) * 10_f64.powi(d)),
                    _ => format!("{k}e{d}").replace('-', "\u{2212}"),
                };
                (f64::from(k).log10() + f64::from(d), text)
            })
            .filter(|(x, _)| (self.low..self.high).contains(x))
            .collect()
    }

    /// Ticks at multiples of 1, 2 or 5 times a power of ten (of whole decades if logarithmic), at most about
    /// `count`.
    fn ticks(&self, count: f64) -> (f64, impl Iterator<Item = f64>) {
        let rough = (self.high - self.low) / count;
        let power = 10_f64.powf(rough.log10().floor());
        let unit = if self.logarithmic {
            rough.ceil().max(1.0)
        } else {
            let units = [1.0, 2.0, 5.0, 10.0].map(|k| k * power);
            let unit = units.into_iter().find(|&u| u >= rough * 0.999);
            unit.unwrap_or(rough)
        };
        let (first, last) = (
            (self.low / unit - 1e-9).ceil(),
            (self.high / unit + 1e-9).floor(),
        );
        (
            unit,
            (0..=(last - first).max(0.0) as u32).map(move |i| (first + f64::from(i)) * unit),
        )
    }
}

/// A framed area with axes.
#[derive(Debug)]
pub(crate) struct Panel {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// What is below is round-off, and has a band.
    pub(crate) round_off: Option<f64>,
}

impl Panel {
    /// Of the usual size.
    pub(crate) fn new(x: Axis, y: Axis) -> Self {
        Panel::sized(CELL, x, y)
    }

    /// Of this width and height with its labels.
    pub(crate) fn sized((width, height): (f64, f64), x: Axis, y: Axis) -> Self {
        Panel {
            left: ROOM.0,
            top: ROOM.1,
            width: width - ROOM.0 - ROOM.2,
            height: height - ROOM.1 - ROOM.3,
            x,
            y,
            round_off: None,
        }
    }

    /// A picture of the axes, with a heading above.
    pub(crate) fn svg(&self, heading: &str) -> Svg {
        let (width, height) = (self.left + self.width, self.top + self.height);
        let mut svg = Svg::new(width + ROOM.2, height + ROOM.3);
        svg.text(
            (self.left, self.top - 12.0),
            15,
            Anchor::Start,
            INK,
            heading,
        );
        self.draw_axes(&mut svg);
        svg
    }

    /// Widens one axis until a unit is as long on either.
    pub(crate) fn same_units(&mut self) {
        let (x, y) = (
            (self.x.high - self.x.low) / self.width,
            (self.y.high - self.y.low) / self.height,
        );
        if x < y {
            self.x.widen(y / x)
        } else {
            self.y.widen(x / y)
        }
    }

    /// The pixel of a data point.
    pub(crate) fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (
            self.left + self.width * self.x.place(x),
            self.top + self.height * (1.0 - self.y.place(y)),
        )
    }

    /// Grid, ticks, frame and labels.
    fn draw_axes(&self, svg: &mut Svg) {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        if let Some(round_off) = self.round_off {
            let (_, y) = self.at((1.0, round_off));
            svg.rectangle((self.left, y), (self.width, bottom - y), BAND);
        }
        for is_x in [true, false] {
            for at in self.axis(is_x).between_decades() {
                let (from, to) = self.across(is_x, at);
                svg.line(from, to, FINE_GRID, 1.0);
            }
            for (at, text) in self.axis(is_x).twos_and_fives() {
                let (place, anchor) = self.label(is_x, at, (21.0, 4.0));
                svg.text(place, 12, anchor, FAINT, &text);
            }
        }
        for (is_x, count) in [(true, self.width / 80.0), (false, self.height / 45.0)] {
            let axis = self.axis(is_x);
            let (unit, ticks) = axis.ticks(count);
            for tick in ticks {
                let (from, to) = self.across(is_x, tick);
                svg.line(from, to, GRID, 1.0);
                let (place, anchor) = self.label(is_x, tick, (22.0, 4.5));
                tick_label(svg, axis, place, anchor, tick, unit);
            }
        }
        let corner = (self.left, bottom);
        svg.line((self.left, self.top), corner, FAINT, 1.2);
        svg.line(corner, (right, bottom), FAINT, 1.2);
        let (x, y) = (self.left + self.width / 2.0, self.top + self.height / 2.0);
        svg.text((x, bottom + 48.0), 15, Anchor::Middle, INK, &self.x.label);
        svg.upward_text((self.left - 62.0, y), 15, &self.y.label);
    }

    fn axis(&self, is_x: bool) -> &Axis {
        if is_x { &self.x } else { &self.y }
    }

    /// The line across the panel at a number of an axis, its logarithm if that is logarithmic.
    fn across(&self, is_x: bool, at: f64) -> ((f64, f64), (f64, f64)) {
        let Axis { low, high, .. } = self.axis(is_x);
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        if is_x {
            let x = self.left + self.width * (at - low) / (high - low);
            ((x, self.top), (x, bottom))
        } else {
            let y = bottom - self.height * (at - low) / (high - low);
            ((self.left, y), (right, y))
        }
    }

    /// Where the label of that line stands, `down` pixels below its lower or its left end.
    fn label(&self, is_x: bool, at: f64, down: (f64, f64)) -> ((f64, f64), Anchor) {
        let (from, to) = self.across(is_x, at);
        match is_x {
            true => ((to.0, to.1 + down.0), Anchor::Middle),
            false => ((from.0 - 10.0, from.1 + down.1), Anchor::End),
        }
    }
}

fn tick_label(svg: &mut Svg, axis: &Axis, at: (f64, f64), anchor: Anchor, tick: f64, unit: f64) {
    const SIZE: u32 = 13;
    if axis.logarithmic {
        return svg.power(at, SIZE, anchor, tick as i32);
    }
    let largest = axis.low.abs().max(axis.high.abs());
    let text = tick_text(tick, unit, largest);
    svg.text(at, SIZE, anchor, INK, &text.replace('-', "\u{2212}"));
}

/// The number at a tick of a linear axis whose ticks are `unit` apart.
fn tick_text(tick: f64, unit: f64, largest: f64) -> String {
    let is_zero = tick.abs() < unit / 2.0;
    if largest >= 1e6 || unit < 1e-4 {
        if is_zero {
            return "0".to_owned();
        }
        let tick: f64 = format!("{tick:.3e}").parse().unwrap_or(tick);
        format!("{tick:e}")
    } else {
        let decimals = (-unit.log10().floor()).max(0.0) as usize;
        let tick = if is_zero { 0.0 } else { tick };
        format!("{tick:.decimals$}")
    }
}

#[cfg(test)]
mod tests {
    use super::{Axis, tick_text};

    #[test]
    fn ticks_are_round_and_within_the_axis() {
        let axis = Axis::between(-1.3, 2.7, "");
        let (unit, ticks) = axis.ticks(5.0);
        assert_eq!(
            (unit, ticks.collect::<Vec<_>>()),
            (1.0, vec![-1.0, 0.0, 1.0, 2.0])
        );
        let axis = Axis::powers(Some((3e-16, 2e-3)), 0.25, "");
        let (unit, ticks) = axis.ticks(7.0);
        assert_eq!(
            (unit, ticks.collect::<Vec<_>>()),
            (2.0, vec![-14.0, -12.0, -10.0, -8.0, -6.0, -4.0])
        );
    }

    #[test]
    fn ticks_are_short_numbers() {
        for (tick, unit, largest, text) in [
            (0.0, 5e4, 2e5, "0"),
            (1.5e5, 5e4, 2e5, "150000"),
            (1.5e6, 5e5, 2e6, "1.5e6"),
            (0.0, 5e-6, 2e-5, "0"),
            (1.5e-5, 5e-6, 2e-5, "1.5e-5"),
            (-0.25, 0.05, 1.0, "-0.25"),
        ] {
            assert_eq!(tick_text(tick, unit, largest), text);
        }
    }

    #[test]
    fn a_power_of_ten_is_always_within() {
        for (low, high) in [(2.0, 3.0), (5.0, 5.0), (0.3, 40.0), (1e-17, 1e-16)] {
            let axis = Axis::powers(Some((low, high)), 0.1, "");
            let (_, ticks) = axis.ticks(5.0);
            assert!(ticks.count() > 0, "{axis:?}");
            assert!(
                axis.low < low.log10() && axis.high > high.log10(),
                "{axis:?}"
            );
        }
    }
}
