//! The reference: Gauss's method with 16 stages and small steps in any float, stages by plain iteration.
//!
//! Z = h A f(y + Z) is iterated until it stands still, in doubles first; y1 = y + h Σ b_i f(Y_i). None of
//! the solver's code runs here. The whole is done with twice as many steps until two solutions agree; the
//! last difference bounds the error of the coarser one, and the finer one is the reference.

use equip_autodiff::{Evaluator, Hamiltonian};
use equip_scalar::Float;
use equip_tableau::{Coefficients, TableauError};

/// Stages of the reference.
const STAGES: usize = 16;
/// Largest h·ω of the first trial.
const ANGLE: f64 = 1.0;
/// Halvings of the steps.
const TRIALS: u32 = 5;
/// Iterations of the stages.
const ITERATIONS: usize = 200;
/// Movement of the stages, relative to the state, at which they are solved: what is left is a contraction
/// less.
const LEFT: f64 = 1e-25;

/// States at given times, rounded to doubles.
#[derive(Debug, Clone)]
pub struct Reference {
    /// (q, p) at each time; not finite where none was found.
    pub states: Vec<Vec<f64>>,
    /// Bound of its error at each time, as [`apart`] measures it.
    pub errors: Vec<f64>,
}

impl Reference {
    /// The state at `end`, in doubles: its error is that of rounding.
    ///
    /// # Panics
    /// Not with the tableaux there are.
    pub fn at(hamiltonian: &Hamiltonian, start: &[f64], end: f64) -> Self {
        let wanted = (crate::rate(hamiltonian, start), 1e-9);
        Self::solve::<f64>(hamiltonian, start, &[end], wanted).unwrap()
    }

    /// The states of the motion from `start` at the ascending `times`, computed in `T`; `rate` is its
    /// fastest frequency, `agreement` the difference of two solutions, relative to the size of the motion,
    /// that is asked for. Where less is reached, `errors` says so.
    ///
    /// # Errors
    /// Those of the tableau.
    pub fn solve<T: Float>(
        hamiltonian: &Hamiltonian,
        start: &[f64],
        times: &[f64],
        (rate, agreement): (f64, f64),
    ) -> Result<Self, TableauError> {
        let mut steps = Steps::<T>::new(hamiltonian)?;
        let mut h = ANGLE / rate;
        let mut states = steps.states(start, times, h);
        let mut before = f64::INFINITY;
        for _ in 0..TRIALS {
            h /= 2.0;
            let coarse = std::mem::replace(&mut states, steps.states(start, times, h));
            if !states.iter().flatten().all(|x| x.is_finite()) {
                break;
            }
            let sizes = sizes(start, &states);
            let pairs = coarse.iter().zip(&states);
            let errors: Vec<f64> = pairs.map(|(a, b)| apart(a, b, sizes)).collect();
            let worst = errors.iter().fold(0.0, |a: f64, &b| a.max(b));
            // Halves that gain nothing leave what rounding, or chaos, makes of it.
            if worst < agreement || worst > before / 16.0 {
                return Ok(Reference { states, errors });
            }
            before = worst;
        }
        let errors = vec![f64::NAN; times.len()];
        Ok(Reference { states, errors })
    }
}

/// Largest |q| and largest |p| over the start and the states.
pub fn sizes(start: &[f64], states: &[Vec<f64>]) -> [f64; 2] {
    let m = start.len() / 2;
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let all = || states.iter().map(Vec::as_slice).chain([start]);
    [
        all().map(|y| largest(&y[..m])).fold(0.0, f64::max),
        all().map(|y| largest(&y[m..])).fold(0.0, f64::max),
    ]
}

/// The distance of two states: max |Δq| and max |Δp|, each in units of the sizes, the larger of both.
pub fn apart(a: &[f64], b: &[f64], [q, p]: [f64; 2]) -> f64 {
    let m = a.len() / 2;
    let unit = |c: usize| if c < m { q } else { p };
    a.iter()
        .zip(b)
        .enumerate()
        .map(|(c, (x, y))| (x - y).abs() / unit(c).max(f64::MIN_POSITIVE))
        .fold(0.0, |far, d| if d.is_nan() || d > far { d } else { far })
}

/// Steps in `T`, whose stages are first solved in doubles.
struct Steps<T: Float> {
    rough: Stages<f64>,
    fine: Stages<T>,
}

impl<T: Float> Steps<T> {
    fn new(hamiltonian: &Hamiltonian) -> Result<Self, TableauError> {
        Ok(Steps {
            rough: Stages::new(hamiltonian)?,
            fine: Stages::new(hamiltonian)?,
        })
    }

    /// The states at `times`, every interval between two of them divided into steps of at most `h`.
    fn states(&mut self, start: &[f64], times: &[f64], h: f64) -> Vec<Vec<f64>> {
        let mut y: Vec<T> = start.iter().map(|&x| T::exact(x)).collect();
        let mut before = 0.0;
        let mut states = Vec::with_capacity(times.len());
        for &time in times {
            let steps = ((time - before) / h).ceil().max(1.0);
            let step = (T::exact(time) - T::exact(before)) / T::exact(steps);
            for _ in 0..steps as u64 {
                self.step(&mut y, step);
                if !y.iter().all(|x| x.is_finite()) {
                    break;
                }
            }
            before = time;
            states.push(y.iter().map(|x| x.to_f64()).collect());
        }
        states
    }

    fn step(&mut self, y: &mut [T], h: T) {
        let rounded: Vec<f64> = y.iter().map(|y| y.to_f64()).collect();
        self.rough.z.fill(0.0);
        self.rough.iterate(&rounded, h.to_f64());
        for (fine, &rough) in self.fine.z.iter_mut().zip(&self.rough.z) {
            *fine = T::exact(rough);
        }
        self.fine.iterate(y, h);
        self.fine.update(y, h);
    }
}

/// Coefficients, and the workspace of a step. Component c of stage i stands at `c·STAGES + i`.
struct Stages<T: Float> {
    evaluator: Evaluator<T>,
    a: Vec<T>,
    b: Vec<T>,
    z: Vec<T>,
    y: Vec<T>,
    gradients: Vec<T>,
}

impl<T: Float> Stages<T> {
    fn new(hamiltonian: &Hamiltonian) -> Result<Self, TableauError> {
        let tableau = Coefficients::<T>::gauss(STAGES)?.tableau(&[T::int(0); STAGES - 1]);
        let length = 2 * hamiltonian.degrees_of_freedom() * STAGES;
        let zeros = vec![T::int(0); length];
        Ok(Stages {
            evaluator: hamiltonian.evaluator(),
            a: tableau.a,
            b: tableau.b,
            z: zeros.clone(),
            y: zeros.clone(),
            gradients: zeros,
        })
    }

    /// Solves for Z, from the Z that is there.
    fn iterate(&mut self, y0: &[T], h: T) {
        let mut last = f64::INFINITY;
        // Below this the iteration may stop where it does not contract.
        let near = (1e3 * T::EPSILON.to_f64()).max(LEFT);
        for _ in 0..ITERATIONS {
            self.evaluate(y0);
            let moved = self.iteration(h);
            if !moved.is_finite() || moved < LEFT || (moved < near && moved >= last) {
                break;
            }
            last = moved;
        }
    }

    /// y0 ← y1.
    fn update(&mut self, y0: &mut [T], h: T) {
        self.evaluate(y0);
        let n = y0.len();
        for (c, y) in y0.iter_mut().enumerate() {
            let slopes = &self.gradients[((c + n / 2) % n) * STAGES..][..STAGES];
            let products = slopes.iter().zip(&self.b).map(|(&g, &b)| g * b);
            let sum = products.fold(T::int(0), |sum, x| sum + x);
            *y = if c < n / 2 {
                *y + h * sum
            } else {
                *y - h * sum
            };
        }
    }

    fn evaluate(&mut self, y0: &[T]) {
        for (c, &y) in y0.iter().enumerate() {
            for i in c * STAGES..(c + 1) * STAGES {
                self.y[i] = y + self.z[i];
            }
        }
        self.evaluator
            .gradients_by_component(&self.y, &mut self.gradients, STAGES, STAGES);
    }

    /// Z = h A f, and by how much that moved the largest component relative to the state.
    fn iteration(&mut self, h: T) -> f64 {
        let n = self.z.len() / STAGES;
        let (mut moved, mut size) = ([0.0_f64; 2], [0.0_f64; 2]);
        for at in 0..n * STAGES {
            let (c, i) = (at / STAGES, at % STAGES);
            let slopes = &self.gradients[((c + n / 2) % n) * STAGES..][..STAGES];
            let row = &self.a[i * STAGES..][..STAGES];
            let products = row.iter().zip(slopes).map(|(&a, &g)| a * g);
            let sum = h * products.fold(T::int(0), |sum, x| sum + x);
            let z = if c < n / 2 { sum } else { -sum };
            let far = (z - self.z[at]).to_f64().abs();
            let large = self.y[at].to_f64().abs().max(z.to_f64().abs());
            self.z[at] = z;
            let half = usize::from(c >= n / 2);
            if far.is_nan() || far > moved[half] {
                moved[half] = far;
            }
            size[half] = size[half].max(large);
        }
        let relative = |half: usize| moved[half] / size[half].max(f64::MIN_POSITIVE);
        let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
        larger(relative(0), relative(1))
    }
}
