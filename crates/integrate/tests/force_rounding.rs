//! Forces that are known to few digits, as of stiff springs near their length and far from the origin.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Equip, Gauss, Run};

/// Three bodies in a plane, `far` from the origin.
fn three_bodies(far: f64) -> (Hamiltonian, [f64; 6], [f64; 6]) {
    let energy = Hamiltonian::new(6, |q, p| {
        let inverse = |i: usize, j: usize| {
            let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
            1.0 / (x * x + y * y).sqrt()
        };
        let potential = inverse(0, 1) + inverse(0, 2) + inverse(1, 2);
        0.5 * p.iter().map(|&p| p * p).sum::<Var>() - potential
    });
    let q = [0.0, 0.0, 1.0, 0.125, 0.375, 5.0].map(|x| far + x);
    (energy.unwrap(), q, [0.0, 0.7, 0.0, -0.7, 0.3, 0.0])
}

fn apart(a: &Run<f64>, b: &Run<f64>) -> f64 {
    let ((_, q, p), (_, r, s)) = (a.last(), b.last());
    let pairs = q.iter().chain(p).zip(r.iter().chain(s));
    pairs.fold(0.0, |most, (x, y)| most.max((x - y).abs()))
}

/// Where the last place of the state moves a force by more than the tolerance of the motion, nothing is
/// resolved by shorter steps: bodies 10⁸ from the origin take no more of them than at it, but for 20, and a
/// stiff spring that hangs at its length at most two for each radian of its swings.
#[test]
fn forces_that_are_rounding_shorten_no_steps() {
    let spring = Hamiltonian::new(2, |q, p| {
        let stretch = (q[0] * q[0] + q[1] * q[1]).sqrt() - 1.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 5e5 * stretch * stretch + q[1]
    });
    let spring = spring.unwrap();
    let equal =
        Gauss::stages(12)
            .step(5e-4)
            .integrate(&spring, &[1.0, 0.0], &[0.0, 0.0], 0.0..=2.0);
    let by_equal_steps = equal.unwrap();
    for (s, tolerance) in [(4, 1e-9), (4, 1e-12), (8, 1e-9), (8, 1e-12), (8, 1e-14)] {
        let method = Equip::stages(s).tolerance(tolerance).max_steps(5000);
        let [near, far] = [0.0, 1e8].map(|far| {
            let (energy, q, p) = three_bodies(far);
            let run = method.integrate(&energy, &q, &p, 0.0..=10.0).unwrap();
            let (_, q, _) = run.last();
            let places: Vec<f64> = q.iter().map(|x| x - far).collect();
            (run.certificate().counts.steps, places)
        });
        assert!(
            far.0 <= near.0 + 20,
            "s = {s}, {tolerance:e}: {} steps, {}",
            far.0,
            near.0
        );
        for (far, near) in far.1.iter().zip(&near.1) {
            assert!(
                (far - near).abs() < 1e-5,
                "s = {s}, {tolerance:e}: {far}, {near}"
            );
        }
        let run = method.integrate(&spring, &[1.0, 0.0], &[0.0, 0.0], 0.0..=2.0);
        let run = run.unwrap();
        let (steps, off) = (run.certificate().counts.steps, apart(&run, &by_equal_steps));
        assert!(steps <= 4000, "s = {s}, {tolerance:e}: {steps} steps");
        assert!(off < 1e-9, "s = {s}, {tolerance:e}: {off:e}");
    }
}
