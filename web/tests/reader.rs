//! Formulas against values and derivatives computed by hand.

use equip_web::{Expression, FormulaError};

/// H and ∇H of a formula at y = (q, p).
fn at(text: &str, y: &[f64]) -> (f64, Vec<f64>) {
    let energy = Expression::read(text, y.len() / 2).unwrap();
    let mut evaluator = energy.hamiltonian().unwrap().evaluator::<f64>();
    let mut gradient = vec![0.0; y.len()];
    let value = evaluator.gradient(y, &mut gradient);
    (value, gradient)
}

fn value(text: &str, y: &[f64]) -> f64 {
    at(text, y).0
}

/// With r = (3, 4): 1/r = 0.2, r/r³ = (0.024, 0.032).
#[test]
fn kepler_by_hand() {
    let (h, gradient) = at("(px^2 + py^2)/2 - 1/sqrt(x^2 + y^2)", &[3.0, 4.0, 0.5, 2.0]);
    assert!((h - 1.925).abs() < 1e-15, "{h}");
    for (found, expected) in gradient.iter().zip([0.024, 0.032, 0.5, 2.0]) {
        assert!((found - expected).abs() < 1e-15, "{gradient:?}");
    }
}

/// At q = π/6, p = 2: H = 2 − √3/2 and ∂H/∂q = sin(π/6) = 1/2.
#[test]
fn pendulum_by_hand() {
    let (h, gradient) = at("p^2/2 - cos(q)", &[std::f64::consts::FRAC_PI_6, 2.0]);
    assert!((h - 1.133_974_596_215_561_4).abs() < 1e-15);
    assert!((gradient[0] - 0.5).abs() < 1e-15 && gradient[1] == 2.0);
}

/// At x = 1, y = 2, p = 0: H = 5/2 + 2 − 8/3 = 11/6, ∂H/∂x = 1 + 4, ∂H/∂y = 2 + 1 − 4.
#[test]
fn henon_heiles_by_hand() {
    let text = "(p1^2 + p2^2 + q1^2 + q2^2)/2 + q1^2*q2 - q2^3/3";
    let (h, gradient) = at(text, &[1.0, 2.0, 0.0, 0.0]);
    assert!((h - 11.0 / 6.0).abs() < 1e-15);
    assert_eq!(gradient, [5.0, -1.0, 0.0, 0.0]);
}

#[test]
fn operators_bind_as_in_mathematics() {
    let y = [3.0, 2.0];
    for (text, expected) in [
        ("-q^2", -9.0),
        ("(-q)^2", 9.0),
        ("2^q^p", 512.0),
        ("q^-2*9", 1.0),
        ("q**2", 9.0),
        ("12/q/p", 2.0),
        ("12/q*p", 8.0),
        ("q-p-1", 0.0),
        ("q - -p", 5.0),
        ("2 + q*p^2", 14.0),
        ("-q*-p", 6.0),
        ("+q", 3.0),
        ("q^(6/2)", 27.0),
        ("(q+1)^0.5", 2.0),
        ("(q+1)^(-3/2)", 0.125),
        ("p^(q+1)", 16.0),
        (".5*q + 2.*p + 1e-1*q + 2E+1*p", 45.8),
        ("q − 2·p", -1.0),
    ] {
        assert!((value(text, &y) - expected).abs() < 1e-13, "{text}");
    }
}

/// (−3)³ has a value as an integer power alone, also where the exponent is computed.
#[test]
fn integer_exponents_are_integer_powers() {
    for text in ["q^3", "q^(1+2)", "q^(6/2)", "q^sqrt(9)", "q^-(-3)"] {
        let (h, gradient) = at(text, &[-3.0, 0.0]);
        assert_eq!(h, -27.0, "{text}");
        assert!((gradient[0] - 27.0).abs() < 1e-13, "{text}");
    }
}

#[test]
fn functions_have_their_values() {
    let y = [0.0, 1.0];
    for (text, expected) in [
        ("q + exp(p)", std::f64::consts::E),
        ("ln(exp(2*p)) + q", 2.0),
        ("log10(p*1000)", 3.0),
        ("exp2(3*p)", 8.0),
        ("cbrt(8*p)", 2.0),
        ("sin(pi*p/6)", 0.5),
        ("tan(pi*p/4)", 1.0),
        ("4*atan(p)", std::f64::consts::PI),
        ("asin(p) + acos(p)", std::f64::consts::FRAC_PI_2),
        ("tanh(q) + sinh(q) + cosh(q)", 1.0),
        ("abs(q - 3*p)", 3.0),
        ("hypot(3*p, 4)", 5.0),
        ("atan2(p, q)", std::f64::consts::FRAC_PI_2),
        ("min(p, 7) + max(p, 7)", 8.0),
        ("erf(q) + erfc(q)", 1.0),
        ("π*p", std::f64::consts::PI),
    ] {
        assert!((value(text, &y) - expected).abs() < 1e-14, "{text}");
    }
}

#[test]
fn names_are_those_of_the_degrees_of_freedom() {
    let y = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5];
    let text = "x + q2 + z + px + p2 + pz";
    assert_eq!(value(text, &y), 111_111.0);
    assert_eq!(value("q1 + p1", &y[..2]), 11.0);
    for name in ["q3", "q0", "q01", "z", "q", "r", "p_1"] {
        let error = Expression::read(name, 2).unwrap_err();
        assert!(matches!(error, FormulaError::UnknownName { .. }), "{name}");
    }
}

/// A sum of many terms is no nesting.
#[test]
fn long_sums_are_read() {
    let text = "q".to_owned() + &" + p*q".repeat(10_000);
    assert_eq!(value(&text, &[1.0, 0.5]), 5001.0);
}

#[test]
fn constants_have_values() {
    let close = |text: &str, expected: f64| {
        assert!((Expression::constant(text).unwrap() - expected).abs() < 1e-15);
    };
    close("2*pi/100", 0.062_831_853_071_795_86);
    close("sqrt((1 + 0.6)/(1 - 0.6))", 2.0);
    close("-1e-3", -0.001);
    for text in ["", "1/0", "ln(-1)", "q", "0.1,"] {
        assert!(Expression::constant(text).is_err(), "{text}");
    }
}
