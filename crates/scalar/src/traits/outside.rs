//! [`Outside`]: an external function of one or two variables, not composed of operations.

use std::fmt::Debug;
use std::sync::Arc;

/// A function f(x) or f(x, y) with its derivatives, such as an interpolated table.
///
/// The function is the same in every number type, and its values depend on its arguments only. It is called
/// at every state. First derivatives are used for ∇H, second derivatives for ∇²H. If a requested derivative
/// has a higher order than those that are known, the result is NaN.
pub trait Outside: Debug + Send + Sync {
    /// Number of variables, 1 or 2.
    fn variables(&self) -> usize;

    /// ∂^(i + j) f/∂xⁱ∂yʲ for `orders` = \[i, j\], at `at` = \[x, y\]. For one variable j = 0, and y is to be
    /// left out of account.
    fn derivative(&self, orders: [u8; 2], at: [f64; 2]) -> f64;

    /// The same in double-double: numbers are unevaluated sums \[upper word, lower word\].
    fn derivative_in_pairs(&self, orders: [u8; 2], at: [[f64; 2]; 2]) -> [f64; 2];

    /// The same at many points, all slices being of one length.
    fn derivatives(&self, orders: [u8; 2], at: [&[f64]; 2], results: &mut [f64]) {
        for ((result, &x), &y) in results.iter_mut().zip(at[0]).zip(at[1]) {
            *result = self.derivative(orders, [x, y]);
        }
    }

    /// All that is needed to make this function again, if it is data: a table is, a closure is not.
    fn to_bytes(&self) -> Option<Vec<u8>> {
        None
    }

    /// First and last value of variable `axis` (0 or 1) for which the function has data; `None` where it has
    /// values for all. Runs end with an error beyond, though [`derivative`](Self::derivative) has numbers
    /// there.
    fn domain(&self, axis: usize) -> Option<[f64; 2]> {
        let _ = axis;
        None
    }

    /// Whether the function is constant between the roots of its [`kinks`](Self::kinks), where its value
    /// jumps: a rounding to integers.
    fn is_step(&self) -> bool {
        false
    }

    /// Functions of the same variables, each of which changes its sign where this one or a derivative of it
    /// jumps.
    fn kinks(&self) -> Vec<Arc<dyn Outside>> {
        Vec::new()
    }
}
