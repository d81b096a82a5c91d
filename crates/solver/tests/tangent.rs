//! The tangent map against finite differences, and what it says about chaos.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_scalar::{DoubleDouble, Float};
use equip_solver::{ChaosIndicators, Equip, Gauss, Method, StepView, TangentMap};
use std::ops::ControlFlow;

fn henon_heiles(energy: &str, q2: &str, p2: &str) -> equip_scenes::Instance {
    let values = [("energy", energy), ("q2", q2), ("p2", p2)];
    equip_scenes::find("henon-heiles")
        .unwrap()
        .instance(&values)
        .unwrap()
}

type D = DoubleDouble;

#[test]
fn it_is_the_derivative_of_the_step_map() {
    let scene = henon_heiles("1/8", "-0.1", "0.05");
    let (q, p) = scene.initial::<D>();
    let h = scene.hamiltonian();
    let tiny = D::decimal("1e-10").unwrap();
    let step = D::decimal("0.3").unwrap();
    let steps = 5;
    let end = |method: Method, q: &[D], p: &[D]| {
        let mut run = method.step(step).start(h, q, p, D::int(0)).unwrap();
        for _ in 0..steps {
            run.advance().unwrap();
        }
        [run.view().q, run.view().p].concat()
    };
    for (method, bound) in [(Gauss::stages(3), 1e-18), (Equip::stages(3), 2e-6)] {
        let mut run = method.step(step).start(h, &q, &p, D::int(0)).unwrap();
        let mut tangent = TangentMap::new(h, &mut run);
        let mut columns: Vec<D> = (0..16).map(|i| D::int(i64::from(i % 5 == 0))).collect();
        for _ in 0..steps {
            run.advance().unwrap();
            tangent.carry(&run, &mut columns).unwrap();
        }
        let mut worst = 0.0f64;
        for (j, column) in columns.chunks(4).enumerate() {
            let moved = |by: D| {
                let mut y = [q.as_slice(), &p].concat();
                y[j] += by;
                end(method, &y[..2], &y[2..])
            };
            let (ahead, behind) = (moved(tiny), moved(-tiny));
            for i in 0..4 {
                let difference = (ahead[i] - behind[i]) / (D::int(2) * tiny);
                worst = worst.max((difference - column[i]).abs().to_f64());
            }
        }
        println!("{method}: {worst:.1e}");
        // Gauss: measured 4e-21, the error of the difference. EQUIP: 2.3e-7, what ∂α/∂y adds, of the size of the step's error.
        assert!(worst < bound);
        // Symplectic: Ψᵀ J Ψ = J.
        let form = |a: &[D], b: &[D]| (a[0] * b[2] + a[1] * b[3]) - (a[2] * b[0] + a[3] * b[1]);
        for i in 0..4 {
            for j in 0..4 {
                let exact = i64::from(j == i + 2) - i64::from(i == j + 2);
                let found = form(&columns[4 * i..][..4], &columns[4 * j..][..4]);
                assert!((found - D::int(exact)).abs().to_f64() < 1e-29);
            }
        }
    }
}

/// λ and MEGNO along an orbit of energy 1/8, at the times given.
fn indicators(q2: &str, p2: &str, times: &[f64]) -> Vec<ChaosIndicators<f64>> {
    let scene = henon_heiles("1/8", q2, p2);
    let (q, p) = scene.initial::<f64>();
    let mut seen = Vec::new();
    let mut observe = |view: &StepView<'_, f64>| {
        if times.get(seen.len()).is_some_and(|&t| view.time >= t) {
            seen.extend(view.chaos);
        }
        ControlFlow::Continue(())
    };
    let end = times.last().unwrap();
    let options = Equip::stages(6).tolerance(1e-9).chaos();
    let run = options
        .integrate_observed(scene.hamiltonian(), &q, &p, 0.0..=*end, &mut observe)
        .unwrap();
    assert_eq!(seen.last(), run.certificate().chaos.as_ref());
    assert_eq!(seen.len(), times.len());
    seen
}

#[test]
fn order_and_chaos_of_henon_heiles() {
    // The orbits of the literature on chaos indicators: Skokos, Bountis, Antonopoulos, Geometrical properties of local dynamics in Hamiltonian systems:
    // the Generalized Alignment Index (GALI) method, Physica D 231 (2007), 4.1, and Skokos, The Lyapunov characteristic exponents and their computation,
    // Lect. Notes Phys. 790 (2010): x = 0, y = -0.25, px = 0.42, py = 0, chaotic with a largest exponent of about 0.047. The regular one, also used
    // by the tests of DynamicalSystems.jl, is x = 0, y = 0.483, px = 0.27898, py = 0: quasi-periodic.
    let times = [1e3, 1e4, 1e5];
    let chaotic = indicators("-0.25", "0", &times);
    for (t, x) in times.iter().zip(&chaotic) {
        println!(
            "{t:e}: {:.4}, {:.1}, λt/2 = {:.1}",
            x.lyapunov,
            x.megno,
            x.lyapunov * t / 2.0
        );
    }
    let regular = indicators("0.483", "0", &times[..2]);
    for (t, x) in times.iter().zip(&regular) {
        println!("{t:e}: {:.2e}, {:.3}", x.lyapunov, x.megno);
    }
}
