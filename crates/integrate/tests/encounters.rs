//! Three bodies from rest, through their close encounters.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Equip, Gauss, Record};
use equip_scalar::{DoubleDouble, Float};

/// A table of docs/which-steps.md.
#[test]
#[ignore = "known deficit: the energy is not repaired after an encounter, 3e-9 at the end, 1e-11 allowed; .ci/figures runs it"]
fn pythagorean_through_its_close_encounters() {
    let scene = equip_scenes::find("pythagorean").unwrap();
    let scene = scene.instance(&[]).unwrap();
    let h = scene.hamiltonian();
    type D = DoubleDouble;
    let (q, p) = scene.initial::<D>();
    let exact = Equip::stages(12)
        .tolerance(D::decimal("1e-27").unwrap())
        .record(Record::Ends)
        .output_at(&[10, 20, 60].map(D::int))
        .integrate(h, &q, &p, D::int(0)..=D::int(60))
        .unwrap();
    let (q, p) = scene.initial::<f64>();
    let mut table = String::from(
        "| | t = 10 | t = 20 | t = 60 | steps | largest energy error | in round-off levels | at the end |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut ends = Vec::new();
    for tolerance in [1e-11, 1e-12, 1e-13, 1e-14, 1e-15] {
        for (name, method) in [("EQUIP", Equip::stages(8)), ("Gauss", Gauss::stages(8))] {
            let made = method
                .tolerance(tolerance)
                .record(Record::Ends)
                .output_at(&[10.0, 20.0, 60.0])
                .integrate(h, &q, &p, 0.0..=60.0)
                .unwrap();
            let errors: Vec<f64> = made
                .outputs()
                .zip(exact.outputs())
                .map(|((_, q, _), (_, exact, _))| {
                    let pairs = q.iter().zip(exact);
                    pairs.fold(0.0, |most: f64, (x, y)| most.max((x - y.to_f64()).abs()))
                })
                .collect();
            let c = made.certificate();
            let energy = c.energy.as_ref().unwrap();
            let levels = c.energy_in_round_off_levels.map(|x| format!("{x:.1}"));
            table += &format!(
                "| {tolerance:e}, {name} | {:.1e} | {:.1e} | {:.1e} | {} | {:.1e} | {} | {:.0e} |\n",
                errors[0],
                errors[1],
                errors[2],
                c.counts.steps,
                energy.max,
                levels.unwrap_or_default(),
                energy.end.abs(),
            );
            if name == "EQUIP" {
                ends.push((errors[2], energy.end.abs()));
            }
        }
    }
    println!("\n{table}");
    // Rounding in the closest encounter, grown by t = 60.
    for (error, energy) in ends {
        assert!(error < 1e-4 && energy < 1e-11, "{error:e}, {energy:e}");
    }
}
