//! A checkpoint through a file and back.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Checkpoint, Equip};
use equip_scalar::{DoubleDouble, Float};

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
    let damaged = text.replace("\"high\":[\"", "\"high\":[\"z");
    let damaged: Checkpoint = serde_json::from_str(&damaged).unwrap();
    assert!(options.resume(kepler.hamiltonian(), &damaged).is_err());
}
