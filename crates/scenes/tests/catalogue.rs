//! Every scene builds, says of itself what is true, and refuses what it cannot do in words that help.
#![allow(clippy::unwrap_used)]

use crate::common::{every_instance, gradient, start};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::{Instance, SceneError, View, all, find};

#[test]
fn names_and_texts_are_complete_and_unique() {
    for (i, scene) in all().iter().enumerate() {
        assert!(
            all()[..i].iter().all(|other| other.name != scene.name),
            "{}",
            scene.name
        );
        for text in [
            scene.title,
            scene.formula,
            scene.source,
            scene.invariants,
            scene.solution,
            scene.hard,
        ] {
            assert!(!text.is_empty(), "{}", scene.name);
        }
        assert!(std::ptr::eq(find(scene.name).unwrap(), scene));
    }
    assert_eq!(all().len(), 20);
}

fn starts_are_finite<T: Float>() {
    for instance in every_instance() {
        let name = instance.scene().name;
        let h = instance.hamiltonian();
        let y = start::<T>(&instance);
        assert_eq!(y.len(), 2 * h.degrees_of_freedom(), "{name}");
        let (value, gradient) = gradient(h, &y);
        assert!(value.to_f64().is_finite(), "{name}: H = {value}");
        assert!(gradient.iter().all(|g| g.to_f64().is_finite()), "{name}");
        assert!(instance.period::<T>() > T::int(0), "{name}");
    }
}

#[test]
fn every_scene_starts_at_the_ends_of_its_parameters() {
    starts_are_finite::<f64>();
    starts_are_finite::<DoubleDouble>();
}

#[test]
fn steps_ends_and_views_make_sense() {
    for instance in every_instance() {
        let name = instance.scene().name;
        let (step, end) = (instance.suggested_step(), instance.suggested_end());
        assert!(
            step > 0.0 && step < end && end.is_finite(),
            "{name}: {step}, {end}"
        );
        let m = instance.hamiltonian().degrees_of_freedom();
        match instance.view() {
            View::PhasePlane => assert_eq!(m, 1, "{name}"),
            View::Paths(pairs) => assert!(pairs.iter().all(|&(a, b)| a < m && b < m), "{name}"),
            View::Profile => assert!(m > 1, "{name}"),
        }
    }
}

#[test]
fn parameters_come_back_as_they_were_given() {
    let kepler = find("kepler")
        .unwrap()
        .instance(&[("e", " 0.90 ")])
        .unwrap();
    let given: Vec<_> = kepler.parameters().collect();
    assert_eq!(given, [("e", "0.90"), ("mu", "1")]);
}

#[test]
fn a_decimal_parameter_is_exact_in_double_double() {
    let kepler = find("kepler").unwrap().instance(&[("e", "0.9")]).unwrap();
    let (q, p) = kepler.initial::<DoubleDouble>();
    let tenth = DoubleDouble::ratio(1, 10);
    let nineteen = p[1] * p[1];
    // Measured: 0 and 6e-31; one ulp of 0.1 and sixteen of 19 allowed.
    assert!((q[0] - tenth).abs() <= DoubleDouble::EPSILON);
    assert!((nineteen - DoubleDouble::int(19)).abs().to_f64() < 1e-29);
}

/// (scene, parameters, separable, degree, degree in p)
type Facts = (
    &'static str,
    &'static [(&'static str, &'static str)],
    bool,
    Option<u32>,
    Option<u32>,
);

#[test]
fn structure_of_each_energy() {
    let facts: &[Facts] = &[
        ("kepler", &[], true, None, Some(2)),
        ("henon-heiles", &[], true, Some(3), Some(2)),
        ("pendulum", &[], true, None, Some(2)),
        ("quartic", &[], true, Some(4), Some(2)),
        ("harmonic", &[], true, Some(2), Some(2)),
        ("double-pendulum", &[], false, None, Some(2)),
        ("stiff-double-pendulum", &[], false, None, Some(2)),
        ("spring-pendulum", &[], true, None, Some(2)),
        ("fpu", &[], true, Some(4), Some(2)),
        ("fput-beta", &[], true, Some(4), Some(2)),
        ("fput-beta", &[("beta", "0")], true, Some(2), Some(2)),
        ("outer-solar-system", &[], true, None, Some(2)),
        ("pythagorean", &[], true, None, Some(2)),
        ("n-body", &[], true, None, Some(2)),
        ("arenstorf", &[], false, None, Some(2)),
        ("charged-particle", &[], false, None, Some(2)),
        ("lennard-jones", &[], true, None, Some(2)),
        ("faou-hairer-pham", &[], true, Some(6), Some(3)),
        ("lotka-volterra", &[], true, None, None),
        ("dnls", &[], false, Some(4), Some(4)),
        ("sine-gordon", &[], true, None, Some(2)),
    ];
    for &(name, values, separable, degree, degree_in_p) in facts {
        let instance = find(name).unwrap().instance(values).unwrap();
        let structure = instance.hamiltonian().structure();
        assert_eq!(structure.separable, separable, "{name}: separable");
        assert_eq!(structure.degree, degree, "{name}: degree");
        assert_eq!(structure.degree_in_p, degree_in_p, "{name}: degree in p");
    }
    assert!(
        all()
            .iter()
            .all(|scene| facts.iter().any(|f| f.0 == scene.name))
    );
}

#[test]
fn the_hessian_of_a_chain_is_sparse() {
    let chain = find("fput-beta")
        .unwrap()
        .instance(&[("n", "1000")])
        .unwrap();
    // A tridiagonal block in q and a diagonal one in p.
    assert_eq!(
        chain.hamiltonian().structure().hessian.len(),
        3 * 1000 - 2 + 1000
    );
}

fn message(result: Result<Instance, SceneError>) -> String {
    result.err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn bad_requests_are_answered_with_what_is_allowed() {
    let kepler = find("kepler").unwrap();
    let cases = [
        (
            kepler.instance(&[("e", "1")]),
            "e = 1 of kepler is out of range; choose a value in [0, 1)",
        ),
        (
            kepler.instance(&[("e", "-0.1")]),
            "e = -0.1 of kepler is out of range; choose a value in [0, 1)",
        ),
        (
            kepler.instance(&[("mass", "1")]),
            "the scene kepler has no parameter `mass`; it has e, mu",
        ),
        (
            kepler.instance(&[("e", "0.1"), ("e", "0.2")]),
            "the parameter e of kepler was given twice; give it once",
        ),
        (
            kepler.instance(&[("e", "0,6")]),
            "`0,6` is not a value for e of kepler; write a decimal like 0.6 or 1e-3, or a quotient like 1/12",
        ),
        (
            find("fpu").unwrap().instance(&[("m", "2.5")]),
            "m of fpu must be a whole number in [1, 100], not `2.5`",
        ),
        (
            find("pythagorean").unwrap().instance(&[("g", "1")]),
            "the scene pythagorean has no parameter `g`; it has none",
        ),
        (
            Instance::from_reference("kepler"),
            "there is no reference solution `kepler`; the known ones are kepler06_1000, kepler09_100, hh_regular, fpu_hlw, outer_ss, pendulum, henon_heiles_1_12, arenstorf, double_pendulum, pythagorean",
        ),
    ];
    for (result, text) in cases {
        assert_eq!(message(result), text);
    }
    let low = message(
        find("henon-heiles")
            .unwrap()
            .instance(&[("energy", "0.01")]),
    );
    assert!(
        low.starts_with(
            "henon-heiles cannot start there with energy 0.01: the start alone takes 0.05"
        ),
        "{low}"
    );
}

#[test]
fn a_misspelt_name_is_answered_with_its_neighbours() {
    let nearest = |name: &str| match find(name) {
        Err(SceneError::UnknownScene { nearest, .. }) => nearest[0],
        _ => panic!("{name} is no scene"),
    };
    assert_eq!(nearest("keppler"), "kepler");
    assert_eq!(nearest("henon"), "henon-heiles");
    assert_eq!(nearest("double_pendulum"), "double-pendulum");
    assert_eq!(nearest("solar-system"), "outer-solar-system");
    assert_eq!(
        find("keppler").unwrap_err().to_string().split(';').next(),
        Some("there is no scene `keppler`")
    );
}
