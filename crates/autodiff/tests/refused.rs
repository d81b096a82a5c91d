//! What an energy must not do, and that the refusal points at the user's own line.

use equip_autodiff::{BuildError, Hamiltonian, Var};
use std::panic::Location;

#[track_caller]
fn line_before() -> u32 {
    Location::caller().line() - 1
}

#[track_caller]
fn assert_branch(built: Result<Hamiltonian, BuildError>, line: u32) {
    match built.map(|_| ()) {
        Err(error @ BuildError::Branch { location }) => {
            assert!(location.file().ends_with("tests/refused.rs"), "{location}");
            assert_eq!(location.line(), line);
            assert!(
                error.to_string().contains(&format!("refused.rs:{line}:")),
                "{error}"
            );
            assert!(error.to_string().contains(".min()"), "{error}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_comparison_is_refused_at_its_line() {
    let mut line = 0;
    let mut refused = |compare: &dyn Fn(Var, Var) -> bool, at: u32| {
        let built = Hamiltonian::new(1, |q, p| {
            assert!(!compare(q[0], p[0]));
            q[0]
        });
        assert_branch(built, at);
        line = at;
    };
    refused(&|x, y| x < y, line!());
    refused(&|x, y| x <= y, line!());
    refused(&|x, y| x > y, line!());
    refused(&|x, y| x >= y, line!());
    refused(&|x, y| x == y, line!());
    refused(&|x, y| x != y, line!());
    refused(&|x, _| x < 1.0, line!());
    refused(&|x, _| 1.0 >= x, line!());
    refused(&|x, _| x == 0.0, line!());
    refused(&|x, y| x.partial_cmp(&y).is_some(), line!());
    refused(&|x, y| [x, y].iter().any(|z| *z > 2.0), line!());
}

#[test]
fn the_column_is_that_of_the_comparison() {
    let built = Hamiltonian::new(1, |q, _| if q[0] < 0.0 { -q[0] } else { q[0] });
    let line = line_before();
    match built {
        Err(BuildError::Branch { location }) => {
            assert_eq!((location.line(), location.column()), (line, 47));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn read_outs_are_refused_at_their_line() {
    let read_out = |read: &dyn Fn(Var) -> f64, at: u32| {
        let built = Hamiltonian::new(1, |q, _| {
            let seen = read(q[0]);
            assert!(seen.is_nan() || seen == 0.0);
            q[0].sin()
        });
        match built {
            Err(error @ BuildError::ReadOut { location }) => {
                assert_eq!(location.line(), at);
                assert!(
                    error.to_string().contains(&format!("refused.rs:{at}:")),
                    "{error}"
                );
            }
            other => panic!("{other:?}"),
        }
    };
    read_out(&|x| f64::from(x), line!());
    read_out(&|x| x.value(), line!());
    read_out(&|x| x.to_f64(), line!());
    read_out(&|x| f64::from(u8::from(x.is_nan())), line!());
    read_out(&|x| f64::from(u8::from(x.is_finite())), line!());
    read_out(&|x| f64::from(u8::from(x.is_sign_negative())), line!());
    read_out(&|x| x.into(), line!());
}

#[test]
fn no_degrees_of_freedom() {
    let built = Hamiltonian::new(0, |_, _| Var::from(1.0));
    assert!(matches!(built, Err(BuildError::NoDegreesOfFreedom)));
}

#[test]
fn variables_of_another_recording() {
    let mut leaked = None;
    let first = Hamiltonian::new(1, |q, p| {
        leaked = Some(q[0]);
        q[0] * p[0]
    });
    assert!(first.is_ok());
    let stranger = leaked.unwrap();
    let built = Hamiltonian::new(1, |q, _| q[0] + stranger);
    assert!(matches!(built, Err(BuildError::ForeignVariable)));
    let built = Hamiltonian::new(1, |_, _| stranger);
    assert!(matches!(built, Err(BuildError::ForeignVariable)));
    let built = Hamiltonian::new(1, |q, _| q[0].powf(2.5) + stranger.powf(0.5));
    assert!(matches!(built, Err(BuildError::ForeignVariable)));
    let outside = Var::from(2.0).sin() * stranger;
    let built = Hamiltonian::new(1, |q, _| outside * q[0]);
    assert!(matches!(built, Err(BuildError::ForeignVariable)));
    let elsewhere = std::thread::spawn(move || Hamiltonian::new(1, |q, _| q[0] * stranger));
    assert!(matches!(
        elsewhere.join().unwrap(),
        Err(BuildError::ForeignVariable)
    ));
}

#[test]
fn a_recording_inside_a_recording_is_its_own() {
    let outer = Hamiltonian::new(1, |q, p| {
        let inner = Hamiltonian::new(1, |q, _| q[0].powi(3)).unwrap();
        let slope = inner.evaluator::<f64>().value(&[2.0, 0.0]);
        slope * q[0] + p[0]
    })
    .unwrap();
    assert_eq!(outer.evaluator::<f64>().value(&[1.0, 1.0]), 9.0);
    let mixed = Hamiltonian::new(1, |q, _| {
        let outer = q[0];
        assert!(Hamiltonian::new(1, |q, _| q[0] + outer).is_err());
        outer
    });
    assert!(mixed.is_ok());
}

#[test]
fn a_panic_leaves_nothing_behind() {
    let result = std::panic::catch_unwind(|| {
        Hamiltonian::new(1, |q, _| {
            let table: Vec<Var> = Vec::new();
            q[0] + *table.last().expect("the user's own panic")
        })
    });
    assert!(result.is_err());
    assert!(Hamiltonian::new(1, |q, _| q[0]).is_ok());
    // Nothing is being recorded: a variable made now belongs nowhere.
    let outside = Var::from(1.0);
    assert!(matches!(
        Hamiltonian::new(1, |_, _| outside),
        Err(BuildError::ForeignVariable)
    ));
}

#[test]
fn an_endless_wait_for_a_comparison_ends() {
    let result = std::panic::catch_unwind(|| {
        Hamiltonian::new(1, |q, _| {
            let mut x = q[0];
            loop {
                x = (x + q[0] / x) / 2.0;
                if (x * x - q[0]).abs() < 1e-15 {
                    return x;
                }
            }
        })
    });
    let text = result
        .unwrap_err()
        .downcast_ref::<String>()
        .cloned()
        .unwrap();
    assert!(
        text.contains("refused.rs") && text.contains("fixed number of iterations"),
        "{text}"
    );
}

#[test]
fn constants_that_are_not_numbers() {
    let nan = f64::NAN;
    let built = Hamiltonian::new(1, |q, _| q[0] * nan);
    assert!(matches!(built, Err(BuildError::ConstantNotANumber)));
    let built = Hamiltonian::new(1, |q, _| q[0] + Var::from(0.0) / 0.0);
    assert!(matches!(built, Err(BuildError::ConstantNotANumber)));
    let built = Hamiltonian::new(1, |q, _| q[0] + Var::from(-1.0).sqrt() * 2.0);
    assert!(matches!(built, Err(BuildError::ConstantNotANumber)));
    let built = Hamiltonian::new(1, |q, _| q[0].powf(nan));
    assert!(matches!(built, Err(BuildError::ConstantNotANumber)));
}

#[test]
fn constants_that_are_infinite() {
    let infinite = |built: Result<Hamiltonian, _>| {
        assert!(matches!(built, Err(BuildError::ConstantInfinite)));
    };
    infinite(Hamiltonian::new(1, |q, _| q[0] * f64::INFINITY));
    infinite(Hamiltonian::new(1, |q, _| q[0].min(f64::NEG_INFINITY)));
    infinite(Hamiltonian::new(1, |q, _| q[0] + Var::from(1.0) / 0.0));
    infinite(Hamiltonian::new(1, |q, _| {
        (Var::from(800.0).exp()).recip() + q[0]
    }));
    infinite(Hamiltonian::new(1, |q, _| q[0].powf(f64::INFINITY)));
    // NaN is the worse of the two.
    let both = Hamiltonian::new(1, |q, _| q[0] * f64::INFINITY + f64::NAN);
    assert!(matches!(both, Err(BuildError::ConstantNotANumber)));
    // What does not reach H does not matter.
    assert!(Hamiltonian::new(1, |q, _| (q[0] * f64::INFINITY, q[0]).1).is_ok());
}
