//! A size to begin with, before there is a step to judge by.
//!
//! With f = J∇H and f' = J∇²H f at the start: 1/10 of the shorter of the times in which the state would move
//! by its own size, |y|/|f| and √(|y|/|f'|), for positions and momenta apart. The first step is then tried at
//! longer or shorter sizes until its error fits, so that the factor does not matter.

use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// Workspace for it.
#[derive(Debug)]
pub(crate) struct FirstSize<T> {
    slope: Vec<T>,
    f: Vec<T>,
    second: Vec<T>,
}

impl<T: Float> FirstSize<T> {
    pub(crate) fn new(n: usize) -> Self {
        let zeros = || vec![T::int(0); n];
        FirstSize {
            slope: zeros(),
            f: zeros(),
            second: zeros(),
        }
    }

    /// Size of the first try from `y`; 1 where nothing moves.
    pub(crate) fn size<E: Evaluate<T>>(&mut self, energy: &mut E, y: &[T]) -> f64 {
        let n = y.len();
        let FirstSize { slope, f, second } = self;
        energy.gradient(y, slope);
        turn(slope, f);
        energy.hessian_vector(y, f, slope);
        turn(slope, second);
        let half = n / 2;
        let mut least = f64::INFINITY;
        for group in [0..half, half..n] {
            let norm = |x: &[T]| {
                group
                    .clone()
                    .fold(0.0, |a: f64, j| a.max(x[j].abs().to_f64()))
            };
            let (size, f, second) = (norm(y), norm(f), norm(second));
            if size > 0.0 {
                least = least.min(size / f).min((size / second).sqrt());
            } else if f > 0.0 {
                least = least.min(f / second);
            }
        }
        if least > 0.0 && least.is_finite() {
            least / 10.0
        } else {
            1.0
        }
    }
}

/// out = J `x`.
pub(crate) fn turn<T: Float>(x: &[T], out: &mut [T]) {
    let m = x.len() / 2;
    for j in 0..m {
        out[j] = x[m + j];
        out[m + j] = -x[j];
    }
}
