//! Stored references: dimensions, energies at both ends, agreement with the closed forms.
#![allow(clippy::unwrap_used)]

use crate::common::{start, value};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::{Instance, find, reference_names};

type T = DoubleDouble;

fn end(instance: &Instance) -> Vec<T> {
    let (mut q, p) = instance.reference().unwrap().state();
    q.extend(p);
    q
}

#[test]
fn every_reference_finds_its_scene_and_itself() {
    for name in reference_names() {
        let instance = Instance::from_reference(name).unwrap();
        let reference = instance.reference().unwrap();
        assert_eq!(reference.name(), name);
        assert_eq!(
            end(&instance).len(),
            2 * instance.hamiltonian().degrees_of_freedom(),
            "{name}"
        );
        assert!(end(&instance).iter().all(|x| !x.is_nan()), "{name}");
        assert!(
            reference.end::<f64>() > 0.0 && reference.trusted_error() < 1e-14,
            "{name}"
        );
    }
    assert_eq!(reference_names().count(), 10);
}

#[test]
fn both_ends_have_the_stated_energy() {
    for name in reference_names() {
        let instance = Instance::from_reference(name).unwrap();
        let reference = instance.reference().unwrap();
        let h = instance.hamiltonian();
        let stated = reference.energy::<T>();
        let size = stated.abs().to_f64().min(1.0);
        let defect = |y: &[T]| (value(h, y) - stated).abs().to_f64() / size;
        let at_start = defect(&start::<T>(&instance));
        let at_end = defect(&end(&instance));
        assert!(
            at_start <= (1e-30_f64).max(2.0 * reference.energy_error()),
            "{name}: start {at_start:e}"
        );
        // The end state is known to so many digits, and H varies along it by at most some 50.
        let known = 50.0 * reference.trusted_error() + 2.0 * reference.energy_error();
        assert!(at_end <= known.max(1e-30), "{name}: end {at_end:e}");
    }
}

#[test]
fn plain_instances_have_the_references_that_start_from_decimals() {
    let reference = |name: &str, values: &[(&str, &str)]| {
        find(name)
            .unwrap()
            .instance(values)
            .unwrap()
            .reference()
            .map(|r| r.name())
    };
    assert_eq!(reference("pendulum", &[]), Some("pendulum"));
    assert_eq!(reference("pendulum", &[("p", "1.0")]), Some("pendulum"));
    assert_eq!(reference("pendulum", &[("p", "1.1")]), None);
    assert_eq!(reference("henon-heiles", &[]), Some("henon_heiles_1_12"));
    assert_eq!(reference("double-pendulum", &[]), Some("double_pendulum"));
    assert_eq!(reference("arenstorf", &[]), Some("arenstorf"));
    assert_eq!(reference("arenstorf", &[("orbit", "2")]), None);
    assert_eq!(reference("pythagorean", &[]), Some("pythagorean"));
    assert_eq!(reference("outer-solar-system", &[]), Some("outer_ss"));
    assert_eq!(reference("outer-solar-system", &[("planets", "2")]), None);
    // e = 0.6 exactly is not the double from which kepler06_1000 started.
    assert_eq!(reference("kepler", &[]), None);
    assert_eq!(reference("fpu", &[]), None);
}

#[test]
fn references_from_doubles_start_from_doubles() {
    for name in ["kepler06_1000", "kepler09_100", "hh_regular", "fpu_hlw"] {
        let instance = Instance::from_reference(name).unwrap();
        let (wide, narrow) = (start::<T>(&instance), start::<f64>(&instance));
        assert!(
            wide.iter().zip(&narrow).all(|(&w, &n)| w == T::exact(n)),
            "{name}"
        );
    }
}

#[test]
fn closed_forms_agree_with_the_references() {
    // Measured 1.1e-27 and 2.2e-27, the phase's round-off over 1000 and 100 periods, and 3.7e-25, the last
    // digit stored.
    for (name, bound) in [
        ("kepler06_1000", 1e-26),
        ("kepler09_100", 1e-26),
        ("pendulum", 1e-24),
    ] {
        let instance = Instance::from_reference(name).unwrap();
        let reference = instance.reference().unwrap();
        let (mut q, p) = instance.exact::<T>(reference.end()).unwrap();
        q.extend(p);
        let error = q
            .iter()
            .zip(end(&instance))
            .map(|(&a, b)| (a - b).abs().to_f64())
            .fold(0.0, f64::max);
        assert!(error < bound, "{name}: {error:e}");
    }
}
