//! The local error of the step with α = 0: how far the method with two stages more comes from the same start,
//!
//! $$ e = y_1^{(s+2)} - y_1^{(s)} . $$
//!
//! One stage more would not do: the stability function of s stages is (−1)^s at infinity, so that fast
//! motion which a step passes over differs in sign between s and s + 1, and e would be that motion instead
//! of the error of the slow one.
//!
//! Cost: about s/2 + 2 iterations with s + 2 stages, from the polynomial of the stages that are there.

use crate::options::step_options::Preconditioner;
use crate::outcome::outcome::Counts;
use crate::step::stages::Stages;
use equip_autodiff::{Evaluate, Kinetic, Structure};
use equip_scalar::Float;
use equip_sweeps::State;
use equip_tableau::{Gauss, legendre_integrals_at};

/// Stages of the finer method beyond those of the method itself: an even number.
const MORE: usize = 2;

/// The method with [`MORE`] stages more.
#[derive(Debug)]
pub(crate) struct LocalError<T: Float> {
    stages: Stages<T>,
    /// Σ_k (∫_0^{c_i} P_k) P_k(c_j): from the L_j of s stages to the Z_i of the finer method, row by row.
    prolongation: Vec<T>,
}

impl<T: Float> LocalError<T> {
    /// `None` if no method has so many stages more than `gauss`.
    pub(crate) fn new(
        gauss: &Gauss<T>,
        structure: &Structure,
        kinetic: Option<Kinetic<T>>,
        preconditioner: Preconditioner,
    ) -> Option<Self> {
        let s = gauss.stages();
        if s + MORE > equip_sweeps::MAX_STAGES {
            return None;
        }
        let finer = Gauss::new(s + MORE).ok()?;
        let mut prolongation = vec![T::int(0); finer.stages() * s];
        let mut integrals = vec![T::int(0); s];
        for (row, &c) in prolongation.chunks_exact_mut(s).zip(finer.nodes()) {
            legendre_integrals_at(c, &mut integrals);
            for (k, &integral) in integrals.iter().enumerate() {
                let terms = row.iter_mut().zip(gauss.legendre(k));
                terms.for_each(|(x, &p)| *x += integral * p);
            }
        }
        Some(LocalError {
            stages: Stages::new(
                finer,
                structure,
                kinetic,
                &vec![T::int(0); s + MORE - 1],
                preconditioner,
            ),
            prolongation,
        })
    }

    /// The largest component of e in each of these units, of a step of size `h` from `y` whose stages have
    /// these L, component by component with this `stride`. `None` if it was not found.
    pub(crate) fn estimate<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        (y, h): (&State<T>, T),
        (l, stride): (&[T], usize),
        units: &[Vec<T>; 2],
        counts: &mut Counts,
    ) -> Option<[T; 2]> {
        let stages = &mut self.stages;
        let s = stages.gauss.stages() - MORE;
        // Nothing is remembered: what is estimated depends on the step alone.
        stages.forget();
        stages.iterate.begin(&stages.gauss, (y, h));
        let rows = &self.prolongation;
        stages.iterate.displace(y, |c, z| {
            let l = &l[c * stride..][..s];
            for (z, row) in z.iter_mut().zip(rows.chunks_exact(s)) {
                *z = row
                    .iter()
                    .zip(l)
                    .fold(T::int(0), |sum, (&e, &l)| sum + e * l);
            }
        });
        stages.contraction.begin(!stages.choice.is_identity());
        if stages.iterate_to_rest(energy, (y, h), counts).is_err() {
            if !stages.choice.escalate() {
                return None;
            }
            stages.solve(energy, (y, h), None, counts).ok()?;
        }
        let sum = |l: &[T]| l.iter().fold(T::int(0), |sum, &l| sum + l);
        let finer = stages
            .iterate
            .increments()
            .chunks_exact(stages.iterate.stride());
        let mut largest = [T::int(0); 2];
        for (c, (finer, l)) in finer.zip(l.chunks_exact(stride)).enumerate() {
            let e = (sum(&finer[..s + MORE]) - sum(&l[..s])).abs();
            for (largest, units) in largest.iter_mut().zip(units) {
                *largest = largest.max(e / units[c]);
            }
        }
        largest.iter().all(|x| x.is_finite()).then_some(largest)
    }
}
