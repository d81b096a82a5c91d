//! One row a cell.

use crate::cell::Cell;
use crate::contestant::{Ending, Leg};
use std::fs::File;
use std::io::{BufWriter, Error, Write};
use std::path::Path;

const OF_A_LEG: [&str; 12] = [
    "seconds",
    "error",
    "energy",
    "gradients",
    "hessians",
    "fixed_point_iterations",
    "newton_iterations",
    "factorisations",
    "kept",
    "made",
    "outcomes",
    "ending",
];

pub(crate) fn write(path: &Path, cells: &[Cell]) -> Result<(), Error> {
    let mut file = BufWriter::new(File::create(path)?);
    write!(
        file,
        "scene,start,stages,step,steps,angle,regime,reference_error,round_off,floor"
    )?;
    for who in ["equip", "gauss"] {
        for name in OF_A_LEG {
            write!(file, ",{who}_{name}")?;
        }
    }
    writeln!(file)?;
    for cell in cells {
        write!(
            file,
            "{},{},{},{:e},{},{:.3e},{},{:.1e},{:.2e},{:.2e}",
            cell.scene,
            cell.start,
            cell.stages,
            cell.step,
            cell.steps,
            cell.angle,
            cell.regime.label(),
            cell.reference_error,
            cell.round_off,
            cell.equip.floor
        )?;
        for (leg, error) in [&cell.equip, &cell.gauss].into_iter().zip(cell.errors) {
            write!(file, ",{}", of_leg(leg, error))?;
        }
        writeln!(file)?;
    }
    file.flush()
}

fn of_leg(leg: &Leg, error: f64) -> String {
    let outcomes: Vec<String> = leg
        .outcomes
        .iter()
        .map(|(name, steps)| format!("{name} {steps}"))
        .collect();
    let ending = match &leg.ending {
        Ending::Done => "done".into(),
        Ending::Cut => "cut".into(),
        Ending::Failed(error) => error.replace(['"', '\n'], " "),
    };
    format!(
        "{:.4e},{error:.3e},{:.3e},{},{},{},{},{},{},{},{},\"{ending}\"",
        leg.seconds,
        leg.energy,
        leg.work.gradients,
        leg.work.hessians,
        leg.work.fixed_point_iterations,
        leg.work.newton_iterations,
        leg.work.factorisations,
        leg.kept,
        leg.steps,
        outcomes.join("; "),
    )
}
