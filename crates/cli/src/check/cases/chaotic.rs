//! Chaotic orbits, separatrices, hard collisions, and motion that symmetric methods do not like.

use crate::check::case::{Case, End, Kind, Problem, Reference, Trajectory};
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::ratio;
use std::f64::consts::TAU;

/// Nothing is compared beyond the time at which round-off has grown to the size of the orbit.
const UNPREDICTABLE: Trajectory =
    Trajectory::Open("beyond the predictability horizon: energy and outcomes only");

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    henon_heiles(&mut all);
    pendulum(&mut all);
    double_pendulum(&mut all);
    lennard_jones(&mut all);
    faou_hairer_pham(&mut all);
    charged_particle(&mut all);
    all
}

fn fine() -> Reference {
    Reference::fine(10, 4)
}

fn henon_heiles(all: &mut Vec<Case>) {
    for energy in ["1/12", "1/8", "1/6"] {
        let name = format!("Hénon–Heiles E={energy}");
        let parameters = [("energy", energy), ("q2", "0.1"), ("p2", "0.1")];
        let case = || Case::scene(name.clone(), "henon-heiles", &parameters);
        for s in [3, 4, 6] {
            for h in [0.5, 0.25] {
                let steps = (50.0 / h) as u64;
                all.push(case().stages(s).steps(steps, h).against(fine()));
            }
            all.push(case().stages(s).steps(1000, 0.5).trajectory(UNPREDICTABLE));
        }
        let wide = case().double_double().stages(6).steps(100, 0.25);
        all.push(wide.against(Reference::fine(14, 2)));
    }
    // Along q1 = 0 over the saddle at (0, 1), whose energy is 1/6: the rest of the way takes finite time.
    for (text, speed, after) in [
        ("0.1667", 0.5774, 13.0),
        ("0.245", 0.7, 5.3),
        ("2", 2.0, 2.7),
    ] {
        let start = move || {
            let energy = |q: &[Var], p: &[Var]| {
                0.5 * (p[0].powi(2) + p[1].powi(2) + q[0].powi(2) + q[1].powi(2))
                    + q[0].powi(2) * q[1]
                    - ratio(1, 3) * q[1].powi(3)
            };
            Problem::recorded(energy, &[0.0, 0.0], &[0.0, speed])
        };
        for s in [3, 4, 6] {
            let name = format!("Hénon–Heiles E={text}, escape");
            let case = Case::new(name, start).stages(s).steps(2000, 0.1);
            all.push(case.ending(End::Error(
                &[Kind::Escape],
                after,
                "the orbit reaches infinity in finite time",
            )));
        }
    }
}

/// On the separatrix and 1e-10 on either side of it.
fn pendulum(all: &mut Vec<Case>) {
    for (p, end) in [
        ("1.9999999999", 100.0),
        ("2", 15.0),
        ("2.0000000001", 100.0),
    ] {
        let name = format!("pendulum p={p}");
        for (s, h) in [(3, 0.25), (4, 0.25), (4, 0.5), (6, 0.5)] {
            all.push(
                Case::scene(name.clone(), "pendulum", &[("p", p)])
                    .stages(s)
                    .steps((end / h) as u64, h)
                    .against(Reference::Closed),
            );
        }
    }
}

fn double_pendulum(all: &mut Vec<Case>) {
    let parameters = [("q1", "0"), ("q2", "0"), ("p1", "0"), ("p2", "3.873")];
    for s in [3, 4, 6] {
        let name = "double pendulum, chaotic";
        let case = Case::scene(name, "double-pendulum", &parameters).stages(s);
        let case = case.steps(256, 1.0 / 32.0).against(fine());
        all.push(case);
    }
}

/// Two atoms head on at 200 times the depth of the well, one of them a little off; and seven in disorder.
fn lennard_jones(all: &mut Vec<Case>) {
    let two = || {
        let energy = |q: &[Var], p: &[Var]| {
            let (dx, dy) = (q[0] - q[2], q[1] - q[3]);
            let sixth = (dx * dx + dy * dy).powi(-3);
            let kinetic = p[0].powi(2) + p[1].powi(2) + p[2].powi(2) + p[3].powi(2);
            0.5 * kinetic + 4.0 * (sixth * sixth - sixth)
        };
        let moment = Hamiltonian::new(4, |q, p| {
            q[0] * p[1] - q[1] * p[0] + q[2] * p[3] - q[3] * p[2]
        })?;
        let two = Problem::recorded(energy, &[-1.5, 0.0, 1.5, 0.05], &[14.0, 0.0, -14.0, 0.0])?;
        Ok(two.keeping("angular momentum", moment))
    };
    for s in [3, 4, 6] {
        for h in [4e-3, 1e-3] {
            let name = "Lennard-Jones, hard collision";
            let case = Case::new(name, two).stages(s);
            let case = case.steps((0.4 / h) as u64, h).against(fine());
            all.push(case);
        }
    }
    let seven = Case::scene(
        "Lennard-Jones, 7 fast atoms",
        "lennard-jones",
        &[("n", "7"), ("speed", "10")],
    );
    let against = Reference::fine(6, 2);
    all.push(seven.steps(500, 1e-3).against(against).quick(false));
}

/// Not reversible: symmetric methods let the energy drift, H = H_ref at every step does not.
fn faou_hairer_pham(all: &mut Vec<Case>) {
    for s in [3, 4, 6] {
        let name = "Faou–Hairer–Pham";
        let case = || Case::scene(name, "faou-hairer-pham", &[]).stages(s);
        all.push(case().steps(500, 0.16).against(fine()));
        all.push(case().steps(20_000, 0.16).trajectory(Trajectory::Open(
            "a long run for the energy; the energy of Gauss drifts",
        )));
    }
}

/// Not separable; b = 100 gyrates 100 times as fast as it drifts.
fn charged_particle(all: &mut Vec<Case>) {
    for (b, per_turn) in [("1", 20.0), ("1", 5.0), ("100", 20.0)] {
        for s in [3, 4, 6] {
            let name = format!("charged particle b={b}");
            let h = TAU / b.parse::<f64>().unwrap_or(1.0) / per_turn;
            let case = Case::scene(name, "charged-particle", &[("b", b)]);
            all.push(case.stages(s).steps(500, h).against(fine()));
        }
    }
    let dd = Case::scene("charged particle b=1", "charged-particle", &[]);
    let dd = dd.double_double().stages(6).steps(100, TAU / 20.0);
    all.push(dd.against(Reference::fine(12, 2)));
}
