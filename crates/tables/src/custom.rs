//! [`Custom`]: a function of one variable given as closures.

use crate::error::TableError;
use crate::polynomial::words;
use equip_scalar::{DoubleDouble, Num, Outside, Scalar};
use std::fmt;
use std::sync::Arc;

type Function<T> = Box<dyn Fn(T) -> T + Send + Sync>;

/// A function f of one variable, given as closures for f, f′ and f″. Use it for functions that cannot be
/// written as a composition of operations: an iteration until convergence, a special function, a call into
/// another library.
///
/// The closures are called at every state, possibly from several threads at once. They must return the same
/// value for the same argument. f is used for H, f′ for ∇H, f″ for ∇²H. A third derivative, as in ∇²H of an
/// energy with [`Custom::derivative_at`], is approximated by differences of f″, to some ten digits. Fourth
/// derivatives are NaN.
///
/// In double-double, f(x) is f + f′·(lower word of x), with 16 digits. For 31 digits give closures with
/// [`in_double_double`](Self::in_double_double).
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_tables::Custom;
///
/// let v = Custom::new(|x| -x.cos(), |x| x.sin(), |x| x.cos());
/// v.check(0.7)?;
/// let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + v.at(q[0]))?;
/// let mut gradient = [0.0; 2];
/// h.evaluator().gradient(&[0.7, 0.1], &mut gradient);
/// assert_eq!(gradient, [0.7_f64.sin(), 0.1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Custom {
    closures: Arc<Closures>,
}

impl Custom {
    /// The function with the closures f, f′ and f″.
    pub fn new(
        f: impl Fn(f64) -> f64 + Send + Sync + 'static,
        slope: impl Fn(f64) -> f64 + Send + Sync + 'static,
        curvature: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::of(Closures {
            doubles: Arc::new([Box::new(f), Box::new(slope), Box::new(curvature)]),
            pairs: None,
        })
    }

    /// The same function with closures f, f′ and f″ for double-double.
    ///
    /// ```
    /// use equip_scalar::{DoubleDouble, Num};
    /// use equip_tables::Custom;
    /// let v = Custom::new(|x| -x.cos(), |x| x.sin(), |x| x.cos())
    ///     .in_double_double(|x| -x.cos(), |x| x.sin(), |x| x.cos());
    /// assert_eq!(v.at(Num(DoubleDouble::ONE)).0, -DoubleDouble::ONE.cos());
    /// ```
    pub fn in_double_double(
        self,
        f: impl Fn(DoubleDouble) -> DoubleDouble + Send + Sync + 'static,
        slope: impl Fn(DoubleDouble) -> DoubleDouble + Send + Sync + 'static,
        curvature: impl Fn(DoubleDouble) -> DoubleDouble + Send + Sync + 'static,
    ) -> Self {
        Self::of(Closures {
            doubles: Arc::clone(&self.closures.doubles),
            pairs: Some([Box::new(f), Box::new(slope), Box::new(curvature)]),
        })
    }

    fn of(closures: Closures) -> Self {
        let closures = Arc::new(closures);
        Custom { closures }
    }

    fn outside(&self) -> Arc<dyn Outside> {
        self.closures.clone()
    }

    /// f(x), in an energy: `v.at(q[0])`.
    #[inline]
    pub fn at<S: Scalar>(&self, x: Num<S>) -> Num<S> {
        Num(S::outside(&self.outside(), [0, 0], [x.0, x.0]))
    }

    /// f′(x), in an energy.
    #[inline]
    pub fn derivative_at<S: Scalar>(&self, x: Num<S>) -> Num<S> {
        Num(S::outside(&self.outside(), [1, 0], [x.0, x.0]))
    }

    /// Compares f′ and f″ at x with differences of f and f′, to a relative error of 10⁻⁶. The error of the
    /// differences is smaller, that of a wrong term larger.
    ///
    /// # Errors
    /// [`TableError::WrongDerivative`] with the first derivative that differs.
    ///
    /// ```
    /// use equip_tables::{Custom, TableError};
    /// let wrong = Custom::new(|x| x.sin(), |x| -x.cos(), |x| -x.sin());
    /// assert!(matches!(wrong.check(0.3), Err(TableError::WrongDerivative { order: 1, .. })));
    /// ```
    pub fn check(&self, x: f64) -> Result<(), TableError> {
        let at = |order: u8, x: f64| self.closures.derivative([order, 0], [x, x]);
        for order in [1, 2] {
            let (expected, rounding) = difference(|x| at(order - 1, x), x);
            let given = at(order, x);
            let size = given.abs() + expected.abs();
            if !((given - expected).abs() <= 1e-6 * size + rounding) {
                return Err(TableError::WrongDerivative {
                    order,
                    x,
                    given,
                    expected,
                });
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Custom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.closures.fmt(f)
    }
}

/// f′ by central differences of f over h and 2h, h = ∛ε in units of x or of 1, with the error of order h²
/// removed; and what rounding makes of it.
fn difference(f: impl Fn(f64) -> f64, x: f64) -> (f64, f64) {
    let h = f64::EPSILON.cbrt() * x.abs().max(1.0);
    let [a, b, c, d] = [x - 2.0 * h, x - h, x + h, x + 2.0 * h].map(f);
    let slope = (8.0 * (c - b) - (d - a)) / (12.0 * h);
    (slope, 8.0 * f64::EPSILON * (b.abs() + c.abs()) / h)
}

struct Closures {
    doubles: Arc<[Function<f64>; 3]>,
    pairs: Option<[Function<DoubleDouble>; 3]>,
}

impl fmt::Debug for Closures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Custom")
    }
}

impl Outside for Closures {
    fn variables(&self) -> usize {
        1
    }

    fn derivative(&self, [order, _]: [u8; 2], [x, _]: [f64; 2]) -> f64 {
        match (self.doubles.get(usize::from(order)), order) {
            (Some(f), _) => f(x),
            (None, 3) => difference(&self.doubles[2], x).0,
            _ => f64::NAN,
        }
    }

    fn derivative_in_pairs(&self, [order, _]: [u8; 2], [[hi, lo], _]: [[f64; 2]; 2]) -> [f64; 2] {
        if let Some(f) = self.pairs.as_ref().and_then(|f| f.get(usize::from(order))) {
            return words(f(DoubleDouble::new(hi, lo)));
        }
        let at = |order: u8| self.derivative([order, 0], [hi, hi]);
        let change = if lo == 0.0 { 0.0 } else { at(order + 1) * lo };
        words(DoubleDouble::new(at(order), change))
    }
}
