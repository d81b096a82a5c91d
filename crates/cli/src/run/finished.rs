//! [`Finished`]: a run with what was found out about it afterwards.

use equip_integrate::{IntegrateError, Run};
use equip_scalar::Float;
use equip_scenes::Instance;

/// A run with what was found out about it afterwards.
#[derive(Debug)]
pub(crate) struct Finished<'a, T: Float> {
    pub(crate) instance: &'a Instance,
    pub(crate) run: Run<T>,
    pub(crate) end_error: Option<EndError<T>>,
    pub(crate) error: Option<IntegrateError<T>>,
}

/// Largest error of a component of q and of p at the end.
#[derive(Debug)]
pub(crate) struct EndError<T> {
    pub(crate) against: String,
    pub(crate) q: T,
    pub(crate) p: T,
}

/// The error of the last state against the stored reference or the closed form, where there is one for its
/// time.
pub(crate) fn end_error<T: Float>(instance: &Instance, run: &Run<T>) -> Option<EndError<T>> {
    let (t, q, p) = run.last();
    let reference = instance
        .reference()
        .filter(|r| (r.end::<T>() - t).abs() <= T::int(4) * T::EPSILON * t.abs());
    let (against, (q_exact, p_exact)) = match reference {
        Some(reference) => (
            format!("reference {}", reference.name()),
            reference.state::<T>(),
        ),
        None => ("the closed form".to_owned(), instance.exact(t)?),
    };
    Some(EndError {
        against,
        q: largest_difference(q, &q_exact),
        p: largest_difference(p, &p_exact),
    })
}

/// The largest difference of two components.
pub(crate) fn largest_difference<T: Float>(found: &[T], exact: &[T]) -> T {
    let differences = found.iter().zip(exact).map(|(&x, &y)| (x - y).abs());
    differences.fold(T::int(0), |most, x| most.max(x))
}
