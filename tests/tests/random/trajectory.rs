//! Errors of the end states beside those of Gauss's method.

use super::case::{Case, Ran};
use equip_integrate::{Gauss, Method};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::rate;

fn end_state<T: Float>(case: &Case, method: Method, parts: i64) -> Option<Vec<T>> {
    let (q, p) = case.system.start.split_at(case.system.m);
    let read = |x: &[f64]| x.iter().map(|&x| T::exact(x)).collect::<Vec<T>>();
    let options = method
        .step(T::exact(case.h) / T::int(parts))
        .measure_energy(false);
    let mut run = options
        .start(&case.system.hamiltonian, &read(q), &read(p), T::int(0))
        .ok()?;
    for _ in 0..case.steps * parts as usize {
        run.advance().ok()?;
    }
    let view = run.view();
    Some([view.q, view.p].concat())
}

/// Errors of the end states, relative to the sizes of positions and momenta.
#[derive(Debug)]
pub(super) struct Errors {
    pub(super) equip: f64,
    pub(super) gauss: f64,
    /// Rounding.
    pub(super) floor: f64,
}

impl Errors {
    pub(super) fn ratio(&self) -> f64 {
        (self.equip - self.floor).max(0.0) / self.gauss.max(self.floor)
    }
}

/// Steps that resolve the motion all along.
const RESOLVED: f64 = 0.5;

/// Largest s·2m for which a reference in double-double is computed: the rest costs too much.
const REFERENCE_SIZE: usize = 60;

pub(super) fn errors(case: &Case, ran: &Ran) -> Option<Errors> {
    let hamiltonian = &case.system.hamiltonian;
    let rate = ran
        .seen
        .iter()
        .map(|seen| rate(hamiltonian, &seen.y))
        .fold(0.0, f64::max);
    let small = case.stages * case.system.start.len() <= REFERENCE_SIZE;
    if !small || case.h_omega > RESOLVED || case.h * rate > RESOLVED || ran.error.is_some() {
        return None;
    }
    let reference: Vec<DoubleDouble> = end_state(case, Gauss::stages(case.stages + 2), 2)?;
    let gauss: Vec<f64> = end_state(case, Gauss::stages(case.stages), 1)?;
    let m = case.system.m;
    let end = &ran.seen.last().unwrap().y;
    let size = |range: std::ops::Range<usize>| {
        let sizes = ran
            .seen
            .iter()
            .flat_map(|seen| &seen.y[range.clone()])
            .chain(&case.system.start[range.clone()]);
        sizes.fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()))
    };
    let sizes = [size(0..m), size(m..2 * m)];
    let error = |y: &[f64]| {
        let off = |(i, (&y, &r)): (usize, (&f64, &DoubleDouble))| {
            (DoubleDouble::exact(y) - r).to_f64().abs() / sizes[i / m]
        };
        y.iter()
            .zip(&reference)
            .enumerate()
            .map(off)
            .fold(0.0, f64::max)
    };
    Some(Errors {
        equip: error(end),
        gauss: error(&gauss),
        floor: case.steps as f64 * f64::EPSILON,
    })
}
