//! [`Measured`]: the measurements along a run, for its certificate.

use crate::control::frequency::Frequency;
use crate::control::policy::{SLOW, STALE_LEVELS};
use crate::options::common::Options;
use crate::report::conserved::{Conserved, Watched};
use crate::report::energy_round_off::{EnergyRoundOff, kinetic_energy};
use crate::report::entries::{EnergyJumps, PhasePerStep, VariableSteps};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Core, Outcome};

/// Energy, invariants, α_k and step sizes over a run.
#[derive(Debug)]
pub(crate) struct Measured<T: Float> {
    /// Whether the steps solve for the energy.
    is_solved: bool,
    /// Whether the energy is evaluated after steps that do not solve for it.
    is_evaluated: bool,
    pub(crate) energy: Option<Conserved<T>>,
    /// The largest energy error in round-off levels, for steps that solve for the energy.
    pub(crate) in_levels: Option<T>,
    pub(crate) energy_round_off: Option<EnergyRoundOff<T>>,
    /// The round-off level of H at the last step.
    pub(crate) round_off: Option<T>,
    /// The invariants; those that are constraints come first.
    pub(crate) watched: Vec<Watched<T>>,
    pub(crate) alpha_range: Vec<(T, T)>,
    pub(crate) phase_per_step: Option<PhasePerStep<T>>,
    frequency: Frequency<T>,
    /// Whether tangent vectors are propagated along the run.
    pub(crate) has_tangent: bool,
    /// The number of crossings of discontinuities at which a step, or a part of a step, ended.
    pub(crate) discontinuities_crossed: u64,
    /// How often the state was changed, and the time of the last change, or of the start.
    pub(crate) state_changes: (u64, T),
    pub(crate) energy_jumps: Option<EnergyJumps<T>>,
    /// The statistics of variable steps.
    pub(crate) variable: Option<VariableSteps<T>>,
}

/// The last step.
pub(crate) struct LastStep<'a, T> {
    /// The state at its end, of which the first `m` positions and momenta are the user's.
    pub(crate) y: &'a [T],
    pub(crate) m: usize,
    /// The time at its end, its size, and the time since the start of the run.
    pub(crate) time: T,
    pub(crate) h: T,
    pub(crate) elapsed: T,
    pub(crate) outcome: Outcome,
    /// The reference of the energy.
    pub(crate) h_ref: T,
}

impl<T: Float> Measured<T> {
    /// For a run of `system` with `alphas` parameters α_k. The steps solve for the energy if `is_solved`.
    pub(crate) fn new(
        system: &Hamiltonian,
        options: &Options<T>,
        (is_solved, alphas): (bool, usize),
    ) -> Self {
        let zero = T::int(0);
        let is_evaluated = options.measure_energy;
        let invariants = options.kept.iter().chain(&options.invariants);
        Measured {
            is_solved,
            is_evaluated,
            energy: (is_solved || is_evaluated).then(|| Conserved::new("energy")),
            in_levels: is_solved.then_some(zero),
            energy_round_off: None,
            round_off: None,
            watched: invariants.map(Watched::new).collect(),
            alpha_range: vec![(zero, zero); alphas],
            phase_per_step: None,
            frequency: Frequency::new(system),
            has_tangent: false,
            discontinuities_crossed: 0,
            state_changes: (0, zero),
            energy_jumps: None,
            variable: None,
        }
    }

    /// Begins a new run from `y` at `t0`, where H is `h_ref` and its gradient is `gradient`.
    pub(crate) fn restart(&mut self, t0: T, h_ref: T, (y, gradient): (&[T], &[T])) {
        let zero = T::int(0);
        (self.discontinuities_crossed, self.energy_jumps) = (0, None);
        self.state_changes = (0, t0);
        self.alpha_range.fill((zero, zero));
        self.in_levels = self.is_solved.then_some(zero);
        let is_measured = self.is_solved || self.is_evaluated;
        self.energy_round_off = is_measured.then(|| EnergyRoundOff::new(t0, h_ref, (y, gradient)));
        self.phase_per_step = None;
        let watched = self.watched.iter_mut().map(|w| &mut w.conserved);
        for conserved in self.energy.iter_mut().chain(watched) {
            conserved.max = zero;
        }
    }

    /// Sets the references of energy and invariants to their values at `y` and `t`, where H is `h_ref`.
    pub(crate) fn refer_to(&mut self, t: T, h_ref: T, y: &[T]) {
        self.round_off = None;
        self.state_changes = (self.state_changes.0 + 1, t);
        if let Some(seen) = &mut self.energy_round_off {
            seen.scale = seen.scale.max(h_ref.abs());
        }
        if let Some(energy) = &mut self.energy {
            energy.begin(h_ref);
        }
        for watched in &mut self.watched {
            watched.begin(t, y);
        }
    }

    /// Records energy, invariants and α_k of the last step. `gradient` is workspace for ∇H.
    pub(crate) fn see(&mut self, core: &mut Core<T>, last: &LastStep<'_, T>, gradient: &mut [T]) {
        self.round_off = None;
        // Every range contains zero from the start.
        if !core.alphas_are_zero() {
            for (range, &alpha) in self.alpha_range.iter_mut().zip(core.alphas()) {
                *range = (range.0.min(alpha), range.1.max(alpha));
            }
        }
        let LastStep { y, m, h_ref, .. } = *last;
        let now = (last.time, last.h.abs() / last.elapsed);
        let seen = (self.energy_round_off.as_mut()).filter(|_| last.outcome.energy_conserved());
        if self.is_solved {
            let constraint = &core.constraints()[0];
            self.round_off = Some(constraint.round_off());
            if let Some(energy) = &mut self.energy {
                energy.see(constraint.residual());
            }
            if let Some(most) = &mut self.in_levels {
                *most = most.max(constraint.in_late_levels());
            }
            if let Some(seen) = seen {
                let gradient = constraint.gradient();
                seen.see(now, (constraint.round_off(), h_ref), || {
                    kinetic_energy(y, gradient, m)
                });
                seen.last = constraint.momentary_round_off();
            }
        } else if self.is_evaluated {
            let error = core.energy_at(y) - h_ref;
            if let Some(energy) = &mut self.energy {
                energy.see(error);
            }
            if let Some(seen) = seen {
                seen.see(now, (error.abs(), h_ref), || {
                    let (energy, counts) = core.energy_and_counts();
                    counts.gradients += 1;
                    energy.gradient(y, gradient);
                    kinetic_energy(y, gradient, m)
                });
                // The error is no bound of rounding.
                seen.last = T::int(0);
                if !(error.abs() <= h_ref.abs() * T::EPSILON.sqrt()) {
                    let (energy, counts) = core.energy_and_counts();
                    counts.gradients += 1;
                    seen.last = T::EPSILON * energy.gradient_with_bound(y, gradient).1;
                }
            }
        }
        for watched in &mut self.watched {
            watched.see(last.time, y);
        }
    }

    /// Records the energy error of a state on the polynomial of the last step. Returns whether it exceeds the
    /// round-off level of this step.
    pub(crate) fn see_on_polynomial(&mut self, error: T) -> bool {
        if let Some(energy) = &mut self.energy {
            energy.see(error);
        }
        (self.round_off).is_some_and(|level| !(error.abs() <= T::int(STALE_LEVELS) * level))
    }

    /// Records hω of the last step, of size `h`, which ended at `y`. Skipped if its iteration was not
    /// preconditioned and converged as fast as for small hω, unless tangent vectors are propagated: these
    /// contain motions that the orbit does not.
    pub(crate) fn see_phase(&mut self, core: &mut Core<T>, y: &[T], h: T) {
        let is_slow = core.contraction().is_some_and(|rate| rate > SLOW);
        if !is_slow && !core.is_preconditioned() && !self.has_tangent {
            return;
        }
        let step = h.abs();
        let angle = self.frequency.at(core.energy_mut(), y) * step.to_f64();
        let phase = PhasePerStep { angle, step };
        self.phase_per_step = Some(phase.max(self.phase_per_step));
    }

    /// Records that a step, or a part of a step, ended on `count` discontinuities, where H jumps by `jump`.
    pub(crate) fn cross(&mut self, count: u64, jump: Option<T>) {
        self.discontinuities_crossed += count;
        if let Some(jump) = jump {
            self.energy_jumps = Some(EnergyJumps::after(self.energy_jumps, jump));
        }
    }
}
