//! [`External`]: an energy whose value and gradient are computed by user code, in doubles.

use super::check::{at_or_near, by_differences, largest};
use super::given::{Given, GivenGradient};
use crate::recording::recorder::MOST;
use crate::replay::batch::Batch;
use crate::replay::point::{Points, check_components};
use crate::structure::facts::HessianPattern;
use crate::{BuildError, Structure, WrongGradient};
use equip_scalar::Float;
use std::fmt;
use std::sync::Arc;

type Value = dyn Fn(&[f64], &[f64]) -> f64 + Send + Sync;

/// H as a function of (q, p) without a trace: C code, an interpolator, a learned energy.
#[derive(Clone)]
pub(crate) struct External {
    value: Arc<Value>,
    /// The relative rounding error of the value.
    accuracy: f64,
    pub(crate) gradient: GivenGradient,
    pub(crate) structure: Arc<Structure>,
}

impl fmt::Debug for External {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mut shown = f.debug_struct("External");
        shown.field("accuracy", &self.accuracy);
        shown.field("structure", &self.structure).finish()
    }
}

impl External {
    pub(crate) fn new(
        m: usize,
        accuracy: f64,
        value: Arc<Value>,
        gradient: GivenGradient,
    ) -> Result<Self, BuildError> {
        if m == 0 {
            return Err(BuildError::NoDegreesOfFreedom);
        }
        if m > MOST {
            return Err(BuildError::TooManyDegreesOfFreedom { m });
        }
        if !(f64::EPSILON..1.0).contains(&accuracy) {
            return Err(BuildError::Accuracy { accuracy });
        }
        Ok(External {
            value,
            accuracy,
            gradient,
            structure: Arc::new(Structure {
                degrees_of_freedom: m,
                separable: false,
                degree: None,
                degree_in_q: None,
                degree_in_p: None,
                hessian: HessianPattern::full(2 * m),
            }),
        })
    }
}

/// An external energy with its workspace.
#[derive(Debug, Clone)]
pub(crate) struct ExternalEvaluator<T> {
    pub(crate) of: External,
    pub(crate) given: Given<T>,
    points: Points<T>,
    /// A state near the given one, ∇H there, and a vector.
    point: Vec<T>,
    ahead: Vec<T>,
    unit: Vec<T>,
}

impl<T: Float> ExternalEvaluator<T> {
    pub(crate) fn new(of: &External) -> Self {
        ExternalEvaluator {
            of: of.clone(),
            given: Given::new(&of.gradient, 2 * of.structure.degrees_of_freedom),
            points: Points::default(),
            point: Vec::new(),
            ahead: Vec::new(),
            unit: Vec::new(),
        }
    }

    fn check(&self, lengths: &[usize]) {
        check_components(2 * self.of.structure.degrees_of_freedom, lengths);
    }

    pub(crate) fn value(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let (q, p) = self.given.in_doubles(y).split_at(y.len() / 2);
        T::exact((self.of.value)(q, p))
    }

    /// The bound covers the rounding of the value and the effect of rounding y. Cancellation of terms within
    /// H is unknown.
    pub(crate) fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        self.given.at(y, gradient);
        let h = self.value(y);
        let terms = y
            .iter()
            .zip(&*gradient)
            .map(|(&y, &derivative)| (y * derivative).abs());
        let of_state = T::exact(f64::EPSILON) * terms.fold(T::int(0), |sum, term| sum + term);
        let of_value = T::exact(self.of.accuracy) * h.abs();
        (h, (of_value + of_state) / T::EPSILON)
    }

    /// Compares the gradient with differences of H.
    pub(crate) fn check_gradient(&mut self, y: &[T]) -> Result<(), WrongGradient<T>> {
        let mut given = vec![T::int(0); y.len()];
        at_or_near(y, |y| {
            let (_, bound) = self.gradient_with_bound(y, &mut given);
            by_differences(y, (&given, bound), self.of.accuracy, |y| self.value(y))
        })
    }

    /// The accuracy, relative to the largest component of ∂H/∂q and of ∂H/∂p: matrix products and Fourier
    /// transforms round in proportion to that.
    pub(crate) fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        self.given.at(y, off);
        for half in off.chunks_exact_mut(y.len() / 2) {
            half.fill(T::exact(self.of.accuracy) * largest(half));
        }
    }

    /// By central differences of the gradient. Positions and momenta have different units: neither changes by
    /// more than ε^{1/3} of its largest component.
    pub(crate) fn hessian_times(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.check(&[y.len(), v.len(), product.len()]);
        let (zero, one) = (T::int(0), T::int(1));
        let m = y.len() / 2;
        let rates = y.chunks_exact(m).zip(v.chunks_exact(m)).map(|(y, v)| {
            let of = largest(y);
            largest(v) / if of > zero { of } else { one }
        });
        let rate = rates.fold(zero, |most, rate| most.max(rate));
        if rate == zero {
            return product.fill(zero);
        }
        let delta = T::exact(f64::EPSILON.cbrt()) / rate;
        self.point.resize(y.len(), zero);
        self.ahead.resize(y.len(), zero);
        for (delta, gradient) in [(delta, &mut self.ahead[..]), (-delta, &mut *product)] {
            for ((point, &y), &v) in self.point.iter_mut().zip(y).zip(v) {
                *point = y + delta * v;
            }
            self.given.at(&self.point, gradient);
        }
        for (product, &ahead) in product.iter_mut().zip(&self.ahead) {
            *product = (ahead - *product) / (T::int(2) * delta);
        }
    }

    /// All n² entries, symmetric.
    pub(crate) fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        let n = y.len();
        Batch::one(y, entries).check([n, n * n]);
        let mut unit = std::mem::take(&mut self.unit);
        unit.clear();
        unit.resize(n, T::int(0));
        for (k, row) in entries.chunks_exact_mut(n).enumerate() {
            unit[k] = T::int(1);
            self.hessian_times(y, &unit, row);
            unit[k] = T::int(0);
        }
        self.unit = unit;
        for i in 0..n {
            for k in 0..i {
                let mean = (entries[i * n + k] + entries[k * n + i]) / T::int(2);
                (entries[i * n + k], entries[k * n + i]) = (mean, mean);
            }
        }
    }

    pub(crate) fn hessians(&mut self, batch: Batch<T>) {
        let n = 2 * self.of.structure.degrees_of_freedom;
        batch.check([n, n * n]);
        let mut points = std::mem::take(&mut self.points);
        points.each(batch, [n, n * n], |y, entries| self.hessian(y, entries));
        self.points = points;
    }
}
