//! The trajectory a row is compared with, and the distance of a run from it.

use super::case::{BuildFault, Case, Judged, Problem, Reference, State};
use super::leg::{Samples, run, stride, widen};
use equip_integrate::{Equip, Gauss};
use equip_scalar::{DoubleDouble, Float};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The states at the samples of a run; `from` is the number of the first of them.
#[derive(Debug)]
pub(crate) struct Truth<T> {
    pub(crate) from: usize,
    pub(crate) samples: Samples<T>,
}

/// Trajectories used by several rows.
#[derive(Debug, Default)]
pub(crate) struct Cache(Mutex<HashMap<String, Arc<OnceLock<Samples<f64>>>>>);

impl Cache {
    /// The entry under `key`. The first thread to ask makes it; the others wait.
    fn get(&self, key: &str, make: impl FnOnce() -> Samples<f64>) -> Samples<f64> {
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let cell = map.entry(key.to_owned()).or_default().clone();
        drop(map);
        cell.get_or_init(make).clone()
    }
}

/// The reference of `case` in the number type of its run, or nothing if it has none.
pub(crate) fn truth<T: Float>(
    case: &Case,
    problem: &Problem,
    start: &State<T>,
    cache: &Cache,
) -> Result<Option<Truth<T>>, BuildFault> {
    let stride = stride(case.steps);
    let samples = match &case.reference {
        Reference::None => return Ok(None),
        Reference::Closed => closed(case, problem, start, stride),
        Reference::Stored => return Ok(stored(case, problem)),
        Reference::Fine { stages, divide } => fine(case, problem, start, *stages, *divide),
        Reference::Shared {
            key,
            grid,
            divide,
            stages,
            end,
        } => {
            let start = problem.initial::<f64>();
            let steps = (end / grid).round() as u64 * divide;
            let h = grid / *divide as f64;
            let all = cache.get(key, || {
                every(*divide, Gauss::stages(*stages), problem, &start, h, steps)
            });
            let apart = (case.h * stride as f64 / grid).round() as usize;
            let mut picked = Samples::none();
            for y in all.iter().step_by(apart) {
                let y: Vec<T> = y.iter().map(|&x| T::exact(x)).collect();
                picked.push(&y, &[]);
            }
            picked
        }
        Reference::Scaled { problem, h } => {
            let problem = problem()?;
            let method = Equip::stages(case.stages);
            let start = problem.initial();
            let (_, samples) = run(method, &problem, &start, T::exact(*h), case.steps);
            samples.in_own_units()
        }
    };
    Ok(Some(Truth { from: 0, samples }))
}

fn closed<T: Float>(case: &Case, problem: &Problem, start: &State<T>, stride: u64) -> Samples<T> {
    let wide = |all: &[T]| all.iter().map(|&x| widen(x)).collect::<Vec<_>>();
    let narrow = |all: Vec<DoubleDouble>| -> Vec<T> {
        let all = all.into_iter();
        all.map(|x| T::from_expansion(x.expansion())).collect()
    };
    let (start, h) = (
        (wide(&start.0), wide(&start.1)),
        DoubleDouble::exact(case.h),
    );
    let mut samples = Samples::none();
    for index in 0..=case.steps / stride {
        let t = DoubleDouble::int((index * stride) as i64) * h;
        let state = problem.instance().and_then(|instance| {
            let state = instance.flow(&start, t);
            state.or_else(|| instance.exact(t))
        });
        if let Some((q, p)) = state {
            samples.push(&narrow(q), &narrow(p));
        }
    }
    samples
}

fn stored<T: Float>(case: &Case, problem: &Problem) -> Option<Truth<T>> {
    let reference = problem.instance()?.reference()?;
    let (q, p) = reference.state();
    let mut samples = Samples::none();
    samples.push(&q, &p);
    Some(Truth {
        from: (case.steps / stride(case.steps)) as usize,
        samples,
    })
}

fn fine<T: Float>(
    case: &Case,
    problem: &Problem,
    start: &State<T>,
    stages: usize,
    divide: u64,
) -> Samples<T> {
    let h = T::exact(case.h) / T::int(divide as i64);
    let (every_k, steps) = (divide * stride(case.steps), case.steps * divide);
    every(every_k, Gauss::stages(stages), problem, start, h, steps)
}

/// The states at every `k`-th step, as far as the method gets.
fn every<T: Float>(
    k: u64,
    method: equip_integrate::Method,
    problem: &Problem,
    (q, p): &State<T>,
    h: T,
    steps: u64,
) -> Samples<T> {
    let mut samples = Samples::none();
    samples.push(q, p);
    let started =
        method
            .step(h)
            .measure_energy(false)
            .start(problem.hamiltonian(), q, p, T::int(0));
    let Ok(mut stepper) = started else {
        return samples;
    };
    for index in 1..=steps {
        match stepper.advance() {
            Ok(view) if index % k == 0 => samples.push(view.q, view.p),
            Ok(_) => {}
            Err(_) => break,
        }
    }
    samples
}

/// Largest error over the samples both have, relative to the largest q and the largest p of the reference;
/// infinite if anything is not a number.
pub(crate) fn distance<T: Float>(judged: Judged, run: &Samples<T>, truth: &Truth<T>) -> f64 {
    let zero = T::int(0);
    let larger = |most: T, x: T| if x.abs() <= most { most } else { x.abs() };
    let is_polar = judged == Judged::Polar;
    // Of positions and of momenta.
    let (mut scale, mut off) = ([zero; 2], [zero; 2]);
    for y in truth.samples.iter() {
        for (scale, part) in scale.iter_mut().zip(observed(judged, y)) {
            *scale = part.into_iter().fold(*scale, larger);
        }
    }
    if is_polar {
        scale[0] = T::int(1);
    }
    for (y, z) in run.iter().skip(truth.from).zip(truth.samples.iter()) {
        let parts = observed(judged, y).into_iter().zip(observed(judged, z));
        for (k, (found, expected)) in parts.enumerate() {
            let differences = found.into_iter().zip(expected).map(|(a, b)| a - b);
            // An angle is known up to turns.
            let turned = differences.map(|d| match is_polar && k == 0 {
                true => d - T::two_pi() * (d / T::two_pi()).round(),
                false => d,
            });
            off[k] = turned.fold(off[k], larger);
        }
    }
    let relative = [0, 1].map(|k| match off[k] == zero {
        true => 0.0,
        false => (off[k] / scale[k]).to_f64(),
    });
    match relative.iter().all(|x| x.is_finite()) {
        true => relative[0].max(relative[1]),
        false => f64::INFINITY,
    }
}

/// The part of y that is judged, as positions and momenta.
fn observed<T: Float>(judged: Judged, y: &[T]) -> [Vec<T>; 2] {
    let (q, p) = y.split_at(y.len() / 2);
    match judged {
        Judged::State => [q.to_vec(), p.to_vec()],
        Judged::First(m) => [q[..m].to_vec(), p[..m].to_vec()],
        Judged::Polar => {
            let moment = q[0] * p[1] - q[1] * p[0];
            [vec![q[1].atan2(q[0])], vec![moment]]
        }
    }
}
