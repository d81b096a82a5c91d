//! Time to an accuracy, from the points of a method.

/// Milliseconds to reach an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Time {
    /// Interpolated between the last point that misses and the first that reaches it, both logarithms linear.
    Interpolated(f64),
    /// The coarsest point reaches it already.
    AtMost(f64),
    /// No point does.
    NotReached,
}

impl Time {
    /// The figure, if there is one.
    pub(super) fn milliseconds(self) -> Option<f64> {
        match self {
            Time::Interpolated(ms) | Time::AtMost(ms) => Some(ms),
            Time::NotReached => None,
        }
    }
}

/// The time to reach `target` along points (error, milliseconds) from coarse to fine.
///
/// The first point within the target counts that is followed by one within it too, or is the last: a lucky
/// hit does not.
pub(super) fn time_to(target: f64, points: &[(f64, f64)]) -> Time {
    let within = |i: usize| points.get(i).is_none_or(|p| p.0 <= target);
    let Some(i) = (0..points.len()).find(|&i| within(i) && within(i + 1)) else {
        return Time::NotReached;
    };
    let (fine, after) = points[i];
    let Some(&(coarse, before)) = i.checked_sub(1).and_then(|i| points.get(i)) else {
        return Time::AtMost(after);
    };
    if !(coarse > target && fine > 0.0 && before > 0.0) {
        return Time::Interpolated(after);
    }
    let part = (coarse / target).ln() / (coarse / fine).ln();
    Time::Interpolated(before * (after / before).powf(part))
}

#[cfg(test)]
mod tests {
    use super::{Time, time_to};

    #[test]
    fn a_power_law_is_met_exactly() {
        // error = ms^-4
        let points: Vec<_> = [1.0, 3.0, 10.0, 40.0]
            .map(|ms: f64| (ms.powi(-4), ms))
            .to_vec();
        for target in [1e-1, 1e-3, 1e-5, 3e-6] {
            let Time::Interpolated(ms) = time_to(target, &points) else {
                panic!("{target:e} is between the points")
            };
            assert!(
                (ms / target.powf(-0.25) - 1.0).abs() < 1e-12,
                "{target:e}: {ms}"
            );
        }
        assert_eq!(time_to(2.0, &points), Time::AtMost(1.0));
        assert_eq!(time_to(1e-9, &points), Time::NotReached);
        assert_eq!(time_to(1e-9, &[]), Time::NotReached);
    }

    #[test]
    fn a_lucky_hit_does_not_count() {
        let points = [(1e-2, 1.0), (1e-9, 2.0), (1e-4, 4.0), (1e-8, 8.0)];
        let Time::Interpolated(ms) = time_to(1e-6, &points) else {
            panic!()
        };
        assert!((ms - 32_f64.sqrt()).abs() < 1e-12, "{ms}");
    }
}
