//! Random Hamiltonians, starts, numbers of stages, steps over six decades: every run ends well.
//!
//! One case: `EQUIP_RANDOM_SEED=17 cargo test -p equip-tests --test random -- --nocapture`.
//! More cases: `EQUIP_RANDOM_CASES=100000`.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Evaluate, System};
use equip_scalar::{DoubleDouble, Float};
use equip_solver::{
    Alphas, Counts, Equip, FixedStep, Gauss, IntegrateError, Method, OnNoAlpha, Outcome, RunFailure, StepView,
};
use equip_tests::{RandomSystem, Seeded, TermKind, rate};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

const CASES: u64 = 2400;

/// Everything that a seed decides.
#[derive(Debug)]
struct Case {
    seed: u64,
    system: RandomSystem,
    stages: usize,
    alphas: Alphas,
    on_no_alpha: OnNoAlpha,
    max_halvings: u32,
    /// Step times the fastest rate at the start.
    h_omega: f64,
    h: f64,
    steps: usize,
}

impl Case {
    fn new(seed: u64) -> Self {
        let rng = &mut Seeded::new(seed);
        let system = RandomSystem::draw(rng);
        let h_omega = rng.power_of_ten(-4.0, 2.0);
        let rate = match rate(&system.hamiltonian, &system.start) {
            rate if rate > 0.0 && rate.is_finite() => rate,
            _ => 1.0,
        };
        Case {
            seed,
            stages: 2 + rng.below(11),
            alphas: if rng.once_in(6) { Alphas::Last } else { Alphas::All },
            on_no_alpha: if rng.once_in(6) { OnNoAlpha::Refuse } else { OnNoAlpha::Carry },
            max_halvings: [3, 3, 3, 0, 1, 2][rng.below(6)],
            h_omega,
            h: h_omega / rate,
            steps: 8 + rng.below(5),
            system,
        }
    }

    fn options(&self) -> FixedStep<f64> {
        Equip::stages(self.stages)
            .alphas(self.alphas)
            .step(self.h)
            .on_no_alpha(self.on_no_alpha)
            .max_halvings(self.max_halvings)
    }
}

/// A step as it was seen.
#[derive(Debug)]
struct Seen {
    y: Vec<f64>,
    outcome: Outcome,
    defect: f64,
    floor: Option<f64>,
    alphas: Vec<f64>,
}

/// A run of a case to its end, or to a typed error.
#[derive(Debug)]
struct Ran {
    seen: Vec<Seen>,
    counts: Counts,
    error: Option<IntegrateError<f64>>,
}

fn run(case: &Case) -> Ran {
    let mut seen = Vec::new();
    let mut watch = |view: &StepView<'_, f64>| {
        seen.push(Seen {
            y: [view.q, view.p].concat(),
            outcome: view.outcome,
            defect: view.energy_defect.unwrap(),
            floor: view.energy_floor,
            alphas: view.alphas.to_vec(),
        });
        ControlFlow::Continue(())
    };
    let (q, p) = case.system.start.split_at(case.system.m);
    let end = case.h * case.steps as f64;
    let result = case.options().integrate_observed(&case.system.hamiltonian, q, p, 0.0..=end, &mut watch);
    let (run, error) = match result {
        Ok(run) => (run, None),
        Err(RunFailure { error, partial }) => (*partial.unwrap(), Some(error)),
    };
    // What the run kept is what was seen, and a failed run has all of it.
    assert_eq!(run.len(), seen.len() + 1);
    for (i, seen) in seen.iter().enumerate() {
        assert_eq!([run.q(i + 1), run.p(i + 1)].concat(), seen.y);
        assert_eq!(run.outcomes()[i + 1], seen.outcome);
    }
    if error.is_none() {
        assert_eq!(seen.len(), case.steps);
    }
    let counts = run.certificate().counts;
    Ran { seen, counts, error }
}

/// No more work than the options allow: every step and every part of a halved one is tried with two norms from two guesses,
/// then with α = 0 from two.
fn work_is_bounded(case: &Case, ran: &Ran) {
    let c = &ran.counts;
    let steps = c.steps + u64::from(ran.error.is_some());
    let parts = (2 << case.max_halvings) - 1;
    let iterations = steps * parts * 6 * 30;
    let s = case.stages as u64;
    assert!(c.newton_iterations <= iterations && c.factorisations <= c.newton_iterations);
    assert!(c.gradients <= iterations * (8 * s + 2));
    assert!(c.alpha_solves <= iterations * (2 * s + 1));
    assert!(c.halvings <= steps * (parts / 2));
    assert_eq!(c.steps, ran.seen.len() as u64);
    let outcomes: u64 = Outcome::ALL.iter().map(|&o| c.outcome(o)).sum();
    assert_eq!(outcomes, c.steps);
}

/// The solver's claims about the energy, checked with H in double-double at the very same states.
///
/// Returns the largest |H(y) − H(y0)| in floors over the steps that claim to have kept it.
fn energy_is_as_claimed(case: &Case, ran: &Ran) -> f64 {
    let hamiltonian = &case.system.hamiltonian;
    let (mut in_f64, mut in_dd) = (hamiltonian.evaluator::<f64>(), hamiltonian.evaluator::<DoubleDouble>());
    let mut at = |y: &[f64]| {
        let exact = in_dd.value(&y.iter().map(|&x| DoubleDouble::exact(x)).collect::<Vec<_>>());
        let noise = (DoubleDouble::exact(in_f64.value(y)) - exact).to_f64().abs();
        (exact, noise)
    };
    let (h0, noise0) = at(&case.system.start);
    let quadratic = hamiltonian.structure().is_quadratic();
    let mut gradient = vec![0.0; case.system.start.len()];
    let mut evaluator = hamiltonian.evaluator::<f64>();
    let mut largest = 0.0_f64;
    let mut quadratic_floor = 0.0_f64;
    for seen in &ran.seen {
        assert!(seen.y.iter().all(|y| y.is_finite()), "state {:?}", seen.y);
        let (h, noise) = at(&seen.y);
        let (defect, noise) = ((h - h0).to_f64().abs(), noise + noise0);
        // What is reported is what is there, whatever the outcome.
        assert!((defect - seen.defect.abs()).abs() <= noise + f64::EPSILON * defect, "reported {:e}, found {defect:e}", seen.defect);
        if quadratic {
            assert_eq!(seen.outcome, Outcome::Quadratic);
            let value = evaluator.gradient(&seen.y, &mut gradient);
            let scale = gradient.iter().zip(&seen.y).fold(value.abs(), |sum, (g, y)| sum + (g * y).abs());
            quadratic_floor = quadratic_floor.max(f64::EPSILON * scale);
            largest = largest.max(defect / (quadratic_floor + noise));
        } else if seen.outcome.energy_kept() {
            let floor = seen.floor.unwrap();
            assert!(defect <= 8.0 * floor + noise, "{:?}: |H - H0| = {defect:e}, floor {floor:e}, noise {noise:e}", seen.outcome);
            if floor > 0.0 {
                largest = largest.max(defect / floor);
            }
        } else {
            assert_eq!(seen.outcome, Outcome::Carried);
            assert_eq!(case.on_no_alpha, OnNoAlpha::Carry);
        }
        assert!(seen.alphas.iter().all(|a| a.abs() <= 0.05 * (1.0 + 1e-12)), "alphas {:?}", seen.alphas);
        if seen.outcome == Outcome::AtFloor {
            assert!(seen.alphas.iter().all(|a| *a == 0.0), "alphas {:?}", seen.alphas);
        }
    }
    largest
}

fn end_state<T: Float>(case: &Case, method: Method, parts: i64) -> Option<Vec<T>> {
    let (q, p) = case.system.start.split_at(case.system.m);
    let read = |x: &[f64]| x.iter().map(|&x| T::exact(x)).collect::<Vec<T>>();
    let options = method.step(T::exact(case.h) / T::int(parts)).measure_energy(false);
    let mut run = options.start(&case.system.hamiltonian, &read(q), &read(p), T::int(0)).ok()?;
    for _ in 0..case.steps * parts as usize {
        run.advance().ok()?;
    }
    let view = run.view();
    Some([view.q, view.p].concat())
}

/// Errors of the end states, relative to the sizes of positions and momenta.
#[derive(Debug)]
struct Errors {
    equip: f64,
    gauss: f64,
    /// Rounding.
    floor: f64,
}

impl Errors {
    fn ratio(&self) -> f64 {
        (self.equip - self.floor).max(0.0) / self.gauss
    }
}

/// Steps that resolve the motion all along.
const RESOLVED: f64 = 0.5;
/// Largest s·2m for which a reference in double-double is computed: the rest costs too much.
const REFERENCE_SIZE: usize = 60;

fn errors(case: &Case, ran: &Ran) -> Option<Errors> {
    let hamiltonian = &case.system.hamiltonian;
    let rate = ran.seen.iter().map(|seen| rate(hamiltonian, &seen.y)).fold(0.0, f64::max);
    let small = case.stages * case.system.start.len() <= REFERENCE_SIZE;
    if !small || case.h_omega > RESOLVED || case.h * rate > RESOLVED || ran.error.is_some() {
        return None;
    }
    let reference: Vec<DoubleDouble> = end_state(case, Gauss::stages(case.stages + 2), 2)?;
    let gauss: Vec<f64> = end_state(case, Gauss::stages(case.stages), 1)?;
    let m = case.system.m;
    let end = &ran.seen.last().unwrap().y;
    let size = |range: std::ops::Range<usize>| {
        let sizes = ran.seen.iter().flat_map(|seen| &seen.y[range.clone()]).chain(&case.system.start[range.clone()]);
        sizes.fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()))
    };
    let sizes = [size(0..m), size(m..2 * m)];
    let error = |y: &[f64]| {
        let off = |(i, (&y, &r)): (usize, (&f64, &DoubleDouble))| (DoubleDouble::exact(y) - r).to_f64().abs() / sizes[i / m];
        y.iter().zip(&reference).enumerate().map(off).fold(0.0, f64::max)
    };
    Some(Errors {
        equip: error(end),
        gauss: error(&gauss),
        floor: case.steps as f64 * f64::EPSILON,
    })
}

#[derive(Debug, Default)]
struct Summary {
    outcomes: BTreeMap<String, u64>,
    ends: BTreeMap<String, u64>,
    kinds: BTreeMap<String, u64>,
    energy: Vec<(f64, u64)>,
    quadratic: Vec<(f64, u64)>,
    trajectories: Vec<(f64, u64, Alphas, Errors)>,
}

fn name_of(error: &IntegrateError<f64>) -> String {
    let text = format!("{error:?}");
    text.split([' ', '{']).next().unwrap().to_owned()
}

fn check(seed: u64, summary: &mut Summary) {
    let case = Case::new(seed);
    let ran = run(&case);
    work_is_bounded(&case, &ran);
    let energy = energy_is_as_claimed(&case, &ran);
    for outcome in Outcome::ALL {
        *summary.outcomes.entry(outcome.label().into()).or_default() += ran.counts.outcome(outcome);
    }
    *summary.ends.entry(ran.error.as_ref().map_or("complete".into(), name_of)).or_default() += 1;
    *summary.kinds.entry(format!("{:?}", case.system.kind)).or_default() += 1;
    if case.system.hamiltonian.structure().is_quadratic() {
        summary.quadratic.push((energy, seed));
    } else {
        summary.energy.push((energy, seed));
    }
    if case.system.kind != TermKind::Quadratic && let Some(errors) = errors(&case, &ran) {
        summary.trajectories.push((errors.ratio(), seed, case.alphas, errors));
    }
}

#[test]
fn random_hamiltonians_end_well() {
    let number = |name: &str| std::env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
    let seeds = match number("EQUIP_RANDOM_SEED") {
        Some(seed) => {
            println!("{:#?}", Case::new(seed));
            println!("{:#?}", run(&Case::new(seed)));
            seed..seed + 1
        }
        None => 0..number("EQUIP_RANDOM_CASES").unwrap_or(CASES),
    };
    let mut summary = Summary::default();
    let mut failed = Vec::new();
    let mut slow = Vec::new();
    for seed in seeds {
        let begun = std::time::Instant::now();
        if catch_unwind(AssertUnwindSafe(|| check(seed, &mut summary))).is_err() {
            println!("seed {seed} failed");
            failed.push(seed);
        }
        slow.push((begun.elapsed().as_secs_f64(), seed));
    }
    slow.sort_by(|a, b| b.partial_cmp(a).unwrap());
    println!("slowest {:?}", &slow[..slow.len().min(12)]);
    println!("outcomes {:#?}\nends {:#?}\nkinds {:?}", summary.outcomes, summary.ends, summary.kinds);
    for (name, list) in [("energy", &mut summary.energy), ("quadratic", &mut summary.quadratic)] {
        list.sort_by(|a, b| b.partial_cmp(a).unwrap());
        println!("{name}: {} {:?}", list.len(), &list[..list.len().min(15)]);
    }
    let t = &mut summary.trajectories;
    t.sort_by(|a, b| b.0.partial_cmp(&a.0).unwrap());
    for alphas in [Alphas::All, Alphas::Last] {
        let t: Vec<_> = t.iter().filter(|t| t.2 == alphas).collect();
        println!("{alphas:?}: {} trajectories, {} above 1.5, {} above 10", t.len(), t.iter().filter(|t| t.0 > 1.5).count(), t.iter().filter(|t| t.0 > 10.0).count());
        for t in t.iter().take(40) {
            let case = Case::new(t.1);
            println!("  {:.2e} seed {} s {} m {} {:?} hw {:.1e} steps {} {:.1e} {:.1e}", t.0, t.1, case.stages, case.system.m, case.system.kind, case.h_omega, case.steps, t.3.equip, t.3.gauss);
        }
    }
    assert!(failed.is_empty(), "{} failed: {failed:?}", failed.len());
}
