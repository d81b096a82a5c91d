//! `equip growth`: how the error of Kepler's problem grows with time, EQUIP beside Gauss under the same step
//! control.
//!
//! Errors are taken 0.3 revolutions after the N-th, never at a whole number of them, where doing nothing
//! scores zero: the largest of the components of position and momentum, against the closed form. A method
//! that drifts in energy gets the period wrong, and its error grows like N²; one that keeps energy and
//! angular momentum leaves N.

use crate::args::{GrowthArgs, number};
use crate::draw::chart::{Line, Plot, Spot, chart};
use crate::draw::figure::Look;
use crate::draw::svg::{EQUIP, GAUSS, Mark};
use crate::fault::Fault;
use crate::run::finished::largest_difference;
use crate::run::integrator::equip_or_gauss;
use crate::run::progress::steps_of;
use crate::text::Print;
use crate::write::outputs::Drawing;
use cpu_time::ThreadTime;
use equip_integrate::{Certificate, IntegrateError, Method, Record, StepView};
use equip_scenes::Instance;
use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::ControlFlow;

/// Points of a curve in a decade of N.
const PER_DECADE: u32 = 8;
/// Patterns of the tolerances; there are no more of these than of patterns.
const DASHES: [&str; 6] = ["none", "6 4", "2 3", "12 3", "10 3 2 3", "1 6"];

/// One method on one orbit.
#[derive(Debug)]
pub(crate) struct Curve {
    pub(crate) eccentricity: String,
    pub(crate) tolerance: String,
    pub(crate) is_equip: bool,
    /// N and the error 0.3 revolutions after it.
    pub(crate) points: Vec<(u64, f64)>,
    /// Largest |ΔH/H₀| up to there.
    pub(crate) energies: Vec<f64>,
    /// Revolutions made.
    pub(crate) revolutions: f64,
    pub(crate) certificate: Certificate<f64>,
    /// CPU time.
    pub(crate) milliseconds: f64,
}

impl Curve {
    pub(crate) fn name(&self) -> &'static str {
        if self.is_equip { "EQUIP" } else { "Gauss" }
    }

    /// The error 0.3 revolutions after the `n`-th.
    pub(crate) fn error_after(&self, n: u64) -> f64 {
        let point = self.points.iter().find(|point| point.0 == n);
        point.map_or(f64::NAN, |point| point.1)
    }

    /// What is drawn of the errors, and of the energy errors.
    pub(crate) fn spots(&self) -> [Vec<Spot>; 2] {
        let points = self.points.iter().zip(&self.energies);
        let both = |(&(n, error), &energy): (&(u64, f64), &f64)| {
            (Spot::exact(n as f64, error), Spot::exact(n as f64, energy))
        };
        points.map(both).collect::<(Vec<_>, Vec<_>)>().into()
    }

    pub(crate) fn look(&self, dashes: &'static str) -> Look {
        let (colour, mark) = match self.is_equip {
            true => (EQUIP, Mark::Disc),
            false => (GAUSS, Mark::Square),
        };
        Look {
            dashes,
            mark: Some(mark),
            ..Look::line(colour)
        }
    }
}

pub(crate) fn growth(args: &GrowthArgs) -> Result<(), Fault> {
    let scene = equip_scenes::find("kepler")?;
    // All lists are read before the first run.
    let orbits = (args.eccentricities.iter())
        .map(|e| Ok(scene.instance(&[("e", e)])?))
        .collect::<Result<Vec<_>, Fault>>()?;
    let tolerances = (args.tolerances.iter())
        .map(|text| Ok((text, number::<f64>("--tolerances", text)?)))
        .collect::<Result<Vec<_>, Fault>>()?;
    if tolerances.len() > DASHES.len() {
        let value = format!("a list of {}", tolerances.len());
        let expected = "at most 6 values, so that the picture stays legible";
        return Err(Fault::option("--tolerances", value, expected));
    }
    let mut drawing = Drawing::new(&args.plot, args.csv.as_deref())?;
    for is_equip in [true, false] {
        for &(text, tolerance) in &tolerances {
            let method = equip_or_gauss(is_equip, args.stages);
            accepted(method, text, tolerance, &orbits)?;
        }
    }
    let bar = steps_of("runs", 2 * orbits.len() * tolerances.len());
    let mut curves = Vec::new();
    let mut out = Print::default();
    writeln!(out, "{}", header(args.revolutions))?;
    for eccentricity in &args.eccentricities {
        for tolerance in &args.tolerances {
            for is_equip in [true, false] {
                let method = (is_equip, args.stages);
                let curve = follow(eccentricity, method, tolerance, args.revolutions)?;
                drawing.create()?;
                bar.suspend(|| writeln!(out, "{}", row(&curve)).and_then(|()| out.flush()))?;
                bar.inc(1);
                curves.push(curve);
            }
        }
    }
    bar.finish_and_clear();
    drawing.write(&draw(&curves, args), || table(&curves))?;
    writeln!(out, "\nplot written to {}", args.plot.display())?;
    if let Some(path) = &args.csv {
        writeln!(out, "errors written to {}", path.display())?;
    }
    Ok(out.end()?)
}

/// Whether the library takes the method and the tolerance.
fn accepted(method: Method, text: &str, tolerance: f64, orbits: &[Instance]) -> Result<(), Fault> {
    let Some(orbit) = orbits.first() else {
        return Ok(());
    };
    let made = method.tolerance(tolerance).prepare(orbit.hamiltonian());
    made.map(drop).map_err(|error| match error {
        IntegrateError::Option {
            option: "tolerance",
            expected,
            ..
        } => Fault::option("--tolerances", text, expected),
        other => Fault::start(other),
    })
}

/// 1, 2, … up to `last`, about evenly on a logarithmic axis, with all powers of ten.
fn numbers(last: u64) -> Vec<u64> {
    let mut numbers: Vec<u64> = (0..)
        .map(|k: u32| 10f64.powf(f64::from(k) / f64::from(PER_DECADE)).round() as u64)
        .take_while(|&n| n < last)
        .chain([last])
        .collect();
    numbers.dedup();
    numbers
}

/// One run, with its errors and energy errors on the way.
pub(crate) fn follow(
    eccentricity: &str,
    (is_equip, stages): (bool, usize),
    tolerance: &str,
    last: u64,
) -> Result<Curve, Fault> {
    let instance = equip_scenes::find("kepler")?.instance(&[("e", eccentricity)])?;
    let (q, p) = instance.initial::<f64>();
    let period: f64 = instance.period();
    let numbers = numbers(last);
    let times: Vec<f64> = numbers.iter().map(|&n| (n as f64 + 0.3) * period).collect();
    let end = (last as f64 + 0.3) * period;
    // Largest |ΔH| so far, and at each of the times.
    let (mut most, mut energies) = (0.0_f64, Vec::new());
    let mut see = |view: &StepView<'_, f64>| {
        most = most.max(view.energy_error.map_or(0.0, f64::abs));
        while times.get(energies.len()).is_some_and(|&t| t <= view.time) {
            energies.push(most);
        }
        ControlFlow::Continue(())
    };
    let begun = ThreadTime::now();
    let run = equip_or_gauss(is_equip, stages)
        .tolerance(number::<f64>("--tolerances", tolerance)?)
        .record(Record::Ends)
        .output_at(&times)
        .integrate_observed(instance.hamiltonian(), &q, &p, 0.0..=end, &mut see)
        .map_err(Fault::undrawn)?;
    let milliseconds = 1e3 * begun.elapsed().as_secs_f64();
    energies.resize(times.len(), most);
    let error = |(t, q, p): (f64, &[f64], &[f64])| {
        let (exact_q, exact_p) = instance.exact(t).unwrap_or_default();
        largest_difference(q, &exact_q).max(largest_difference(p, &exact_p))
    };
    let certificate = run.certificate().clone();
    let start = certificate.energy.as_ref().map_or(1.0, |e| e.start.abs());
    Ok(Curve {
        eccentricity: eccentricity.to_owned(),
        tolerance: tolerance.to_owned(),
        is_equip,
        points: numbers.into_iter().zip(run.outputs().map(error)).collect(),
        energies: energies.into_iter().map(|energy| energy / start).collect(),
        revolutions: last as f64 + 0.3,
        certificate,
        milliseconds,
    })
}

/// One panel for each eccentricity, error against revolutions.
fn draw(curves: &[Curve], args: &GrowthArgs) -> String {
    let plot = |eccentricity: &String| Plot {
        has_derivatives: true,
        ..Plot::new(
            &format!("e = {eccentricity}"),
            "revolutions N",
            "error of (q, p)",
        )
    };
    let plots: Vec<Plot> = args.eccentricities.iter().map(plot).collect();
    let mut lines = Vec::new();
    for (tolerance, dashes) in args.tolerances.iter().zip(DASHES) {
        for is_equip in [true, false] {
            let like = |c: &&Curve| c.is_equip == is_equip && c.tolerance == *tolerance;
            let like: Vec<&Curve> = curves.iter().filter(like).collect();
            let Some(first) = like.first() else { continue };
            let of = |eccentricity: &String| {
                let curve = like
                    .iter()
                    .find(|curve| curve.eccentricity == *eccentricity);
                curve.map_or_else(Vec::new, |curve| curve.spots()[0].clone())
            };
            lines.push(Line {
                name: format!("{}, tolerance {tolerance}", first.name()),
                look: first.look(dashes),
                points: args.eccentricities.iter().map(of).collect(),
            });
        }
    }
    let title = "Kepler\u{2019}s problem: growth of the error";
    let facts = format!(
        "{} stages, step size control; largest error over all components of q and p, 0.3 revolutions after the N-th",
        args.stages
    );
    chart(title, &facts, &plots, &lines).file(&args.plot)
}

/// The powers of ten among the numbers of revolutions.
fn powers(last: u64) -> impl Iterator<Item = u64> {
    (0..19)
        .map(|k| 10u64.pow(k))
        .take_while(move |&n| n <= last)
}

fn header(last: u64) -> String {
    let mut text = "| e | tolerance | method |".to_owned();
    for n in powers(last) {
        let _ = write!(text, " N = {n} |");
    }
    text += " steps per revolution | rejected, per step | unsolved, per step | ∇H per step | uncorrected | largest energy error | in round-off levels |\n|";
    text + &"---|".repeat(3 + powers(last).count() + 7)
}

fn row(curve: &Curve) -> String {
    let Curve {
        certificate: c,
        eccentricity: e,
        tolerance,
        ..
    } = curve;
    let mut text = format!("| {e} | {tolerance} | {} |", curve.name());
    let last = curve.points.last().map_or(0, |point| point.0);
    for n in powers(last) {
        let _ = write!(text, " {:.1e} |", curve.error_after(n));
    }
    let (rejected, failed) = (c.variable_steps).map_or((0, 0), |s| (s.rejected, s.failed));
    let steps = c.counts.steps as f64;
    let share = |n: u64| n as f64 / steps;
    let _ = write!(
        text,
        " {:.1} | {:.2} | {:.2} | {:.0} | {} | {:.0e} | {} |",
        steps / curve.revolutions,
        share(rejected),
        share(failed),
        share(c.counts.gradients),
        c.counts.uncorrected(),
        c.energy.as_ref().map_or(f64::NAN, |energy| energy.max),
        c.energy_in_round_off_levels
            .map_or_else(String::new, |levels| format!("{levels:.1}")),
    );
    text
}

pub(crate) fn table(curves: &[Curve]) -> String {
    let mut text = "e,tolerance,method,revolutions,error\n".to_owned();
    for curve in curves {
        for (n, error) in &curve.points {
            let _ = writeln!(
                text,
                "{},{},{},{}.3,{error:e}",
                curve.eccentricity,
                curve.tolerance,
                curve.name(),
                n
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{numbers, powers};

    #[test]
    fn numbers_hold_the_powers_of_ten_and_the_end() {
        let all = numbers(250);
        assert!(all.is_sorted() && all.last() == Some(&250));
        assert!(powers(250).all(|n| all.contains(&n)));
        assert_eq!(powers(250).collect::<Vec<_>>(), [1, 10, 100]);
    }
}
