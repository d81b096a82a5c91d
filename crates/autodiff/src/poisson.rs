//! Systems y' = B(y)∇H(y) with a bracket that is not canonical, and functions of a state y.

use crate::hamiltonian::Hamiltonian;
use crate::recording::recorder::Recording;
use crate::recording::trace::record;
use crate::routes::traced::Traced;
use crate::{BuildError, Var};
use equip_scalar::Float;

impl Hamiltonian {
    /// Traces a function H(y) of a state with `n` components that are not pairs of positions and momenta: the
    /// energy of a system [`with_bracket`](Self::with_bracket), or an invariant or event function of such a
    /// system.
    ///
    /// Runs take and return the two [`halves`](Self::halves) of y in place of q and p. If n is odd, the
    /// second half has an additional component, which is 0.
    ///
    /// # Errors
    /// See [`new`](Self::new).
    pub fn of_state(n: usize, function: impl FnOnce(&[Var]) -> Var) -> Result<Self, BuildError> {
        let recorded = Self::new(n.div_ceil(2), |front, back| {
            let y: Vec<Var> = front.iter().chain(back).take(n).copied().collect();
            function(&y)
        })?;
        Ok(Hamiltonian {
            components: n,
            ..recorded
        })
    }

    /// The system y' = B(y)∇H(y) of this energy. `entries` lists the entries (i, j, B_ij), i ≠ j from 0, of
    /// one triangle of the skew-symmetric B(y). B_ji = −B_ij follows, and entries not listed are 0. The
    /// closure is called once and traced, like the closure of [`new`](Self::new).
    ///
    /// B need not satisfy the Jacobi identity for H to be conserved. Quadratic Casimirs are conserved by the
    /// methods that conserve quadratic invariants. B must be smooth along the motion.
    ///
    /// # Errors
    /// [`BuildError::BracketEntry`] for entries outside B or on its diagonal, and for pairs that are listed
    /// twice; [`BuildError::BracketWithTime`] if H depends on time; the errors of [`new`](Self::new).
    ///
    /// ```
    /// use equip_autodiff::{Hamiltonian, Var};
    ///
    /// // Euler's equations of a rigid body: m' = m × ω with ω = ∇H.
    /// let [i1, i2, i3] = [1.0, 2.0, 3.0];
    /// let body = Hamiltonian::of_state(3, |m| {
    ///     0.5 * (m[0] * m[0] / i1 + m[1] * m[1] / i2 + m[2] * m[2] / i3)
    /// })?
    /// .with_bracket(|m| vec![(0, 1, -m[2]), (0, 2, m[1]), (1, 2, -m[0])])?;
    ///
    /// // w of y' = Jw: the halves of y' are (w_p, −w_q).
    /// let mut w = [0.0; 4];
    /// body.evaluator::<f64>().flow_gradient(&[0.0, 1.0, 1.0, 0.0], &mut w);
    /// assert_eq!(w[2], 1.0 / 3.0 - 1.0 / 2.0);
    /// # Ok::<(), equip_autodiff::BuildError>(())
    /// ```
    pub fn with_bracket(
        mut self,
        entries: impl FnOnce(&[Var]) -> Vec<(usize, usize, Var)>,
    ) -> Result<Self, BuildError> {
        if self.has_time() {
            return Err(BuildError::BracketWithTime);
        }
        let form = record_form(self.degrees_of_freedom(), self.components, entries)?;
        self.set_bracket(Traced::of(form)?);
        Ok(self)
    }

    /// Whether y' = J∇H.
    pub fn is_canonical(&self) -> bool {
        self.bracket.is_none()
    }

    /// The number of components of the state: 2m, or 2m − 1 if the last component is unused
    /// ([`of_state`](Self::of_state)).
    pub fn components(&self) -> usize {
        self.components
    }

    /// The two halves of `y`, of m components each, in the form that runs take.
    ///
    /// # Panics
    /// If `y` does not have as many components as the state.
    pub fn halves<T: Float>(&self, y: &[T]) -> (Vec<T>, Vec<T>) {
        assert_eq!(
            y.len(),
            self.components,
            "a state of this system has so many components"
        );
        let mut front = y.to_vec();
        front.resize(2 * self.degrees_of_freedom(), T::int(0));
        let back = front.split_off(self.degrees_of_freedom());
        (front, back)
    }
}

/// Traces the bilinear form of B ([`crate::structure::bracket`]) for a state with two halves of length m, of
/// which `components` are used.
fn record_form(
    m: usize,
    components: usize,
    entries: impl FnOnce(&[Var]) -> Vec<(usize, usize, Var)>,
) -> Result<Recording, BuildError> {
    let n = 2 * m;
    let mut wrong = None;
    let form = record(3 * m, |front, back| {
        let all: Vec<Var> = front.iter().chain(back).copied().collect();
        let (g, lambda) = (&all[n..2 * n], &all[2 * n..]);
        let mut given = entries(&all[..components]);
        let pair = |&(i, j, _): &(usize, usize, Var)| (i.min(j), i.max(j));
        given.sort_by_key(pair);
        let twice = given.windows(2).find(|two| pair(&two[0]) == pair(&two[1]));
        let outside = given
            .iter()
            .find(|(i, j, _)| i == j || *i.max(j) >= components);
        wrong = outside
            .or(twice.map(|two| &two[1]))
            .map(|&(row, column, _)| BuildError::BracketEntry {
                row,
                column,
                components,
            });
        if wrong.is_some() {
            given.clear();
        }
        let terms = given
            .into_iter()
            .map(|(i, j, b)| b * (lambda[i] * g[j] - lambda[j] * g[i]));
        terms.sum()
    })?;
    wrong.map_or(Ok(form), Err)
}
