//! What is known of a motion from its reference.

use equip_autodiff::Hamiltonian;
use equip_tests::{Reference, sizes};

/// Extremes over the start and the states of the reference.
pub(crate) struct Motion {
    /// Largest |q|, largest |p|.
    pub(crate) sizes: [f64; 2],
    /// Fastest frequency.
    pub(crate) rate: f64,
    /// ε (|H| + Σ |y_i ∂_i H|).
    pub(crate) round_off: f64,
}

impl Motion {
    pub(crate) fn along(hamiltonian: &Hamiltonian, start: &[f64], reference: &Reference) -> Self {
        let mut evaluator = hamiltonian.evaluator::<f64>();
        let mut gradient = vec![0.0; start.len()];
        let mut motion = Motion {
            sizes: sizes(start, &reference.states),
            rate: 0.0,
            round_off: 0.0,
        };
        let finite = |y: &&[f64]| y.iter().all(|x| x.is_finite());
        let states = reference.states.iter().map(Vec::as_slice);
        for y in states.chain([start]).filter(finite) {
            let h = evaluator.gradient(y, &mut gradient).abs();
            let terms: f64 = y.iter().zip(&gradient).map(|(y, g)| (y * g).abs()).sum();
            motion.rate = motion.rate.max(equip_tests::rate(hamiltonian, y));
            motion.round_off = motion.round_off.max(f64::EPSILON * (h + terms));
        }
        motion
    }
}
