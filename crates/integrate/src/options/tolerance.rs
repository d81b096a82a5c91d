//! [`Tolerance`]: variable step sizes by a tolerance.

use crate::control::estimate::Allowed;
use crate::error::IntegrateError;
use crate::options::common::{Words, check, in_digits};
use crate::options::method::Method;
use equip_scalar::Float;
use equip_solver::MAX_STAGES;

/// Step sizes by a tolerance, with bounds.
#[derive(Debug, Clone)]
pub(crate) struct Tolerance<T> {
    pub(crate) tolerance: T,
    pub(crate) relative: [Vec<T>; 2],
    pub(crate) absolute: [Vec<T>; 2],
    pub(crate) first_step: Option<T>,
    pub(crate) min_step: T,
    pub(crate) max_step: T,
    pub(crate) max_steps: u64,
}

/// The names of the options.
const RELATIVE: [&str; 2] = ["rtol (q)", "rtol (p)"];
const ABSOLUTE: [&str; 2] = ["atol (q)", "atol (p)"];

/// The smallest degree with enough coefficients for an error estimate.
const MIN_STAGES: usize = 2;

impl<T: Float> Tolerance<T> {
    pub(crate) fn words(&self) -> Words {
        let or = |x: Option<T>, automatic: &str| x.map_or(automatic.to_owned(), in_digits);
        let errors = |x: &[T], otherwise: &str| match x {
            [] => otherwise.to_owned(),
            x => x
                .iter()
                .map(|&x| in_digits(x))
                .collect::<Vec<_>>()
                .join(", "),
        };
        vec![
            ("steps", "by a tolerance".to_owned()),
            ("tolerance", in_digits(self.tolerance)),
            ("rtol of the positions", errors(&self.relative[0], "that")),
            ("rtol of the momenta", errors(&self.relative[1], "that")),
            ("atol of the positions", errors(&self.absolute[0], "zero")),
            ("atol of the momenta", errors(&self.absolute[1], "zero")),
            ("first_step", or(self.first_step, "automatic")),
            ("min_step", in_digits(self.min_step)),
            ("max_step", in_digits(self.max_step)),
        ]
    }

    pub(crate) fn validate(&self, method: Method) -> Result<(), IntegrateError<T>> {
        let stages = method.degree();
        if stages < MIN_STAGES && method.stage_count() > stages {
            return Err(IntegrateError::NoErrorEstimate);
        }
        if stages < MIN_STAGES {
            return Err(IntegrateError::StagesOutOfRange {
                stages,
                min: MIN_STAGES,
                max: MAX_STAGES,
            });
        }
        let zero = T::int(0);
        let finite = |x: T| x > zero && x.is_finite();
        let relative = |name, error| {
            check(
                error >= T::EPSILON && error <= T::ratio(1, 100),
                name,
                error,
                "between the relative precision of the numbers and 1/100",
            )
        };
        relative("tolerance", self.tolerance)?;
        for (errors, name) in self.relative.iter().zip(RELATIVE) {
            errors.iter().try_for_each(|&error| relative(name, error))?;
        }
        for (errors, name) in self.absolute.iter().zip(ABSOLUTE) {
            for &error in errors {
                let ok = error >= zero && error.is_finite();
                check(ok, name, error, "finite and not negative")?;
            }
        }
        let first = self.first_step.unwrap_or(T::int(1));
        check(finite(first), "first_step", first, "positive and finite")?;
        let (min, max) = (self.min_step, self.max_step);
        check(
            min >= zero && min.is_finite(),
            "min_step",
            min,
            "finite and not negative",
        )?;
        check(
            max > zero && max >= min,
            "max_step",
            max,
            "positive and not below min_step",
        )?;
        check(self.max_steps > 0, "max_steps", zero, "1 or more")?;
        Ok(())
    }

    /// The smallest relative error of any component.
    pub(crate) fn tightest(&self) -> T {
        let of_group = |given: &Vec<T>| match given.as_slice() {
            [] => self.tolerance,
            given => given.iter().fold(T::INFINITY, |a, &x| a.min(x)),
        };
        let [q, p] = &self.relative;
        of_group(q).min(of_group(p))
    }

    /// The admissible errors of all components: `pairs` positions and as many momenta, of which the first `m`
    /// belong to the user. `None` if the tolerance applies to all of them.
    pub(crate) fn allowed(
        &self,
        m: usize,
        pairs: usize,
    ) -> Result<Option<Allowed<T>>, IntegrateError<T>> {
        let fill = |given: &[Vec<T>; 2], otherwise: T, names: [&'static str; 2]| {
            let mut all = vec![otherwise; 2 * pairs];
            let groups = all.chunks_exact_mut(pairs).zip(given);
            for ((all, errors), what) in groups.zip(names) {
                match errors.as_slice() {
                    [] => {}
                    [one] => all[..m].fill(*one),
                    errors if errors.len() == m => all[..m].copy_from_slice(errors),
                    errors => {
                        return Err(IntegrateError::WrongLength {
                            what,
                            expected: m,
                            found: errors.len(),
                        });
                    }
                }
            }
            Ok(all)
        };
        let zero = T::int(0);
        let allowed = Allowed {
            relative: fill(&self.relative, self.tolerance, RELATIVE)?,
            absolute: fill(&self.absolute, zero, ABSOLUTE)?,
        };
        let is_plain = self.absolute.iter().flatten().all(|&x| x == zero)
            && (self.relative.iter().flatten()).all(|&x| x == self.tolerance);
        Ok((!is_plain).then_some(allowed))
    }
}
