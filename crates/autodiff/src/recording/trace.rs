//! [`Trace`]: the scalar type that traces operations.

use crate::BuildError;
use crate::recording::op::Op;
use crate::recording::recorder::{self, MOST, Recorder};
use equip_scalar::{Attempt, Constant, Num, Outside, Recording, Scalar};
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::panic::Location;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// The variable of an energy closure: see [`Num`] for its functions.
///
/// ```
/// use equip_autodiff::{Hamiltonian, Var};
/// fn kinetic(p: &[Var]) -> Var {
///     p.iter().map(|p| p.powi(2)).sum::<Var>() / 2.0
/// }
/// let oscillator = Hamiltonian::new(1, |q, p| kinetic(p) + q[0].powi(2) / 2.0)?;
/// # Ok::<(), equip_autodiff::BuildError>(())
/// ```
pub type Var = Num<Trace>;

/// An index into the trace of this thread.
#[derive(Debug, Clone, Copy)]
pub struct Trace {
    recording: u32,
    node: u32,
}

impl Trace {
    fn new(recording: u32, node: u32) -> Self {
        Trace { recording, node }
    }
}

/// The trace number of a variable created outside a trace.
const NOWHERE: u32 = 0;

thread_local! {
    /// The traces in progress. There may be several, since an energy may build another Hamiltonian.
    static RECORDERS: RefCell<Vec<Recorder>> = const { RefCell::new(Vec::new()) };
}

/// Removes the recorder of a trace, even if the energy panics.
struct Guard;

impl Drop for Guard {
    fn drop(&mut self) {
        RECORDERS.with_borrow_mut(Vec::pop);
    }
}

/// Calls the energy once with m positions and m momenta.
pub(crate) fn record(
    m: usize,
    energy: impl FnOnce(&[Var], &[Var]) -> Var,
) -> Result<recorder::Recording, BuildError> {
    let (id, y) = begin(m)?;
    let guard = Guard;
    let Num(result) = energy(&y[..m], &y[m..]);
    std::mem::forget(guard);
    end(id, result)
}

fn begin(m: usize) -> Result<(u32, Vec<Var>), BuildError> {
    static LAST: AtomicU32 = AtomicU32::new(NOWHERE);
    if m == 0 {
        return Err(BuildError::NoDegreesOfFreedom);
    }
    if m > MOST {
        return Err(BuildError::TooManyDegreesOfFreedom { m });
    }
    let id = LAST.fetch_add(1, Ordering::Relaxed).wrapping_add(1).max(1);
    let variable = |node| Trace::new(id, node);
    RECORDERS.with_borrow_mut(|stack| stack.push(Recorder::new(id, 2 * m)));
    Ok((
        id,
        (0..2 * m as u32).map(|node| Num(variable(node))).collect(),
    ))
}

fn end(id: u32, result: Trace) -> Result<recorder::Recording, BuildError> {
    let recorder = RECORDERS
        .with_borrow_mut(Vec::pop)
        .ok_or(BuildError::ForeignVariable)?;
    match recorder.refusal {
        Some((Attempt::Comparison, location)) => return Err(BuildError::Branch { location }),
        Some((Attempt::ReadOut, location)) => return Err(BuildError::ReadOut { location }),
        None => {}
    }
    if recorder.overflow {
        return Err(BuildError::TooManyOperations);
    }
    if recorder.foreign || result.recording != id {
        return Err(BuildError::ForeignVariable);
    }
    Ok(recorder.finish(result.node))
}

/// Appends to the innermost trace. An operand of another trace is an error at its end.
fn append(operands: &[Trace], f: impl FnOnce(&mut Recorder) -> u32) -> Trace {
    RECORDERS.with_borrow_mut(|stack| match stack.last_mut() {
        Some(recorder) if operands.iter().all(|x| x.recording == recorder.id) => {
            Trace::new(recorder.id, f(recorder))
        }
        Some(recorder) => {
            recorder.foreign = true;
            Trace::new(recorder.id, 0)
        }
        None => Trace::new(NOWHERE, 0),
    })
}

fn unary(op: Op, x: Trace) -> Trace {
    binary(op, x, x)
}

fn binary(op: Op, x: Trace, y: Trace) -> Trace {
    append(&[x, y], |recorder| recorder.apply(op, x.node, y.node))
}

impl Recording for Trace {
    fn refuse(attempt: Attempt, location: &'static Location<'static>) {
        RECORDERS.with_borrow_mut(|stack| {
            if let Some(recorder) = stack.last_mut() {
                recorder.refuse(attempt, location);
            }
        });
    }
}

macro_rules! operators {
    ($($op:ident $f:ident),*) => {$(
        impl $op for Trace {
            type Output = Trace;
            fn $f(self, other: Trace) -> Trace {
                binary(Op::$op, self, other)
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Trace {
    type Output = Trace;
    fn neg(self) -> Trace {
        unary(Op::Neg, self)
    }
}

macro_rules! unary {
    ($($f:ident $op:ident),*) => {$(
        fn $f(x: Trace) -> Trace {
            unary(Op::$op, x)
        }
    )*};
}

macro_rules! binary {
    ($($f:ident $op:ident),*) => {$(
        fn $f(x: Trace, y: Trace) -> Trace {
            binary(Op::$op, x, y)
        }
    )*};
}

impl Scalar for Trace {
    fn constant(c: Constant) -> Trace {
        append(&[], |recorder| recorder.constant(c))
    }

    fn powi(x: Trace, n: i32) -> Trace {
        unary(Op::Powi(n), x)
    }

    fn powf(x: Trace, c: Constant) -> Trace {
        append(&[x], |recorder| recorder.powf(x.node, c))
    }

    fn powf_derivative(x: Trace, power: Trace, c: Constant) -> Trace {
        append(&[x, power], |recorder| {
            recorder.powf_derivative(x.node, power.node, c)
        })
    }

    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], x: [Trace; 2]) -> Trace {
        append(&x, |recorder| {
            recorder.outside(f, orders, x.map(|x| x.node))
        })
    }

    unary!(
        cbrt Cbrt, exp2 Exp2, asinh Asinh, acosh Acosh, atanh Atanh, erf Erf, erfc Erfc, signum Sign,
        recip Recip, sqrt Sqrt, exp Exp, ln Ln, exp_m1 ExpM1, ln_1p Ln1p, sin Sin, cos Cos, tan Tan,
        asin Asin, acos Acos, atan Atan, sinh Sinh, cosh Cosh, tanh Tanh, abs Abs
    );
    binary!(
        pow Pow, atan2 Atan2, hypot Hypot, min Min, max Max, at_most AtMost,
        where_nonzero WhereNonzero
    );
}
