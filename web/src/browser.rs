//! What the page calls, in JavaScript's types.

use crate::expression::Expression;
use crate::simulation::{Progress, Simulation};
use wasm_bindgen::prelude::{JsError, wasm_bindgen};

/// The value of a formula without variables, as of a field for a step.
///
/// # Errors
/// An `Error` with the message of [`crate::FormulaError`].
#[wasm_bindgen]
pub fn constant(text: &str) -> Result<f64, JsError> {
    Ok(Expression::constant(text)?)
}

/// [`Simulation`] in JavaScript.
#[wasm_bindgen(js_name = Simulation)]
#[derive(Debug)]
pub struct PageSimulation(Simulation);

#[wasm_bindgen(js_class = Simulation)]
impl PageSimulation {
    /// See [`Simulation::new`].
    ///
    /// # Errors
    /// An `Error` with the message of [`crate::SimulationError`].
    #[wasm_bindgen(constructor)]
    pub fn new(
        energy: &str,
        q: &[f64],
        p: &[f64],
        stages: usize,
        step: f64,
    ) -> Result<PageSimulation, JsError> {
        Ok(PageSimulation(Simulation::new(energy, q, p, stages, step)?))
    }

    /// See [`Simulation::advance`].
    pub fn advance(&mut self, steps: usize) -> PageProgress {
        PageProgress(self.0.advance(steps))
    }

    /// H at the initial condition.
    #[wasm_bindgen(getter, js_name = initialEnergy)]
    pub fn initial_energy(&self) -> f64 {
        self.0.initial_energy()
    }

    /// See [`Simulation::round_off_level`].
    #[wasm_bindgen(getter, js_name = roundOffLevel)]
    pub fn round_off_level(&self) -> f64 {
        self.0.round_off_level()
    }

    /// The verdict of EQUIP's certificate; `undefined` of one stage.
    #[wasm_bindgen(getter)]
    pub fn verdict(&self) -> Option<String> {
        let certificate = self.0.equip_certificate()?;
        Some(certificate.energy_conserved_to_round_off)
    }

    /// Steps of EQUIP whose energy error was not removed.
    #[wasm_bindgen(getter)]
    pub fn uncorrected(&self) -> Option<f64> {
        let certificate = self.0.equip_certificate()?;
        Some(certificate.counts.uncorrected() as f64)
    }

    /// Digits to which EQUIP conserved the energy; `undefined` of one stage.
    #[wasm_bindgen(getter, js_name = equipDigits)]
    pub fn equip_digits(&self) -> Option<f64> {
        let certificate = self.0.equip_certificate()?;
        Some(self.0.digits(&certificate))
    }

    /// Digits to which Gauss conserved the energy.
    #[wasm_bindgen(getter, js_name = gaussDigits)]
    pub fn gauss_digits(&self) -> f64 {
        self.0.digits(&self.0.gauss_certificate())
    }
}

/// [`Progress`] in JavaScript: typed arrays, each made where it is read.
#[wasm_bindgen(js_name = Progress)]
#[derive(Debug)]
pub struct PageProgress(Progress);

macro_rules! arrays {
    ($($name:ident $js:ident = $($path:ident).+;)*) => {
        #[wasm_bindgen(js_class = Progress)]
        impl PageProgress {
            $(
                #[doc = concat!("`", stringify!($($path).+), "` of [`Progress`].")]
                #[wasm_bindgen(getter, js_name = $js)]
                pub fn $name(&self) -> Vec<f64> {
                    self.0.$($path).+.clone()
                }
            )*

            /// Why the step after these failed.
            #[wasm_bindgen(getter)]
            pub fn failure(&self) -> Option<String> {
                self.0.failure.clone()
            }
        }
    };
}
arrays! {
    times times = times;
    equip_q equipQ = equip.q;
    equip_p equipP = equip.p;
    equip_errors equipErrors = equip.energy_errors;
    gauss_q gaussQ = gauss.q;
    gauss_p gaussP = gauss.p;
    gauss_errors gaussErrors = gauss.energy_errors;
}
