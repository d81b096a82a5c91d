//! The linearised equations as the solver calls them.

use crate::iterate::iterate::Iterate;
use crate::iterate::precondition::{Held, Preconditioner};
use crate::linear::compiled::ready;
use crate::linear::linear_iteration::{LinearIteration, Sides};
use equip_autodiff::{Evaluator, Pattern};
use equip_scalar::Float;
use equip_tableau::Coefficients;

impl<T: Float> LinearIteration<T> {
    /// With the K that a step starts from, for `sides` right-hand sides at most.
    pub fn new(
        method: &Coefficients<T>,
        iterate: &Iterate<T>,
        pattern: Pattern,
        sides: usize,
    ) -> Self {
        (ready::<T>().linear)(method, iterate, pattern, sides)
    }

    /// Takes ∇²H at the stages of an iterate that has converged, all of which are there: s Hessians. Returns
    /// whether it is finite.
    pub fn linearise(&mut self, iterate: &Iterate<T>, energy: &mut Evaluator<T>) -> bool {
        self.hessians.evaluate(iterate, energy);
        (ready::<T>().weigh)(self, iterate)
    }

    /// Whether the fastest motion of what was linearised turns by an angle hω of at most `most`.
    pub fn is_within(&mut self, most: f64) -> bool {
        (ready::<T>().is_within)(self, most)
    }

    /// Solves for all sides until the error of their sums of δL, each component weighed with `weights`, is
    /// less than `tolerance`, by how their changes shrink. Returns whether it is.
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
