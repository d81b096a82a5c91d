//! What a contestant is: a program and a method with one number that sets its accuracy.

use equip::prelude::DoubleDouble;

/// The number a contestant's accuracy is set by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Knob {
    /// Equal steps over the interval.
    Steps,
    /// A tolerance.
    Tolerance,
}

/// The settings to be tried, from coarse to fine: `first` · `factor`^k, k < `count`.
#[derive(Debug, Clone, Copy)]
pub struct Ladder {
    pub knob: Knob,
    pub first: f64,
    pub factor: f64,
    pub count: i32,
}

impl Ladder {
    /// Tolerances 10^−`from`, …, decade by decade, down to 10^−`to`.
    pub fn tolerances(from: i32, to: i32) -> Self {
        Ladder {
            knob: Knob::Tolerance,
            first: 10_f64.powi(-from),
            factor: 0.1,
            count: to - from + 1,
        }
    }

    /// Numbers of steps from `fewest`, each by 2/5 larger than the one before, up to `most`.
    pub fn steps(fewest: f64, most: f64) -> Self {
        let factor = 1.4_f64;
        Ladder {
            knob: Knob::Steps,
            first: fewest,
            factor,
            count: 1 + ((most / fewest).ln() / factor.ln()).ceil() as i32,
        }
    }

    /// All settings; numbers of steps are whole.
    pub fn settings(&self) -> Vec<f64> {
        (0..self.count)
            .map(|k| self.round(self.first * self.factor.powi(k)))
            .collect()
    }

    /// The setting between two.
    pub fn between(&self, a: f64, b: f64) -> f64 {
        self.round((a * b).sqrt())
    }

    fn round(&self, setting: f64) -> f64 {
        match self.knob {
            Knob::Steps => setting.round(),
            Knob::Tolerance => setting,
        }
    }
}

/// A timed run.
#[derive(Debug, Clone)]
pub struct Ran {
    /// CPU seconds of the propagation alone, median of the turn.
    pub seconds: f64,
    /// (q, p) at the end.
    pub end: Vec<DoubleDouble>,
    /// Steps made, where they are known.
    pub steps: Option<u64>,
}

/// A program with a method.
pub trait Contestant {
    /// The program: `equip`, `heyoka`, …
    fn program(&self) -> &str;
    /// Method and variant within the program.
    fn method(&self) -> String;
    /// The settings to be tried.
    fn ladder(&self) -> Ladder;
    /// One turn with a setting.
    ///
    /// # Errors
    /// What went wrong, in words; the setting then counts as not reaching anything.
    fn run(&mut self, setting: f64) -> Result<Ran, String>;
}
