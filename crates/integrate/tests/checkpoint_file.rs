//! A checkpoint through a file and back.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{
    Certificate, Checkpoint, Equip, IntegrateError, Integrator, Observer, StepView,
};
use equip_scalar::{DoubleDouble, Float};
use serde_json::Value;
use std::ops::ControlFlow;

#[test]
fn text_and_back_is_exact() {
    let kepler = equip_scenes::find("kepler").unwrap();
    let kepler = kepler.instance(&[("e", "0.9")]).unwrap();
    let (q, p) = kepler.initial::<DoubleDouble>();
    let tolerance = DoubleDouble::decimal("1e-22").unwrap();
    let options = Equip::stages(8).tolerance(tolerance);
    let zero = DoubleDouble::int(0);
    let mut run = options.start(kepler.hamiltonian(), &q, &p, zero).unwrap();
    for _ in 0..5 {
        run.advance().unwrap();
    }
    let checkpoint = run.checkpoint();
    let text = serde_json::to_string(&checkpoint).unwrap();
    let back: Checkpoint = serde_json::from_str(&text).unwrap();
    assert_eq!(checkpoint, back);
    let mut again = options.resume(kepler.hamiltonian(), &back).unwrap();
    for _ in 0..5 {
        let (a, b) = (run.advance().unwrap(), again.advance().unwrap());
        assert_eq!((a.time, a.q, a.p), (b.time, b.q, b.p));
    }
    let damaged = text.replace("\"the state\",[\"", "\"the state\",[\"z");
    let damaged: Checkpoint = serde_json::from_str(&damaged).unwrap();
    assert!(options.resume(kepler.hamiltonian(), &damaged).is_err());
}

#[test]
fn certificates_come_back_as_they_were() {
    fn back<T: Float + serde::Serialize + serde::de::DeserializeOwned>(of: &Certificate<T>) {
        let text = serde_json::to_string(of).unwrap();
        println!("{text}");
        assert_eq!(&serde_json::from_str::<Certificate<T>>(&text).unwrap(), of);
        assert!(text.contains("\"Solved\":"), "{text}");
    }
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let options = Equip::stages(4).tolerance(1e-9).chaos();
    let run = options.integrate(&pendulum, &[1.0], &[0.0], 0.0..=10.0);
    back(run.unwrap().certificate());
    let wide = DoubleDouble::exact;
    let options = Equip::stages(4).step(wide(0.125));
    let run = options.integrate(&pendulum, &[wide(1.0)], &[wide(0.0)], wide(0.0)..=wide(4.0));
    back(run.unwrap().certificate());
}

/// Keeps the checkpoint after the third step, and ends the run there.
#[derive(Default)]
struct AfterThree {
    index: u64,
    checkpoint: Option<Checkpoint>,
}

impl Observer<f64> for AfterThree {
    fn step(&mut self, view: &StepView<'_, f64>) -> ControlFlow<()> {
        self.index = view.index;
        ControlFlow::Continue(())
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.index == 3
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        self.checkpoint = Some(checkpoint);
        ControlFlow::Break(())
    }
}

fn after_three(options: &Integrator<f64>, pendulum: &Hamiltonian) -> Checkpoint {
    let mut keep = AfterThree::default();
    options
        .integrate_observed(pendulum, &[0.3], &[1.0], 0.0..=10.0, &mut keep)
        .unwrap();
    keep.checkpoint.unwrap()
}

/// Flips every bit of the text; what still is a checkpoint must not be resumed.
fn every_flip_is_refused(options: &Integrator<f64>) {
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let text = serde_json::to_vec(&after_three(options, &pendulum)).unwrap();
    let resumed = |text: &[u8]| {
        let checkpoint: Checkpoint = serde_json::from_slice(text).ok()?;
        Some(options.resume(&pendulum, &checkpoint).map(|_| ()))
    };
    assert_eq!(resumed(&text), Some(Ok(())));
    let mut read = 0;
    for byte in 0..text.len() {
        for bit in 0..8 {
            let mut flipped = text.clone();
            flipped[byte] ^= 1 << bit;
            let outcome = resumed(&flipped);
            assert_ne!(outcome, Some(Ok(())), "bit {bit} of byte {byte}");
            read += usize::from(outcome.is_some());
        }
    }
    println!(
        "{} bytes, {read} flips are checkpoints to the reader",
        text.len()
    );
    assert!(read > text.len());
}

#[test]
fn every_flipped_bit_is_refused() {
    every_flip_is_refused(&Equip::stages(3).step(0.25));
    every_flip_is_refused(&Equip::stages(3).step(0.25).chaos());
    every_flip_is_refused(&Equip::stages(4).tolerance(1e-8));
}

#[test]
fn a_part_left_out_is_refused() {
    let options = Equip::stages(3).step(0.25);
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let mut run = options.start(&pendulum, &[0.3], &[1.0], 0.0).unwrap();
    run.advance().unwrap();
    let whole = serde_json::to_value(run.checkpoint()).unwrap();
    let names: Vec<String> = whole.as_object().unwrap().keys().cloned().collect();
    for name in names {
        let mut part = whole.clone();
        let left_out = part.as_object_mut().unwrap().remove(&name).unwrap();
        // What a run does not have is none, whether it is there or not.
        if left_out.is_null() {
            continue;
        }
        let Ok(checkpoint) = serde_json::from_value::<Checkpoint>(part) else {
            continue;
        };
        let refused = options.resume(&pendulum, &checkpoint).unwrap_err();
        let damaged = matches!(refused, IntegrateError::CheckpointDamaged { .. });
        assert!(damaged, "{name}: {refused}");
    }
}

const NAN: &str = "7ff8000000000000";
/// What was measured of the steps so far, which decides nothing of those to come, and the checksum, which
/// is made anew.
const MEASURED: [&str; 8] = [
    "the seconds",
    "the errors",
    "the errors in round-off levels",
    "the round-off level",
    "the round-off levels of the energy",
    "the phase per step",
    "the range of α",
    "the sizes of the steps",
];

/// The name of the list that the place is in; empty if it is in none.
fn name_of<'a>(whole: &'a Value, place: &str) -> &'a str {
    let mut parts = place.split('/').skip(1);
    let (list, i) = (
        parts.next().unwrap_or_default(),
        parts.next().unwrap_or_default(),
    );
    let name = whole.pointer(&format!("/{list}/{i}/0"));
    name.and_then(Value::as_str).unwrap_or_default()
}

/// The places of all numbers.
fn numbers(value: &Value, place: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            (map.iter()).for_each(|(name, value)| numbers(value, &format!("{place}/{name}"), found))
        }
        Value::Array(list) => (list.iter().enumerate())
            .for_each(|(i, value)| numbers(value, &format!("{place}/{i}"), found)),
        Value::String(text) if u64::from_str_radix(text, 16).is_ok() && text.len() == 16 => {
            found.push(place.to_owned());
        }
        _ => {}
    }
}

/// A checkpoint whose checksum is right, with NaN in one place after the other.
fn nan_is_refused(options: &Integrator<f64>) {
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let whole = serde_json::to_value(after_three(options, &pendulum)).unwrap();
    let mut places = Vec::new();
    numbers(&whole, "", &mut places);
    assert!(places.len() > 40, "{}", places.len());
    for place in places {
        let mut damaged = whole.clone();
        *damaged.pointer_mut(&place).unwrap() = Value::from(NAN);
        let mut damaged: Checkpoint = serde_json::from_value(damaged).unwrap();
        damaged.seal();
        let is_refused = options.resume(&pendulum, &damaged).is_err();
        // Gradients of a state that begins with NaN are those of no state, and are made anew.
        let name = name_of(&whole, &place);
        let makes_none = name == "gradients" && place.ends_with("/1/0");
        let is_measured = MEASURED.contains(&name) || place == "/checksum";
        let decides_nothing = is_measured || makes_none;
        assert!(is_refused || decides_nothing, "NaN at {place} was taken");
    }
}

#[test]
fn nan_in_any_place_that_decides_something_is_refused() {
    nan_is_refused(&Equip::stages(3).step(0.25));
    nan_is_refused(&Equip::stages(4).tolerance(1e-8));
}

/// A checkpoint whose checksum is right, with a number that no run has: a run from it would not end, or would
/// overflow.
#[test]
fn numbers_of_no_run_are_refused() {
    let by_tolerance = Equip::stages(4).tolerance(1e-8);
    let by_equal_steps = Equip::stages(3).step(0.25);
    let remainder = "the rounding remainder of the time";
    for (options, name, number) in [
        (&by_tolerance, remainder, 1e10),
        (&by_tolerance, "the steps not accepted", -1.0),
        (&by_equal_steps, "the place on the grid", 1e300),
        (&by_equal_steps, "the place on the grid", 0.5),
    ] {
        let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
        let mut forged = serde_json::to_value(after_three(options, &pendulum)).unwrap();
        let lists = forged["run"].as_array_mut().unwrap();
        let list = lists.iter_mut().find(|list| list[0] == name).unwrap();
        list[1][0] = Value::from(format!("{:016x}", f64::to_bits(number)));
        let mut forged: Checkpoint = serde_json::from_value(forged).unwrap();
        forged.seal();
        let refused = options.resume(&pendulum, &forged).unwrap_err();
        assert_eq!(refused, IntegrateError::CheckpointDamaged { what: name });
    }
}
