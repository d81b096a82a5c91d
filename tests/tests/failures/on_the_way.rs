//! Steps that cannot be made, and what is left of the run before them.

use super::{kepler_failure_until, says};
use equip_autodiff::Hamiltonian;
use equip_integrate::{AlphaPolicy, Alphas, Equip, Gauss, IntegrateError, Preconditioner};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, henon_heiles};

/// H = p²/2 + (1 − q)^(3/2): a particle thrown over the edge q = 1 of the domain, where the force still is
/// finite.
fn edge() -> Hamiltonian {
    Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0]).powf(1.5)).unwrap()
}

fn leaves_the_domain<T: Float>() {
    let options = Equip::stages(3).step(T::ratio(1, 20));
    let (q, p) = ([T::int(0)], [T::int(1)]);
    let failure = options
        .integrate(&edge(), &q, &p, T::int(0)..=T::int(5))
        .unwrap_err();
    let IntegrateError::NotFinite {
        time,
        step,
        halvings,
    } = failure.error
    else {
        panic!("{:?}", failure.error);
    };
    says(
        &failure.to_string(),
        &["leaves the domain of H", "or the step is too large"],
    );
    assert!(halvings == 10 && step <= T::ratio(1, 20));

    // What was made is there, and is what a run that ends before the edge makes.
    let partial = failure.partial.unwrap();
    let (t, q_last, p_last) = partial.last();
    assert!(t <= time && partial.len() > 2 && q_last[0] < T::int(1));
    assert_eq!(partial.certificate().end, t);
    let good = options.integrate(&edge(), &q, &p, T::int(0)..=t).unwrap();
    assert_eq!(good.last(), (t, q_last, p_last));

    // A stepper that failed stands where it stood, and fails again in the same way.
    let mut run = options.start(&edge(), &q, &p, T::int(0)).unwrap();
    let first = loop {
        if let Err(error) = run.advance() {
            break error;
        }
    };
    let state = |view: equip_integrate::StepView<'_, T>| {
        (
            view.index,
            view.time,
            view.q.to_vec(),
            view.p.to_vec(),
            view.energy_error,
        )
    };
    let stopped = state(run.view());
    assert_eq!(
        (stopped.1, &stopped.2[..], &stopped.3[..]),
        (t, q_last, p_last)
    );
    for _ in 0..3 {
        assert_eq!(run.advance().unwrap_err(), first);
        assert_eq!(state(run.view()), stopped);
        assert_eq!(run.counts().steps, stopped.0);
    }
    assert_eq!(run.next().unwrap().unwrap_err(), first);
}

#[test]
fn an_energy_that_ends_somewhere() {
    leaves_the_domain::<f64>();
    leaves_the_domain::<DoubleDouble>();
}

#[test]
fn an_edge_with_an_infinite_force() {
    // √(1 − q): the stages diverge before they leave the domain, or leave it; either is typed.
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0]).sqrt()).unwrap();
    let options = Equip::stages(3).step(0.05);
    let failure = options
        .integrate(&h, &[0.0], &[1.0], 0.0..=5.0)
        .unwrap_err();
    assert!(
        matches!(
            failure.error,
            IntegrateError::NotFinite { .. } | IntegrateError::NoConvergence { .. }
        ),
        "{:?}",
        failure.error
    );
    assert!(failure.partial.unwrap().last().1[0] < 1.0);
}

#[test]
fn stages_that_do_not_converge() {
    // Half a period in one step.
    let options = Equip::stages(3).step(3.0).max_halvings(0);
    let options = options.preconditioner(Preconditioner::Identity);
    let (error, text) = kepler_failure_until(&options, 3.0);
    assert!(
        matches!(
            error,
            IntegrateError::NoConvergence {
                iterations: 2..,
                halvings: 0,
                ..
            }
        ),
        "{error:?}"
    );
    says(&text, &["did not converge", "use a smaller step"]);
}

/// H = q p grows like e^t; the implicit midpoint rule with h = 2 has the matrix 1 − h/2 = 0.
fn no_pivot<T: Float>() {
    let h = Hamiltonian::new(1, |q, p| q[0] * p[0]).unwrap();
    let options = Gauss::stages(1).step(T::int(2)).max_halvings(0);
    let one = [T::int(1)];
    let failure = options
        .integrate(&h, &one, &one, T::int(0)..=T::int(4))
        .unwrap_err();
    let expected = IntegrateError::Singular {
        time: T::int(0),
        step: T::int(2),
        halvings: 0,
    };
    assert_eq!(failure.error, expected);
    says(
        &failure.to_string(),
        &["singular", "use a slightly different step"],
    );
    assert_eq!(failure.partial.unwrap().len(), 1);
    // Halved, it is not singular.
    let run = options
        .max_halvings(1)
        .integrate(&h, &one, &one, T::int(0)..=T::int(4))
        .unwrap();
    assert_eq!(run.certificate().counts.halvings, 2);
}

#[test]
fn a_singular_newton_matrix() {
    no_pivot::<f64>();
    no_pivot::<DoubleDouble>();
}

/// Chaotic Hénon–Heiles with a large step and the single α of the paper.
fn refuses<T: Float>() {
    let (h, Start { q, p }) = henon_heiles::<T>(T::ratio(1, 6), "-0.2", "0.1");
    let options = Equip::stages(2)
        .alphas(Alphas::Last)
        .step(T::ratio(1, 2))
        .max_halvings(0)
        .alpha_policy(AlphaPolicy::Refuse);
    let interval = T::int(0)..=T::int(500);
    let failure = options.integrate(&h, &q, &p, interval).unwrap_err();
    let IntegrateError::NoAdmissibleAlpha {
        time,
        energy_error,
        round_off,
        ..
    } = failure.error
    else {
        panic!("{:?}", failure.error);
    };
    assert!(energy_error.abs() > round_off && round_off > T::int(0));
    says(
        &failure.to_string(),
        &[
            "smaller step",
            "more stages",
            "several α_k",
            "accept uncorrected steps",
        ],
    );
    let partial = failure.partial.unwrap();
    assert_eq!(partial.last().0, time);
    assert!(partial.certificate().energy_conserved_on_every_step());
}

#[test]
fn no_admissible_alpha_when_the_user_refuses_to_carry() {
    refuses::<f64>();
    refuses::<DoubleDouble>();
}
