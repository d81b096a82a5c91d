//! Errors after two periods against the number of steps, in double-double.

use crate::draw::page::{Cell, cell};
use crate::fault::Fault;
use crate::run::finished::largest_difference;
use equip_integrate::{AlphaPolicy, Alphas, Equip, Gauss, Method, Record, StepView};
use equip_scalar::{DoubleDouble, Float, ratio};
use equip_scenes::Instance;
use serde::Serialize;
use std::ops::ControlFlow;

/// Steps per period.
pub(super) const STEPS: [u32; 3] = [80, 160, 320];
/// Numbers of stages.
pub(super) const STAGES: [usize; 3] = [2, 3, 4];

/// A member of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) enum Member {
    /// α = 0.
    Gauss,
    /// α = 0.02.
    Fixed,
    /// α with g(α, h) = 0.
    Solved,
}

impl Member {
    pub(super) const ALL: [Member; 3] = [Member::Gauss, Member::Fixed, Member::Solved];

    pub(super) fn name(self) -> &'static str {
        match self {
            Member::Gauss => "Gauss, α = 0",
            Member::Fixed => "α = 0.02",
            Member::Solved => "EQUIP, g(α, h) = 0",
        }
    }

    pub(super) fn method(self, stages: usize) -> Method {
        match self {
            Member::Gauss => Gauss::stages(stages),
            Member::Fixed => Method::fixed_alpha(stages, ratio(1, 50)),
            Member::Solved => Equip::stages(stages).alphas(Alphas::Last),
        }
    }
}

/// One method with one number of stages.
#[derive(Debug, Serialize)]
pub(super) struct Convergence {
    pub(super) stages: usize,
    pub(super) method: Member,
    /// Errors after two periods.
    pub(super) errors: [f64; 3],
    /// Largest |ΔL| over all runs.
    pub(super) momentum: f64,
    /// Largest |α| of a step.
    pub(super) alphas: [f64; 3],
}

impl Convergence {
    /// From the last two numbers of steps.
    pub(super) fn order(&self) -> f64 {
        (self.errors[1] / self.errors[2]).log2()
    }

    /// Errors and order, as the tables have them.
    pub(super) fn cells(&self) -> [Cell; 4] {
        let [a, b, c] = self.errors.map(|error| format!("{error:.3e}"));
        [
            cell("80 steps a period", a),
            cell("160", b),
            cell("320", c),
            cell("order", format!("{:.2}", self.order())),
        ]
    }
}

pub(super) fn measure(instance: &Instance) -> Result<Vec<Convergence>, Fault> {
    let mut all = Vec::new();
    for stages in STAGES {
        for method in Member::ALL {
            let mut row = Convergence {
                stages,
                method,
                errors: [0.0; 3],
                momentum: 0.0,
                alphas: [0.0; 3],
            };
            for (k, steps) in STEPS.into_iter().enumerate() {
                let run = run::<DoubleDouble>(instance, method.method(stages), steps, 2)?;
                row.errors[k] = run.error;
                row.momentum = row.momentum.max(run.momentum);
                row.alphas[k] = run.alpha;
            }
            all.push(row);
        }
    }
    Ok(all)
}

/// Figures of one run.
#[derive(Debug, Default, Serialize)]
pub(super) struct Figures {
    /// Largest error of a component of (q, p) at the end, a whole number of periods after the start.
    pub(super) error: f64,
    /// The same over the last period.
    pub(super) last_period: f64,
    /// Largest |ΔH| and |ΔL|.
    pub(super) energy: f64,
    pub(super) momentum: f64,
    /// Largest |α_{s−1}| of a step.
    #[serde(skip)]
    pub(super) alpha: f64,
    /// Largest |ΔH| of each period.
    pub(super) energies: Vec<f64>,
}

/// A run of whole periods; α goes as far as g = 0 needs.
pub(super) fn run<T: Float>(
    instance: &Instance,
    method: Method,
    steps: u32,
    periods: u32,
) -> Result<Figures, Fault> {
    let period = instance.period::<T>();
    let h = period / T::int(i64::from(steps));
    let end = T::int(i64::from(periods)) * period;
    let (q, p) = instance.initial::<T>();
    let mut evaluator = instance.hamiltonian().evaluator::<T>();
    let mut conserved =
        |q: &[T], p: &[T]| (evaluator.value(&[q, p].concat()), q[0] * p[1] - q[1] * p[0]);
    // H and L.
    let start = conserved(&q, &p);
    let mut figures = Figures::default();
    let mut see = |view: &StepView<'_, T>| {
        let (energy, momentum) = conserved(view.q, view.p);
        let energy_error = (energy - start.0).abs().to_f64();
        figures.energy = figures.energy.max(energy_error);
        figures.momentum = figures.momentum.max((momentum - start.1).abs().to_f64());
        let alpha = view.alphas.last().map_or(0.0, |alpha| alpha.abs().to_f64());
        figures.alpha = figures.alpha.max(alpha);
        let period = (view.index - 1) as usize / steps as usize;
        figures.energies.resize(period + 1, 0.0);
        figures.energies[period] = figures.energies[period].max(energy_error);
        if period + 1 == periods as usize
            && let Some((q, p)) = instance.exact(view.time)
        {
            let error = largest_difference(view.q, &q).max(largest_difference(view.p, &p));
            figures.last_period = figures.last_period.max(error.to_f64());
        }
        ControlFlow::Continue(())
    };
    let options = method
        .step(h)
        .record(Record::Ends)
        .alpha_policy(AlphaPolicy::Always);
    let run = options
        .integrate_observed(instance.hamiltonian(), &q, &p, T::int(0)..=end, &mut see)
        .map_err(|failure| Fault::start(failure.error))?;
    let (_, q_end, p_end) = run.last();
    let error = largest_difference(q_end, &q).max(largest_difference(p_end, &p));
    figures.error = error.to_f64();
    Ok(figures)
}
