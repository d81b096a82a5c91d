//! [`Paper`]: all figures, as JSON has them.

use super::convergence::Convergence;
use super::orbit::Orbit;
use super::residual::Residual;
use super::statements::Statement;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(super) struct Paper {
    pub(super) version: &'static str,
    pub(super) statements: Vec<Statement>,
    pub(super) convergence: Vec<Convergence>,
    pub(super) residual: Residual,
    pub(super) orbits: Vec<Orbit>,
}
