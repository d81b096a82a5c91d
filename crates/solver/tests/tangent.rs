//! The tangent map against finite differences, and what it says about chaos.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_scalar::{DoubleDouble, Float};
use equip_solver::{Chaos, Equip, Gauss, Method, TangentMap};

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

#[test]
fn order_and_chaos_of_henon_heiles() {
    let indicator = |energy, q2, p2| {
        let scene = henon_heiles(energy, q2, p2);
        let (q, p) = scene.initial::<f64>();
        let h = scene.hamiltonian();
        let options = Equip::stages(6).tolerance(1e-10);
        let mut run = options.start(h, &q, &p, 0.0).unwrap();
        let mut chaos = Chaos::new(h, &mut run, &[1.0, 0.5, -0.3, 0.2]);
        while run.time() < 10_000.0 {
            run.advance().unwrap();
            chaos.see(&run).unwrap();
        }
        (chaos.lyapunov(), chaos.megno())
    };
    // Regular at E = 1/8: measured λ(10⁴) = 6.7e-4, MEGNO 1.92.
    let (lambda, megno) = indicator("1/8", "0.55", "0");
    println!("regular: {lambda:.2e}, {megno:.3}");
    assert!(lambda < 2e-3 && (megno - 2.0).abs() < 0.1);
    // Chaotic at E = 1/8: measured λ(10⁴) = 0.056, MEGNO 280.
    let (lambda, megno) = indicator("1/8", "-0.016", "0");
    println!(
        "chaotic: {lambda:.4}, {megno:.1}, λt/2 = {:.1}",
        lambda * 5_000.0
    );
    assert!((0.03..0.07).contains(&lambda));
    assert!((0.7..1.3).contains(&(megno / (lambda * 5_000.0))));
}
