//! Stiff springs: where U(q) = ½ Σ κ_c q_c² + a remainder that bends much less, sweeps solve for the quadratic part exactly.
//!
//! With fixed gradients a sweep of H = T(p) + U(q) contracts by h² w ∇²U (KB)². Of that the part by κ is known before, for each component on its
//! own: [`crate::foresee`] puts into the gradient what it will have changed by when the sweep is made, and what is left is the contraction by the
//! remainder. The equations are the same, and so is what K makes of their solution.
//!
//! *Which.* At the start of the run κ_c = ∂²U/∂q_c², where it stands out of its row of ∇²U by [`which::OUTWEIGHS`] and h² w κ is at least 1/[`which::SOFT`].
//! Springs are those whose κ_c is still the same to 1/[`STEADY`] a step later, and every [`CHECKED`] steps.
//! *Whether.* The first step is made without them, or with them if its sweeps do not contract. They stay as long as in most steps sweeps contract
//! twice as well with them as in the first step without. What has once been given up is not tried again.
//!
//! For fixed steps with α = 0 to begin with: the matrices hold for one h.

mod which;

pub(crate) use which::most_resolved;

use crate::checkpoint::{Exact, SpringsMemory};
use crate::columns::both_ways;
use crate::error::IntegrateError;
use crate::foresee::{Foresee, ForeseeSides, From, Matrix};
use crate::outcome::Counts;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::{Float, InstructionSet};
use equip_tableau::Gauss;
use which::standing_out;

/// The same spring later on, to 1 over this.
const STEADY: i64 = 16;
/// Steps after which that is looked at again: a spring that turns leaves its axis.
const CHECKED: u64 = 16;
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// h² w κ for each matrix.
    stiffnesses: Vec<T>,
    /// The matrices, and −Kᵀ, column by column; empty until they are made use of.
    matrices: Vec<Matrix<T>>,
    back: Vec<T>,
    trial: Trial,
    /// How sweeps contracted without them.
    without: T,
    /// Steps made with them, those that contracted no better or not at all, and those that the last step foretold badly.
    steps: u64,
    poor: u64,
    misled: u64,
    /// The κ_c they were made from.
    found: Vec<(usize, T)>,
    /// Room for ∇²H, and its pattern; 1 over the masses.
    entries: Vec<T>,
    pattern: Pattern,
    w: Vec<T>,
    /// Whether this step is made with them.
    pub(crate) is_active: bool,
}

impl<T: Float> Springs<T> {
    /// With these κ, the rest empty.
    fn new((pattern, w, h): (&Pattern, &[T], T), found: Vec<(usize, T)>) -> Option<Self> {
        let (mut springs, mut stiffnesses) = (Vec::new(), Vec::<T>::new());
        for &(c, kappa) in &found {
            let stiffness = h * h * w[c] * kappa;
            let alike = |of: &T| T::int(ALIKE) * (*of - stiffness).abs() <= *of;
            let matrix = match stiffnesses.iter().position(alike) {
                Some(matrix) => matrix,
                None if stiffnesses.len() < MOST => {
                    stiffnesses.push(stiffness);
                    stiffnesses.len() - 1
                }
                None => continue,
            };
            let kappa = stiffnesses[matrix] / (h * h * w[c]);
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
            stiffnesses,
            matrices: Vec::new(),
            back: Vec::new(),
            trial: Trial::Before,
            without: T::ratio(NONE[0], NONE[1]),
            steps: 0,
            poor: 0,
            misled: 0,
            found,
            entries: vec![T::int(0); pattern.len()],
            pattern: pattern.clone(),
            w: w.to_vec(),
            is_active: false,
        })
    }

    /// Makes the matrices, once, if this step is made with the springs; without them it is if that cannot be.
    fn make(&mut self, gauss: &Gauss<T>) {
        if !self.is_active || !self.matrices.is_empty() {
            return;
        }
        let stiffnesses = self.stiffnesses.iter();
        let made = stiffnesses.map(|&stiffness| Matrix::new(gauss, self.h, stiffness));
        match made.collect() {
            Some(matrices) => {
                self.matrices = matrices;
                [_, self.back] = both_ways(gauss);
            }
            None => (self.trial, self.is_active) = (Trial::Off, false),
        }
    }

    /// A step of size `h` begins at `y`.
    pub(crate) fn begin<E: Evaluate<T>>(
        &mut self,
        gauss: &Gauss<T>,
        energy: &mut E,
        (y, h): (&[T], T),
        counts: &mut Counts,
    ) {
        let is_due = self.trial == Trial::On && self.steps.is_multiple_of(CHECKED);
        if self.trial == Trial::Pending || is_due {
            energy.hessian(y, &mut self.entries);
            counts.hessians += 1;
            let (pattern, w, entries) = (&self.pattern, &self.w, &self.entries);
            self.springs.retain(|&Spring { c, kappa, .. }| {
                standing_out(pattern, w, entries, c)
                    .is_some_and(|now| T::int(STEADY) * (now - kappa).abs() <= kappa)
            });
            let any = !self.springs.is_empty();
            self.trial = if any { Trial::On } else { Trial::Off };
        }
        self.is_active = self.trial == Trial::On && h == self.h;
        self.make(gauss);
    }

    /// Sweeps have not contracted. Returns whether they are worth another try at once, with springs.
    pub(crate) fn has_failed(&mut self, gauss: &Gauss<T>) -> bool {
        let first = self.trial == Trial::Before;
        if first {
            self.trial = Trial::On;
            self.is_active = true;
            self.make(gauss);
        } else if self.is_active {
            self.poor += 1;
            self.judge();
        }
        first
    }

    /// A step has been made; the worst contraction was `seen`, if the α's have had no part in it.
    pub(crate) fn has_made(&mut self, seen: Option<T>) {
        if self.trial == Trial::Before {
            self.trial = Trial::Pending;
            self.without = seen.unwrap_or(self.without);
        } else if self.is_active {
            self.steps += 1;
            let is_poor = seen.is_some_and(|seen| T::int(2) * seen > self.without);
            self.poor += u64::from(is_poor);
            self.judge();
        }
    }

    fn judge(&mut self) {
        if 4 * self.poor > self.steps + 8 {
            (self.trial, self.is_active) = (Trial::Off, false);
        }
    }

    /// Sweeps have not contracted from where the last step led to.
    pub(crate) fn was_misled(&mut self) {
        self.misled += u64::from(self.is_active);
    }

    /// Whether the last step as a whole is to foretell this one, or what is slow in it.
    pub(crate) fn foretells(&self) -> bool {
        !self.is_active || 64 * self.misled <= self.steps + 64
    }

    /// Adds to the gradients of stages with these h b_i what they are about to change by.
    pub(crate) fn foresee(
        &self,
        set: InstructionSet,
        from: From<'_, T>,
        (hb, gradients): (&[T], &mut [T]),
        s: usize,
    ) {
        if const { !T::IS_DOUBLE } {
            return;
        }
        set.run(&mut Foresee {
            springs: &self.springs,
            matrices: &self.matrices,
            back: &self.back,
            from,
            hb,
            gradients,
            m: self.w.len(),
            s,
        });
    }

    /// The same for δL of several sides of linearised equations, `made` being what their X was made with.
    pub(crate) fn foresee_sides(
        &self,
        set: InstructionSet,
        (made, rows): (&mut [T], &mut [T]),
        hb: &[T],
        (sides, s): (usize, usize),
        reversed: bool,
    ) {
        if const { !T::IS_DOUBLE } {
            return;
        }
        set.run(&mut ForeseeSides {
            springs: &self.springs,
            matrices: &self.matrices,
            hb,
            made,
            rows,
            sides,
            s,
            reversed,
        });
    }

    /// The same springs for another number of stages.
    pub(crate) fn for_other_stages(&self) -> Option<Self> {
        Self::new((&self.pattern, &self.w, self.h), self.found.clone())
    }

    /// Made use of in this step, those of `others` that are left.
    pub(crate) fn activate_as(&mut self, gauss: &Gauss<T>, others: &Self) {
        self.is_active = others.is_active;
        self.make(gauss);
        if self.springs.len() != others.springs.len() {
            let mut left = others.springs.iter().peekable();
            self.springs
                .retain(|spring| left.next_if(|other| other.c == spring.c).is_some());
        }
    }

    pub(crate) fn memory(&self) -> SpringsMemory {
        SpringsMemory {
            components: self.found.iter().map(|&(c, _)| c).collect(),
            kappa: self
                .found
                .iter()
                .map(|&(_, kappa)| Exact::of(kappa))
                .collect(),
            kept: self.springs.iter().map(|spring| spring.c).collect(),
            trial: self.trial,
            without: Exact::of(self.without),
            counts: [self.steps, self.poor, self.misled],
        }
    }

    /// Those of a run that is resumed with steps of size `h`.
    pub(crate) fn from_memory(
        (pattern, w, h): (&Pattern, &[T], T),
        memory: &SpringsMemory,
    ) -> Result<Option<Self>, IntegrateError<T>> {
        let SpringsMemory {
            components, kappa, ..
        } = memory;
        let what = "the springs";
        if components.len() != kappa.len() || components.iter().any(|&c| c >= w.len()) {
            return Err(IntegrateError::CheckpointDamaged { what });
        }
        let mut values = vec![T::int(0); kappa.len()];
        Exact::read_all(kappa, &mut values, what)?;
        let found = components.iter().copied().zip(values).collect();
        let mut springs = Self::new((pattern, w, h), found);
        if let Some(springs) = &mut springs {
            springs.springs.retain(|s| memory.kept.contains(&s.c));
            springs.trial = memory.trial;
            springs.without = memory.without.read()?;
            [springs.steps, springs.poor, springs.misled] = memory.counts;
        }
        Ok(springs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_autodiff::{Hamiltonian, System};

    fn found(h: &Hamiltonian, y: &[f64], step: f64, wants_alphas: bool) -> Option<Springs<f64>> {
        let gauss = Gauss::new(8).unwrap();
        let w = vec![1.0; y.len() / 2];
        let pattern = (&*h.structure().hessian, &*w, wants_alphas);
        Springs::find(&gauss, &mut h.evaluator::<f64>(), pattern, (y, step)).0
    }

    #[test]
    fn only_what_is_stiff_and_outweighs_its_row_is_a_spring() {
        let h = Hamiltonian::new(4, |q, p| {
            let soft = 0.25 * (q[0] - q[2]).powi(4) + 0.5 * (q[3] - q[0]).powi(2);
            0.5 * p.iter().map(|&p| p * p).sum::<equip_autodiff::Var>()
                + 1250.0 * (q[1] * q[1] + 1.001 * q[2] * q[2])
                + soft
        });
        let h = h.unwrap();
        let y = [1.0, 0.0, 0.02, 0.5, 1.0, 0.0, 1.0, 0.0];
        let mut springs = found(&h, &y, 0.1, false).unwrap();
        let components: Vec<_> = springs.springs.iter().map(|s| s.c).collect();
        assert_eq!((components, springs.stiffnesses.len()), (vec![1, 2], 1));
        assert!(springs.matrices.is_empty(), "nothing has asked for them");
        assert!(found(&h, &y, 0.005, false).is_none());
        // ω = 50, 8 stages.
        assert!(found(&h, &y, 0.06, true).is_some() && found(&h, &y, 0.07, true).is_none());
        // The first step without, the next with them, while they are of use.
        let (gauss, mut energy) = (Gauss::new(8).unwrap(), h.evaluator::<f64>());
        let mut step = |springs: &mut Springs<f64>, seen, size| {
            springs.begin(&gauss, &mut energy, (&y, size), &mut Counts::default());
            let active = springs.is_active;
            assert!(!active || springs.matrices.len() == 1);
            springs.has_made(Some(seen));
            active
        };
        assert!(!step(&mut springs, 0.2, 0.1) && step(&mut springs, 0.01, 0.1));
        assert!(!step(&mut springs, 0.01, 0.05) && step(&mut springs, 0.01, 0.1));
        while step(&mut springs, 0.15, 0.1) {}
        assert_eq!((springs.steps, springs.poor), (6, 4));
    }

    /// Kepler's problem at the pericentre on the first axis: ∂²U/∂q₂² = 1/r³ stands alone in its row, but not for long.
    #[test]
    fn orbits_have_none() {
        let h = Hamiltonian::new(2, |q, p| {
            0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
        });
        let h = h.unwrap();
        let mut springs = found(&h, &[0.4, 0.0, 0.0, 2.0], 0.25, false).unwrap();
        springs.has_made(Some(0.3));
        springs.begin(
            &Gauss::new(8).unwrap(),
            &mut h.evaluator(),
            (&[0.25, 0.42, -1.1, 1.2], 0.25),
            &mut Counts::default(),
        );
        assert!(!springs.is_active && springs.trial == Trial::Off);
        assert!(springs.matrices.is_empty());
    }
}
