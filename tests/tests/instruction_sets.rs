//! Whole runs have the same bits and do the same work on every instruction set: made in programs of their
//! own, as the choice is made once in a program.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss, Preconditioner, Record};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::{Instance, find};
use std::process::Command;

/// Steps of a run: enough for steps that begin from the last one, and for α's.
const STEPS: i64 = 25;

/// A line for each method: what it is, the words of the end state, and the work.
fn lines<T: Float>(name: &str, system: &Hamiltonian, scene: &Instance, h: f64, s: &[usize]) {
    let (q, p) = scene.initial::<T>();
    let step = T::exact(h);
    for &s in s {
        for (kind, method) in [
            ("gauss", Gauss::stages(s).step(step)),
            ("equip", Equip::stages(s).step(step)),
            (
                "iterations",
                (Equip::stages(s).step(step)).preconditioner(Preconditioner::Identity),
            ),
        ] {
            let end = T::int(STEPS) * step;
            let method = method.record(Record::Ends);
            let run = method.integrate(system, &q, &p, T::int(0)..=end);
            let run = run.unwrap_or_else(|e| panic!("{name}, {kind}, s = {s}: {e}"));
            let (_, q, p) = run.last();
            let words = q.iter().chain(p).flat_map(|x| x.expansion());
            let bits: Vec<String> = words.map(|x| format!("{:x}", x.to_bits())).collect();
            let counts = run.certificate().counts;
            println!("end of {name} {kind} {s} {} {counts:?}", bits.join(" "));
        }
    }
}

#[test]
#[ignore = "prints what the test below compares"]
fn print_bits() {
    let scene = |name: &str, values: &[(&str, &str)]| find(name).unwrap().instance(values).unwrap();

    let instance = scene("kepler", &[]);
    // 12 and 20 stages have no kernel with the energy, 16 one of two groups, the others one of one.
    let stages = [3, 4, 6, 8, 12, 16, 20];
    lines::<f64>("Kepler", instance.hamiltonian(), &instance, 0.3, &stages);
    let kepler = instance.hamiltonian();
    lines::<DoubleDouble>("Kepler, double-double", kepler, &instance, 0.3, &[8, 16]);

    let instance = scene("henon-heiles", &[]);
    lines::<f64>(
        "Hénon–Heiles",
        instance.hamiltonian(),
        &instance,
        0.5,
        &stages,
    );

    let values: &[(&str, &str)] = &[("n", "70")];
    for (name, values, h, stages) in [
        // Not separable: all components are unknown.
        ("double-pendulum", &[][..], 0.05, &[4, 8, 16][..]),
        // On stiff springs.
        ("fpu", &[], 0.08, &[8, 16]),
        // Long.
        ("fput-beta", values, 0.7, &[4, 8, 16]),
    ] {
        let instance = scene(name, values);
        lines::<f64>(name, instance.hamiltonian(), &instance, h, stages);
    }
}

#[test]
fn runs_have_the_same_bits_on_all_instruction_sets() {
    let printed = |set: &str| -> Vec<String> {
        let child = Command::new(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "instruction_sets::print_bits",
                "--ignored",
                "--nocapture",
            ])
            .env("EQUIP_SIMD", set)
            .output()
            .unwrap();
        assert!(
            child.status.success(),
            "{set}: {}",
            String::from_utf8_lossy(&child.stderr)
        );
        let text = String::from_utf8(child.stdout).unwrap();
        let from_end = |line: &str| line.find("end of ").map(|at| line[at..].to_owned());
        text.lines().filter_map(from_end).collect()
    };
    let expected = printed("none");
    assert_eq!(expected.len(), 3 * (7 + 2 + 7 + 3 + 2 + 3));
    for set in ["avx2", "avx512"] {
        let found = printed(set);
        assert_eq!(found.len(), expected.len(), "{set}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found, expected, "{set}");
        }
    }
}
