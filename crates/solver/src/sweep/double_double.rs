//! Sweeps in double-double, compiled here once: as generic code they would be compiled, for every set of instructions, in each crate that
//! makes runs in double-double, which takes minutes.

use super::Form;
use crate::draft::Draft;
use crate::half::Half;
use crate::whole::Whole;
use equip_scalar::{DoubleDouble, Float, InstructionSet};

/// The linear half of a sweep; `None` if T is not `DoubleDouble`.
pub(super) fn run<T: Float>(set: InstructionSet, form: Form<'_, T>) -> Option<f64> {
    Some(match form {
        Form::Whole(task) => whole(set, &mut task.in_double_doubles()?),
        Form::Half(task) => half(set, &mut task.in_double_doubles()?),
        Form::Draft(task) => draft(set, &mut task.in_double_doubles()?),
    })
}

fn whole(set: InstructionSet, task: &mut Whole<'_, DoubleDouble>) -> f64 {
    set.run(task).to_f64()
}

fn half(set: InstructionSet, task: &mut Half<'_, DoubleDouble>) -> f64 {
    set.run(task).to_f64()
}

fn draft(set: InstructionSet, task: &mut Draft<'_, DoubleDouble>) -> f64 {
    set.run(task).to_f64()
}
