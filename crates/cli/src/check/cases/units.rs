//! The same motion in other units, with a constant added to H, and with steps from 1e-8 to 1e+2 of the
//! period.

use crate::check::case::{BuildFault, Builder, Case, End, Kind, Problem, Reference, Trajectory};
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{Constant, DoubleDouble, Float};
use std::f64::consts::TAU;

/// Scaled numbers round otherwise: 100 steps of 1/16 of Kepler e = 0.6 differ by up to 2.7e-14 (f64) and
/// 8.3e-29 (double-double).
const SAME: Trajectory = Trajectory::Within(1e-11);
const SAME_WIDE: Trajectory = Trajectory::Within(1e-27);

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    kepler(&mut all);
    quartic(&mut all);
    shifted(&mut all);
    steps(&mut all);
    all
}

/// Kepler e = 0.6 in units of length, mass and time that are powers of ten: H = |p|²/(2M) − (L³M/τ²)/|q|.
fn in_units(length: i32, mass: i32, time: i32) -> Result<Problem, BuildFault> {
    // The units are doubles, so that a step is the same in every number type; what follows from them is not
    // rounded to them.
    let unit = |power: i32| DoubleDouble::exact(10.0_f64.powi(power));
    let [length, mass, time] = [length, mass, time].map(unit);
    let momentum = mass * length / time;
    // Products ordered such that none leaves the range.
    let strength = momentum * length / time * length;
    let moment = {
        let length = Constant::from(length);
        Hamiltonian::new(2, |q, p| q[0] / length * p[1] - q[1] / length * p[0])?
    };
    let read = |all: [f64; 2], unit: DoubleDouble| {
        all.map(|x| Constant::from(DoubleDouble::exact(x) * unit))
    };
    let (q, p) = (read([0.4, 0.0], length), read([0.0, 2.0], momentum));
    let (mass, strength) = (Constant::from(mass), Constant::from(strength));
    let h = Hamiltonian::new(2, |q, p| {
        (p[0] / mass * p[0] + p[1] / mass * p[1]) / 2.0 - strength / q[0].hypot(q[1])
    })?;
    Ok(Problem::new(h, &q, &p).keeping("angular momentum", moment))
}

fn kepler(all: &mut Vec<Case>) {
    let row = |k: i32, [l, m, t]: [i32; 3]| {
        let (l, m, t) = (k * l, k * m, k * t);
        let name = format!("Kepler in 1e{l} lengths, 1e{m} masses, 1e{t} times");
        let one: Builder = Box::new(|| in_units(0, 0, 0));
        Case::new(name, move || in_units(l, m, t))
            .steps(100, 10.0_f64.powi(t) / 16.0)
            .against(Reference::Scaled {
                problem: one,
                h: 1.0 / 16.0,
            })
    };
    let units = [
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
        [1, -1, 1],
        [-1, 1, -1],
    ];
    for unit in units {
        all.push(row(100, unit).trajectory(SAME));
    }
    // The low parts of a double-double need room below: squares of 1e-100 have none to spare.
    for unit in units {
        let wide = row(60, unit).double_double().stages(6);
        all.push(wide.trajectory(SAME_WIDE));
    }
}

/// p²/2 + q⁴/4 with amplitude 2^k: H near the largest and the smallest doubles.
fn quartic(all: &mut Vec<Case>) {
    let problem = |k: i32| {
        let energy = |q: &[Var], p: &[Var]| 0.5 * p[0].powi(2) + 0.25 * q[0].powi(4);
        Problem::recorded(energy, &[2.0_f64.powi(k)], &[0.0])
    };
    // Powers of two scale without rounding. H = 2^(4k − 2): 2^1018, 2^-962, and 2^-1062, where doubles are
    // subnormal.
    for k in [255, -240, -265] {
        let one: Builder = Box::new(move || problem(0));
        let name = format!("quartic, H = 2^{}", 4 * k - 2);
        let case = Case::new(name, move || problem(k));
        let case = case.steps(100, 0.1 * 2.0_f64.powi(-k));
        all.push(
            case.against(Reference::Scaled {
                problem: one,
                h: 0.1,
            })
            .trajectory(SAME),
        );
    }
}

/// Kepler with a constant added to H: the same motion, the round-off level of the constant.
fn shifted(all: &mut Vec<Case>) {
    let problem = || {
        let energy = |q: &[Var], p: &[Var]| {
            0.5 * (p[0].powi(2) + p[1].powi(2)) - 1.0 / (q[0].powi(2) + q[1].powi(2)).sqrt() + 1e10
        };
        Problem::recorded(energy, &[0.4, 0.0], &[0.0, 2.0])
    };
    let fine = || Reference::fine(10, 4);
    for (s, n) in [(3, 160), (3, 40), (4, 80), (6, 40)] {
        let case = Case::new("Kepler e=0.6, H + 1e10", problem).stages(s);
        all.push(case.steps(3 * n, TAU / n as f64).against(fine()));
    }
    let dd = Case::new("Kepler e=0.6, H + 1e10", problem).double_double();
    all.push(dd.stages(6).steps(120, TAU / 60.0).against(fine()));
}

/// 100 steps, each a power of ten times the period.
fn steps(all: &mut Vec<Case>) {
    const PENDULUM: f64 = 6.743_001_419_250_385;
    for (name, parameters, period) in [
        ("pendulum p=1", ("pendulum", [("p", "1")]), PENDULUM),
        ("Kepler e=0.6", ("kepler", [("e", "0.6")]), TAU),
    ] {
        let (of, values) = parameters;
        for power in -8..=2 {
            let name = format!("{name}, h = 1e{power} periods");
            let case = Case::scene(name, of, &values);
            let case = case
                .steps(100, period * 10.0_f64.powi(power))
                .against(Reference::Closed);
            all.push(if power < 0 {
                case
            } else {
                case.trajectory(Trajectory::Open("steps of entire periods resolve nothing"))
                    .ending(End::Either(
                        &[
                            Kind::NoConvergence,
                            Kind::Singular,
                            Kind::NotFinite,
                            Kind::Astray,
                        ],
                        "the stage equations of such a step need not have a solution",
                    ))
            });
        }
    }
}
