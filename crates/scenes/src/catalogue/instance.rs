//! [`Instance`]: a scene with given parameters, ready to be integrated.

use super::any_model::{AnyModel, with_model};
use super::reference::{Reference, reference_names};
use super::scene::{Scene, find};
use crate::error::SceneError;
use crate::invariant::Invariant;
use crate::model::{Model, Units, View, momenta};
use crate::parameter::Value;
use crate::reading::read_all;
use crate::reference::{self, Doubles, ReferenceData};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// A scene with given parameters: traced H, initial state, invariants, time scale and known solutions.
#[derive(Debug)]
pub struct Instance {
    scene: &'static Scene,
    values: Vec<Value>,
    model: AnyModel,
    start: Option<&'static Doubles>,
    hamiltonian: Hamiltonian,
    invariants: Vec<Invariant>,
}

impl Scene {
    /// The scene with the given parameter values, and defaults for all others.
    ///
    /// Values are text, a decimal or a quotient of integers, so that a run in double-double reads `0.1` as
    /// 1/10.
    ///
    /// ```
    /// let kepler = equip_scenes::find("kepler")?.instance(&[("e", "0.9")])?;
    /// let (q, p) = kepler.initial::<f64>();
    /// assert!((q[0] - 0.1).abs() < 1e-16 && (p[1] - 19.0_f64.sqrt()).abs() < 1e-14);
    /// # Ok::<(), equip_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`], with the allowed values, for a parameter that is unknown, given twice, not a number,
    /// not a whole number if one is required, or out of range.
    pub fn instance(&'static self, values: &[(&str, &str)]) -> Result<Instance, SceneError> {
        let values = read_all(self.name, self.parameters, values)?;
        let model = (self.build)(&values);
        with_model!(&model, m => m.check())?;
        Ok(Instance {
            scene: self,
            values,
            start: None,
            hamiltonian: with_model!(&model, m => m.hamiltonian())?,
            invariants: with_model!(&model, m => m.invariants())?,
            model,
        })
    }
}

impl Instance {
    /// The scene, parameters and initial data of a stored reference solution (see
    /// [`reference_names`](crate::reference_names)).
    ///
    /// If the reference starts from doubles, so does the instance, in every floating-point type.
    ///
    /// # Errors
    /// [`SceneError::UnknownReference`] for another name.
    pub fn from_reference(name: &str) -> Result<Self, SceneError> {
        let data = reference::ALL.iter().find(|r| r.name == name);
        let data = data.ok_or_else(|| SceneError::UnknownReference {
            name: name.into(),
            known: reference_names().collect(),
        })?;
        let mut instance = find(data.scene)?.instance(data.parameters)?;
        instance.start = data.start.as_ref();
        Ok(instance)
    }

    /// The scene of this instance.
    pub fn scene(&self) -> &'static Scene {
        self.scene
    }

    /// Every parameter with its value as text, in the order of the scene.
    pub fn parameters(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let names = self.scene.parameters.iter().map(|p| p.name);
        names.zip(self.values.iter().map(|v| v.text.as_str()))
    }

    /// H, traced.
    pub fn hamiltonian(&self) -> &Hamiltonian {
        &self.hamiltonian
    }

    /// (q₀, p₀), every root and ratio computed in `T`.
    pub fn initial<T: Float>(&self) -> (Vec<T>, Vec<T>) {
        match self.start {
            None => with_model!(&self.model, m => m.initial()),
            Some(Doubles { q, v }) => (
                q.iter().map(|&q| T::exact(q)).collect(),
                with_model!(&self.model, m => momenta(m, v.iter().map(|&v| T::exact(v)))),
            ),
        }
    }

    /// The invariants besides H.
    pub fn invariants(&self) -> &[Invariant] {
        &self.invariants
    }

    /// The natural unit of time: the orbital period, 2π/ω, or the unit named in the file of the scene.
    pub fn period<T: Float>(&self) -> T {
        with_model!(&self.model, m => m.period(&self.initial()))
    }

    /// A fixed step size with which a method of order 8 resolves the motion.
    pub fn suggested_step(&self) -> f64 {
        with_model!(&self.model, m => m.step())
    }

    /// A suitable end time.
    pub fn suggested_end(&self) -> f64 {
        with_model!(&self.model, m => m.end())
    }

    /// The exact state at time `t`, if a closed form is known, at the cost of a few dozen elementary
    /// functions in `T`.
    ///
    /// Its error grows like the phase error, some ε·t/period. A run in `f64` starts from an initial state
    /// rounded to `f64`. To measure the error of the run alone, use [`flow`](Self::flow) in a wider type,
    /// from the rounded state.
    pub fn exact<T: Float>(&self, t: T) -> Option<(Vec<T>, Vec<T>)> {
        match self.start {
            None => with_model!(&self.model, m => m.exact(t)),
            Some(_) => self.flow(&self.initial(), t),
        }
    }

    /// The exact state at a time `t` after any state (q, p), for scenes whose general solution has a closed
    /// form: kepler (bound orbits), harmonic, pendulum, quartic.
    ///
    /// # Panics
    /// If q or p is shorter than the degrees of freedom.
    pub fn flow<T: Float>(&self, start: &(Vec<T>, Vec<T>), t: T) -> Option<(Vec<T>, Vec<T>)> {
        with_model!(&self.model, m => m.flow(start, t))
    }

    /// The stored reference solution with these parameters and this initial state, if there is one.
    pub fn reference(&self) -> Option<Reference<'_>> {
        let data = reference::ALL.iter().find(|data| self.is_start_of(data))?;
        Some(Reference {
            data,
            model: &self.model,
        })
    }

    /// The units of positions and time.
    pub fn units(&self) -> Units {
        with_model!(&self.model, m => m.units())
    }

    /// The type of picture.
    pub fn view(&self) -> View {
        with_model!(&self.model, m => m.view())
    }

    fn is_start_of(&self, data: &ReferenceData) -> bool {
        let same_start = match (self.start, &data.start) {
            (None, None) => true,
            (Some(here), Some(there)) => here == there,
            _ => false,
        };
        let parameters = self.scene.parameters;
        data.scene == self.scene.name
            && same_start
            && read_all(data.scene, parameters, data.parameters).is_ok_and(|values| {
                values
                    .iter()
                    .map(|v| v.exact)
                    .eq(self.values.iter().map(|v| v.exact))
            })
    }
}
