//! Long runs with step control: error and energy error of EQUIP and Gauss over many revolutions of Kepler's
//! problem, and with close encounters.

use crate::commands::growth::{Curve, follow};
use crate::draw::chart::{Line, Plot, chart};
use crate::draw::figure::Figure;
use crate::fault::Fault;
use indicatif::ProgressBar;

const STAGES: usize = 8;
const TOLERANCE: &str = "1e-12";
/// Revolutions of the quick report, and after which errors are compared.
pub(super) const REVOLUTIONS: u64 = 1000;
/// Revolutions of the orbit without close encounters in the complete report.
const MANY: u64 = 100_000;

/// Names of the two parts, for `--only`.
pub(super) const LONG: &str = "long-runs";
pub(super) const CLOSE: &str = "close-encounters";

/// The runs of both parts, EQUIP and Gauss in turn.
#[derive(Debug, Default)]
pub(super) struct Long {
    pub(super) regular: Vec<Curve>,
    pub(super) close: Vec<Curve>,
}

impl Long {
    /// Revolutions after which the regular orbit has errors in the table.
    pub(super) fn numbers(&self) -> Vec<u64> {
        let last = self.regular.first().and_then(|curve| curve.points.last());
        let mut numbers = vec![REVOLUTIONS];
        numbers.extend(last.map(|point| point.0).filter(|n| *n > REVOLUTIONS));
        numbers
    }
}

/// Runs the parts whose name contains `wanted`.
pub(super) fn measure(wanted: &str, is_quick: bool, bar: &ProgressBar) -> Result<Long, Fault> {
    let mut long = Long::default();
    if LONG.contains(wanted) {
        let revolutions = if is_quick { REVOLUTIONS } else { MANY };
        long.regular = pair("0.6", revolutions, bar)?;
    }
    if CLOSE.contains(wanted) {
        for eccentricity in ["0.9", "0.99", "0.999"] {
            long.close.extend(pair(eccentricity, REVOLUTIONS, bar)?);
        }
    }
    Ok(long)
}

fn pair(eccentricity: &str, revolutions: u64, bar: &ProgressBar) -> Result<Vec<Curve>, Fault> {
    bar.set_message(format!("e = {eccentricity}, {revolutions} revolutions"));
    let curve = |is_equip| follow(eccentricity, (is_equip, STAGES), TOLERANCE, revolutions);
    Ok(vec![curve(true)?, curve(false)?])
}

/// Error and energy error against revolutions, a panel of each for each orbit.
pub(super) fn figure(title: &str, curves: &[Curve]) -> Figure {
    let mut orbits: Vec<&str> = curves.iter().map(|c| c.eccentricity.as_str()).collect();
    orbits.dedup();
    let (mut plots, mut energies) = (Vec::new(), Vec::new());
    for orbit in &orbits {
        let of = |curve: &&Curve| curve.eccentricity == **orbit;
        let levels = (curves.iter().filter(of)).filter_map(|curve| {
            let certificate = &curve.certificate;
            let start = certificate.energy.as_ref()?.start.abs();
            Some(certificate.energy_round_off.as_ref()?.round_off / start)
        });
        let levels = levels.filter(|level| *level > 0.0 && level.is_finite());
        plots.push(Plot {
            has_derivatives: true,
            ..Plot::new(
                &format!("Error, e = {orbit}"),
                "revolutions N",
                "error of (q, p)",
            )
        });
        energies.push(Plot {
            round_off: levels.reduce(f64::max),
            ..Plot::new(
                &format!("Energy error, e = {orbit}"),
                "revolutions N",
                "largest |ΔH/H₀|",
            )
        });
    }
    plots.append(&mut energies);
    let line = |is_equip: bool| {
        let like = || {
            curves
                .iter()
                .filter(move |curve| curve.is_equip == is_equip)
        };
        let first = like().next()?;
        Some(Line {
            name: format!("{}({STAGES})", first.name()),
            look: first.look("none"),
            points: [0, 1]
                .map(|k| {
                    like()
                        .map(move |c| c.spots()[k].clone())
                        .collect::<Vec<_>>()
                })
                .concat(),
        })
    };
    let lines: Vec<Line> = [true, false].into_iter().filter_map(line).collect();
    let facts = format!(
        "Step size control, tolerance {TOLERANCE}; largest error over all components of q and p, 0.3 revolutions after the N-th, and largest energy error until then"
    );
    chart(title, &facts, &plots, &lines)
}
