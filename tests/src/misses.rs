//! Bounds that are all tried before a test fails.

use crate::side_by_side::Made;
use crate::{Reference, apart, sizes};

/// The bounds that did not hold so far.
#[derive(Debug, Default)]
pub struct Misses(Vec<String>);

/// How far EQUIP may be behind Gauss.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Error over Gauss's.
    pub error: f64,
    /// Work over Gauss's, in gradients with a Hessian as n of them.
    pub work: f64,
    /// Errors below this, relative to the size of the motion, are round-off.
    pub round_off: f64,
}

impl Limits {
    /// Error three times, work four times that of Gauss.
    pub const ORDINARY: Limits = Limits {
        error: 3.0,
        work: 4.0,
        round_off: 1e-12,
    };
}

/// Two runs, EQUIP's and Gauss's, each with the text of its error if it ended in one.
pub type Pair = [Result<Made<f64>, String>; 2];

impl Misses {
    /// Wants `found` to be `most` at most.
    pub fn most(&mut self, what: &str, found: f64, most: f64) {
        let line = format!("{what}: {found:.3e}, at most {most:.3e}");
        println!("{line}");
        if !(found <= most) {
            self.0.push(line);
        }
    }

    /// Wants EQUIP and Gauss to end well, and EQUIP as near to the reference's last state and with as much
    /// work as the limits allow. Returns the error over Gauss's.
    pub fn beside_gauss(
        &mut self,
        what: &str,
        pair: &Pair,
        (start, reference): (&[f64], &Reference),
        limits: Limits,
    ) -> f64 {
        let whole: Vec<usize> = (0..start.len()).collect();
        self.beside_gauss_in(what, pair, (start, reference), &whole, limits)
    }

    /// The same, of the error in some components only.
    pub fn beside_gauss_in(
        &mut self,
        what: &str,
        pair: &Pair,
        (start, reference): (&[f64], &Reference),
        components: &[usize],
        limits: Limits,
    ) -> f64 {
        let (equip, gauss) = match pair {
            [Ok(equip), Ok(gauss)] => (equip, gauss),
            [equip, gauss] => {
                let failed = [("EQUIP", equip), ("Gauss", gauss)];
                for (who, error) in failed.map(|(who, run)| (who, run.as_ref().err())) {
                    if let Some(error) = error {
                        println!("{what}, {who}: {error}");
                        self.0.push(format!("{what}, {who}: {error}"));
                    }
                }
                return f64::NAN;
            }
        };
        let last = reference.states.len() - 1;
        let truth = &reference.states[last];
        let sizes = sizes(start, &reference.states);
        let error = |made: &Made<f64>| {
            let mut state = truth.clone();
            for &c in components {
                state[c] = made.state[c];
            }
            apart(&state, truth, sizes)
        };
        let (far, theirs) = (error(equip), error(gauss));
        let least = limits.round_off.max(reference.errors[last]);
        let ratio = far.max(least) / theirs.max(least);
        println!(
            "{what}: {far:.2e} beside {theirs:.2e}; {} of {} steps uncorrected",
            equip.uncorrected, equip.steps
        );
        self.most(&format!("{what}, error"), ratio, limits.error);
        let work = equip.work() / gauss.work();
        self.most(&format!("{what}, work"), work, limits.work);
        ratio
    }

    /// Fails with all that did not hold.
    ///
    /// # Panics
    /// If anything did not.
    pub fn end(self) {
        let missed = self.0.len();
        assert!(missed == 0, "{missed} missed:\n{}", self.0.join("\n"));
    }
}

/// The geometric mean.
pub fn geometric_mean(x: &[f64]) -> f64 {
    (x.iter().map(|x| x.ln()).sum::<f64>() / x.len() as f64).exp()
}
