//! [`Leg`]: one method on one problem, with all that is measured of it.

use super::case::{Kind, Problem, State};
use equip_autodiff::{Evaluator, Hamiltonian};
use equip_integrate::{Counts, IntegrateError, Method, Outcome, StepView};
use equip_scalar::{DoubleDouble, Float};
use std::time::{Duration, Instant};

/// A method that has not reached the end by then is stopped.
const PATIENCE: Duration = Duration::from_secs(600);

/// States kept of a run for comparison, at most; longer runs keep every k-th.
const MOST_SAMPLES: u64 = 20_000;

/// The states of a run at every `stride`-th step, the start included; n = 2m numbers each.
#[derive(Debug, Clone)]
pub(crate) struct Samples<T> {
    pub(crate) n: usize,
    pub(crate) states: Vec<T>,
}

impl<T: Float> Samples<T> {
    pub(crate) fn none() -> Self {
        Samples {
            n: 0,
            states: Vec::new(),
        }
    }

    pub(crate) fn push(&mut self, q: &[T], p: &[T]) {
        self.n = q.len() + p.len();
        self.states.extend_from_slice(q);
        self.states.extend_from_slice(p);
    }

    /// The first `count` of them.
    pub(crate) fn first(mut self, count: usize) -> Self {
        self.states.truncate(count * self.n);
        self
    }

    pub(crate) fn len(&self) -> usize {
        self.iter().len()
    }

    /// Positions and momenta in units of the largest of each.
    pub(crate) fn in_own_units(mut self) -> Self {
        let m = self.n / 2;
        let mut scale = [T::int(0); 2];
        for y in self.iter() {
            for (i, &x) in y.iter().enumerate() {
                scale[i / m] = scale[i / m].max(x.abs());
            }
        }
        let n = self.n;
        for (i, x) in self.states.iter_mut().enumerate() {
            *x /= scale[i % n / m];
        }
        self
    }

    pub(crate) fn iter(&self) -> std::slice::ChunksExact<'_, T> {
        self.states.chunks_exact(self.n.max(1))
    }
}

/// Steps between samples of a run of so many steps.
pub(crate) fn stride(steps: u64) -> u64 {
    steps.div_ceil(MOST_SAMPLES).max(1)
}

/// An error that ended a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ended {
    pub(crate) kind: Kind,
    pub(crate) text: String,
    pub(crate) time: f64,
}

/// A quantity that is to be kept.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Kept {
    pub(crate) name: String,
    /// Largest error, in the quantity's own unit.
    pub(crate) error: f64,
    /// The same in units of ε Σ|∂_iI y_i|.
    pub(crate) in_roundoff: f64,
}

/// The figures of a run, as doubles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Leg {
    pub(crate) counts: Counts,
    /// Largest |H − H_ref|.
    pub(crate) energy: f64,
    /// Largest |H − H_ref| in round-off levels over steps that say the energy is kept.
    pub(crate) levels: Option<f64>,
    /// The same with H evaluated in double-double; runs in f64 only.
    pub(crate) independent_levels: Option<f64>,
    pub(crate) invariants: Vec<Kept>,
    pub(crate) ended: Option<Ended>,
    /// Whether it was stopped for taking too long.
    pub(crate) impatient: bool,
    pub(crate) seconds: f64,
}

impl Leg {
    /// Steps of each outcome that occurred, in the order of reports.
    pub(crate) fn outcomes(&self) -> impl Iterator<Item = (Outcome, u64)> {
        let all = Outcome::ALL
            .into_iter()
            .map(|o| (o, self.counts.outcome(o)));
        all.filter(|(_, n)| *n > 0)
    }
}

/// The value of H and of invariants, and how large the rounding of the state makes them.
struct Watched<T: Float> {
    evaluator: Evaluator<T>,
    gradient: Vec<T>,
    name: String,
    start: T,
    error: T,
    scale: T,
}

impl<T: Float> Watched<T> {
    fn new(name: &str, function: &Hamiltonian, y: &[T]) -> Self {
        let mut evaluator = function.evaluator::<T>();
        let start = evaluator.compensated_value(y);
        Watched {
            evaluator,
            gradient: vec![T::int(0); y.len()],
            name: name.to_owned(),
            start,
            error: T::int(0),
            scale: T::int(0),
        }
    }

    fn see(&mut self, y: &[T]) {
        let value = self
            .evaluator
            .gradient_with_compensated_value(y, &mut self.gradient);
        let moved = self.gradient.iter().zip(y);
        let scale = moved.fold(T::int(0), |sum, (&g, &y)| sum + (g * y).abs());
        let error = (value - self.start).abs();
        if !(error <= self.error) {
            self.error = error;
        }
        if scale > self.scale {
            self.scale = scale;
        }
    }

    fn kept(&self) -> Kept {
        let unit = T::EPSILON * self.scale;
        let zero = T::int(0);
        Kept {
            name: self.name.clone(),
            error: self.error.to_f64(),
            in_roundoff: if self.error == zero {
                0.0
            } else {
                (self.error / unit).to_f64()
            },
        }
    }
}

pub(crate) fn widen<T: Float>(x: T) -> DoubleDouble {
    DoubleDouble::from_expansion(x.expansion())
}

/// Everything that sees the steps.
struct Watch<T: Float> {
    leg: Leg,
    samples: Samples<T>,
    watched: Vec<Watched<T>>,
    /// H in double-double, and its value at the start.
    independent: Option<(Evaluator<DoubleDouble>, DoubleDouble)>,
}

impl<T: Float> Watch<T> {
    fn new(problem: &Problem, (q, p): &State<T>) -> Self {
        let y = [q.as_slice(), p].concat();
        let watched = problem.invariants.iter();
        let watched = watched.map(|i| Watched::new(i.name(), i.function(), &y));
        let mut samples = Samples::none();
        samples.push(q, p);
        Watch {
            watched: watched.collect(),
            independent: None,
            leg: Leg::default(),
            samples,
        }
    }

    fn step(&mut self, view: &StepView<'_, T>, sample: bool) {
        let error = view.energy_error.map_or(0.0, Float::to_f64).abs();
        if !(error <= self.leg.energy) {
            self.leg.energy = error;
        }
        let is_kept = view.outcome.energy_conserved();
        let round_off = view.energy_round_off.filter(|_| is_kept).map(Float::to_f64);
        if let Some(round_off) = round_off {
            raise(&mut self.leg.levels, in_levels(error, round_off));
        }
        if !sample {
            return;
        }
        self.samples.push(view.q, view.p);
        let y = [view.q, view.p].concat();
        self.watched.iter_mut().for_each(|w| w.see(&y));
        if let (Some((h, h_ref)), Some(round_off)) = (&mut self.independent, round_off) {
            let y: Vec<_> = y.iter().map(|&x| widen(x)).collect();
            let levels = in_levels((h.value(&y) - *h_ref).to_f64(), round_off);
            raise(&mut self.leg.independent_levels, levels);
        }
    }
}

/// |error| / round-off level; an error of zero is zero levels, also where the level underflows.
fn in_levels(error: f64, round_off: f64) -> f64 {
    if error == 0.0 {
        0.0
    } else {
        (error / round_off).abs()
    }
}

fn raise(most: &mut Option<f64>, x: f64) {
    if !most.is_some_and(|most| x <= most) {
        *most = Some(x);
    }
}

/// `steps` steps of size `h` from `start`, or as far as it gets.
pub(crate) fn run<T: Float>(
    method: Method,
    problem: &Problem,
    start: &State<T>,
    h: T,
    steps: u64,
) -> (Leg, Samples<T>) {
    let begun = Instant::now();
    let (q, p) = start;
    let mut watch = Watch::new(problem, start);
    let stride = stride(steps);
    let begin = method.step(h).start(problem.hamiltonian(), q, p, T::int(0));
    let mut stepper = match begin {
        Ok(stepper) => stepper,
        Err(error) => {
            watch.leg.ended = Some(ended(&error, T::int(0)));
            return (watch.leg, watch.samples);
        }
    };
    let h_ref = stepper.certificate().energy.map(|energy| energy.start);
    // Nothing is wider than double-double.
    let h_ref = h_ref.filter(|_| T::MANTISSA_BITS < DoubleDouble::MANTISSA_BITS);
    watch.independent = h_ref.map(|h_ref| (problem.hamiltonian().evaluator(), widen(h_ref)));
    for index in 1..=steps {
        let time = stepper.time();
        match stepper.advance() {
            Ok(view) => watch.step(&view, index % stride == 0),
            Err(error) => {
                watch.leg.ended = Some(ended(&error, time));
                break;
            }
        }
        if index % 64 == 0 && begun.elapsed() > PATIENCE {
            watch.leg.impatient = true;
            break;
        }
    }
    let mut leg = watch.leg;
    leg.counts = *stepper.counts();
    leg.invariants = watch.watched.iter().map(Watched::kept).collect();
    leg.seconds = begun.elapsed().as_secs_f64();
    (leg, watch.samples)
}

fn ended<T: Float>(error: &IntegrateError<T>, time: T) -> Ended {
    Ended {
        kind: match error {
            IntegrateError::NotFinite { .. } => Kind::NotFinite,
            IntegrateError::NoConvergence { .. } => Kind::NoConvergence,
            IntegrateError::Singular { .. } => Kind::Singular,
            IntegrateError::Astray { .. } => Kind::Astray,
            IntegrateError::Escape { .. } => Kind::Escape,
            IntegrateError::EnergyNotFinite { .. } => Kind::EnergyNotFinite,
            _ => Kind::Other,
        },
        text: error.to_string(),
        time: time.to_f64(),
    }
}
