//! What is compiled once, with this crate, by [`equip_scalar::ready!`]: what depends on the float type alone, and of recorded energies the step as a
//! whole. What is woven into an energy that is a type is compiled with that.

use crate::error::IntegrateError;
use crate::moves::Moves;
use crate::newton::Newton;
use crate::one_more::OneMore;
use crate::options::StageSolver;
use crate::outcome::Outcome;
use crate::response::Response;
use crate::slopes::Slopes;
use crate::state::State;
use crate::step::Core;
use crate::sweep::Iterate;
use crate::sweep_task::{Rule, SweepTask};
use crate::sweeps::Sweeps;
use equip_autodiff::{Evaluate, HessianPattern, Holds, Kinetic, RecordedEvaluator, Structure};
use equip_scalar::Float;
use equip_tableau::Gauss;
use std::marker::PhantomData;
use std::ops::Range;

/// The functions, each as it is called.
#[rustfmt::skip]
#[allow(clippy::type_complexity)] // Signatures are what they are.
pub(crate) struct Ready<T: Float> {
    pub(crate) step: fn(&mut Recorded<T>, (&State<T>, T, T), &mut State<T>) -> Result<Outcome, IntegrateError<T>>,
    pub(crate) find_springs: fn(&mut Recorded<T>, &Structure, (&[T], T)),
    pub(crate) sweeps: fn((&Gauss<T>, Option<&OneMore<T>>), usize, Option<Kinetic<T>>, &[T], (Rule, &HessianPattern, bool)) -> Sweeps<T>,
    pub(crate) newton: fn(usize, Option<&OneMore<T>>, &Structure, StageSolver, (usize, usize), u32) -> Newton<T>,
    pub(crate) begin: fn(&mut Sweeps<T>, &Gauss<T>, &SweepTask<'_, T>),
    pub(crate) begin_from_nothing: fn(&mut Iterate<T>, &Gauss<T>, (&State<T>, T)),
    pub(crate) foresee: fn(&mut Iterate<T>, &State<T>, bool),
    pub(crate) mix: fn(&mut Iterate<T>, &State<T>) -> T,
    pub(crate) measure: fn(&mut Iterate<T>, &State<T>, Range<usize>),
    pub(crate) keep_momenta: fn(&mut Iterate<T>, &State<T>),
    pub(crate) give_z: fn(&mut Iterate<T>, &State<T>, &mut [T]),
    pub(crate) end_point: fn(&Iterate<T>, &State<T>, &mut State<T>),
    pub(crate) slopes: fn(&mut Slopes<T>, &Iterate<T>, T) -> bool,
    pub(crate) move_alphas: fn(&mut Sweeps<T>, (T, T), &mut Moves<T>, &SweepTask<'_, T>) -> bool,
    pub(crate) solve_forward: fn(&mut Response<T>, &Iterate<T>, T) -> bool,
    pub(crate) solve_back: fn(&mut Response<T>, &Iterate<T>, T) -> bool,
}

/// A core with the evaluator of a recording.
pub(crate) type Recorded<T> = Core<T, RecordedEvaluator<T>>;

impl<T: Float> Ready<T> {
    const HERE: Self = Ready {
        step: Core::make,
        find_springs: Core::look_for_springs,
        sweeps: Sweeps::new,
        newton: Newton::new,
        begin: Sweeps::begin,
        begin_from_nothing: Iterate::begin,
        foresee: Iterate::foresee,
        mix: Iterate::mix,
        measure: Iterate::measure,
        keep_momenta: Iterate::keep_momenta,
        give_z: Iterate::give_z,
        end_point: Iterate::end_point,
        slopes: Slopes::take,
        move_alphas: Sweeps::move_alphas,
        solve_forward: Response::solve_forward,
        solve_back: Response::solve_back,
    };
}

equip_scalar::ready!(Ready);

/// A core with an evaluator of any type.
struct InCore<T>(PhantomData<T>);

impl<'a, T: Float> Holds<'a> for InCore<T> {
    type With<E: 'a> = &'a mut Core<T, E>;
}

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// One step of size `h` from `y` at time `t` into `next`. `y` is not changed, whatever happens.
    pub(crate) fn step(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, IntegrateError<T>> {
        // Constant, so that nothing is compiled for recordings but the call.
        if const { E::IS_RECORDED } {
            (ready::<T>().step)(E::recorded::<InCore<T>>(self), (y, t, h), next)
        } else {
            self.make((y, t, h), next)
        }
    }

    /// The run is made of steps of size `h` and begins at `y`.
    pub(crate) fn find_springs(&mut self, structure: &Structure, start: (&[T], T)) {
        if const { E::IS_RECORDED } {
            (ready::<T>().find_springs)(E::recorded::<InCore<T>>(self), structure, start);
        } else {
            self.look_for_springs(structure, start);
        }
    }
}
