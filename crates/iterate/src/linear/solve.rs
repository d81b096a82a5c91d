//! The interface of the linearised equations to the solver.

use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::{Held, Preconditioner};
use crate::linear::compiled::ready;
use crate::linear::linear_iteration::{LinearIteration, Sides};
use equip_autodiff::{Evaluator, Pattern};
use equip_scalar::Float;
use equip_tableau::Coefficients;

impl<T: Float> LinearIteration<T> {
    /// With K of the initial α_k, for at most `sides` right-hand sides.
    pub fn new(
        method: &Coefficients<T>,
        iterate: &Iterate<T>,
        pattern: Pattern,
        sides: usize,
    ) -> Self {
        (ready::<T>().linear)(method, iterate, pattern, sides)
    }

    /// Evaluates ∇²H at the s converged stages of `iterate`, which must include those of the momenta. Returns
    /// whether ∇²H is finite.
    pub fn linearise(&mut self, iterate: &Iterate<T>, energy: &mut Evaluator<T>) -> bool {
        self.hessians.evaluate(iterate, energy);
        (ready::<T>().weigh)(self, iterate)
    }

    /// Whether the fastest motion of the linearised equations satisfies hω ≤ `most`.
    pub fn is_within(&mut self, most: f64) -> bool {
        (ready::<T>().is_within)(self, most)
    }

    /// Solves for all sides until the estimated error of Σ δL, with each component weighted by `weights`, is
    /// less than `tolerance`. The estimate follows from the contraction of the changes. Returns whether the
    /// iteration has converged.
    pub fn solve(
        &mut self,
        held: Held,
        (r, x): (&[T], &mut [T]),
        (weights, tolerance): (&[T], T),
        iterate: &Iterate<T>,
        m: Option<&mut (dyn Preconditioner<T> + '_)>,
    ) -> bool {
        let sides = Sides {
            r,
            x,
            weights,
            tolerance,
        };
        (ready::<T>().solve)(self, held, sides, iterate, m)
    }
}
