//! What wrong inputs are answered with: what is wrong, where, and what to write instead.

use equip_web::{Simulation, SimulationError};

/// The message for H with one degree of freedom.
fn message(energy: &str) -> String {
    refused(energy, &[0.5], &[1.0], 3, 0.1).to_string()
}

fn refused(energy: &str, q: &[f64], p: &[f64], stages: usize, step: f64) -> SimulationError {
    Simulation::new(energy, q, p, stages, step).unwrap_err()
}

#[test]
fn formulas_are_refused_with_place_and_remedy() {
    for (energy, parts) in [
        ("", &["empty", "p^2/2 - cos(q)"][..]),
        ("p^2/2 + w", &["`w` at character 9", "write q or p"]),
        ("p^2/2 - coz(q)", &["`coz` at character 9", "cos, tan"]),
        ("p*log(q)", &["`log` at character 3", "ln for the natural"]),
        ("p^2/2 - cos q", &["`cos` at character 9", "write cos( … )"]),
        ("p^2/2 - cos(q", &["opened at character 12", "write )"]),
        ("p^2/2 - (q", &["opened at character 9", "write )"]),
        ("p^2/2) - q", &["closed at character 6", "write ("]),
        ("2q + p", &["before `q` at character 2", "write *"]),
        ("q(p + 1)", &["before `(` at character 2", "write *"]),
        ("p + * q", &["before `*` at character 5", "missing"]),
        ("p + q^", &["before the end at character 7", "missing"]),
        ("p*()", &["before `)` at character 4"]),
        ("p = q", &["`=` at character 3", "right-hand side"]),
        ("p² + q", &["`²` at character 2", "write ^2"]),
        ("[p + q]", &["`[` at character 1", "write ("]),
        ("p + q$", &["`$` at character 6"]),
        ("1.2.3*p", &["`1.2.3` at character 1", "0.5"]),
        ("1e999*p", &["`1e999` at character 1"]),
        ("0,5*p", &["comma at character 2", "1.5"]),
        ("p*(0,5 + q)", &["comma at character 5", "1.5"]),
        (
            "atan2(q)",
            &["`atan2` at character 1", "1 arguments", "write 2"],
        ),
        ("sin(q, p)", &["`sin`", "2 arguments", "write 1"]),
        ("3 + pi", &["depends on no variable", "write q or p"]),
        ("p + 1/0", &["infinite"]),
        ("ln(-1)*p", &["NaN"]),
    ] {
        let message = message(energy);
        for part in parts {
            assert!(message.contains(part), "{energy}: {message}");
        }
    }
}

/// Parentheses, signs, powers and calls: none overflows the stack.
#[test]
fn deep_nesting_is_refused() {
    let deep = 10_000;
    for text in [
        "(".repeat(deep) + "q" + &")".repeat(deep),
        "(".repeat(deep),
        "-".repeat(deep) + "q",
        "q^".repeat(deep) + "q",
        "sin(".repeat(deep) + "q" + &")".repeat(deep),
        "q*(1+".repeat(deep),
    ] {
        let message = message(&text);
        assert!(message.contains("more than 100 levels"), "{message}");
    }
    let allowed = "(".repeat(99) + "p + q" + &")".repeat(99);
    assert!(Simulation::new(&allowed, &[0.5], &[1.0], 3, 0.1).is_ok());
    let long = "q + ".repeat(100_000) + "q";
    assert!(message(&long).contains("400001 characters"));
}

#[test]
fn initial_conditions_are_checked() {
    let h = "p^2/2 + ln(q)";
    let negative = refused(h, &[-1.0], &[0.0], 3, 0.1);
    assert!(matches!(negative, SimulationError::EnergyNotFinite { value } if value.is_nan()));
    assert!(
        negative
            .to_string()
            .contains("logarithm of a negative number")
    );
    let lengths = refused(h, &[1.0, 2.0], &[0.0], 3, 0.1).to_string();
    assert!(lengths.contains("2 initial positions q and 1 initial momenta p"));
    let none = refused(h, &[], &[], 3, 0.1).to_string();
    assert!(none.contains("0 degrees of freedom"));
    // H is finite at q = 0, its gradient is not.
    let root = refused("p^2/2 + sqrt(q)", &[0.0], &[0.0], 3, 0.1).to_string();
    assert!(root.contains("gradient is not finite"), "{root}");
}

#[test]
fn steps_and_stages_are_checked() {
    for step in [0.0, f64::NAN, f64::INFINITY] {
        let message = refused("p^2/2 + q^2", &[1.0], &[0.0], 3, step).to_string();
        assert!(message.contains("the step is"), "{message}");
    }
    for stages in [0, 33] {
        let message = refused("p^2/2 + q^4", &[1.0], &[0.0], stages, 0.1).to_string();
        assert!(message.contains("stages requested"), "{message}");
    }
}
