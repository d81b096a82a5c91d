//! A drive that is faster than the motion.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::Equip;

/// The quadrature of the work of the drive has a larger error than q and p, and α does not carry it to them.
/// With bounds that contain the error of the work the errors are 4 to 20 times as large. Closed form:
/// q = 400/399 cos t + ½ sin t − cos 20t / 399.
#[test]
fn the_error_of_the_work_is_no_bound_for_the_motion() {
    let driven = Hamiltonian::with_time(1, |t, q, p| {
        (p[0] * p[0] + q[0] * q[0]) / 2 - q[0] * (20 * t).cos()
    });
    let driven = driven.unwrap();
    let end = 15.0_f64;
    let exact = (400.0 / 399.0) * end.cos() + 0.5 * end.sin() - (20.0 * end).cos() / 399.0;
    for (s, step, most) in [
        (6, 0.2, 1e-8),
        (8, 0.2, 1e-12),
        (8, 0.4, 3e-8),
        (12, 0.4, 1e-13),
    ] {
        let method = Equip::stages(s).step(step);
        let run = method
            .integrate(&driven, &[1.0], &[0.5], 0.0..=end)
            .unwrap();
        let error = (run.last().1[0] - exact).abs();
        println!("s = {s}, h = {step}: {error:e}");
        assert!(error < most, "s = {s}, h = {step}: {error:e}");
    }
}
