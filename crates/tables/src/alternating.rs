//! [`Alternating`]: a function that changes its sign at every inner knot.
//!
//! Between the knots x_i and x_{i+1}, with h = x_{i+1} − x_i, g = ± 4 (x − x_i)(x_{i+1} − x)/h. Before the
//! second and after the last but one knot, g is linear. g and its derivative, ∓4 at the knots, are
//! continuous. The first and the last knot are not roots, because the polynomials continue there.

use crate::knots::Knots;
use crate::polynomial::{derivative, words};
use equip_scalar::{DoubleDouble, Float, Outside};
use std::sync::Arc;

#[derive(Debug)]
pub(crate) struct Alternating {
    knots: Arc<Knots>,
    /// Which variable it is a function of, and of how many there are.
    axis: usize,
    variables: usize,
}

impl Alternating {
    /// None of a table without inner knots.
    pub(crate) fn of(
        knots: &Arc<Knots>,
        axis: usize,
        variables: usize,
    ) -> Option<Arc<dyn Outside>> {
        let knots = Arc::clone(knots);
        (knots.len() > 2).then(|| {
            Arc::new(Alternating {
                knots,
                axis,
                variables,
            }) as Arc<dyn Outside>
        })
    }

    fn order(&self, orders: [u8; 2]) -> Option<u8> {
        let is_constant = self.variables == 2 && orders[1 - self.axis] > 0;
        (!is_constant).then_some(orders[self.axis])
    }

    /// The derivative at t after knot i, the interval being h wide.
    fn at<T: Float>(&self, i: usize, order: u8, t: T, h: T) -> T {
        let slope = T::int(if i.is_multiple_of(2) { 4 } else { -4 });
        let coefficients = if i == 0 {
            [slope * h, -slope, T::int(0), T::int(0)]
        } else if i + 2 == self.knots.len() {
            [T::int(0), slope, T::int(0), T::int(0)]
        } else {
            [T::int(0), slope, -slope / h, T::int(0)]
        };
        derivative(coefficients, order, t)
    }
}

impl Outside for Alternating {
    fn variables(&self) -> usize {
        self.variables
    }

    fn derivative(&self, orders: [u8; 2], at: [f64; 2]) -> f64 {
        let (Some(order), x) = (self.order(orders), at[self.axis]) else {
            return 0.0;
        };
        let i = self.knots.before(x);
        let [start, end] = [i, i + 1].map(|i| self.knots.pairs[i].hi());
        self.at(i, order, x - start, end - start)
    }

    fn derivative_in_pairs(&self, orders: [u8; 2], at: [[f64; 2]; 2]) -> [f64; 2] {
        let (Some(order), [hi, lo]) = (self.order(orders), at[self.axis]) else {
            return [0.0; 2];
        };
        let x = DoubleDouble::new(hi, lo);
        let i = self.knots.before_pair(x);
        let [start, end] = [i, i + 1].map(|i| self.knots.pairs[i]);
        words(self.at(i, order, x - start, end - start))
    }
}
