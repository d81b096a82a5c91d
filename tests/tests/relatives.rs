//! HBVM(k, s), the averaged vector field and trapezoidal methods: orders, conservation of H, published and
//! independently computed figures.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Gauss, IntegrateError, Invariant, Method, Preconditioner, Record, Run};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::find;

type Start<T> = (Vec<T>, Vec<T>);

fn run<T: Float>(
    h: &Hamiltonian,
    (q, p): &Start<T>,
    method: Method,
    (end, steps): (T, u64),
) -> Run<T> {
    let step = end / T::int(steps as i64);
    let method = method.step(step).record(Record::Ends);
    method.integrate(h, q, p, T::int(0)..=end).unwrap()
}

fn distance<T: Float>(run: &Run<T>, (q, p): &Start<T>) -> f64 {
    let (_, q1, p1) = run.last();
    let pairs = q.iter().chain(p).zip(q1.iter().chain(p1));
    let errors = pairs.map(|(&a, &b)| (a - b).abs().to_f64());
    errors.fold(0.0, f64::max)
}

/// Kepler's problem, e = 0.6, two periods, in quad precision by an independent program: error at the end,
/// largest |ΔH| and |ΔL| with 80 steps a period.
#[test]
fn hbvm_has_the_figures_of_quad_precision() {
    let scene = find("kepler").unwrap().instance(&[("e", "0.6")]).unwrap();
    let start = scene.initial::<DoubleDouble>();
    let end = DoubleDouble::int(2) * scene.period::<DoubleDouble>();
    let momentum = Hamiltonian::new(2, |q, p| q[0] * p[1] - q[1] * p[0]).unwrap();
    for (k, s, error, energy, l) in [
        (2, 2, [5.872e-3, 3.906e-4], [2.24e-5, 1.50e-6], [0.0, 0.0]),
        (
            4,
            2,
            [5.834e-4, 3.686e-5],
            [1.10e-9, 4.39e-12],
            [1.03e-5, 6.45e-7],
        ),
        (
            6,
            2,
            [5.832e-4, 3.685e-5],
            [2.97e-14, 7.92e-18],
            [1.03e-5, 6.45e-7],
        ),
        (
            6,
            3,
            [1.660e-6, 2.636e-8],
            [5.70e-14, 1.24e-17],
            [1.99e-8, 3.11e-10],
        ),
        (
            9,
            3,
            [1.660e-6, 2.636e-8],
            [1.29e-20, 3.77e-26],
            [1.99e-8, 3.11e-10],
        ),
    ] {
        for (i, steps) in [160, 320].into_iter().enumerate() {
            let method = Method::hbvm(k, s).step(end / DoubleDouble::int(steps));
            let method = method
                .record(Record::Ends)
                .invariant(Invariant::new("L", momentum.clone()));
            let (q, p) = &start;
            let run = method.integrate(scene.hamiltonian(), q, p, DoubleDouble::int(0)..=end);
            let run = run.unwrap();
            let certificate = run.certificate();
            let found = [
                distance(&run, &start),
                certificate.energy.as_ref().unwrap().max.to_f64(),
                certificate.invariants[0].max.to_f64(),
            ];
            println!("HBVM({k}, {s}), {steps}: {found:?}");
            for (found, wanted) in found.into_iter().zip([error[i], energy[i], l[i]]) {
                let off = (found - wanted).abs();
                assert!(
                    off <= 0.01 * wanted + 1e-29,
                    "HBVM({k}, {s}), {steps}: {found:e}, {wanted:e}"
                );
            }
        }
    }
}

/// Orders on a double pendulum, which is not separable, and conservation of H with the smaller step.
#[test]
fn orders_are_those_of_the_degree() {
    let scene = find("double-pendulum").unwrap().instance(&[]).unwrap();
    let start = scene.initial::<f64>();
    let exact = run(scene.hamiltonian(), &start, Gauss::stages(12), (2.0, 160));
    let (_, q, p) = exact.last();
    let exact = (q.to_vec(), p.to_vec());
    for (method, order, steps) in [
        (Method::averaged_vector_field(), 2.0, 80),
        (Method::trapezoidal(5), 2.0, 80),
        (Method::hbvm(6, 2), 4.0, 80),
        (Method::hbvm(8, 3), 6.0, 80),
        (Method::hbvm(10, 4), 8.0, 40),
    ] {
        let runs =
            [steps, 2 * steps].map(|steps| run(scene.hamiltonian(), &start, method, (2.0, steps)));
        let energy = runs[1].certificate().energy.as_ref().unwrap().max;
        let most = match method == Method::trapezoidal(5) {
            true => 1e-6,
            false => 1e-12,
        };
        assert!(energy < most, "{method}: {energy:e}");
        let errors = runs.map(|run| distance(&run, &exact));
        let found = (errors[0] / errors[1]).log2();
        println!("{method}: order {found:.2}, {errors:?}");
        assert!((found - order).abs() < 0.15, "{method}: {found}");
    }
}

/// Of a quartic H the averaged vector field takes two nodes, and conserves it to round-off; so does Boole's
/// rule, which is exact to degree 5.
#[test]
fn a_quartic_energy_is_conserved_by_as_many_nodes_as_it_takes() {
    let quartic = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + 0.25 * q[0].powi(4)).unwrap();
    let start = (vec![1.0], vec![0.3]);
    for method in [
        Method::averaged_vector_field(),
        Method::trapezoidal(5),
        Method::hbvm(4, 2),
    ] {
        let run = run(&quartic, &start, method, (100.0, 1000));
        let certificate = run.certificate();
        println!("{}: {:?}", certificate.method, certificate.energy);
        assert!(certificate.energy.as_ref().unwrap().max < 2e-14, "{method}");
        if method == Method::averaged_vector_field() {
            assert_eq!(certificate.method.stage_count(), 2);
        }
    }
}

/// Every preconditioner finds the same step of a stiff H, also where K is singular.
#[test]
fn preconditioners_agree_on_their_steps() {
    let scene = find("fpu").unwrap().instance(&[]).unwrap();
    let start = scene.initial::<f64>();
    for method in [
        Method::hbvm(6, 3),
        Method::averaged_vector_field(),
        Method::trapezoidal(4),
    ] {
        let ends = [
            Preconditioner::Identity,
            Preconditioner::Diagonal,
            Preconditioner::Frozen,
            Preconditioner::Full,
        ]
        .map(|m| {
            let options = method.step(0.01).preconditioner(m).record(Record::Ends);
            let run = options.integrate(scene.hamiltonian(), &start.0, &start.1, 0.0..=1.0);
            let (_, q, p) = {
                let run = run.unwrap();
                let (t, q, p) = run.last();
                (t, q.to_vec(), p.to_vec())
            };
            [q, p].concat()
        });
        for end in &ends[1..] {
            let off = end
                .iter()
                .zip(&ends[0])
                .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            println!("{method}: {off:.1e}");
            assert!(off < 1e-12, "{method}: {off:e}");
        }
    }
}

/// HBVM by a tolerance, with dense output: errors are those of its order.
#[test]
fn hbvm_follows_a_tolerance() {
    let scene = find("henon-heiles").unwrap().instance(&[]).unwrap();
    let (q, p) = scene.initial::<f64>();
    let exact = run(
        scene.hamiltonian(),
        &(q.clone(), p.clone()),
        Gauss::stages(12),
        (20.0, 200),
    );
    let exact = (exact.last().1.to_vec(), exact.last().2.to_vec());
    for tolerance in [1e-6, 1e-9] {
        let options = Method::hbvm(8, 4).tolerance(tolerance).dense();
        let run = options
            .integrate(scene.hamiltonian(), &q, &p, 0.0..=20.0)
            .unwrap();
        let error = distance(&run, &exact);
        println!(
            "{tolerance:e}: {error:.1e}, {} steps",
            run.certificate().counts.steps
        );
        assert!(error < 10.0 * tolerance);
        let middle = run.trajectory().unwrap().at(10.0).unwrap();
        let fine = Gauss::stages(12)
            .step(0.1)
            .integrate(scene.hamiltonian(), &q, &p, 0.0..=10.0);
        let fine = fine.unwrap();
        let off = (middle.0[0] - fine.last().1[0]).abs();
        assert!(off < 10.0 * tolerance, "{off:e}");
    }
}

#[test]
fn methods_that_do_not_exist_are_refused() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].powi(4)).unwrap();
    for (method, expected) in [
        (Method::hbvm(2, 3), (2, 3, 32)),
        (Method::hbvm(3, 0), (0, 1, 32)),
        (Method::hbvm(33, 2), (33, 1, 32)),
        (Method::trapezoidal(1), (1, 2, 8)),
        (Method::trapezoidal(9), (9, 2, 8)),
    ] {
        let error = method
            .step(0.1)
            .start(&h, &[1.0], &[0.0], 0.0)
            .map(|_| ())
            .unwrap_err();
        let IntegrateError::StagesOutOfRange { stages, min, max } = error else {
            panic!("{error}");
        };
        assert_eq!((stages, min, max), expected, "{method}");
    }
    // The error of degree 1 has no estimate.
    let by_tolerance = Method::averaged_vector_field().tolerance(1e-6);
    assert!(by_tolerance.start(&h, &[1.0], &[0.0], 0.0).is_err());
}
