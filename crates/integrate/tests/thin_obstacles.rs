//! Obstacles, wells and lenses that are much thinner than the steps of free flight: no stage sees them, but a
//! switching function of H changes its sign within the step, or dips towards zero. Right values: parabolas,
//! hyperbolic functions.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Equip, Gauss};

/// From q = 0 with p = 1; something at 50.3, 0.1 to either side.
const CENTRE: f64 = 50.3;
const HALF: f64 = 0.1;
const END: f64 = 100.0;

/// An obstacle in one dimension, and q at the end.
type Obstacle = (&'static str, Hamiltonian, f64);

fn flight(u: impl Fn(Var) -> Var) -> Hamiltonian {
    Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + u(q[0])).unwrap()
}

fn obstacles() -> Vec<Obstacle> {
    let (low, high) = (CENTRE - HALF, CENTRE + HALF);
    // Uphill with force 20: turned back after 0.1.
    let turned = low - (END - low - 0.1);
    // K (q − low)(high − q), as high as four times the energy: q is −½ ch kt + (1/k) sh kt about the centre,
    // out again where tanh(kt/2) = 1/(½k).
    let steep = 2.0 / (HALF * HALF);
    let k = (2.0 * steep).sqrt();
    let smooth = low - (END - low - 2.0 * (1.0 / (k * HALF)).atanh() / k);
    // Down by 2 and up again with force 20, at the speed √5 in the middle.
    let well = high + (END - low - (5.0_f64.sqrt() - 1.0) / 10.0);
    let tent = |q: Var| (1 - (q - CENTRE).abs() / HALF).max(0);
    vec![
        ("wall", flight(|q| 2 * tent(q)), turned),
        ("well", flight(|q| -2 * tent(q)), well),
        (
            "two ramps",
            flight(|q| 20 * (q - low).min(high - q).max(0)),
            turned,
        ),
        (
            "three ramps",
            flight(|q| 20 * ((q - low).max(0) - 2 * (q - CENTRE).max(0) + (q - high).max(0))),
            turned,
        ),
        (
            "a product",
            flight(|q| steep * (q - low).max(0) * (high - q).max(0)),
            smooth,
        ),
        (
            "selected",
            flight(|q| {
                (q - low)
                    .min(high - q)
                    .select(20 * (HALF - (q - CENTRE).abs()), 0)
            }),
            turned,
        ),
        (
            "behind a kink of no account",
            flight(|q| 2 * tent(q) + 1e-15 * (q - 49.0).abs()),
            turned,
        ),
    ]
}

#[test]
fn by_tolerance_nothing_is_passed_unseen() {
    for (name, h, right) in obstacles() {
        for (s, most) in [(2, 200), (4, 60), (8, 40), (12, 40)] {
            for tolerance in [1e-6, 1e-9] {
                for method in [Equip::stages(s), Gauss::stages(s)] {
                    let options = method.tolerance(tolerance);
                    let run = options.integrate(&h, &[0.0], &[1.0], 0.0..=END);
                    let run =
                        run.unwrap_or_else(|e| panic!("{name}, {method}, {tolerance:e}: {e}"));
                    let (q, steps) = (run.last().1[0], run.len() - 1);
                    let error = (q - right).abs();
                    println!("{name}, {method}, {tolerance:e}: {error:.1e}, {steps} steps");
                    assert!(
                        error < 1e3 * tolerance,
                        "{name}, {method}, {tolerance:e}: {q}"
                    );
                    assert!(steps < most);
                }
            }
        }
    }
}

#[test]
fn steps_of_one_size_meet_them_too() {
    for (name, h, right) in obstacles() {
        for s in [2, 8] {
            for step in [25.0, 12.5, 1.0] {
                let options = Equip::stages(s).step(step);
                let run = options.integrate(&h, &[0.0], &[1.0], 0.0..=END);
                let run = run.unwrap_or_else(|e| panic!("{name}, {s}, {step}: {e}"));
                let error = (run.last().1[0] - right).abs();
                println!("{name}, s = {s}, {step}: {error:.1e}");
                // A force that is not constant is met by one step of its own only, kt = 1.1: what two
                // stages make of that turns back, at 0.9 of its speed.
                let most = match (name, s) {
                    ("a product", 2) => 10.0,
                    ("a product", _) => 1e-6,
                    _ => 1e-9,
                };
                assert!(error < most, "{name}, s = {s}, {step}: {error:e}");
            }
        }
    }
}

/// Up to three tents anywhere on the way, of any width: a run by tolerance ends where one of short steps
/// ends.
#[test]
fn tents_anywhere() {
    for seed in 0..80 {
        let mut drawn = 100 * seed;
        let mut draw = |low: f64, high: f64| {
            drawn += 1;
            low + (high - low) * (f64::from(drawn) * 0.618_033_988_75).fract()
        };
        let tents: Vec<[f64; 3]> = (0..1 + seed % 3)
            .map(|_| {
                let (centre, half) = (draw(20.0, 80.0), 10.0_f64.powf(draw(-2.0, 0.5)));
                let heights = [2.0, -2.0, 0.2, 4.0];
                [centre, half, heights[draw(0.0, 3.99) as usize]]
            })
            .collect();
        let h = flight(|q| {
            let tent = |&[centre, half, height]: &[f64; 3]| {
                height * (1 - (q - centre).abs() / half).max(0)
            };
            tents.iter().map(tent).sum()
        });
        let end = |s: usize, most: f64| {
            let options = Equip::stages(s).tolerance(1e-9).max_step(most);
            let run = options.integrate(&h, &[0.0], &[1.0], 0.0..=END).unwrap();
            run.last().1[0]
        };
        let right = end(3, 0.01);
        for s in [2, 4, 8, 12] {
            let error = (end(s, f64::INFINITY) - right).abs();
            println!("{tents:?}, s = {s}: {error:.1e}");
            assert!(error < 1e-5, "{tents:?}, s = {s}: {error:e}");
        }
    }
}

/// A lens of radius 0.1 that pushes outward, ½k²(w² − r²) within, passed at a distance from its centre. Its
/// switching function r − w is smooth, and positive at all stages.
#[test]
fn a_thin_lens_in_two_dimensions() {
    let (w, k) = (HALF, 6.0_f64);
    for impact in [0.0, 0.03, 0.08, 0.0999] {
        let h = Hamiltonian::new(2, |q, p| {
            let (x, y) = (q[0] - CENTRE, q[1] - impact);
            let r = (x * x + y * y).sqrt().min(w);
            (p[0] * p[0] + p[1] * p[1] + k * k * (w * w - r * r)) / 2
        });
        let (h, x) = (h.unwrap(), -(w * w - impact * impact).sqrt());
        // r = r0 ch kt + v0/k sh kt comes out again where tanh kt = −2B/(A + C), r² = A ch² + 2B ch sh + C
        // sh².
        let (a, b, c) = (w * w, x / k, 1.0 / (k * k));
        let kt = (-2.0 * b / (a + c)).atanh();
        let (ch, sh) = (kt.cosh(), kt.sinh());
        let (out, speed) = (
            [x * ch + sh / k, -impact * ch],
            [k * x * sh + ch, -impact * k * sh],
        );
        let left = END - (CENTRE + x) - kt / k;
        let right = [
            CENTRE + out[0] + left * speed[0],
            impact + out[1] + left * speed[1],
        ];
        for s in [2, 4, 8] {
            for tolerance in [1e-6, 1e-9] {
                let options = Equip::stages(s).tolerance(tolerance);
                let run = options
                    .integrate(&h, &[0.0; 2], &[1.0, 0.0], 0.0..=END)
                    .unwrap();
                let (_, q, _) = run.last();
                let error = (q[0] - right[0]).abs().max((q[1] - right[1]).abs());
                println!("impact {impact}, s = {s}, {tolerance:e}: {error:.1e}");
                // Grazing flight magnifies what it is off by 1/√(w² − impact²) and the length of the way.
                assert!(
                    error < 1e5 * tolerance,
                    "{impact}, {s}, {tolerance:e}: {q:?} {right:?}"
                );
            }
        }
    }
}
