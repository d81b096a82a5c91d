//! Memory of a chain grows linearly, and steps allocate nothing. The allocator of this program counts, for
//! every thread by itself.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Equip, Gauss, Method, Preconditioner};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static BYTES: Cell<usize> = const { Cell::new(0) };
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

fn count(bytes: usize) {
    // A thread that is being torn down has no counter.
    let _ = BYTES.try_with(|n| n.set(n.get() + bytes));
    let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + 1));
}

// SAFETY: every request goes to the system allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        // SAFETY: the caller's promises are those of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of this thread so far.
pub(crate) fn allocations() -> u64 {
    ALLOCATIONS.get()
}

/// Bytes asked for by the start and `first` steps of a dnls ring, and allocations of the 20 steps after them.
fn ring(sites: &str, method: Method, first: usize) -> (usize, u64) {
    let scene = equip_scenes::find("dnls").unwrap();
    let scene = scene.instance(&[("n", sites)]).unwrap();
    let (q, p) = scene.initial::<f64>();
    let options = method.step(0.1).preconditioner(Preconditioner::Frozen);
    let before = BYTES.get();
    let mut run = options.start(scene.hamiltonian(), &q, &p, 0.0).unwrap();
    for _ in 0..first {
        run.advance().unwrap();
    }
    let bytes = BYTES.get() - before;
    let before = ALLOCATIONS.get();
    for _ in 0..20 {
        run.advance().unwrap();
    }
    (bytes, ALLOCATIONS.get() - before)
}

#[test]
fn memory_of_a_ring_is_linear() {
    // With three stages the energy is solved for in the first steps of every ring.
    for method in [Gauss::stages(4), Equip::stages(3)] {
        let [a, b, c] = ["250", "500", "1000"].map(|n| ring(n, method, 2).0);
        println!("{method}: {a}, {b}, {c} bytes");
        // Everything that was ever asked for, reallocations included: doubling may add one.
        assert!(b < 5 * a / 2 && c < 5 * b / 2);
    }
}

#[test]
fn steps_of_the_dense_path_allocate_nothing() {
    for method in [Gauss::stages(4), Equip::stages(3)] {
        // The local error is made at its first use.
        let (_, allocations) = ring("8", method, 20);
        assert_eq!(allocations, 0, "{method}");
    }
}

#[test]
fn variable_steps_allocate_nothing() {
    let scene = equip_scenes::find("kepler").unwrap();
    let scene = scene.instance(&[("e", "0.9")]).unwrap();
    let (q, p) = scene.initial::<f64>();
    for method in [Gauss::stages(6), Equip::stages(6)] {
        // So little that it is the tolerance that limits the steps, not the contraction of the iterations.
        let options = method.tolerance(1e-14);
        let mut run = options.start(scene.hamiltonian(), &q, &p, 0.0).unwrap();
        // Two revolutions, so that every kind of step has been made once.
        while run.time() < 13.0 {
            run.advance().unwrap();
        }
        let before = ALLOCATIONS.get();
        while run.time() < 30.0 {
            run.advance().unwrap();
        }
        assert_eq!(ALLOCATIONS.get() - before, 0, "{method}");
        let steps = run.certificate().variable_steps.unwrap();
        assert!(steps.rejected + steps.failed > 0);
    }
}
