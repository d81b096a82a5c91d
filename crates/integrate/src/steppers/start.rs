//! An [`Integration`] is prepared once, and may begin many runs.

use crate::control::failed::check_gradient;
use crate::error::IntegrateError;
use crate::options::common::{Options, coefficients};
use crate::options::event::Event;
use crate::options::integrator::{Integrator, StepSizes};
use crate::report::measured::Measured;
use crate::report::stopwatch::Stopwatch;
use crate::steppers::domains::WithinDomains;
use crate::steppers::in_parts::Substeps;
use crate::steppers::integration::Integration;
use crate::time::direction::TimeDirection;
use crate::time::visible::visible;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Constraint, Core, Counts, Invariant, Outcome, State};

impl<T: Float> Integration<T> {
    /// Prepares everything that does not depend on the initial state.
    pub(crate) fn prepare(
        integrator: &Integrator<T>,
        system: &Hamiltonian,
    ) -> Result<Self, IntegrateError<T>> {
        let options = &integrator.options;
        if system.is_canonical() && system.components() % 2 == 1 {
            let components = system.components();
            return Err(IntegrateError::NoBracket { components });
        }
        let method = integrator.method.for_degree(system.structure().degree);
        let coefficients = coefficients(method)?;
        let mut settings = options.validate(method)?;
        // `all` includes time, if H depends on time.
        let (all, zero) = (system.degrees_of_freedom(), T::int(0));
        let m = all - usize::from(system.has_time());
        let stages = settings.stages;
        check_functions(options, m, all)?;
        let has_target = settings.first_alpha.is_some() && !system.structure().is_quadratic();
        let mut constraints = Vec::new();
        if has_target {
            constraints.push(Constraint::energy(2 * all));
        }
        for kept in &options.kept {
            let alone = Invariant::new(kept.name(), kept.function().alone());
            // Every method of the family conserves quadratic invariants, and no α changes them.
            if !alone.is_quadratic() {
                constraints.push(Constraint::invariant(&alone, 2 * all));
            }
        }
        let free = settings.first_alpha.map_or(0, |first| stages - first);
        if constraints.len() > free {
            let (kept, alphas) = (constraints.len(), free);
            return Err(IntegrateError::TooFewAlphas { kept, alphas });
        }
        let alphas = if constraints.is_empty() {
            0
        } else {
            coefficients.alphas()
        };
        let measured = Measured::new(system, options, (has_target, alphas));
        let switches = system.switches();
        let size = match &integrator.sizes {
            StepSizes::Fixed(h) => Some(h.abs()),
            StepSizes::Tolerance(_) => None,
        };
        // The change of H has no bound across a jump, nor with a gradient that is not checked.
        let is_bounded = system.is_canonical() && switches.is_empty() && options.check_gradient;
        let is_measured = options.measure_energy && size.is_some();
        settings.check_energy = is_bounded && (has_target || is_measured);
        let in_parts = size.and_then(|_| Substeps::boxed(&switches, &coefficients, 2 * all));
        let domains = WithinDomains::new(&switches, stages, 2 * all);
        let mut evaluator = system.evaluator::<T>();
        evaluator.make_ready(2 * all);
        let gradient = vec![zero; 2 * all];
        let y = State::new(&gradient[..all], &gradient[all..]);
        Ok(Integration {
            core: Core::new(system, evaluator, settings, coefficients, constraints),
            m,
            method,
            t0: zero,
            direction: TimeDirection::Forward,
            size,
            h_ref: zero,
            domains,
            in_parts,
            index: 0,
            time: zero,
            next: y.clone(),
            gradient,
            measured,
            check_gradient: options.check_gradient,
            last: (zero, Outcome::NotRequested),
            begun: Stopwatch::start(),
            fingerprint: integrator.words(),
            start: vec![zero; 2 * m],
            y,
        })
    }

    /// Another integration with the same steps, at the same state.
    pub(crate) fn beside(
        &self,
        integrator: &Integrator<T>,
        system: &Hamiltonian,
    ) -> Result<Self, IntegrateError<T>> {
        let mut other = Self::prepare(integrator, system)?;
        other.start_at(visible(&self.y.hi, self.m), self.time, self.direction)?;
        Ok(other)
    }

    /// Begins a new run at (`q0`, `p0`) and `t0`, as after preparation. Nothing is allocated. After an error
    /// the run is unchanged.
    pub(crate) fn start_at(
        &mut self,
        (q0, p0): (&[T], &[T]),
        t0: T,
        direction: TimeDirection,
    ) -> Result<(), IntegrateError<T>> {
        self.move_to(q0, p0, t0)?;
        *self.core.counts_mut() = Counts::default();
        (self.t0, self.time, self.index) = (t0, t0, 0);
        self.direction = direction;
        self.start[..self.m].copy_from_slice(q0);
        self.start[self.m..].copy_from_slice(p0);
        self.last = (T::int(0), Outcome::NotRequested);
        let at = (&self.y.hi[..], &self.gradient[..]);
        self.measured.restart(t0, self.h_ref, at);
        self.begun = Stopwatch::start();
        Ok(())
    }

    /// The start of the present stretch: the start of the run, or the present time if the run has since
    /// reversed beyond its start.
    pub(crate) fn stretch_start(&self) -> T {
        let is_turned = self.direction.is_before(self.time, self.t0);
        if is_turned { self.time } else { self.t0 }
    }

    /// The initial state of the run, in the form that H takes.
    pub(crate) fn start_state(&self) -> Vec<T> {
        self.as_in_h(&self.start, self.t0)
    }

    /// (q, p) at time `t` in the form that H takes.
    pub(crate) fn as_in_h(&self, state: &[T], t: T) -> Vec<T> {
        let (mut y, half) = (vec![T::int(0); self.y.hi.len()], self.y.hi.len() / 2);
        let (q, p) = state.split_at(self.m);
        y[..self.m].copy_from_slice(q);
        y[self.m..half].fill(t);
        y[half..][..self.m].copy_from_slice(p);
        y
    }

    /// Moves the run to another state at time `t`. The references of energy and invariants are those of this
    /// state from now on, and the next step does not depend on earlier steps.
    pub(crate) fn move_to(&mut self, q: &[T], p: &[T], t: T) -> Result<(), IntegrateError<T>> {
        let h_ref = self.look_at(q, p, t)?;
        self.next.lo.fill(T::int(0));
        std::mem::swap(&mut self.y, &mut self.next);
        self.h_ref = h_ref;
        self.core.begin(h_ref, &self.y.hi);
        self.measured.refer_to(t, h_ref, &self.y.hi);
        Ok(())
    }

    /// Writes the state (`q`, `p`) at `t` to `next`. Returns H at this state.
    ///
    /// # Errors
    /// Invalid values, or H not finite at this state.
    pub(crate) fn look_at(&mut self, q: &[T], p: &[T], t: T) -> Result<T, IntegrateError<T>> {
        let m = self.m;
        check_initial(m, q, p)?;
        let y = &mut self.next.hi;
        let half = y.len() / 2;
        let (positions, momenta) = y.split_at_mut(half);
        positions[..m].copy_from_slice(q);
        momenta[..m].copy_from_slice(p);
        // If H depends on time, t and p_t = 0, the energy supplied since.
        positions[m..].fill(t);
        momenta[m..].fill(T::int(0));
        let energy = self.core.energy_mut();
        let h_ref = energy.gradient_with_compensated_value(y, &mut self.gradient);
        if !h_ref.is_finite() || self.gradient.iter().any(|g| !g.is_finite()) {
            return Err(IntegrateError::EnergyNotFinite { energy: h_ref });
        }
        if let Some(domains) = &mut self.domains {
            domains.check(t, &self.next.hi)?;
        }
        if self.check_gradient {
            check_gradient(self.core.energy_mut(), t, &self.next.hi)?;
        }
        Ok(h_ref)
    }
}

/// Checks that events, invariants and constraints are functions of states with m degrees of freedom, or with
/// `all` if they include time.
fn check_functions<T: Float>(
    options: &Options<T>,
    m: usize,
    all: usize,
) -> Result<(), IntegrateError<T>> {
    let wrong = |what, expected, found| {
        Err(IntegrateError::WrongLength {
            what,
            expected,
            found,
        })
    };
    let events = options.events.iter().filter_map(Event::recording);
    let functions = events.map(|function| ("a recorded event", function));
    let invariants = options.invariants.iter();
    for (what, function) in functions.chain(invariants.map(|i| ("an invariant", i.function()))) {
        let found = function.degrees_of_freedom() - usize::from(function.has_time());
        if found != m && (found != all || function.has_time()) {
            return wrong(what, m, found);
        }
    }
    for kept in &options.kept {
        let found = kept.function().degrees_of_freedom();
        if found != all {
            let what = if found + 1 == all {
                "an invariant to preserve (recorded without time, where H is one `with_time`)"
            } else {
                "an invariant to preserve"
            };
            return wrong(what, all, found);
        }
    }
    Ok(())
}

fn check_initial<T: Float>(m: usize, q0: &[T], p0: &[T]) -> Result<(), IntegrateError<T>> {
    for (what, values) in [("q0", q0), ("p0", p0)] {
        if values.len() != m {
            let found = values.len();
            return Err(IntegrateError::WrongLength {
                what,
                expected: m,
                found,
            });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, x)| !x.is_finite()) {
            return Err(IntegrateError::InitialNotFinite { what, index, value });
        }
    }
    Ok(())
}
