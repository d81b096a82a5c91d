//! [`judge`]: figures against expectations.
//!
//! The criteria, the same for every row:
//! - every step is accounted for: as many outcomes as steps asked for, or a typed error after the last, which
//!   the row is to have or Gauss has on steps of the same size;
//! - |H − H_ref| ≤ 8 round-off levels on every step whose outcome says that the energy is kept, by the
//!   solver's own evaluation of H and, for runs in `f64`, 9 by one in double-double; H_ref is the number the
//!   run started with. (After a start at a pericentre, where large terms cancel, that number itself has an
//!   error of many levels of the quiet part of the orbit.)
//! - linear and quadratic invariants stay within (8 + 2√n) ε Σ|∂_iI y_i| over n steps, halves counted: the
//!   random walk of rounding;
//! - uncorrected steps leave at most twice the energy error of Gauss with the same steps,
//!   where these follow the motion; such a row is *explained*, by the reasons that the solver gives;
//! - the largest trajectory error over the grid (of the slow variables, where fast oscillations are not
//!   resolved) is at most three times that of Gauss, plus eight times what a change of the start by one unit
//!   in the last place does. A row whose definition has a larger figure, at which it was measured, is a
//!   *known deficit* up to a quarter more than that.

use super::case::{End, Expect, Kind, Trajectory};
use super::leg::Leg;
use super::measured::Measured;
use crate::limits::{LEVELS, TRAJECTORY, UNCORRECTED};

/// Trajectory errors within so many times what one rounding of the start does are round-off.
const NOISE: f64 = 8.0;
/// Trajectory errors of known deficits, over the figure that is known.
const DEFICIT: f64 = 1.25;

/// What became of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Word {
    Pass,
    /// The run ended with the typed error that is the right answer.
    ExpectedError,
    /// Steps were uncorrected, each for a reason, and the energy is no further off than with Gauss.
    Explained,
    /// The trajectory error is beyond its limit, as is known of this row.
    KnownDeficit,
    Fail,
}

impl Word {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Word::Pass => "pass",
            Word::ExpectedError => "expected error",
            Word::Explained => "explained",
            Word::KnownDeficit => "known deficit",
            Word::Fail => "FAIL",
        }
    }
}

/// The verdict with its reasons: what failed, or what is to be known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Verdict {
    pub(crate) word: Word,
    pub(crate) notes: Vec<String>,
}

impl Verdict {
    pub(crate) fn failed(reason: String) -> Self {
        Verdict {
            word: Word::Fail,
            notes: vec![reason],
        }
    }
}

pub(crate) fn judge(expect: &Expect, wanted: u64, measured: &Measured) -> Verdict {
    let mut judge = Judge {
        expect,
        wanted,
        measured,
        equip: &measured.equip,
        word: Word::Pass,
        faults: Vec::new(),
        notes: Vec::new(),
    };
    judge.ending();
    judge.accounts();
    judge.energy();
    judge.invariants();
    judge.uncorrected();
    judge.trajectory();
    let (word, notes) = match judge.faults.is_empty() {
        true => (judge.word, judge.notes),
        false => (Word::Fail, judge.faults),
    };
    Verdict { word, notes }
}

/// A row on which judgement is passed: each criterion adds to its faults and notes.
struct Judge<'a> {
    expect: &'a Expect,
    wanted: u64,
    measured: &'a Measured,
    equip: &'a Leg,
    word: Word,
    faults: Vec<String>,
    notes: Vec<String>,
}

impl Judge<'_> {
    fn ending(&mut self) {
        let (steps, wanted) = (self.equip.counts.steps, self.wanted);
        if self.equip.impatient {
            let text = format!("too slow: {steps} of {wanted} steps");
            self.faults.push(text);
        }
        let Some(ended) = &self.equip.ended else {
            if let End::Error(_, _, why) = self.expect.end {
                self.faults.push(format!("no error, although {why}"));
            }
            if !self.equip.impatient && steps != wanted {
                self.faults.push(format!("{steps} of {wanted} steps made"));
            }
            return;
        };
        let expected = match self.expect.end {
            End::Complete => None,
            End::Error(kinds, after, why) => Some((kinds, after, why)),
            End::Either(kinds, why) => Some((kinds, 0.0, why)),
        };
        let text = format!("at t = {:.6}: {}", ended.time, ended.text);
        let is_like = |kinds: &[Kind], after| kinds.contains(&ended.kind) && ended.time >= after;
        let gauss = self.measured.gauss.ended.as_ref();
        let note = if let Some((_, _, why)) = expected.filter(|e| is_like(e.0, e.1)) {
            format!("{why}; {text}")
        } else if let Some(gauss) = gauss.filter(|gauss| gauss.kind == ended.kind) {
            format!("error {text}; Gauss has it at t = {:.6}", gauss.time)
        } else {
            return self.faults.push(format!("error {text}"));
        };
        self.notes.push(note);
        self.word = Word::ExpectedError;
    }

    fn accounts(&mut self) {
        let sum: u64 = self.equip.outcomes().map(|(_, n)| n).sum();
        let steps = self.equip.counts.steps;
        if sum != steps {
            self.faults
                .push(format!("{sum} outcomes for {steps} steps"));
        }
    }

    fn energy(&mut self) {
        // The rounding of the solver's own evaluation of H is up to one level.
        let by_double_double = self.equip.independent_levels;
        for (how, levels, most) in [
            ("", self.equip.levels, LEVELS),
            (" in double-double", by_double_double, LEVELS + 1.0),
        ] {
            if let Some(levels) = levels.filter(|levels| !(*levels <= most)) {
                let text = format!("energy error of {levels:.3} round-off levels{how}");
                self.faults.push(text);
            }
        }
        if !self.equip.energy.is_finite() {
            self.faults.push("the energy error is not a number".into());
        }
    }

    fn invariants(&mut self) {
        // Steps that were split count in parts.
        let parts = self.equip.counts.steps + self.equip.counts.halvings;
        let most = 8.0 + 2.0 * (parts as f64).sqrt();
        for kept in &self.equip.invariants {
            if !(kept.in_roundoff <= most) {
                self.faults.push(format!(
                    "{} error {:.1e}, {:.3} times round-off, {most:.3} allowed",
                    kept.name, kept.error, kept.in_roundoff
                ));
            }
        }
    }

    /// Uncorrected steps are explained if the energy is no worse for them than that of Gauss.
    fn uncorrected(&mut self) {
        let (count, steps) = (self.equip.counts.uncorrected(), self.equip.counts.steps);
        if count == 0 {
            return;
        }
        let (energy, gauss) = (self.equip.energy, self.measured.gauss.energy);
        let text = format!(
            "{count} steps uncorrected ({:.2} %), energy error {energy:.1e}, {gauss:.1e} with Gauss",
            100.0 * (count as f64 / steps as f64)
        );
        // Where Gauss came to an end before, or neither follows the motion, there is nothing to compare with.
        let is_open = matches!(self.expect.trajectory, Trajectory::Open(_));
        if is_open || energy <= UNCORRECTED * gauss || self.measured.gauss.ended.is_some() {
            self.notes.push(text);
            if self.word == Word::Pass {
                self.word = Word::Explained;
            }
        } else {
            self.faults.push(text);
        }
    }

    fn trajectory(&mut self) {
        match self.expect.trajectory {
            Trajectory::Resolved => self.compared("trajectory"),
            Trajectory::Slow => self.compared("slow variables'"),
            Trajectory::Within(most) => {
                let error = self.measured.error.unwrap_or(f64::NAN);
                if !(error <= most) {
                    let text = format!("trajectory error {error:.1e}, {most:.1e} allowed");
                    self.faults.push(text);
                }
            }
            Trajectory::Open(why) => self.notes.push(why.to_owned()),
        }
    }

    /// The error of `what` against that of Gauss; a known deficit is noted.
    fn compared(&mut self, what: &str) {
        let round_off = NOISE * self.measured.noise.unwrap_or(0.0);
        let (Some(error), Some(gauss)) = (self.measured.error, self.measured.gauss_error) else {
            return;
        };
        if error <= TRAJECTORY * gauss + round_off {
            return;
        }
        let ratio = self.measured.ratio().unwrap_or(0.0);
        let text = format!("{what} error {ratio:.3} times that of Gauss, {TRAJECTORY} allowed");
        match self.expect.deficit {
            Some(known) if ratio <= DEFICIT * known => {
                self.word = Word::KnownDeficit;
                self.notes.push(format!("{text}; {known} is known"));
            }
            Some(known) => self.faults.push(format!("{text}; {known} is known")),
            None => self.faults.push(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::{End, Expect, Kind, Trajectory};
    use super::super::leg::{Ended, Kept, Leg};
    use super::super::measured::Measured;
    use super::{DEFICIT, LEVELS, TRAJECTORY, UNCORRECTED, Word, judge};
    use equip_integrate::{Counts, Outcome};

    const EXPECT: Expect = Expect {
        end: End::Complete,
        trajectory: Trajectory::Resolved,
        deficit: None,
    };

    fn counts(solved: u64, uncorrected: u64) -> Counts {
        let mut counts = Counts::default();
        (0..solved).for_each(|_| counts.record(Outcome::Solved));
        (0..uncorrected).for_each(|_| counts.record(Outcome::TooFar));
        counts
    }

    fn ended(kind: Kind, time: f64) -> Option<Ended> {
        let text = String::new();
        Some(Ended { kind, text, time })
    }

    fn good() -> Measured {
        Measured {
            equip: Leg {
                counts: counts(100, 0),
                levels: Some(1.0),
                independent_levels: Some(2.0),
                energy: 1e-16,
                ..Leg::default()
            },
            gauss: Leg {
                energy: 1e-9,
                ..Leg::default()
            },
            error: Some(1e-6),
            gauss_error: Some(2e-6),
            noise: Some(1e-15),
        }
    }

    fn word(expect: Expect, measured: &Measured) -> Word {
        judge(&expect, 100, measured).word
    }

    #[test]
    fn a_good_row_passes() {
        assert_eq!(judge(&EXPECT, 100, &good()).word, Word::Pass);
    }

    #[test]
    fn every_criterion_fails_a_row() {
        let broken: [fn(&mut Measured); 12] = [
            |m| m.equip.counts = counts(99, 0),
            |m| (m.equip.counts, m.equip.counts.steps) = (counts(99, 0), 100),
            |m| m.equip.levels = Some(1.01 * LEVELS),
            |m| m.equip.levels = Some(f64::NAN),
            |m| m.equip.independent_levels = Some(1.01 * (LEVELS + 1.0)),
            |m| m.equip.energy = f64::NAN,
            |m| {
                m.equip.counts = counts(99, 1);
                m.equip.energy = 1.01 * UNCORRECTED * m.gauss.energy;
            },
            |m| m.error = Some(1.01 * TRAJECTORY * 2e-6),
            |m| m.error = Some(f64::INFINITY),
            |m| m.equip.impatient = true,
            |m| {
                m.equip.invariants = vec![Kept {
                    name: "L".into(),
                    error: 1e-14,
                    in_roundoff: 29.0,
                }];
            },
            |m| m.equip.ended = ended(Kind::NotFinite, 1.0),
        ];
        for (i, break_it) in broken.iter().enumerate() {
            let mut measured = good();
            break_it(&mut measured);
            let verdict = judge(&EXPECT, 100, &measured);
            assert_eq!(verdict.word, Word::Fail, "criterion {i}");
            assert!(!verdict.notes.is_empty(), "criterion {i}");
        }
    }

    #[test]
    fn an_expected_error_must_come_and_be_of_its_kind() {
        let mut measured = good();
        let end = End::Error(&[Kind::NotFinite], 0.5, "it escapes");
        let expect = Expect { end, ..EXPECT };
        assert_eq!(word(expect, &measured), Word::Fail);
        for (kind, time, word_expected) in [
            (Kind::NotFinite, 1.0, Word::ExpectedError),
            (Kind::NotFinite, 0.1, Word::Fail),
            (Kind::Singular, 1.0, Word::Fail),
        ] {
            measured.equip.ended = ended(kind, time);
            assert_eq!(word(expect, &measured), word_expected);
        }
    }

    #[test]
    fn an_error_that_gauss_has_too_is_expected() {
        let ended = |kind| ended(kind, 1.0);
        let mut measured = good();
        measured.equip.ended = ended(Kind::NoConvergence);
        assert_eq!(word(EXPECT, &measured), Word::Fail);
        measured.gauss.ended = ended(Kind::NotFinite);
        assert_eq!(word(EXPECT, &measured), Word::Fail);
        measured.gauss.ended = ended(Kind::NoConvergence);
        assert_eq!(word(EXPECT, &measured), Word::ExpectedError);
    }

    #[test]
    fn carried_steps_are_explained_as_long_as_the_energy_is_that_of_gauss() {
        let mut measured = good();
        measured.equip.counts = counts(90, 10);
        for (part, expected) in [(0.99, Word::Explained), (1.01, Word::Fail)] {
            measured.equip.energy = part * UNCORRECTED * measured.gauss.energy;
            assert_eq!(word(EXPECT, &measured), expected);
        }
    }

    #[test]
    fn a_known_deficit_is_known_by_its_figure_and_is_no_excuse_for_anything_else() {
        let known = 10.0 * TRAJECTORY;
        let expect = Expect {
            deficit: Some(known),
            ..EXPECT
        };
        let mut measured = good();
        for (ratio, expected) in [
            (0.99 * TRAJECTORY, Word::Pass),
            (1.01 * TRAJECTORY, Word::KnownDeficit),
            (0.99 * DEFICIT * known, Word::KnownDeficit),
            (1.01 * DEFICIT * known, Word::Fail),
            (f64::NAN, Word::Fail),
        ] {
            measured.error = Some(ratio * 2e-6);
            assert_eq!(word(expect, &measured), expected, "{ratio}");
        }
        measured.error = Some(known * 2e-6);
        let verdict = judge(&expect, 100, &measured);
        assert!(verdict.notes[0].contains("30 is known"), "{verdict:?}");
        measured.equip.levels = Some(1.01 * LEVELS);
        assert_eq!(word(expect, &measured), Word::Fail);
    }

    #[test]
    fn round_off_is_no_fault() {
        let mut measured = good();
        (measured.error, measured.gauss_error) = (Some(7e-15), Some(1e-15));
        assert_eq!(word(EXPECT, &measured), Word::Pass);
        measured.noise = Some(1e-16);
        assert_eq!(word(EXPECT, &measured), Word::Fail);
    }
}
