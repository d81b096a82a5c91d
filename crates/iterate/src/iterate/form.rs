//! The forms of the iteration Z ← K(α) L(Z):
//!
//! | H | unknowns | one iteration | file |
//! |---|---|---|---|
//! | any | Z of all 2m components | ∇H at the stages; Z ← K L | [`crate::forms::full`] |
//! | T(p) + U(q), T = ½ Σ w_c p_c² + b·p | Z of the m positions | ∇U at the stages; P ← p + K L_p; L_q = h b ∇T(P); Z_q ← K L_q | [`crate::forms::separable`] |
//! | the same, while Z is far from the solution | Z of the m positions | ∇U at the stages; Z_q ← Z_q + h M⁻¹ K B K ΔL_p | [`crate::forms::incremental`] |

use crate::forms::form::Step;
use crate::forms::full::Full;
use crate::forms::incremental::Incremental;
use crate::forms::separable::Separable;
use crate::iterate::iterate::Iterate;
use crate::layout::state::State;
use equip_scalar::Float;

/// The form of an iteration, with its input and output.
pub(crate) enum Form<'a, T> {
    Full(Full<'a, T>),
    Separable(Separable<'a, T>),
    Incremental(Incremental<'a, T>),
}

impl<T: Float> Iterate<T> {
    /// The form of the next iteration.
    #[inline(always)]
    pub(crate) fn form<'a>(&'a mut self, y: &'a State<T>) -> Form<'a, T> {
        let twofold = self.twofold.as_deref().filter(|_| self.is_incremental);
        let step = Step {
            k: twofold.unwrap_or(&self.k),
            hb: &self.hb,
            hi: &y.hi,
            lo: &y.lo,
            inverse_scale: &self.inverse_scale,
            gradients: &mut self.gradients,
            l: &mut self.l,
            delta: &mut self.delta,
            z: &mut self.z,
            points: &mut self.points,
            s: self.s,
        };
        let Some(kinetic) = &self.kinetic else {
            return Form::Full(Full(step));
        };
        let half = Separable {
            step,
            inverse_masses: kinetic.diagonal().unwrap_or_default(),
            offset: kinetic.offset(),
            keeps_momenta: self.has_momenta,
        };
        match twofold {
            None => Form::Separable(half),
            Some(_) => Form::Incremental(Incremental { half, h: self.h }),
        }
    }

    /// The linear half of an iteration: L from the gradients, Z ← K L, and the stages. Returns the largest
    /// change of Z relative to the sizes of the components; the result is not finite if any change is not.
    pub(crate) fn mix(&mut self, y: &State<T>) -> f64 {
        let set = self.set;
        match self.form(y) {
            Form::Full(mut task) => set.run(&mut task),
            Form::Separable(mut task) => set.run(&mut task),
            Form::Incremental(mut task) => set.run(&mut task),
        }
    }
}
