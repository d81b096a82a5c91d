//! How the text of a parameter is read.
//!
//! Values are decimal text (`0.1`, `1e-3`) or quotients (`1/12`) and are kept as exact constants: a run in
//! double-double reads `0.1` as 1/10, not as the double nearest to it.

mod decimal_text;

use crate::error::SceneError;
use crate::parameter::{Parameter, Value};
use decimal_text::constant;

/// Reads `given` over the defaults of `parameters`, in the order of `parameters`.
pub(crate) fn read_all(
    scene: &'static str,
    parameters: &'static [Parameter],
    given: &[(&str, &str)],
) -> Result<Vec<Value>, SceneError> {
    if let Some((name, _)) = given
        .iter()
        .find(|(n, _)| parameters.iter().all(|p| p.name != *n))
    {
        return Err(SceneError::UnknownParameter {
            scene,
            name: (*name).into(),
            known: parameters.iter().map(|p| p.name).collect(),
        });
    }
    parameters
        .iter()
        .map(|parameter| {
            let mut texts = given
                .iter()
                .filter(|(n, _)| *n == parameter.name)
                .map(|(_, t)| *t);
            let text = texts.next().unwrap_or(parameter.default);
            if texts.next().is_some() {
                return Err(SceneError::GivenTwice {
                    scene,
                    parameter: parameter.name,
                });
            }
            read(parameter, scene, text)
        })
        .collect()
}

fn read(this: &Parameter, scene: &'static str, text: &str) -> Result<Value, SceneError> {
    let parameter = this.name;
    let text = text.trim();
    let exact = constant(text).ok_or_else(|| SceneError::NotANumber {
        scene,
        parameter,
        text: text.into(),
    })?;
    let nearest = exact.to::<f64>();
    if this.integer && nearest.fract() != 0.0 {
        return Err(SceneError::NotAnInteger {
            scene,
            parameter,
            text: text.into(),
            range: this.range,
        });
    }
    if !this.range.contains(nearest) {
        return Err(SceneError::OutOfRange {
            scene,
            parameter,
            text: text.into(),
            range: this.range,
        });
    }
    Ok(Value {
        exact,
        nearest,
        text: text.into(),
    })
}
