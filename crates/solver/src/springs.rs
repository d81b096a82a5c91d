//! Stiff springs: where U(q) = ½ Σ κ_c q_c² + a remainder that bends much less, sweeps solve for the quadratic part exactly.
//!
//! With fixed gradients a sweep of H = T(p) + U(q) contracts by h² w ∇²U (KB)². Of that the part by κ is known before, for each component on its
//! own: [`crate::foresee`] puts into the gradient what it will have changed by when the sweep is made, and what is left is the contraction by the
//! remainder. The equations are the same, and so is what K makes of their solution.
//!
//! *Which.* At the start of the run κ_c = ∂²U/∂q_c², where it stands out of its row of ∇²U by [`OUTWEIGHS`] and h² w κ is at least 1/[`SOFT`].
//! Springs are those whose κ_c is still the same to 1/[`STEADY`] a step later.
//! *Whether.* They stay if sweeps contract twice as well with them as without, which the first step was made, and as long as sweeps go on
//! to contract well with them. What has once been given up is not tried again.
//!
//! For fixed steps with α = 0 to begin with: the matrices hold for one h.

use crate::foresee::Matrix;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;
use equip_tableau::Gauss;

/// A spring is so many times as large as the rest of its row of ∇²U, in units of equal masses.
const OUTWEIGHS: i64 = 8;
/// Springs with h² w κ below 1 over this are none.
const SOFT: i64 = 4;
/// The same spring a step later, to 1 over this.
const STEADY: i64 = 16;
/// Springs this alike, 1 over it, have one matrix.
const ALIKE: i64 = 128;
/// Matrices at most.
const MOST: usize = 8;
/// Contraction without springs of a step whose sweeps did not contract.
const NONE: [i64; 2] = [7, 10];

/// How a component is bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spring<T> {
    /// The component, κ, and 1 over its mass.
    pub(crate) c: usize,
    pub(crate) kappa: T,
    pub(crate) w: T,
    /// Which matrix.
    pub(crate) matrix: usize,
}

/// How far it is known that they pay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trial {
    /// No step has been made.
    Before,
    /// A step without them has been made.
    Pending,
    /// They are made use of.
    On,
    /// They are not.
    Off,
}

#[derive(Debug)]
pub(crate) struct Springs<T: Float> {
    h: T,
    pub(crate) springs: Vec<Spring<T>>,
    pub(crate) matrices: Vec<Matrix<T>>,
    pub(crate) trial: Trial,
    /// How sweeps contracted without them.
    pub(crate) without: T,
    /// Steps made with them, and those that failed.
    pub(crate) steps: u64,
    pub(crate) failed: u64,
    /// Room for ∇²H, and its pattern; 1 over the masses.
    entries: Vec<T>,
    pattern: Pattern,
    w: Vec<T>,
    /// Whether this step is made with them.
    pub(crate) is_active: bool,
}

impl<T: Float> Springs<T> {
    /// Those of steps of size `h` from `y`; `None` if there are none.
    pub(crate) fn find<E: Evaluate<T>>(
        gauss: &Gauss<T>,
        energy: &mut E,
        (pattern, w): (&Pattern, &[T]),
        (y, h): (&[T], T),
    ) -> Option<Self> {
        let mut entries = vec![T::int(0); pattern.len()];
        energy.hessian(y, &mut entries);
        let found = (0..w.len()).filter_map(|c| {
            let kappa = standing_out(pattern, w, &entries, c)?;
            (T::int(SOFT) * (h * h * w[c] * kappa) >= T::int(1)).then_some((c, kappa))
        });
        Self::new(gauss, (pattern, w, h), found)
    }

    /// With these κ, the rest empty.
    pub(crate) fn new(
        gauss: &Gauss<T>,
        (pattern, w, h): (&Pattern, &[T], T),
        found: impl Iterator<Item = (usize, T)>,
    ) -> Option<Self> {
        let (mut springs, mut matrices) = (Vec::new(), Vec::<Matrix<T>>::new());
        for (c, kappa) in found {
            let stiffness = h * h * w[c] * kappa;
            let alike = |m: &Matrix<T>| {
                T::int(ALIKE) * (m.stiffness - stiffness).abs() <= m.stiffness
            };
            let matrix = match matrices.iter().position(alike) {
                Some(matrix) => matrix,
                None if matrices.len() < MOST => {
                    matrices.push(Matrix::new(gauss, h, stiffness)?);
                    matrices.len() - 1
                }
                None => continue,
            };
            let kappa = matrices[matrix].stiffness / (h * h * w[c]);
            springs.push(Spring {
                c,
                kappa,
                w: w[c],
                matrix,
            });
        }
        (!springs.is_empty()).then(|| Springs {
            h,
            springs,
            matrices,
            trial: Trial::Before,
            without: T::ratio(NONE[0], NONE[1]),
            steps: 0,
            failed: 0,
            entries: vec![T::int(0); pattern.len()],
            pattern: pattern.clone(),
            w: w.to_vec(),
            is_active: false,
        })
    }

    /// A step of size `h` begins at `y`.
    pub(crate) fn begin<E: Evaluate<T>>(&mut self, energy: &mut E, (y, h): (&[T], T)) {
        if self.trial == Trial::Pending {
            energy.hessian(y, &mut self.entries);
            let (pattern, w, entries) = (&self.pattern, &self.w, &self.entries);
            self.springs.retain(|&Spring { c, kappa, .. }| {
                standing_out(pattern, w, entries, c)
                    .is_some_and(|now| T::int(STEADY) * (now - kappa).abs() <= kappa)
            });
            let any = !self.springs.is_empty();
            self.trial = if any { Trial::On } else { Trial::Off };
        }
        self.is_active = self.trial == Trial::On && h == self.h;
    }

    /// Sweeps have not contracted. Returns whether they are worth another try at once, with springs.
    pub(crate) fn has_failed(&mut self) -> bool {
        let first = self.trial == Trial::Before;
        if first {
            self.trial = Trial::On;
            self.is_active = true;
        } else if self.is_active {
            self.failed += 1;
            self.judge(self.failed * 4 > self.steps + 4);
        }
        first
    }

    /// A step has been made, in which the worst contraction was `seen`.
    pub(crate) fn has_made(&mut self, seen: T) {
        if self.trial == Trial::Before {
            (self.trial, self.without) = (Trial::Pending, seen);
        } else if self.is_active {
            self.steps += 1;
            self.judge(self.steps == 1 && T::int(2) * seen > self.without);
        }
    }

    fn judge(&mut self, is_bad: bool) {
        if is_bad {
            (self.trial, self.is_active) = (Trial::Off, false);
        }
    }
}

/// κ_c, if it is positive and outweighs the rest of its row.
fn standing_out<T: Float>(pattern: &Pattern, w: &[T], entries: &[T], c: usize) -> Option<T> {
    let (mut kappa, mut rest) = (T::int(0), T::int(0));
    for (place, j) in pattern.row(c) {
        if j == c {
            kappa = entries[place];
        } else if j < w.len() {
            rest += entries[place].abs() * (w[j] / w[c]).sqrt();
        }
    }
    (kappa > T::int(0) && kappa >= T::int(OUTWEIGHS) * rest).then_some(kappa)
}
