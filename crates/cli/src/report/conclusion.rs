//! What the figures of a report say, a sentence for each of its parts.

use super::accuracy::Time;
use super::long::{Long, REVOLUTIONS};
use super::results::{Results, times};
use crate::commands::growth::Curve;
use crate::draw::panel::range;
use crate::limits::LEVELS;
use crate::text::three_digits;

/// The sentences, of the parts that were measured.
pub(super) fn conclusion(long: &Long, results: &[Results]) -> Vec<String> {
    let sentences = [
        regular(&long.regular),
        close(&long.close),
        (!results.is_empty()).then(|| cost(&ratios(results))),
    ];
    sentences.into_iter().flatten().collect()
}

fn pairs(curves: &[Curve]) -> impl Iterator<Item = (&Curve, &Curve)> {
    let pairs = curves.chunks_exact(2);
    pairs.map(|pair| (&pair[0], &pair[1]))
}

fn regular(curves: &[Curve]) -> Option<String> {
    let (equip, gauss) = pairs(curves).next()?;
    let n = equip.points.last()?.0;
    let energy = |curve: &Curve| curve.energies.last().copied().unwrap_or(f64::NAN);
    let [ours, theirs] = [equip, gauss].map(|curve| curve.error_after(n));
    Some(format!(
        "After {n} revolutions of Kepler’s problem with e = {} and step size control, the largest relative energy error is {:.1e} with EQUIP and \
         {:.1e} with Gauss. The error of the state is {ours:.1e} with EQUIP and {theirs:.1e} with Gauss; that of EQUIP is {}.",
        equip.eccentricity,
        energy(equip),
        energy(gauss),
        compared(ours / theirs)
    ))
}

fn close(curves: &[Curve]) -> Option<String> {
    let errors = pairs(curves)
        .map(|(equip, gauss)| equip.error_after(REVOLUTIONS) / gauss.error_after(REVOLUTIONS));
    let (low, high) = range(errors)?;
    let ours: Vec<&Curve> = pairs(curves).map(|pair| pair.0).collect();
    let is_conserved = |curve: &&&Curve| {
        let levels = curve.certificate.energy_in_round_off_levels;
        curve.certificate.counts.uncorrected() == 0 && levels.is_some_and(|x| x <= LEVELS)
    };
    let orbits: Vec<_> = ours.iter().map(|c| c.eccentricity.as_str()).collect();
    let sum = |of: fn(&Curve) -> u64| ours.iter().map(|curve| of(curve)).sum::<u64>();
    Some(format!(
        "With close encounters (e = {}), EQUIP conserves the energy to round-off in {} of {} runs of {REVOLUTIONS} revolutions and leaves {} of {} steps \
         uncorrected; its error is {low:.1e} to {high:.1e} times that of Gauss.",
        orbits.join(", "),
        ours.iter().filter(is_conserved).count(),
        ours.len(),
        sum(|curve| curve.certificate.counts.uncorrected()),
        sum(|curve| curve.certificate.counts.steps),
    ))
}

/// Times of EQUIP over those of Gauss to the same error, with as many stages and the same kind of steps.
fn ratios(results: &[Results]) -> Vec<f64> {
    let mut ratios = Vec::new();
    for result in results {
        for equip in result.curves.iter().filter(|c| c.contender.is_equip) {
            let mut other = equip.contender;
            other.is_equip = false;
            let gauss = result.curves.iter().find(|c| c.contender == other);
            let all = |curve| times(curve, result.targets);
            let pairs = gauss.map(|gauss| all(equip).into_iter().zip(all(gauss)));
            // A bound is no time.
            ratios.extend(pairs.into_iter().flatten().filter_map(|pair| match pair {
                (Time::Interpolated(ours), Time::Interpolated(theirs)) => Some(ours / theirs),
                _ => None,
            }));
        }
    }
    ratios.sort_by(f64::total_cmp);
    ratios
}

fn cost(ratios: &[f64]) -> String {
    let Some((low, high)) = range(ratios.iter().copied()) else {
        return "No error was reached by both EQUIP and Gauss with the same number of stages: the times cannot be compared.".into();
    };
    let (count, faster) = (ratios.len(), ratios.iter().filter(|x| **x < 1.0).count());
    format!(
        "For the same error and number of stages, EQUIP takes {low:.2} to {high:.2} times the CPU time of Gauss (median {:.2}); of {count} comparisons, \
         EQUIP is faster in {faster} and Gauss in {}.",
        ratios[count / 2],
        count - faster
    )
}

/// A ratio in words.
fn compared(ratio: f64) -> String {
    match ratio {
        x if x < 0.95 => format!("smaller by a factor of {}", three_digits(1.0 / x)),
        x if x > 1.05 => format!("larger by a factor of {}", three_digits(x)),
        x if x.is_nan() => "not comparable".into(),
        _ => "as large".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::{compared, cost};

    #[test]
    fn sentences_follow_the_figures() {
        let words = [0.01, 1.0, 30.0, f64::NAN].map(compared);
        let expected = [
            "smaller by a factor of 100",
            "as large",
            "larger by a factor of 30.0",
            "not comparable",
        ];
        assert_eq!(words, expected);
        let text = cost(&[0.5, 2.0, 3.0]);
        let parts = ["0.50 to 3.00", "median 2.00", "faster in 1 and Gauss in 2"];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
        assert!(cost(&[]).contains("cannot be compared"));
    }
}
