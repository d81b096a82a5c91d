//! Evaluations allocate nothing, but for the first by machine code. The allocator of this program counts, for
//! every thread by itself.

use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float};
use std::alloc::{GlobalAlloc, Layout, System as Platform};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
    /// Bytes allocated, and the most there have been.
    static BYTES: Cell<[isize; 2]> = const { Cell::new([0; 2]) };
}

fn count_bytes(more: isize) {
    BYTES.with(|bytes| {
        let [now, peak] = bytes.get();
        bytes.set([now + more, peak.max(now + more)]);
    });
}

/// The result, and how many bytes more than before were allocated at most on the way to it.
pub(crate) fn peak<R>(of: impl FnOnce() -> R) -> (R, usize) {
    let [before, _] = BYTES.get();
    BYTES.set([before; 2]);
    let result = of();
    let [_, peak] = BYTES.get();
    (result, (peak - before) as usize)
}

// SAFETY: every call is passed on to the platform's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        count_bytes(layout.size() as isize);
        // SAFETY: the caller's obligations are those of this function.
        unsafe { Platform.alloc(layout) }
    }
    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        count_bytes(-(layout.size() as isize));
        // SAFETY: as above.
        unsafe { Platform.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of a second round of calls, after a first.
fn count<T: Float>(h: &Hamiltonian) -> usize {
    let n = 2 * h.degrees_of_freedom();
    let y: Vec<T> = (0..n).map(|i| T::ratio(i as i64 + 1, 7)).collect();
    let (mut gradient, v) = (y.clone(), y.clone());
    let states = [y.clone(), y.clone()].concat();
    let mut gradients = states.clone();
    let batch: Vec<T> = (0..8 * n).map(|i| T::ratio(i as i64 + 1, 9)).collect();
    let mut slopes = batch.clone();
    let mut entries = vec![T::int(0); h.structure().hessian.len()];
    let mut evaluator = h.evaluator::<T>();
    let mut round = || {
        let before = ALLOCATIONS.with(Cell::get);
        evaluator.value(&y);
        evaluator.gradient(&y, &mut gradient);
        evaluator.gradients(&states, &mut gradients, n);
        for (stride, count) in [(8, 8), (4, 3), (5, 5)] {
            let (all, half) = (n * stride, n * stride / 2);
            evaluator.gradients_by_component(&batch[..all], &mut slopes[..all], stride, count);
            if h.structure().separable {
                evaluator.forces_by_component(&batch[..half], &mut slopes[..half], stride, count);
            }
        }
        evaluator.gradient_with_bound(&y, &mut gradient);
        evaluator.hessian_vector(&y, &v, &mut gradient);
        evaluator.hessian(&y, &mut entries);
        ALLOCATIONS.with(Cell::get) - before
    };
    round();
    round()
}

#[test]
fn evaluations_allocate_nothing() {
    let chain = Hamiltonian::new(40, |q, p| {
        let springs = q
            .windows(2)
            .map(|q| (q[1] - q[0]).powf(2.5) + (q[0] * q[1]).sin());
        springs.sum::<Var>() + p.iter().map(|p| p.powi(2)).sum::<Var>()
    })
    .unwrap();
    let supplied = chain.clone().with_gradient(|_, _, dq, dp| {
        dq.fill(1.0);
        dp.fill(2.0);
    });
    let mixed = Hamiltonian::new(2, |q, p| p[0] * q[1] - 1.0 / q[0].hypot(q[1])).unwrap();
    let arithmetic = Hamiltonian::new(12, |q, p| {
        let pairs = q.windows(2).map(|q| 1.0 / (1.0 + q[0] * q[1]).sqrt());
        pairs.sum::<Var>() + p.iter().map(|p| p.powi(2)).sum::<Var>()
    })
    .unwrap();
    let gradient = |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
        dq.copy_from_slice(q);
        dp.copy_from_slice(p);
    };
    let external = Hamiltonian::external(3, f64::EPSILON, |q, p| q[0] + p[0], gradient).unwrap();
    for h in [&chain, &supplied, &mixed, &arithmetic, &external] {
        assert_eq!([count::<f64>(h), count::<DoubleDouble>(h)], [0; 2], "{h:?}");
    }
}
