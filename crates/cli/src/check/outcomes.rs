//! Figures of a row in few characters, and what they mean.

use super::measure::Row;

impl Row {
    /// The worse of the solver's and the independent figure.
    pub(crate) fn levels(&self) -> Option<f64> {
        let m = &self.measured;
        match (m.levels, m.independent_levels) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        }
    }
}

/// Letters of the outcomes, as [`legend`] explains.
fn letter(label: &str) -> &'static str {
    match label {
        "energy solved" => "S",
        "at the round-off level" => "F",
        "quadratic H, nothing to do" => "Q",
        "energy not requested" => "N",
        "uncorrected: no effect of α" => "C",
        "uncorrected: α beyond its bound" => "B",
        "uncorrected: end point changed too much" => "D",
        "uncorrected: fast motion not resolved" => "U",
        _ => "?",
    }
}

/// Steps by outcome: letters with their numbers.
pub(crate) fn outcomes(row: &Row) -> Vec<(&'static str, u64)> {
    let parts = row.measured.outcomes.iter();
    parts.map(|(label, n)| (letter(label), *n)).collect()
}

pub(crate) const LEGEND: &str = "outcomes: S energy solved, F at the round-off level, uncorrected \
    C where α has no effect, B beyond the bound of α, D beyond the bound of the end point, U where the motion is not resolved; Q quadratic H, N energy not requested\n\
    levels: largest |H − H_ref| in round-off levels, the worse of the solver's figure and one in double-double; \
    energy: the same, absolute, EQUIP and Gauss\n\
    inv.: largest error of an invariant; error: of the trajectory, relative, largest over the grid, EQUIP and \
    Gauss; s: seconds of the row with Gauss and reference";

#[cfg(test)]
mod tests {
    use super::{LEGEND, letter};
    use equip_integrate::Outcome;

    #[test]
    fn every_outcome_has_a_letter_and_every_letter_its_meaning() {
        for outcome in Outcome::ALL {
            let letter = letter(outcome.label());
            assert_ne!(letter, "?", "{}", outcome.label());
            let (_, outcomes) = LEGEND.split_once("outcomes: ").unwrap_or_default();
            let outcomes = outcomes.lines().next().unwrap_or_default();
            let words = outcomes.split([' ', ',', ';']);
            assert_eq!(words.filter(|word| *word == letter).count(), 1, "{letter}");
        }
    }
}
