//! Figures of a row in few characters, and what they mean.

use super::leg::Leg;
use equip_integrate::Outcome;

/// The letter of an outcome, as [`LEGEND`] explains.
fn letter(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Solved => "S",
        Outcome::AtRoundOff => "F",
        Outcome::Quadratic => "Q",
        Outcome::NotRequested => "N",
        Outcome::NoEffect => "C",
        Outcome::BeyondBound => "B",
        Outcome::TooFar => "D",
        Outcome::Unresolved => "U",
        _ => "?",
    }
}

/// Steps by outcome, letters with their numbers; `gap` keeps a letter and its number together.
pub(crate) fn outcomes(leg: &Leg, gap: &str) -> String {
    let parts = leg
        .outcomes()
        .map(|(o, n)| format!("{}{gap}{n}", letter(o)));
    parts.collect::<Vec<_>>().join(" ")
}

pub(crate) const LEGEND: &str = "outcomes: S energy solved, F at the round-off level, uncorrected \
    C if α has no effect, B if α is beyond its bound, D if the end point changes too much, U if the motion is not resolved; \
    Q quadratic H, N energy not requested\n\
    levels: largest |H − H_ref| in round-off levels, the larger of the values of the solver and of double-double; \
    energy: the same, absolute, for EQUIP and Gauss\n\
    inv.: largest error of an invariant; error: largest relative trajectory error over the time grid, for EQUIP and \
    Gauss; s: seconds for the row, with Gauss and the reference";

#[cfg(test)]
mod tests {
    use super::{LEGEND, letter};
    use equip_integrate::Outcome;

    #[test]
    fn every_outcome_has_a_letter_and_every_letter_its_meaning() {
        for outcome in Outcome::ALL {
            let letter = letter(outcome);
            assert_ne!(letter, "?", "{outcome:?}");
            let (_, outcomes) = LEGEND.split_once("outcomes: ").unwrap_or_default();
            let outcomes = outcomes.lines().next().unwrap_or_default();
            let words = outcomes.split([' ', ',', ';']);
            assert_eq!(words.filter(|word| *word == letter).count(), 1, "{letter}");
        }
    }
}
