//! Wild units, shifted energies, every number of stages.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Alphas, Counts, Equip, Gauss, Method};
use equip_scalar::{Constant, DoubleDouble, Float};
use equip_tests::{Start, decimal_digits, distance, henon_heiles, kepler, relative_distance};

/// Kepler e = 0.6 in units of length, mass and time: H = |p|²/(2M) − (L³M/τ²)/|q|.
struct Units<T> {
    length: T,
    mass: T,
    time: T,
}

impl<T: Float + Into<Constant>> Units<T> {
    /// Hamiltonian, start and factor of the momenta.
    fn kepler(&self) -> (Hamiltonian, Start<T>, T) {
        let momentum = self.mass * self.length / self.time;
        // Products ordered such that none leaves the range of the float type.
        let strength = momentum * self.length / self.time * self.length;
        let (mass, strength): (Constant, Constant) = (self.mass.into(), strength.into());
        let h = Hamiltonian::new(2, |q, p| {
            (p[0] / mass * p[0] + p[1] / mass * p[1]) / 2.0 - strength / q[0].hypot(q[1])
        });
        let (_, Start { q, p }) = kepler::<T>(6);
        let start = Start {
            q: q.iter().map(|&x| x * self.length).collect(),
            p: p.iter().map(|&x| x * momentum).collect(),
        };
        (h.unwrap(), start, momentum)
    }

    /// The trajectory in units of length and momentum, 100 steps of 1/16, and its counts.
    fn trajectory(&self, method: Method) -> (Vec<T>, Counts) {
        let (h, start, momentum) = self.kepler();
        let step = self.time / T::int(16);
        let mut run = method
            .step(step)
            .start(&h, &start.q, &start.p, T::int(0))
            .unwrap();
        let mut all = Vec::new();
        for _ in 0..100 {
            let view = run.advance().unwrap();
            all.extend(view.q.iter().map(|&x| x / self.length));
            all.extend(view.p.iter().map(|&x| x / momentum));
        }
        (all, *run.counts())
    }
}

const METHODS: fn() -> [Method; 3] = || {
    [
        Gauss::stages(3),
        Equip::stages(3),
        Equip::stages(4).alphas(Alphas::Last),
    ]
};

fn units_do_not_matter<T: Float + Into<Constant>>(power: i64, tolerance: f64) {
    let scale = |k: i64| -> T {
        let ten = (0..k.abs()).fold(T::int(1), |x, _| x * T::int(10));
        if k < 0 { T::int(1) / ten } else { ten }
    };
    for method in METHODS() {
        let one = Units {
            length: T::int(1),
            mass: T::int(1),
            time: T::int(1),
        };
        let (reference, counts) = one.trajectory(method);
        for (l, m, t) in [
            (power, 0, 0),
            (-power, 0, 0),
            (0, power, 0),
            (0, -power, 0),
            (0, 0, power),
            (0, 0, -power),
            (power, -power, power),
            (-power, power, -power),
        ] {
            let units = Units {
                length: scale(l),
                mass: scale(m),
                time: scale(t),
            };
            let (scaled, scaled_counts) = units.trajectory(method);
            let off = distance(&scaled, &reference).to_f64();
            println!("{method}, {}, 1e{l}, 1e{m}, 1e{t}: {off:.1e}", T::NAME);
            assert!(off < tolerance, "{method}, 1e{l}, 1e{m}, 1e{t}: {off:e}");
            let ends = |c: &Counts| [c.uncorrected(), c.halvings];
            assert_eq!(ends(&scaled_counts), ends(&counts));
        }
    }
}

#[test]
fn units_of_ten_to_the_hundred() {
    units_do_not_matter::<f64>(100, 1e-11);
}

#[test]
fn units_of_ten_to_the_sixty_in_double_double() {
    // The low parts of a double-double need room below: squares of 1e-100 have none to spare.
    units_do_not_matter::<DoubleDouble>(60, 1e-27);
}

#[test]
fn units_that_are_powers_of_two_change_no_bit() {
    for method in METHODS() {
        // A division by 1 would not be recorded, and not be in the bound of the rounding.
        let one = Units {
            length: 1.0,
            mass: 2.0,
            time: 1.0,
        };
        let (reference, counts) = one.trajectory(method);
        for (l, m, t) in [
            (200, 0, 0),
            (0, -300, 0),
            (0, 0, 250),
            (-150, 99, -53),
            (77, -200, 121),
        ] {
            let units = Units {
                length: 2.0_f64.powi(l),
                mass: 2.0_f64.powi(m + 1),
                time: 2.0_f64.powi(t),
            };
            let (scaled, scaled_counts) = units.trajectory(method);
            assert!(scaled == reference, "{method}, 2^{l}, 2^{m}, 2^{t}");
            assert_eq!(scaled_counts, counts);
        }
    }
}

/// Kepler with 10¹⁰ added to H: the same motion, but the floor of the energy is that of 10¹⁰.
fn shifted_energy<T: Float>(n: i64, s: usize) {
    let (h, start) = kepler::<T>(6);
    let shifted = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt() + 1e10
    })
    .unwrap();
    let step = T::two_pi() / T::int(n);
    let end = |h: &Hamiltonian, method: Method| {
        let mut run = method
            .step(step)
            .start(h, &start.q, &start.p, T::int(0))
            .unwrap();
        for _ in 0..3 * n {
            run.advance().unwrap();
        }
        let view = run.view();
        ([view.q, view.p].concat(), run.certificate())
    };
    let error = |state: &[T]| distance(state, &start.state()).to_f64();
    let (plain, _) = end(&h, Equip::stages(s));
    let (gauss, _) = end(&h, Gauss::stages(s));
    for alphas in [Alphas::Several, Alphas::Last] {
        let (state, certificate) = end(&shifted, Equip::stages(s).alphas(alphas));
        let energy = certificate.energy.as_ref().unwrap().max;
        println!(
            "{}, s = {s}, n = {n}, {alphas:?}: error {:.2e} (Gauss {:.2e}, unshifted {:.2e}), defect {energy:.1e}, alphas {:?}",
            T::NAME,
            error(&state),
            error(&gauss),
            error(&plain),
            certificate.alpha_range
        );
        assert!(certificate.energy_conserved_on_every_step());
        assert!(certificate.energy_in_round_off_levels.unwrap() <= T::int(8));
        // Measured up to 10 roundings of H, which is what 4 floors are here.
        assert!(energy <= T::int(16) * T::int(10_000_000_000) * T::EPSILON);
        // Never judge by the energy: the trajectory is no worse than that of Gauss.
        assert!(error(&state) <= 1.05 * error(&gauss));
        assert!(
            certificate
                .alpha_range
                .iter()
                .all(|(a, b)| a.abs().max(b.abs()) <= T::ratio(1, 5))
        );
    }
}

#[test]
fn an_energy_with_a_large_constant_added() {
    shifted_energy::<f64>(160, 3);
    shifted_energy::<f64>(80, 3);
    shifted_energy::<f64>(40, 3);
    shifted_energy::<DoubleDouble>(80, 3);
    shifted_energy::<DoubleDouble>(60, 6);
}

fn every_number_of_stages<T: Float>(stages: &[usize], floor: f64) {
    let end = |method: Method| {
        let (h, Start { q, p }) = henon_heiles::<T>(T::ratio(1, 12), "0.3", "0.2");
        let mut run = method
            .step(T::ratio(1, 2))
            .start(&h, &q, &p, T::int(0))
            .unwrap();
        for _ in 0..20 {
            run.advance().unwrap();
        }
        let view = run.view();
        ([view.q, view.p].concat(), run.certificate())
    };
    let (exact, _) = end(Gauss::stages(24));
    let mut last = [f64::INFINITY; 2];
    for &s in stages {
        let methods = [
            Gauss::stages(s),
            if s < 2 {
                Gauss::stages(s)
            } else {
                Equip::stages(s)
            },
        ];
        for (method, last) in methods.into_iter().zip(&mut last) {
            let (state, certificate) = end(method);
            let error = relative_distance(&state, &exact).to_f64();
            let energy = certificate.energy.as_ref().unwrap().max.to_f64();
            println!(
                "{method}, {}: error {error:.2e}, energy {energy:.1e}",
                T::NAME
            );
            assert!(
                error < (*last / 3.0).max(floor),
                "{method}: {error:e} after {last:e}"
            );
            if s >= 3 && certificate.energy_in_round_off_levels.is_some() {
                assert!(
                    certificate.energy_conserved_on_every_step(),
                    "{certificate}"
                );
                assert!(decimal_digits(T::exact(energy)) > -floor.log10());
            }
            *last = error;
        }
    }
}

#[test]
fn one_to_twenty_stages() {
    let all: Vec<usize> = (1..=20).collect();
    every_number_of_stages::<f64>(&all, 3e-15);
    every_number_of_stages::<DoubleDouble>(&[1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20], 1e-30);
}

/// A circular orbit has the least energy of all with its angular momentum: to remove a floor of a defect
/// takes an eccentricity of √ε, or of ε/e where e is larger. Beside the closed form after a thousand periods.
#[test]
#[ignore = "known deficit: 1.5 times the gradients of Gauss with 8 steps a period, e = 1e-6, 1.2 allowed"]
fn circular_orbits_stay_what_they_are() {
    let h = Hamiltonian::new(2, |q, p| {
        (p[0] * p[0] + p[1] * p[1]) / 2.0 - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    });
    let (h, end) = (h.unwrap(), 6280.5_f64);
    // Kepler's equation to e³.
    let place = |e: f64| {
        let anomaly = end + e * end.sin() + e * e / 2.0 * (2.0 * end).sin();
        [anomaly.cos() - e, (1.0 - e * e).sqrt() * anomaly.sin()]
    };
    let run = |method: Method, e: f64, steps: i32| {
        let (q, p) = ([1.0 - e, 0.0], [0.0, ((1.0 + e) / (1.0 - e)).sqrt()]);
        let mut run = method
            .step(end / f64::from(steps))
            .start(&h, &q, &p, 0.0)
            .unwrap();
        for _ in 0..steps {
            run.advance().unwrap();
        }
        (distance(run.view().q, &place(e)), run.certificate())
    };
    for (e, s, steps) in [
        (0.0_f64, 8, 30_000),
        (0.0, 8, 29_980),
        (1e-8, 8, 30_040),
        (1e-6, 8, 30_020),
        (1e-4, 8, 29_970),
        (1e-6, 8, 8000),
    ] {
        let (error, certificate) = run(Equip::stages(s), e, steps);
        let (_, gauss) = run(Gauss::stages(s), e, steps);
        println!("e = {e}, s = {s}: {error:.1e}");
        // Measured up to 8e-11; with one defect in some thousand steps removed 2e-9, with every one 1.7e-8 to
        // 2e-7.
        assert!(error < 2e-10);
        assert!(certificate.energy_conserved_on_every_step());
        assert!(certificate.energy_in_round_off_levels.unwrap() <= 8.0);
        let gradients = [&certificate, &gauss].map(|c| c.counts.gradients as f64);
        assert!(gradients[0] < 1.2 * gradients[1], "{gradients:?}");
    }
    // 3.5 steps a period round as much in a step as 8 stages in ten: a defect beyond 7 floors, which must be
    // removed, falls to 40 of 100 runs.
    let mut errors: Vec<f64> = (0..24)
        .map(|k| {
            let (error, certificate) = run(Equip::stages(16), 1e-8 * 1.4_f64.powi(k), 3500);
            assert!(certificate.energy_in_round_off_levels.unwrap() <= 8.0);
            error
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    println!("s = 16: {errors:?}");
    assert!(errors[8] < 2e-10 && errors[23] < 2e-6);
}
