//! Whether a step follows the motion, judged by its change of energy (docs/adr/0020).
//!
//! If a step is too long, its stage equations have solutions that do not approximate the motion: near a
//! singularity, one body emerges behind another. Every preconditioner may find them, those that contract from
//! far away more often. The change of H is compared with the energy exchanged between positions and momenta,
//!
//! $$ W = \sum_i h b_i \sum_c |\dot q_c\, \dot p_c| \quad \text{at the stages } Y_i . $$
//!
//! If the Legendre coefficients of the derivative of the motion decay by a factor of 1/2 each, H changes by
//! about 4⁻ˢ W in a step of s stages. A step is halved if H changes by more than 2⁻ˢ⁻¹ W. If it cannot be
//! halved further, it is accepted for a change of up to W, since the force may be discontinuous in the step.

use crate::outcome::failure::Failure;
use crate::policy::STALLED;
use crate::step::core::Core;
use equip_iterate::State;
use equip_scalar::Float;

impl<T: Float> Core<T> {
    /// Checks the step of size `h` from `y` to `next` of a method that does not solve for H.
    pub(crate) fn check_energy(
        &mut self,
        (y, h): (&State<T>, T),
        next: &State<T>,
    ) -> Result<(), Failure<T>> {
        if !self.options.check_energy || !self.constraints.is_empty() {
            return Ok(());
        }
        let (start, end) = (self.energy_at(&y.hi), self.energy_at(&next.hi));
        self.start.copy_from_slice(&next.hi);
        self.start_energy = end;
        let change = end - start;
        let checked = self.check_change(change, h);
        if checked.is_ok() {
            return checked;
        }
        let (energy, gradient) = (&mut self.energy, &mut self.gradient);
        let mut bound = |y: &State<T>| energy.gradient_with_bound(&y.hi, gradient).1;
        let round_off = T::EPSILON * (bound(y) + bound(next));
        self.counts.gradients += 2;
        if change.abs() <= T::int(STALLED) * round_off {
            return Ok(());
        }
        self.start.fill(T::NAN);
        checked
    }

    /// Checks the step of size `h` with α = 0, whose constraints have been evaluated.
    pub(crate) fn check_residual(&self, h: T) -> Result<(), Failure<T>> {
        let Some(energy) = self.energy_constraint() else {
            return Ok(());
        };
        let change = energy.residual - energy.start_error;
        if !self.options.check_energy || change.abs() <= T::int(STALLED) * energy.round_off() {
            return Ok(());
        }
        self.check_change(change, h)
    }

    fn check_change(&self, change: T, h: T) -> Result<(), Failure<T>> {
        let exchanged = self.exchanged(h);
        // Below, the products of the exchange underflow.
        if change.abs() < T::MIN_POSITIVE {
            return Ok(());
        }
        let share = match self.may_be_halved {
            true => T::int(2 << self.stages.method.degree()),
            false => T::int(1),
        };
        if share * change.abs() > exchanged {
            return Err(Failure::Astray { change, exchanged });
        }
        Ok(())
    }

    /// W of the stages of a step of size `h`.
    fn exchanged(&self, h: T) -> T {
        let (l, stride) = (
            self.stages.iterate.increments(),
            self.stages.iterate.stride(),
        );
        let (of_q, of_p) = l.split_at(l.len() / 2);
        let mut sums = [T::int(0); equip_iterate::MAX_STAGES];
        for (q, p) in of_q.chunks_exact(stride).zip(of_p.chunks_exact(stride)) {
            for (sum, (&q, &p)) in sums.iter_mut().zip(q.iter().zip(p)) {
                *sum += (q * p).abs();
            }
        }
        let stages = sums.iter().zip(self.stages.method.weights());
        stages.fold(T::int(0), |sum, (&x, &b)| sum + x / (h * b).abs())
    }
}
