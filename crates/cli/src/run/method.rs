//! The method requested by name.

use crate::args::{MethodName, number};
use crate::fault::Fault;
use equip_integrate::{Alphas, Equip, Gauss, Method};
use equip_scalar::{Constant, Float};

/// The method `name` with so many stages; its α is read in the precision of the run.
pub(crate) fn method<T: Float>(stages: usize, name: &MethodName) -> Result<Method, Fault> {
    Ok(match name {
        MethodName::Equip => Equip::stages(stages),
        MethodName::EquipLast => Equip::stages(stages).alphas(Alphas::Last),
        MethodName::Gauss => Gauss::stages(stages),
        MethodName::Relative(method) => *method,
        MethodName::FixedAlpha(text) => {
            let alpha = number::<T>("--method fixed-alpha", text)?;
            if !alpha.is_finite() {
                return Err(Fault::option("--method fixed-alpha", text, "finite"));
            }
            Method::fixed_alpha(stages, Constant::from_expansion(alpha.expansion()))
        }
    })
}
