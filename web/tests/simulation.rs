//! What both methods make of systems whose course is known.

use equip_web::Simulation;

const KEPLER: &str = "(px^2 + py^2)/2 - 1/sqrt(x^2 + y^2)";

fn largest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

/// Kepler's problem at the pericentre, e = 0.6, H0 = −1/2.
fn kepler(stages: usize, step: f64) -> Simulation {
    Simulation::new(KEPLER, &[0.4, 0.0], &[0.0, 2.0], stages, step).unwrap()
}

#[test]
fn equip_conserves_the_energy_where_gauss_does_not() {
    let step = 0.15;
    for stages in 2..=4 {
        let mut run = kepler(stages, step);
        assert!((run.initial_energy() + 0.5).abs() < 1e-15);
        let progress = run.advance(200);
        assert_eq!(progress.failure, None);
        assert_eq!(progress.times.len(), 200);
        assert!((progress.times[199] - 200.0 * step).abs() < 1e-12);
        let [equip, gauss] = [&progress.equip, &progress.gauss].map(|t| largest(&t.energy_errors));
        assert!(equip < 1e-14, "{stages} stages: {equip:e}");
        assert!(gauss > 1e-8, "{stages} stages: {gauss:e}");
        let certificate = run.equip_certificate().unwrap();
        assert_eq!(certificate.counts.uncorrected(), 0);
        assert!(run.digits(&certificate) > 14.0);
        assert!(run.digits(&run.gauss_certificate()) < 8.0);
        assert!((1e-16..1e-13).contains(&run.round_off_level()));
    }
}

/// The energy errors are those of the states, to the rounding of H.
#[test]
fn energy_errors_are_those_of_the_states() {
    let progress = kepler(3, 0.05).advance(150);
    for track in [&progress.equip, &progress.gauss] {
        for (i, error) in track.energy_errors.iter().enumerate() {
            let [x, y, px, py] = [
                track.q[2 * i],
                track.q[2 * i + 1],
                track.p[2 * i],
                track.p[2 * i + 1],
            ];
            let energy = (px * px + py * py) / 2.0 - 1.0 / x.hypot(y);
            assert!((((energy + 0.5) / 0.5).abs() - error).abs() < 1e-14);
        }
    }
}

/// One call or many make the same bits.
#[test]
fn steps_do_not_depend_on_how_they_are_called() {
    let whole = kepler(3, 0.1).advance(60);
    let mut run = kepler(3, 0.1);
    let mut times = Vec::new();
    let mut q = Vec::new();
    for _ in 0..20 {
        let part = run.advance(3);
        times.extend(part.times);
        q.extend(part.equip.q);
    }
    assert_eq!((times, q), (whole.times, whole.equip.q));
    assert!(run.advance(0).times.is_empty());
}

/// q'' = −q from (1, 0): q = cos t.
#[test]
fn the_oscillator_is_cos_t() {
    let mut run = Simulation::new("(p^2 + q^2)/2", &[1.0], &[0.0], 4, 0.1).unwrap();
    let progress = run.advance(30);
    for track in [&progress.equip, &progress.gauss] {
        for (t, q) in progress.times.iter().zip(&track.q) {
            assert!((q - t.cos()).abs() < 1e-10);
        }
        // Every Gauss method conserves a quadratic H.
        assert!(largest(&track.energy_errors) < 1e-14);
    }
}

#[test]
fn one_stage_is_gauss_alone() {
    let mut run = kepler(1, 0.01);
    let progress = run.advance(10);
    assert!(progress.equip.q.is_empty() && progress.gauss.q.len() == 20);
    assert!(run.equip_certificate().is_none());
}

/// Where H0 = 0 the error is not divided by it.
#[test]
fn an_energy_of_zero_is_a_start() {
    let mut run = Simulation::new("p^2/2 + q^4", &[0.0], &[0.0], 3, 0.1).unwrap();
    assert_eq!(run.energy_scale(), 1.0);
    let progress = run.advance(5);
    assert_eq!(progress.equip.energy_errors, [0.0; 5]);
}

/// q'' = 3q²/2 from (1, 1): q = 4/(2 − t)² runs away to infinity at t = 2.
#[test]
fn a_failing_step_ends_the_run_with_a_message() {
    let mut run = Simulation::new("p^2/2 - q^3/2", &[1.0], &[1.0], 3, 0.01).unwrap();
    let progress = run.advance(1000);
    let failure = progress.failure.unwrap();
    assert!(failure.starts_with("EQUIP: ") || failure.starts_with("Gauss: "));
    let steps = progress.times.len();
    assert!((150..205).contains(&steps), "{steps} steps, {failure}");
    assert_eq!(progress.equip.q.len(), steps);
    assert_eq!(progress.gauss.q.len(), steps);
    let after = run.advance(10);
    assert!(after.times.is_empty() && after.failure == Some(failure));
}
