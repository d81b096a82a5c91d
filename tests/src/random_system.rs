//! Random Hamiltonians of known families, each from a seed: the same on every machine.

use crate::Seeded;
use equip_autodiff::{Hamiltonian, Var};

/// What the terms beyond the quadratic ones are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TermKind {
    /// None: H is quadratic, definite or not.
    Quadratic,
    /// Monomials of degree 3 to 6.
    Polynomial,
    /// Quotients, with and without real poles.
    Rational,
    /// Sines and cosines of linear forms.
    Trigonometric,
    /// Exponentials and Gaussians.
    Exponential,
    /// Square roots, smooth, with a cusp, and with an edge of their domain.
    Root,
    /// Trees of all operations.
    Tree,
}

impl TermKind {
    /// All kinds.
    pub const ALL: [TermKind; 7] = [
        TermKind::Quadratic,
        TermKind::Polynomial,
        TermKind::Rational,
        TermKind::Trigonometric,
        TermKind::Exponential,
        TermKind::Root,
        TermKind::Tree,
    ];
}

/// A random Hamiltonian with a start at which it is finite.
#[derive(Debug)]
pub struct RandomSystem {
    /// What it is made of.
    pub kind: TermKind,
    /// H = T(p) + U(q).
    pub separable: bool,
    /// Degrees of freedom.
    pub m: usize,
    /// H. All constants are doubles, so that every float type has the same function.
    pub hamiltonian: Hamiltonian,
    /// q(0), then p(0).
    pub start: Vec<f64>,
}

/// Starts tried before another Hamiltonian is drawn.
const STARTS: usize = 20;

impl RandomSystem {
    /// The system of that seed. `rng` is left where the system took it.
    pub fn draw(rng: &mut Seeded) -> Self {
        loop {
            let kind = TermKind::ALL[rng.below(TermKind::ALL.len())];
            let separable = rng.once_in(2);
            // Few degrees of freedom more often than many: the work grows like m³.
            let m = 1 + rng.below(6).min(rng.below(6));
            let hamiltonian =
                Hamiltonian::new(m, |q, p| energy(rng, kind, separable, q, p)).unwrap();
            let mut evaluator = hamiltonian.evaluator::<f64>();
            let mut gradient = vec![0.0; 2 * m];
            for _ in 0..STARTS {
                let start = start(rng, 2 * m);
                let value = evaluator.gradient(&start, &mut gradient);
                if value.is_finite() && gradient.iter().all(|g| g.is_finite()) {
                    return RandomSystem {
                        kind,
                        separable,
                        m,
                        hamiltonian,
                        start,
                    };
                }
            }
        }
    }
}

/// Components of the size of 1, sometimes of another size, sometimes with zeros.
fn start(rng: &mut Seeded, n: usize) -> Vec<f64> {
    let size = if rng.once_in(5) {
        rng.power_of_ten(-3.0, 1.0)
    } else {
        1.0
    };
    let zeros = rng.once_in(5);
    (0..n)
        .map(|_| {
            let x = size * rng.between(-1.5, 1.5);
            if zeros && rng.once_in(2) { 0.0 } else { x }
        })
        .collect()
}

fn energy(rng: &mut Seeded, kind: TermKind, separable: bool, q: &[Var], p: &[Var]) -> Var {
    let all: Vec<Var> = q.iter().chain(p).copied().collect();
    let mut h: Var = p.iter().map(|&p| rng.power_of_ten(-1.0, 1.0) * p * p).sum();
    if !rng.once_in(4) {
        h += q
            .iter()
            .map(|&q| rng.power_of_ten(-1.0, 1.0) * q * q)
            .sum::<Var>();
    }
    for _ in 0..1 + rng.below(4) {
        h += match (separable, rng.once_in(3)) {
            (false, _) => term(rng, kind, &all),
            (true, false) => term(rng, kind, q),
            (true, true) => term(rng, kind, p),
        };
    }
    if rng.once_in(6) {
        rng.power_of_ten(-8.0, 8.0) * h
    } else {
        h
    }
}

fn any(rng: &mut Seeded, x: &[Var]) -> Var {
    x[rng.below(x.len())]
}

/// c₀ + Σ c_i x_i over one to three variables.
fn linear(rng: &mut Seeded, x: &[Var]) -> Var {
    let mut sum = rng.between(-1.0, 1.0) * any(rng, x) + rng.between(-0.5, 0.5);
    for _ in 0..rng.below(3) {
        sum += rng.between(-1.0, 1.0) * any(rng, x);
    }
    sum
}

fn term(rng: &mut Seeded, kind: TermKind, x: &[Var]) -> Var {
    let c = rng.between(-1.0, 1.0);
    match kind {
        TermKind::Quadratic => c * linear(rng, x) * any(rng, x),
        TermKind::Polynomial => {
            let degree = 3 + rng.below(4);
            c * (0..degree).map(|_| any(rng, x)).product::<Var>()
        }
        TermKind::Rational => match rng.below(4) {
            0 => c / linear(rng, x),
            1 => c * linear(rng, x).powi(3) / (1.0 + linear(rng, x).powi(2)),
            _ => c * linear(rng, x) / (rng.between(0.3, 2.0) + linear(rng, x).powi(2)),
        },
        TermKind::Trigonometric => match rng.below(3) {
            0 => c * (3.0 * linear(rng, x)).cos(),
            1 => c * linear(rng, x) * linear(rng, x).sin(),
            _ => c * linear(rng, x).cos() * linear(rng, x).cos(),
        },
        TermKind::Exponential => match rng.below(3) {
            0 => c * linear(rng, x).exp(),
            1 => c * (-linear(rng, x).powi(2)).exp(),
            _ => c.abs() * (1.0 - linear(rng, x).exp()).powi(2),
        },
        TermKind::Root => match rng.below(4) {
            0 => c * linear(rng, x).sqrt(),
            1 => c / (linear(rng, x).powi(2) + linear(rng, x).powi(2)).sqrt(),
            _ => c * (0.1 + linear(rng, x).powi(2) + any(rng, x).powi(2)).sqrt(),
        },
        TermKind::Tree => c * tree(rng, x, 4),
    }
}

fn tree(rng: &mut Seeded, x: &[Var], depth: usize) -> Var {
    if depth == 0 || rng.once_in(8) {
        return linear(rng, x);
    }
    let a = tree(rng, x, depth - 1);
    match rng.below(14) {
        0 | 1 => a + tree(rng, x, depth - 1),
        2 => a - tree(rng, x, depth - 1),
        3 | 4 => a * tree(rng, x, depth - 1),
        5 => a / tree(rng, x, depth - 1),
        6 => a / (1.0 + tree(rng, x, depth - 1).powi(2)),
        7 => a.sin(),
        8 => a.cos(),
        9 => a.exp(),
        10 => (1.0 + a.powi(2)).sqrt(),
        11 => a.sqrt(),
        12 => a.tanh(),
        _ => a.powi(2 + rng.below(3) as i32),
    }
}

/// An estimate of the fastest rate at `y`, in 1/time: the spectral radius of J∇²H, and |y'|/|y|.
///
/// The radius is ‖(J∇²H)⁶⁴‖^(1/64), which is too large by n^(1/64) at most for normal matrices.
pub fn rate(hamiltonian: &Hamiltonian, y: &[f64]) -> f64 {
    let (n, m) = (y.len(), y.len() / 2);
    let pattern = &hamiltonian.structure().hessian;
    let mut evaluator = hamiltonian.evaluator::<f64>();
    let (mut entries, mut gradient) = (vec![0.0; pattern.len()], vec![0.0; n]);
    evaluator.hessian(y, &mut entries);
    evaluator.gradient(y, &mut gradient);
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    let slow = match largest(&gradient) / largest(y) {
        ratio if ratio.is_finite() => ratio,
        _ => 0.0,
    };
    let mut a = vec![0.0; n * n];
    for row in 0..n {
        let (turned, sign) = if row < m {
            (row + m, -1.0)
        } else {
            (row - m, 1.0)
        };
        for (position, column) in pattern.row(row) {
            a[turned * n + column] = sign * entries[position];
        }
    }
    let mut log_norm = 0.0;
    for squarings in 0..=6 {
        let size = (0..n)
            .map(|i| a[i * n..][..n].iter().map(|x| x.abs()).sum())
            .fold(0.0, f64::max);
        if !(size > 0.0 && size.is_finite()) {
            return slow;
        }
        a.iter_mut().for_each(|x| *x /= size);
        log_norm += size.ln() / f64::from(1 << squarings);
        let entry = |i: usize, j: usize| (0..n).map(|k| a[i * n + k] * a[k * n + j]).sum();
        a = (0..n * n).map(|k| entry(k / n, k % n)).collect();
    }
    slow.max(log_norm.exp())
}
