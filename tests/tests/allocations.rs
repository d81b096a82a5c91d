//! A step allocates nothing: the allocations of this thread are counted.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Alphas, Equip, Gauss, Method};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{double_pendulum, kepler};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn count() {
    // A thread that is being torn down has no counter.
    let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
}

// SAFETY: every request goes to the system allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are those of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of `steps` steps after the first.
fn allocations<T: Float>(method: Method, h: T, steps: usize) -> u64 {
    let (energy, start) = kepler::<T>(6);
    let mut run = method
        .step(h)
        .start(&energy, &start.q, &start.p, T::int(0))
        .unwrap();
    run.advance().unwrap();
    let before = ALLOCATIONS.get();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    ALLOCATIONS.get() - before
}

#[test]
fn the_counter_counts() {
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(vec![1, 2, 3]));
    assert_eq!(ALLOCATIONS.get() - before, 1);
}

#[test]
fn steps_allocate_nothing() {
    for s in [2, 3, 6] {
        for method in [
            Gauss::stages(s),
            Equip::stages(s),
            Equip::stages(s).alphas(Alphas::Last),
            Method::fixed_alpha(s, 0.01),
        ] {
            assert_eq!(allocations(method, 0.05, 200), 0, "{method}");
            assert_eq!(
                allocations(method, DoubleDouble::ratio(1, 20), 20),
                0,
                "{method}"
            );
        }
    }
}

#[test]
fn halved_and_carried_steps_allocate_nothing() {
    let (energy, start) = double_pendulum::<f64>();
    let options = Equip::stages(2).alphas(Alphas::Last).step(0.2);
    let mut run = options.start(&energy, &start.q, &start.p, 0.0).unwrap();
    // What is made at its first use, a costlier preconditioner and the local error, has been made.
    for _ in 0..300 {
        run.advance().unwrap();
    }
    let before = ALLOCATIONS.get();
    for _ in 0..150 {
        run.advance().unwrap();
    }
    assert_eq!(ALLOCATIONS.get() - before, 0);
    assert!(
        run.counts().halvings > 0,
        "the run was meant to be hard: {:?}",
        run.counts()
    );
}
