//! Close encounters: Kepler ellipses near a line, three bodies, the Moon passed at 0.006, a fall into the
//! centre.

use crate::check::case::{BuildFault, Case, End, Kind, Problem, Reference, Trajectory};
use equip_autodiff::Var;
use std::f64::consts::TAU;

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    kepler(&mut all);
    arenstorf(&mut all);
    pythagorean(&mut all);
    fall(&mut all);
    all
}

/// Steps a period that are too few for the pericentre, and enough.
fn kepler(all: &mut Vec<Case>) {
    let sizes = [
        ("0.9", 60, 600),
        ("0.99", 500, 10_000),
        ("0.999", 2000, 100_000),
    ];
    for (e, few, enough) in sizes {
        let name = format!("Kepler e={e}");
        let case = |s: usize, n: u64, periods: u64| {
            Case::scene(name.clone(), "kepler", &[("e", e)])
                .stages(s)
                .steps(periods * n, TAU / n as f64)
                .against(Reference::Closed)
        };
        for s in [3, 4, 6] {
            let coarse =
                case(s, few, if e == "0.999" { 1 } else { 5 }).trajectory(Trajectory::Open(
                    "steps too large for the pericentre: no method here follows the orbit",
                ));
            all.push(if e == "0.999" {
                let why = "the first step is 100 times as long as the pericentre passage";
                let kinds = &[
                    Kind::NoConvergence,
                    Kind::NotFinite,
                    Kind::Singular,
                    Kind::Astray,
                ];
                coarse.ending(End::Either(kinds, why))
            } else {
                coarse
            });
            // Two: what follows a pericentre is harder than what leads to the first.
            let periods = 2;
            all.push(case(s, enough, periods).quick(enough <= 10_000));
        }
    }
    let dd = Case::scene("Kepler e=0.9", "kepler", &[("e", "0.9")]);
    let dd = dd.double_double().stages(8).steps(300, TAU / 300.0);
    all.push(dd.against(Reference::Closed));
}

/// Closed orbit of period 17.07 that passes the Moon at 0.006.
fn arenstorf(all: &mut Vec<Case>) {
    const PERIOD: f64 = 17.065_216_560_157_96;
    for (s, steps) in [(4, 40_000), (6, 20_000)] {
        let case = Case::scene("Arenstorf orbit 1", "arenstorf", &[]).stages(s);
        let case = case.steps(steps, PERIOD / steps as f64);
        all.push(case.against(Reference::Stored).quick(false));
    }
}

/// Burrau's three bodies: until t = 10, and through the pass at 0.0004 near t = 15.83.
fn pythagorean(all: &mut Vec<Case>) {
    let early = Case::scene("Pythagorean, t = 0 … 3", "pythagorean", &[]);
    let early = early
        .stages(6)
        .steps(3000, 1e-3)
        .against(Reference::fine(10, 4));
    all.push(early.quick(false));
    for (s, h) in [(4, 1e-5), (6, 1e-5), (6, 4e-5)] {
        let name = "Pythagorean, t = 15.8 … 15.86";
        let case = Case::new(name, close_pass).stages(s);
        let case = case
            .steps((0.06_f64 / h).round() as u64, h)
            .against(Reference::fine(8, (h / 5e-6).round() as u64));
        all.push(case.quick(false));
    }
}

/// The Pythagorean problem from doubles near its state at t = 15.8 (Gauss, s = 8, h = 1/4000).
fn close_pass() -> Result<Problem, BuildFault> {
    let instance = equip_scenes::find("pythagorean")?.instance(&[])?;
    let q = [
        -4.553_875_751_466_207_6e-1,
        -3.647_357_906_982_310_3e-1,
        -7.703_302_444_133_991e-1,
        -2.752_278_524_469_367_6e-1,
        1.786_086_284_462_213,
        9.748_634_544_263_056e-1,
    ];
    let p = [
        -1.561_121_235_247_387e1,
        3.791_806_834_008_791_6,
        1.563_521_461_922_642e1,
        -3.859_526_878_320_137_7,
        -2.400_226_675_255_209_5e-2,
        6.772_004_431_134_598e-2,
    ];
    let h = instance.hamiltonian().clone();
    let mut problem = Problem::new(h, &q, &p);
    for kept in instance.invariants() {
        problem = problem.keeping(kept.name, kept.quantity.clone());
    }
    Ok(problem)
}

/// From rest straight into the centre, which is reached at t = π/√8.
fn fall(all: &mut Vec<Case>) {
    let start = || {
        let energy = |q: &[Var], p: &[Var]| {
            0.5 * (p[0].powi(2) + p[1].powi(2)) - 1.0 / (q[0].powi(2) + q[1].powi(2)).sqrt()
        };
        Problem::recorded(energy, &[1.0, 0.0], &[0.0, 0.0])
    };
    for (s, h) in [(3, 0.01), (4, 0.01), (6, 0.01), (4, 1e-3)] {
        let case = Case::new("fall into the centre", start).stages(s);
        let case = case.steps((2.0 / h) as u64, h);
        let kinds = &[
            Kind::NotFinite,
            Kind::NoConvergence,
            Kind::Singular,
            Kind::Astray,
        ];
        let why = "the motion ends in the singularity";
        all.push(if h > 1e-3 {
            // With Gauss as well.
            let over = "a step may pass over the singularity without any sign of it at the stages";
            case.trajectory(Trajectory::Open(over))
                .ending(End::Either(kinds, why))
        } else {
            case.ending(End::Error(kinds, 1.1, why))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::close_pass;
    use equip_integrate::Gauss;

    /// Measured: see the message. The pass is the point of these rows, and they start from a state that was
    /// integrated.
    #[test]
    fn the_close_pass_is_within_the_interval() {
        let problem = close_pass().unwrap();
        let (q, p) = problem.initial::<f64>();
        let method = Gauss::stages(6).step(5e-6).measure_energy(false);
        let mut stepper = method.start(problem.hamiltonian(), &q, &p, 0.0).unwrap();
        let (mut nearest, mut time) = (f64::INFINITY, 0.0);
        for _ in 0..12_000 {
            let view = stepper.advance().unwrap();
            let distance = (view.q[0] - view.q[2]).hypot(view.q[1] - view.q[3]);
            if distance < nearest {
                (nearest, time) = (distance, 15.8 + view.time);
            }
        }
        println!("nearest {nearest:.2e} at t = {time:.4}");
        assert!(nearest < 1e-3, "{nearest:e} at {time}");
        assert!((15.82..15.84).contains(&time), "{time}");
    }
}
