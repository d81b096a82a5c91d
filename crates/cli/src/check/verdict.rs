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

use super::case::{End, Expect, Trajectory};
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
    let mut faults = Vec::new();
    let mut notes = Vec::new();
    let mut word = ending(expect, wanted, measured, &mut faults, &mut notes);
    accounts(measured, &mut faults);
    energy(measured, &mut faults);
    invariants(measured, &mut faults);
    if uncorrected(expect, measured, &mut faults, &mut notes) && word == Word::Pass {
        word = Word::Explained;
    }
    if trajectory(expect, measured, &mut faults, &mut notes) {
        word = Word::KnownDeficit;
    }
    if faults.is_empty() {
        Verdict { word, notes }
    } else {
        Verdict {
            word: Word::Fail,
            notes: faults,
        }
    }
}

fn ending(
    expect: &Expect,
    wanted: u64,
    measured: &Measured,
    faults: &mut Vec<String>,
    notes: &mut Vec<String>,
) -> Word {
    if measured.impatient {
        faults.push(format!("too slow: {} of {wanted} steps", measured.steps));
    }
    let expected = match expect.end {
        End::Complete => None,
        End::Error(kinds, after, why) => Some((kinds, after, why)),
        End::Either(kinds, why) => Some((kinds, 0.0, why)),
    };
    match (&measured.ended, expected) {
        (None, None) => {}
        (None, Some((_, _, why))) if matches!(expect.end, End::Error(..)) => {
            faults.push(format!("no error, though {why}"));
        }
        (None, Some(_)) => {}
        (Some(ended), Some((kinds, after, why)))
            if kinds.contains(&ended.kind) && ended.time >= after =>
        {
            notes.push(format!("{why}; at t = {:.6}: {}", ended.time, ended.text));
            return Word::ExpectedError;
        }
        (Some(ended), _) => {
            let text = format!("error at t = {:.6}: {}", ended.time, ended.text);
            match &measured.gauss_ended {
                Some(gauss) if gauss.kind == ended.kind => {
                    let time = gauss.time;
                    notes.push(format!("{text}; Gauss ends alike at t = {time:.6}"));
                    return Word::ExpectedError;
                }
                _ => faults.push(text),
            }
        }
    }
    if measured.ended.is_none() && !measured.impatient && measured.steps != wanted {
        faults.push(format!("{} of {wanted} steps made", measured.steps));
    }
    Word::Pass
}

fn accounts(measured: &Measured, faults: &mut Vec<String>) {
    let sum: u64 = measured.outcomes.iter().map(|(_, n)| n).sum();
    if sum != measured.steps {
        faults.push(format!("{sum} outcomes for {} steps", measured.steps));
    }
}

fn energy(measured: &Measured, faults: &mut Vec<String>) {
    // The rounding of the solver's own evaluation of H is up to one level.
    let figures = [
        ("", measured.levels, LEVELS),
        (
            " by double-double",
            measured.independent_levels,
            LEVELS + 1.0,
        ),
    ];
    for (how, levels, most) in figures {
        if let Some(levels) = levels
            && !(levels <= most)
        {
            faults.push(format!("energy error of {levels:.3} round-off levels{how}"));
        }
    }
    if !measured.energy.is_finite() {
        faults.push("the energy error is not a number".to_owned());
    }
}

fn invariants(measured: &Measured, faults: &mut Vec<String>) {
    let most = 8.0 + 2.0 * (measured.parts as f64).sqrt();
    for kept in &measured.invariants {
        if !(kept.in_roundoff <= most) {
            faults.push(format!(
                "{} off by {:.1e}, {:.3} round-offs where {most:.3} are allowed",
                kept.name, kept.error, kept.in_roundoff
            ));
        }
    }
}

/// Whether steps were uncorrected and the energy is no worse for it than that of Gauss.
fn uncorrected(
    expect: &Expect,
    measured: &Measured,
    faults: &mut Vec<String>,
    notes: &mut Vec<String>,
) -> bool {
    if measured.uncorrected == 0 {
        return false;
    }
    let share = measured.uncorrected as f64 / measured.steps as f64;
    let (energy, gauss) = (measured.energy, measured.gauss_energy);
    let text = format!(
        "{} steps uncorrected ({:.2} %), energy off by {energy:.1e}, by {gauss:.1e} with Gauss",
        measured.uncorrected,
        100.0 * share
    );
    // Where Gauss came to an end before, or neither follows the motion, there is nothing to compare with.
    let is_open = matches!(expect.trajectory, Trajectory::Open(_));
    if is_open || energy <= UNCORRECTED * gauss || measured.gauss_ended.is_some() {
        notes.push(text);
        true
    } else {
        faults.push(text);
        false
    }
}

/// Whether the trajectory error is a known deficit.
fn trajectory(
    expect: &Expect,
    measured: &Measured,
    faults: &mut Vec<String>,
    notes: &mut Vec<String>,
) -> bool {
    let round_off = NOISE * measured.noise.unwrap_or(0.0);
    let mut is_known = false;
    let mut limit = |what: &str| {
        if let (Some(error), Some(gauss)) = (measured.error, measured.gauss_error)
            && !(error <= TRAJECTORY * gauss + round_off)
        {
            let ratio = measured.ratio().unwrap_or(0.0);
            let text = format!("{what} error {ratio:.3} times that of Gauss, {TRAJECTORY} allowed");
            match expect.deficit {
                Some(known) if ratio <= DEFICIT * known => {
                    is_known = true;
                    notes.push(format!("{text}; {known} is known"));
                }
                Some(known) => faults.push(format!("{text}; {known} is known")),
                None => faults.push(text),
            }
        }
    };
    match expect.trajectory {
        Trajectory::Resolved => limit("trajectory"),
        Trajectory::Slow => limit("slow variables'"),
        Trajectory::Within(most) => {
            if !measured.error.is_some_and(|error| error <= most) {
                let error = measured.error.unwrap_or(f64::NAN);
                faults.push(format!("trajectory error {error:.1e}, {most:.1e} allowed"));
            }
        }
        Trajectory::Open(why) => notes.push(why.to_owned()),
    }
    is_known
}

#[cfg(test)]
mod tests {
    use super::super::case::{End, Expect, Kind, Trajectory};
    use super::super::leg::{Ended, Kept};
    use super::super::measured::Measured;
    use super::{DEFICIT, LEVELS, TRAJECTORY, UNCORRECTED, Word, judge};

    const EXPECT: Expect = Expect {
        end: End::Complete,
        trajectory: Trajectory::Resolved,
        deficit: None,
    };

    fn good() -> Measured {
        Measured {
            steps: 100,
            outcomes: vec![("energy solved", 100)],
            levels: Some(1.0),
            independent_levels: Some(2.0),
            energy: 1e-16,
            gauss_energy: 1e-9,
            error: Some(1e-6),
            gauss_error: Some(2e-6),
            noise: Some(1e-15),
            ..Measured::default()
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
            |m| m.steps = 99,
            |m| m.outcomes = vec![("energy solved", 99)],
            |m| m.levels = Some(1.01 * LEVELS),
            |m| m.levels = Some(f64::NAN),
            |m| m.independent_levels = Some(1.01 * (LEVELS + 1.0)),
            |m| m.energy = f64::NAN,
            |m| (m.uncorrected, m.energy) = (1, 1.01 * UNCORRECTED * m.gauss_energy),
            |m| m.error = Some(1.01 * TRAJECTORY * 2e-6),
            |m| m.error = Some(f64::INFINITY),
            |m| m.impatient = true,
            |m| {
                m.invariants = vec![Kept {
                    name: "L".into(),
                    error: 1e-14,
                    in_roundoff: 29.0,
                }];
            },
            |m| {
                m.ended = Some(Ended {
                    kind: Kind::NotFinite,
                    text: "NaN".into(),
                    time: 1.0,
                });
            },
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
            measured.ended = Some(Ended {
                kind,
                text: String::new(),
                time,
            });
            assert_eq!(word(expect, &measured), word_expected);
        }
    }

    #[test]
    fn an_error_that_gauss_has_too_is_expected() {
        let ended = |kind| {
            Some(Ended {
                kind,
                text: String::new(),
                time: 1.0,
            })
        };
        let mut measured = good();
        measured.ended = ended(Kind::NoConvergence);
        assert_eq!(word(EXPECT, &measured), Word::Fail);
        measured.gauss_ended = ended(Kind::NotFinite);
        assert_eq!(word(EXPECT, &measured), Word::Fail);
        measured.gauss_ended = ended(Kind::NoConvergence);
        assert_eq!(word(EXPECT, &measured), Word::ExpectedError);
    }

    #[test]
    fn carried_steps_are_explained_as_long_as_the_energy_is_that_of_gauss() {
        let mut measured = good();
        measured.uncorrected = 10;
        for (part, expected) in [(0.99, Word::Explained), (1.01, Word::Fail)] {
            measured.energy = part * UNCORRECTED * measured.gauss_energy;
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
        measured.levels = Some(1.01 * LEVELS);
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
