//! The decisions and the bits of thirty small runs: what a change of the code's shape leaves as it is.
//!
//! The table is `tests/guard.txt`. A change that is meant to move a row prints the new one:
//! `cargo test -p equip-tests --test all guard -- --nocapture`.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Equip, Integrator, Outcome, Stepper};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::find;
use std::fmt::Write;

/// Without functions of the machine's own library, whose last bits differ.
const SCENES: [&str; 13] = [
    "arenstorf",
    "charged-particle",
    "dnls",
    "faou-hairer-pham",
    "fpu",
    "fput-beta",
    "henon-heiles",
    "kepler",
    "n-body",
    "outer-solar-system",
    "pythagorean",
    "quartic",
    "spring-pendulum",
];
const STEPS: usize = 40;

/// FNV-1a.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// Outcome and work of every step, and the bits after it.
fn row<T: Float>(name: &str, scene: &str, options: &Integrator<T>) -> String {
    let instance = find(scene).unwrap().instance(&[]).unwrap();
    let (q, p) = instance.initial::<T>();
    let mut run = options
        .start(instance.hamiltonian(), &q, &p, T::int(0))
        .unwrap();
    let (mut decisions, mut bits) = (String::new(), String::new());
    for _ in 0..STEPS {
        let (made, words) = one_more(&mut run);
        decisions.push_str(&made);
        for x in words {
            for word in &x.expansion()[..4] {
                write!(bits, "{:x} ", word.to_bits()).unwrap();
            }
        }
    }
    format!(
        "{name} {scene} {:016x} {:016x}",
        hash(&decisions),
        hash(&bits)
    )
}

/// Makes a step; what it decided, and the state after it.
fn one_more<T: Float>(run: &mut Stepper<T>) -> (String, Vec<T>) {
    let view = run.advance().unwrap();
    let (outcome, state) = (view.outcome, [view.q, view.p].concat());
    let outcome = Outcome::ALL.iter().position(|&other| other == outcome);
    // Numbers alone: a name may change.
    let counts = format!("{:?}", run.certificate().counts);
    let numbers = counts.replace(|c: char| !c.is_ascii_digit() && c != ' ', "");
    (format!("{outcome:?} {numbers}\n"), state)
}

fn rows() -> Vec<String> {
    let mut rows = Vec::new();
    for scene in SCENES {
        let step = find(scene).unwrap().instance(&[]).unwrap().suggested_step();
        rows.push(row("EQUIP(4)", scene, &Equip::stages(4).step(step)));
        rows.push(row(
            "EQUIP(8),1e-10",
            scene,
            &Equip::stages(8).tolerance(1e-10),
        ));
    }
    for scene in ["kepler", "henon-heiles", "fput-beta", "outer-solar-system"] {
        let tolerance = DoubleDouble::exact(1e-20);
        rows.push(row(
            "EQUIP(8),dd,1e-20",
            scene,
            &Equip::stages(8).tolerance(tolerance),
        ));
    }
    rows
}

#[test]
fn decisions_and_bits_are_those_of_before() {
    let rows = rows();
    let found = rows.join("\n") + "\n";
    println!("{found}");
    let changed: Vec<_> = rows
        .iter()
        .zip(include_str!("../guard.txt").lines())
        .filter(|(a, b)| a != b)
        .collect();
    assert!(changed.is_empty(), "{changed:#?}");
    assert_eq!(found, include_str!("../guard.txt"));
}
