//! Long runs: nothing grows but what must. Figures of the longest ones stand in `docs/long-runs.md`.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Counts, Equip, Gauss, Method, Outcome};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;
use equip_tests::{Start, Trend, kepler, trend};
use std::time::Instant;

/// Samples taken along a run.
const SAMPLES: u64 = 1000;
/// Floors within which the energy of a run stays: steps are judged by the largest floor of late, so that one
/// with a lower floor of its own may have a defect of somewhat more.
const LEVELS: f64 = 2.0;

/// What a run of n steps leaves behind. Energies and moments of the samples are those of the f64 states,
/// computed in double-double.
#[derive(Debug)]
struct Long {
    n: u64,
    counts: Counts,
    /// Largest |H − H(y0)| of all steps, in f64.
    energy: f64,
    /// The same in round-off levels of the steps; 0 for Gauss, which is not judged by them.
    in_levels: f64,
    /// The largest round-off level of H, the running error bound over all operations of its recording. With
    /// six bodies it is ten times ε (2|H| + Σ|∂_iH y_i|), the rounding of the ends of its sums.
    floor: f64,
    /// H − H(y0) at the samples.
    energies: Vec<f64>,
    /// L − L(y0) at the samples, and L(y0).
    moments: Vec<f64>,
    moment: f64,
}

impl Long {
    fn run(
        method: Method,
        hamiltonian: &Hamiltonian,
        start: &Start<f64>,
        h: f64,
        n: u64,
        moment: Moment,
    ) -> Self {
        let mut evaluator = hamiltonian.evaluator::<DoubleDouble>();
        let mut exact = |q: &[f64], p: &[f64]| {
            let y: Vec<DoubleDouble> = q.iter().chain(p).map(|&x| DoubleDouble::exact(x)).collect();
            let (q, p) = y.split_at(q.len());
            (evaluator.value(&y), moment(q, p))
        };
        let (h0, l0) = exact(&start.q, &start.p);
        let mut long = Long {
            n,
            counts: Counts::default(),
            energy: 0.0,
            in_levels: 0.0,
            floor: 0.0,
            energies: vec![0.0],
            moments: vec![0.0],
            moment: l0.to_f64(),
        };
        // An odd distance between samples meets all phases of an orbit.
        let every = (n / SAMPLES) | 1;
        let begun = Instant::now();
        let mut stepper = method
            .step(h)
            .start(hamiltonian, &start.q, &start.p, 0.0)
            .unwrap();
        for index in 1..=n {
            let view = stepper.advance().unwrap();
            long.energy = long.energy.max(view.energy_error.unwrap().abs());
            if index % every == 0 {
                let (h1, l1) = exact(view.q, view.p);
                long.energies.push((h1 - h0).to_f64());
                long.moments.push((l1 - l0).to_f64());
            }
        }
        long.counts = *stepper.counts();
        let certificate = stepper.certificate();
        long.in_levels = certificate.energy_in_round_off_levels.unwrap_or(0.0);
        long.floor = certificate
            .energy_round_off
            .map_or(0.0, |level| level.round_off);
        long.print(method, begun.elapsed().as_secs_f64());
        long
    }

    fn print(&self, method: Method, seconds: f64) {
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let show = |name: &str, x: &[f64]| {
            let Trend {
                slope,
                random_walk,
                standard_error,
            } = trend(x);
            let all = x.len() as f64;
            println!(
                "  {name}: samples max {:.2e}, trend over the run {:.1e} ± {:.1e} (random walk {:.1e})",
                largest(x),
                slope * all,
                standard_error * all,
                random_walk * all
            );
        };
        println!(
            "{method}, {} steps, {seconds:.1} s: energy max {:.2e}, floor {:.2e}, in floors {:.2}, {:?}",
            self.n, self.energy, self.floor, self.in_levels, self.counts
        );
        show("energy", &self.energies);
        show("angular momentum", &self.moments);
        println!("  2 sqrt(n) eps |L| = {:.2e}", self.moment_law());
    }

    /// A row of the tables of `docs/long-runs.md`.
    fn row(&self, method: Method) -> String {
        let n = self.n as f64;
        let largest = self.moments.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let is_gauss = method == Gauss::stages(method.stage_count());
        let in_levels = match is_gauss {
            true => String::new(),
            false => format!("{:.1}", self.in_levels),
        };
        format!(
            "| {}, {} stages | {:.1e} | {in_levels} | {largest:.1e} | {:.1e} | {:.2} | {:.1} |\n",
            if is_gauss { "Gauss" } else { "EQUIP" },
            method.stage_count(),
            self.energy,
            self.moment_law(),
            self.counts.fixed_point_iterations as f64 / n,
            100.0 * self.counts.outcome(Outcome::Solved) as f64 / n,
        )
    }

    /// 2 √n ε |L|.
    fn moment_law(&self) -> f64 {
        2.0 * (self.n as f64).sqrt() * f64::EPSILON * self.moment.abs()
    }

    /// The energy error is bounded by round-off, by the solver's evaluation of H and by one in double-double,
    /// and has no trend beyond it: within a floor the energy moves as that of Gauss does. The angular
    /// momentum walks at random.
    fn keeps_both(&self) {
        // Measured: 0.2 to 1.13 floors, the energy by double-double 4e-22 where the floor is 4.0e-22.
        assert!(
            self.floor > 0.0 && self.in_levels <= LEVELS,
            "{} floors",
            self.in_levels
        );
        for defect in &self.energies {
            assert!(
                defect.abs() <= LEVELS * self.floor,
                "{defect:e}, floor {:e}",
                self.floor
            );
        }
        let Trend {
            slope,
            standard_error,
            ..
        } = trend(&self.energies);
        let drift = slope.abs() * self.energies.len() as f64;
        let noise = 4.0 * standard_error * self.energies.len() as f64;
        assert!(drift <= noise.max(self.floor), "energy drifts by {drift:e}");
        self.walks_at_random();
    }

    fn walks_at_random(&self) {
        assert!(self.moments.iter().all(|l| l.abs() <= self.moment_law()));
    }
}

/// A quadratic invariant in double-double.
type Moment = fn(&[DoubleDouble], &[DoubleDouble]) -> DoubleDouble;

fn kepler_run(method: Method, steps_per_period: i32, n: u64) -> Long {
    let (hamiltonian, start) = kepler::<f64>(6);
    let h = std::f64::consts::TAU / f64::from(steps_per_period);
    Long::run(method, &hamiltonian, &start, h, n, |q, p| {
        q[0] * p[1] - q[1] * p[0]
    })
}

/// Prints a table of `docs/long-runs.md`.
fn print(rows: &[String]) {
    println!(
        "\n| | energy, max | in round-off levels | angular momentum, max | 2√n ε\\|L\\| | iterations per step | steps with α, % |\n\
         |---|---|---|---|---|---|---|\n{}",
        rows.concat()
    );
}

fn kepler_keeps_both(s: usize, steps_per_period: i32, n: u64) -> String {
    let gauss = kepler_run(Gauss::stages(s), steps_per_period, n);
    gauss.walks_at_random();
    let equip = kepler_run(Equip::stages(s), steps_per_period, n);
    equip.keeps_both();
    assert_eq!(equip.counts.uncorrected(), 0);
    assert!(gauss.energy > 1e3 * equip.energy);
    gauss.row(Gauss::stages(s)) + &equip.row(Equip::stages(s))
}

#[test]
fn kepler_a_hundred_thousand_steps() {
    kepler_keeps_both(3, 160, 100_000);
    kepler_keeps_both(4, 100, 100_000);
}

#[test]
#[ignore = "long: .ci/figures runs it"]
fn kepler_ten_million_steps() {
    print(&[(3, 160), (4, 100)].map(|(s, steps)| kepler_keeps_both(s, steps, 10_000_000)));
}

/// What the angular momentum of Kepler's problem grows by in a step: slopes of the least-squares lines
/// through the origin of runs whose steps are a little different, their mean, and its standard error.
fn growth(method: Method, e: i64, steps_per_period: f64, n: u64) -> ([f64; 8], f64, f64) {
    let (hamiltonian, start) = kepler::<f64>(e);
    let slopes: [f64; 8] = std::array::from_fn(|run| {
        let h = std::f64::consts::TAU / (steps_per_period * (1.0 + 0.0037 * run as f64));
        let run = Long::run(method, &hamiltonian, &start, h, n, |q, p| {
            q[0] * p[1] - q[1] * p[0]
        });
        let (mut products, mut squares) = (0.0, 0.0);
        for (i, l) in run.moments.iter().enumerate() {
            products += i as f64 * l;
            squares += (i as f64).powi(2);
        }
        products / squares / ((n / SAMPLES) | 1) as f64
    });
    let count = slopes.len() as f64;
    let mean = slopes.iter().sum::<f64>() / count;
    let variance = slopes.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let error = (variance / count).sqrt();
    println!("{method}: {slopes:?}, mean {mean:.1e} ± {error:.1e}");
    (slopes, mean, error)
}

/// Steps of nearly half a period, which begin an orbit's size off: what early iterations are off is not to be
/// left in the last.
#[test]
fn the_angular_momentum_does_not_grow_in_long_steps() {
    // Measured: 1.8e-18 and 3.9e-18 ± 1.2e-18; 2e-17 with K B K made of ½ + U rounded.
    for method in [Gauss::stages(16), Equip::stages(16)] {
        let (_, mean, _) = growth(method, 1, 2.24, 30_000);
        assert!(mean.abs() <= 6e-18, "{mean:e}");
    }
}

/// It walks at random up to some 10⁶ steps; beyond, what iterations leave is repeated from period to period,
/// and differs from one size of the step to the next.
#[test]
#[ignore = "long: run with cargo test -p equip-tests --release --test all long:: -- --ignored"]
fn the_angular_momentum_grows_little_in_a_million_steps() {
    // Measured: single runs up to 3.0e-20, means 1.3e-20 and 0.7e-20.
    for method in [Gauss::stages(4), Equip::stages(4)] {
        let (slopes, mean, _) = growth(method, 6, 100.0, 1_000_000);
        assert!(
            slopes.iter().all(|slope| slope.abs() <= 5e-20),
            "{slopes:?}"
        );
        assert!(mean.abs() <= 2.5e-20, "{mean:e}");
    }
}

/// Moves bodies in space to where their common centre of mass rests at the origin. In the reference's frame
/// it moves 6.8e-6 astronomical units a day: after 10⁸ days all positions are 680 units off, and their
/// rounding is a hundred times what it was at the start.
fn to_barycentre(hamiltonian: &Hamiltonian, q: &mut [f64], p: &mut [f64]) {
    // ∂H/∂p at momenta 1 has the masses.
    let n = q.len();
    let y: Vec<f64> = q.iter().copied().chain(vec![1.0; n]).collect();
    let mut gradient = vec![0.0; 2 * n];
    hamiltonian.evaluator::<f64>().gradient(&y, &mut gradient);
    let masses: Vec<f64> = gradient[n..].iter().map(|x| x.recip()).collect();
    for axis in 0..3 {
        let along = || (axis..n).step_by(3);
        let all: f64 = along().map(|k| masses[k]).sum();
        let centre = along().map(|k| masses[k] * q[k]).sum::<f64>() / all;
        let velocity = along().map(|k| p[k]).sum::<f64>() / all;
        for k in along() {
            q[k] -= centre;
            p[k] -= masses[k] * velocity;
        }
    }
}

fn outer_solar_system(method: Method, h: f64, days: f64) -> Long {
    let instance = Instance::from_reference("outer_ss").unwrap();
    let (mut q, mut p) = instance.initial::<f64>();
    to_barycentre(instance.hamiltonian(), &mut q, &mut p);
    let n = (days / h).round() as u64;
    // The third component of the total angular momentum.
    let moment: Moment = |q, p| {
        let bodies = q.chunks_exact(3).zip(p.chunks_exact(3));
        bodies.fold(DoubleDouble::int(0), |sum, (q, p)| {
            sum + (q[0] * p[1] - q[1] * p[0])
        })
    };
    Long::run(
        method,
        instance.hamiltonian(),
        &Start { q, p },
        h,
        n,
        moment,
    )
}

fn outer_solar_system_keeps_both(s: usize, h: f64, days: f64) -> String {
    let gauss = outer_solar_system(Gauss::stages(s), h, days);
    gauss.walks_at_random();
    let equip = outer_solar_system(Equip::stages(s), h, days);
    equip.keeps_both();
    gauss.row(Gauss::stages(s)) + &equip.row(Equip::stages(s))
}

#[test]
#[ignore = "long: .ci/figures runs it"]
fn outer_solar_system_a_million_days() {
    print(&[4, 5, 6].map(|s| outer_solar_system_keeps_both(s, 100.0, 1e6)));
}

#[test]
#[ignore = "long: .ci/figures runs it"]
fn outer_solar_system_a_hundred_million_days() {
    print(&[outer_solar_system_keeps_both(8, 200.0, 1e8)]);
}
