//! The functions that depend on the float type alone, compiled once with this crate for `f64` and
//! double-double ([`equip_scalar::ready!`]).

use crate::convergence::again::Series;
use crate::extrapolation::polynomial::Polynomial;
use crate::iterate::iterate::Iterate;
use crate::layout::state::State;
use equip_autodiff::{Evaluator, Kinetic};
use equip_scalar::Float;
use equip_tableau::Coefficients;
use std::ops::Range;

/// The functions by name.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
pub(crate) struct Ready<T: Float> {
    pub(crate) new: fn(&Coefficients<T>, usize, Option<Kinetic<T>>, &[T]) -> Iterate<T>,
    pub(crate) at_zero: fn(&mut Iterate<T>, &Coefficients<T>, (&State<T>, T)),
    pub(crate) from_polynomial: fn(&mut Iterate<T>, &Coefficients<T>, (&State<T>, T, T), &Polynomial<T>, Option<&[T]>),
    pub(crate) polynomial: fn(&mut Polynomial<T>, equip_scalar::InstructionSet, [T; 3], bool),
    pub(crate) iterate: fn(&mut Iterate<T>, &mut Evaluator<T>, &State<T>, &mut Series<'_>) -> f64,
    pub(crate) mix: fn(&mut Iterate<T>, &State<T>) -> f64,
    pub(crate) measure: fn(&mut Iterate<T>, &State<T>, Range<usize>),
    pub(crate) make_momenta: fn(&mut Iterate<T>, &State<T>),
    pub(crate) correct: fn(&mut Iterate<T>),
    pub(crate) advance: fn(&Iterate<T>, &State<T>, &mut State<T>),
    pub(crate) fill_k: fn(&mut Iterate<T>, &Coefficients<T>, &[T]),
    pub(crate) keep_z: fn(&mut Iterate<T>),
    pub(crate) add_kept: fn(&mut Iterate<T>, &State<T>) -> f64,
    pub(crate) place: fn(&mut Iterate<T>, &State<T>),
    pub(crate) stages: fn(&mut Iterate<T>, &Coefficients<T>, (&State<T>, T), (&[T], &[T])),
}

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        new: Iterate::new,
        at_zero: Iterate::begin_at_zero,
        from_polynomial: Iterate::begin_from_polynomial,
        polynomial: Polynomial::make,
        iterate: Iterate::iterate,
        mix: Iterate::mix,
        measure: Iterate::measure,
        make_momenta: Iterate::make_momenta,
        correct: Iterate::correct_increments,
        advance: Iterate::advance,
        fill_k: Iterate::fill_k,
        keep_z: Iterate::keep_z,
        add_kept: Iterate::add_kept,
        place: Iterate::place,
        stages: Iterate::take_stages,
    };
}

equip_scalar::ready!(Ready);
