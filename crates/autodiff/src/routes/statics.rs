//! [`Static`]: the trait route. H is compiled for floats and for dual numbers.
//!
//! The structure comes from recording the same method on a tape. The gradient is the hand-written one if
//! there is one, else in doubles that of dual numbers of fixed length for n = 2m = 2, 4, 6, 8, else that of
//! the recording. The Hessian at a double is num-dual's for n = 2, else the recording's (pendulum 23 and 43
//! ns; from n = 4 on the recording is ten times as fast). Kepler's gradient (n = 4) takes 3.8 ns by hand, 5.4
//! by dual numbers, 4.8 a point by dual numbers over lanes, 52 by the tape.

use crate::derivative::by_duals::{LARGEST, by_length, dual_gradient, hessian, value};
use crate::native::fused::{Forces, Fused, Gradients, Joined, fuse};
use crate::replay::batch::Batch;
use crate::replay::point::{Points, check_batch, check_hessians, require_separable};
use crate::routes::check::{Checked, compare};
use crate::{
    BuildError, Energy, Evaluate, Hamiltonian, Kinetic, Recorded, RecordedEvaluator, Structure,
    Switches, System, WrongGradient,
};
use equip_scalar::{Float, InstructionSet, Num};
use std::sync::Arc;

/// An energy given as a type; made by [`Hamiltonian::from_energy`](crate::Hamiltonian::from_energy).
#[derive(Debug)]
pub struct Static<E> {
    energy: Arc<E>,
    recorded: Recorded,
}

// Not derived: an energy need not be `Clone` to be shared.
impl<E> Clone for Static<E> {
    fn clone(&self) -> Self {
        Static {
            energy: Arc::clone(&self.energy),
            recorded: self.recorded.clone(),
        }
    }
}

impl<E: Energy> Static<E> {
    fn new(energy: E) -> Result<Self, BuildError> {
        let recorded = Recorded::new(energy.degrees_of_freedom(), |q, p| energy.energy(q, p))?;
        Ok(Static {
            energy: Arc::new(energy),
            recorded,
        })
    }

    /// The hand-written gradient, if there is one.
    fn supplied_gradient<T: Float>(&self, y: &[T], gradient: &mut [T]) -> bool {
        supplied(&*self.energy, y, gradient)
    }
}

impl<E: Energy> Hamiltonian<Static<E>> {
    /// Compiles an energy given as a type with one generic method.
    ///
    /// # Errors
    /// [`BuildError`] if the number of degrees of freedom is 0 or too large, or a constant is NaN or
    /// infinite.
    ///
    /// ```
    /// use equip_autodiff::{Energy, Hamiltonian, System};
    /// use equip_scalar::{Num, Scalar};
    ///
    /// struct Oscillator;
    /// impl Energy for Oscillator {
    ///     fn degrees_of_freedom(&self) -> usize {
    ///         1
    ///     }
    ///     fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
    ///         (p[0] * p[0] + q[0] * q[0]) / 2.0
    ///     }
    /// }
    /// assert!(Hamiltonian::from_energy(Oscillator)?.structure().is_quadratic());
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn from_energy(energy: E) -> Result<Self, BuildError> {
        Ok(Hamiltonian {
            route: Static::new(energy)?,
            alone: None,
        })
    }

    /// Compares the hand-written gradient, if there is one, with automatic differentiation at the state
    /// y = (q, p). Components may differ by √ε of the largest one.
    ///
    /// # Errors
    /// [`BuildError::WrongGradient`] names the first component that differs.
    ///
    /// # Panics
    /// If `y` does not have length n = 2m.
    pub fn check_gradient<T: Float>(&self, y: &[T]) -> Result<(), BuildError> {
        let mut given = vec![T::NAN; y.len()];
        let mut expected = given.clone();
        self.route.recorded.evaluator().gradient(y, &mut expected);
        if self.route.supplied_gradient(y, &mut given) {
            Ok(compare(&given, &expected)?)
        } else {
            Ok(())
        }
    }
}

impl<E: Energy> System for Static<E> {
    type Evaluator<T: Float> = StaticEvaluator<E, T>;

    fn structure(&self) -> &Structure {
        self.recorded.structure()
    }

    fn switches(&self) -> Switches {
        self.recorded.switches()
    }

    fn evaluator<T: Float>(&self) -> StaticEvaluator<E, T> {
        let n = 2 * self.structure().degrees_of_freedom;
        let is_supplied = self.supplied_gradient(&vec![T::int(1); n], &mut vec![T::int(0); n]);
        StaticEvaluator {
            route: self.clone(),
            tape: self.recorded.evaluator(),
            points: Points::new(n),
            is_supplied,
            checked: is_supplied.then(|| Checked::new(n)),
            state: vec![Num(T::int(0)); if n > LARGEST { n } else { 0 }],
            set: InstructionSet::best(),
        }
    }
}

/// Evaluates a static energy in the float type `T`.
#[derive(Debug)]
pub struct StaticEvaluator<E, T: Float> {
    route: Static<E>,
    tape: RecordedEvaluator<T>,
    /// Room for states too long for an array.
    state: Vec<Num<T>>,
    points: Points<T>,
    /// The energy brings its own gradient.
    is_supplied: bool,
    /// Room to check it.
    checked: Option<Checked<T>>,
    set: InstructionSet,
}

impl<E, T: Float> Clone for StaticEvaluator<E, T> {
    fn clone(&self) -> Self {
        StaticEvaluator {
            route: self.route.clone(),
            tape: self.tape.clone(),
            state: self.state.clone(),
            points: self.points.clone(),
            is_supplied: self.is_supplied,
            checked: self.checked.clone(),
            set: self.set,
        }
    }
}

impl<E: Energy, T: Float> StaticEvaluator<E, T> {
    #[inline(always)]
    fn check(&self, lengths: &[usize]) {
        let n = 2 * self.route.structure().degrees_of_freedom;
        assert!(
            lengths.iter().all(|&l| l == n),
            "a state of this system has {n} components"
        );
    }

    /// The gradient without H, which costs an evaluation of its own beside a hand-written gradient.
    #[inline(always)]
    fn gradient_only(&mut self, y: &[T], gradient: &mut [T]) {
        if !self.route.supplied_gradient(y, gradient) {
            self.differentiate(y, gradient);
        }
    }

    #[inline(always)]
    fn differentiate(&mut self, y: &[T], gradient: &mut [T]) -> T {
        if by_tape::<T>() {
            return self.tape.gradient(y, gradient);
        }
        let energy = &*self.route.energy;
        by_length!(y, N => dual_gradient::<E, T, N>(energy, y, gradient), {
            self.tape.gradient(y, gradient)
        })
    }
}

impl<E: Energy, T: Float> Evaluate<T> for StaticEvaluator<E, T> {
    #[inline]
    fn value(&mut self, y: &[T]) -> T {
        self.check(&[y.len()]);
        let energy = &*self.route.energy;
        by_length!(y, N => value::<E, T, N>(energy, y), {
            self.state.iter_mut().zip(y).for_each(|(place, &x)| *place = Num(x));
            let (q, p) = self.state.split_at(y.len() / 2);
            energy.energy(q, p).0
        })
    }

    #[inline]
    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.check(&[y.len(), gradient.len()]);
        if self.route.supplied_gradient(y, gradient) {
            self.value(y)
        } else {
            self.differentiate(y, gradient)
        }
    }

    #[inline]
    fn compensated_value(&mut self, y: &[T]) -> T {
        if self.route.recorded.has_long_sums() {
            self.tape.compensated_value(y)
        } else {
            self.value(y)
        }
    }

    #[inline]
    fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        if !self.route.recorded.has_long_sums() {
            return self.gradient(y, gradient);
        }
        self.check(&[y.len(), gradient.len()]);
        if self.route.supplied_gradient(y, gradient) {
            self.tape.compensated_value(y)
        } else {
            self.tape.gradient_with_compensated_value(y, gradient)
        }
    }

    fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        let h = self.gradient_with_compensated_value(y, gradient);
        (h, self.tape.bound(y))
    }

    #[inline]
    fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        self.check(&[n]);
        for (y, gradient) in states.chunks_exact(n).zip(gradients.chunks_exact_mut(n)) {
            self.gradient_only(y, gradient);
        }
    }

    #[inline]
    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let n = 2 * self.route.structure().degrees_of_freedom;
        check_batch(n, [states.len(), gradients.len()], stride, count);
        let energy = &*self.route.energy;
        if self.is_supplied {
            self.points
                .each(states, gradients, stride, count, |y, gradient| {
                    supplied(energy, y, gradient);
                });
        } else if n > LARGEST || by_tape::<T>() {
            self.tape
                .gradients_by_component(states, gradients, stride, count);
        } else if let Some(batch) = Batch::of_doubles(states, gradients, stride, count) {
            match n {
                2 => batch.gradients::<E, 2>(energy),
                4 => batch.gradients::<E, 4>(energy),
                6 => batch.gradients::<E, 6>(energy),
                _ => batch.gradients::<E, 8>(energy),
            }
        } else {
            let mut points = std::mem::take(&mut self.points);
            points.each(states, gradients, stride, count, |y, gradient| {
                self.differentiate(y, gradient);
            });
            self.points = points;
        }
    }

    #[inline]
    fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        let structure = self.route.structure();
        let m = structure.degrees_of_freedom;
        require_separable(structure);
        check_batch(m, [positions.len(), gradients.len()], stride, count);
        let energy = &*self.route.energy;
        if self.is_supplied {
            self.points
                .each(positions, gradients, stride, count, |y, gradient| {
                    supplied(energy, y, gradient);
                });
        } else if 2 * m > LARGEST || by_tape::<T>() {
            self.tape
                .forces_by_component(positions, gradients, stride, count);
        } else if let Some(batch) = Batch::of_doubles(positions, gradients, stride, count) {
            match m {
                1 => batch.forces::<E, 1>(energy),
                2 => batch.forces::<E, 2>(energy),
                3 => batch.forces::<E, 3>(energy),
                _ => batch.forces::<E, 4>(energy),
            }
        } else {
            let mut points = std::mem::take(&mut self.points);
            points.each(positions, gradients, stride, count, |y, gradient| {
                self.differentiate(y, gradient);
            });
            self.points = points;
        }
    }

    #[inline]
    fn fuse_gradients<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let n = 2 * self.route.structure().degrees_of_freedom;
        if self.is_supplied {
            return None;
        }
        let slopes = Gradients(&*self.route.energy);
        fuse!(self.set, n, slopes, task, [2 4])
    }

    #[inline]
    fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let structure = self.route.structure();
        require_separable(structure);
        if self.is_supplied {
            return None;
        }
        let slopes = Forces(&*self.route.energy);
        fuse!(self.set, structure.degrees_of_freedom, slopes, task, [1 2 3 4])
    }

    fn check_gradient(&mut self, y: &[T]) -> Result<(), WrongGradient<T>> {
        let Some(checked) = &mut self.checked else {
            return Ok(());
        };
        checked.at(y, |y, given, expected| {
            supplied(&*self.route.energy, y, given);
            self.tape.gradient(y, expected);
        })
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        self.tape.kinetic()
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        self.set = set;
        self.tape.set_instruction_set(set);
    }

    fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        self.tape.gradient_rounding(y, off);
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.tape.hessian_vector(y, v, product);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        check_hessians(self.route.structure(), [y.len(), entries.len()], 1, 1);
        let to_entries = (&*self.route.structure().hessian, &mut *entries);
        let is_made = T::as_doubles(y).is_some_and(|y| hessian(&*self.route.energy, y, to_entries));
        if !is_made {
            self.tape.hessian(y, entries);
        }
    }

    fn hessians_by_component(
        &mut self,
        states: &[T],
        entries: &mut [T],
        stride: usize,
        count: usize,
    ) {
        self.tape
            .hessians_by_component(states, entries, stride, count);
    }
}

/// Whether the tape over vectors is as good: what an operation costs outweighs what it costs to find it, and
/// the energy is not compiled once more for each set of instructions.
#[inline(always)]
fn by_tape<T: Float>() -> bool {
    T::WIDTH > 1 && !T::IS_DOUBLE
}

#[inline(always)]
fn supplied<E: Energy, T: Float>(energy: &E, y: &[T], gradient: &mut [T]) -> bool {
    let m = y.len() / 2;
    let (q, p) = y.split_at(m);
    let (dq, dp) = gradient.split_at_mut(m);
    energy.gradient(q, p, dq, dp)
}
