//! What sweeps remember from step to step, and what they say of the one made last.

use super::Sweeps;
use crate::failure::{Damaged, Failure};
use crate::memory::SolverMemory;
use crate::sweep_task::Trouble;
use equip_scalar::Float;

impl<T: Float> Sweeps<T> {
    /// Forgets what was remembered of earlier steps.
    pub(crate) fn forget(&mut self) {
        self.contraction.set_rate(0.5);
        self.defect = T::int(0);
        (self.scale, self.spread) = (T::int(0), T::int(0));
        self.dear.far = T::int(0);
        self.slight.forget();
    }

    /// The trouble of the step solved last, for a run that has sweeps only, or that halves it.
    pub(crate) fn failure(&self, trouble: Trouble) -> Failure<T> {
        match trouble {
            Trouble::NoAlpha => Failure::NoAlpha,
            Trouble::Slow if !self.contraction.change.is_finite() => Failure::NotFinite,
            Trouble::Slow | Trouble::StagesOnly => Failure::NoConvergence {
                iterations: self.made,
                correction: T::exact(self.contraction.change),
            },
        }
    }

    /// Whether α's were asked for that mean that g does not react to them: no other solver finds any.
    pub(crate) fn are_alphas_out_of_reach(&self) -> bool {
        let most = T::int(1) / T::EPSILON.sqrt();
        !self.alphas.iter().all(|a| a.abs() <= most)
    }

    /// What is remembered from step to step.
    pub(crate) fn save(&self, memory: &mut SolverMemory<T>) {
        let (rate, reach) = (self.contraction.rate, self.slight.reach);
        let numbers = [
            T::exact(rate),
            self.defect,
            self.scale,
            self.spread,
            reach,
            self.dear.far,
        ];
        memory.put("sweeps", numbers);
    }

    pub(crate) fn restore(&mut self, memory: &SolverMemory<T>) -> Result<(), Damaged> {
        let [rate, defect, scale, spread, reach, far] = memory.numbers("sweeps")?;
        self.contraction.set_rate(rate.to_f64());
        (self.defect, self.scale, self.spread) = (defect, scale, spread);
        self.slight.reach = reach;
        self.dear.far = far;
        Ok(())
    }
}
