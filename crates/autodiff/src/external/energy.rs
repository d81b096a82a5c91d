//! [`External`]: an energy whose value and gradient are computed by user code, in doubles.
//!
//! If user code computes a potential only, H = Σ_c p_c²/(2 m_c) + U(q). The iteration then has the positions
//! as its only unknowns, and ∇²H takes differences of ∇U alone.

use super::check::{at_or_near, by_differences, largest};
use super::given::{Given, GivenGradient};
use crate::recording::recorder::MOST;
use crate::replay::batch::Batch;
use crate::replay::point::{Points, check_components};
use crate::structure::facts::HessianPattern;
use crate::{BuildError, Kinetic, Structure, WrongGradient};
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
    /// 1/m_c, if user code computes a potential only.
    inverse_masses: Option<Arc<[f64]>>,
    pub(crate) structure: Arc<Structure>,
}

/// T(p) = ½ Σ_c w_c p_c².
fn kinetic(inverse_masses: &[f64], p: &[f64]) -> f64 {
    let terms = inverse_masses.iter().zip(p).map(|(&w, &p)| w * p * p);
    0.5 * terms.sum::<f64>()
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
            inverse_masses: None,
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

    /// The energy Σ_c p_c²/(2 m_c) + U(q), given U and ∇U.
    pub(crate) fn of_potential(
        masses: &[f64],
        accuracy: f64,
        value: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Result<Self, BuildError> {
        let m = masses.len();
        let inverse_masses: Arc<[f64]> = masses.iter().map(|mass| 1.0 / mass).collect();
        let usable = |mass: &f64| mass.is_normal() && (1.0 / mass).is_normal();
        if let Some(component) = masses.iter().position(|mass| !usable(mass)) {
            let mass = masses[component];
            return Err(BuildError::Mass { component, mass });
        }
        let (of_value, of_gradient) = (inverse_masses.clone(), inverse_masses.clone());
        let value = move |q: &[f64], p: &[f64]| kinetic(&of_value, p) + value(q);
        let gradient = move |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
            gradient(q, dq);
            let velocities = dp.iter_mut().zip(p).zip(&*of_gradient);
            velocities.for_each(|((v, &p), &w)| *v = w * p);
        };
        let gradient = GivenGradient(Arc::new(gradient));
        let mut external = External::new(m, accuracy, Arc::new(value), gradient)?;
        external.inverse_masses = Some(inverse_masses);
        external.structure = Arc::new(Structure {
            degrees_of_freedom: m,
            separable: true,
            degree: None,
            degree_in_q: None,
            degree_in_p: Some(2),
            hessian: HessianPattern::of_potential(m),
        });
        Ok(external)
    }
}

/// An external energy with its workspace.
#[derive(Debug, Clone)]
pub(crate) struct ExternalEvaluator<T> {
    pub(crate) of: External,
    pub(crate) given: Given<T>,
    points: Points<T>,
    /// A state near the given one, ∇H there, a vector, and its product with ∇²H.
    point: Vec<T>,
    ahead: Vec<T>,
    unit: Vec<T>,
    product: Vec<T>,
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
            product: Vec::new(),
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
    /// H is unknown, except that of T and U.
    pub(crate) fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        self.given.at(y, gradient);
        let h = self.value(y);
        let terms = y
            .iter()
            .zip(&*gradient)
            .map(|(&y, &derivative)| (y * derivative).abs());
        let of_state = T::exact(f64::EPSILON) * terms.fold(T::int(0), |sum, term| sum + term);
        let (_, p) = self.given.state().split_at(y.len() / 2);
        let t = (self.of.inverse_masses.as_ref()).map_or(0.0, |masses| kinetic(masses, p));
        let of_value = T::exact(self.of.accuracy) * ((h - T::exact(t)).abs() + T::exact(t).abs());
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

    /// The components whose entries are computed by differences: all, or the positions.
    fn differenced(&self) -> usize {
        let m = self.of.structure.degrees_of_freedom;
        match self.of.inverse_masses {
            Some(_) => m,
            None => 2 * m,
        }
    }

    /// The number of gradients for ∇²H at one point.
    pub(crate) fn gradients_of_hessian(&self) -> u64 {
        2 * self.differenced() as u64
    }

    /// T(p), if user code computes a potential only.
    pub(crate) fn kinetic(&self) -> Option<Kinetic<T>> {
        let inverse_masses = self.of.inverse_masses.as_ref()?.iter();
        Some(Kinetic::diagonal_of(inverse_masses.map(|&w| T::exact(w))))
    }

    /// All entries of the pattern, symmetric.
    pub(crate) fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        let (n, len) = (self.differenced(), self.of.structure.hessian.len());
        Batch::one(y, entries).check([2 * self.of.structure.degrees_of_freedom, len]);
        let mut unit = std::mem::take(&mut self.unit);
        let mut product = std::mem::take(&mut self.product);
        unit.clear();
        unit.resize(y.len(), T::int(0));
        product.resize(y.len(), T::int(0));
        let (block, of_momenta) = entries.split_at_mut(n * n);
        for (k, row) in block.chunks_exact_mut(n).enumerate() {
            unit[k] = T::int(1);
            self.hessian_times(y, &unit, &mut product);
            row.copy_from_slice(&product[..n]);
            unit[k] = T::int(0);
        }
        (self.unit, self.product) = (unit, product);
        if let Some(inverse_masses) = &self.of.inverse_masses {
            let pairs = of_momenta.iter_mut().zip(&**inverse_masses);
            pairs.for_each(|(x, &w)| *x = T::exact(w));
        }
        let entries = block;
        for i in 0..n {
            for k in 0..i {
                let mean = (entries[i * n + k] + entries[k * n + i]) / T::int(2);
                (entries[i * n + k], entries[k * n + i]) = (mean, mean);
            }
        }
    }

    pub(crate) fn hessians(&mut self, batch: Batch<T>) {
        let lengths = [
            2 * self.of.structure.degrees_of_freedom,
            self.of.structure.hessian.len(),
        ];
        batch.check(lengths);
        let mut points = std::mem::take(&mut self.points);
        points.each(batch, lengths, |y, entries| self.hessian(y, entries));
        self.points = points;
    }
}
