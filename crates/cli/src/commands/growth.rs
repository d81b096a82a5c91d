//! `equip growth`: how the error of Kepler's problem grows with time, EQUIP beside Gauss under the same step
//! control.
//!
//! Errors are taken 0.3 revolutions after the N-th, never at a whole number of them, where doing nothing
//! scores zero: the largest of the components of position and momentum, against the closed form. A method
//! that drifts in energy gets the period wrong, and its error grows like N²; one that keeps energy and
//! angular momentum leaves N.

use crate::args::{GrowthArgs, number};
use crate::draw::growth::{Curve, DASHES, draw};
use crate::fault::Fault;
use crate::run::progress::steps_of;
use crate::write::outputs::{Drawing, apart};
use equip_integrate::{Equip, Gauss, IntegrateError, Method, Record};
use equip_scenes::Instance;
use std::fmt::Write as _;
use std::io::{Write as _, stdout};

/// Points of a curve in a decade of N.
const PER_DECADE: u32 = 8;

pub(crate) fn growth(args: &GrowthArgs) -> Result<(), Fault> {
    let scene = equip_scenes::find("kepler")?;
    // All lists are read before the first run.
    let orbits = (args.eccentricities.iter())
        .map(|e| Ok((e, scene.instance(&[("e", e)])?)))
        .collect::<Result<Vec<_>, Fault>>()?;
    let tolerances = (args.tolerances.iter())
        .map(|text| Ok((text, number::<f64>("--tolerances", text)?)))
        .collect::<Result<Vec<_>, Fault>>()?;
    if tolerances.len() > DASHES.len() {
        return Err(Fault::Option {
            option: "--tolerances",
            value: format!("a list of {}", tolerances.len()),
            expected: "at most 6, which can be told apart in the picture",
        });
    }
    apart(&[("--plot", Some(&args.plot)), ("--csv", args.csv.as_deref())])?;
    let methods = [
        (true, Equip::stages(args.stages)),
        (false, Gauss::stages(args.stages)),
    ];
    for (_, method) in methods {
        for &(text, tolerance) in &tolerances {
            accepted(method, text, tolerance, &orbits)?;
        }
    }
    let mut drawing = Drawing::new(&args.plot, args.csv.as_deref());
    let bar = steps_of("runs", orbits.len() * tolerances.len() * methods.len());
    let mut curves = Vec::new();
    let mut out = stdout().lock();
    writeln!(out, "{}", header(args.revolutions))?;
    for (eccentricity, instance) in &orbits {
        for (text, tolerance) in &tolerances {
            for (is_equip, method) in methods {
                let mut curve = follow(instance, method, *tolerance, args.revolutions)?;
                drawing.create()?;
                curve.eccentricity.clone_from(eccentricity);
                curve.tolerance.clone_from(text);
                curve.is_equip = is_equip;
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
    Ok(())
}

/// Whether the library takes the method and the tolerance.
fn accepted(
    method: Method,
    text: &str,
    tolerance: f64,
    orbits: &[(&String, Instance)],
) -> Result<(), Fault> {
    let Some((_, orbit)) = orbits.first() else {
        return Ok(());
    };
    let made = method.tolerance(tolerance).prepare(orbit.hamiltonian());
    made.map(drop).map_err(|error| match error {
        IntegrateError::Option {
            option: "tolerance",
            expected,
            ..
        } => Fault::Option {
            option: "--tolerances",
            value: text.to_owned(),
            expected,
        },
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

/// One run, and its errors on the way.
fn follow(instance: &Instance, method: Method, tolerance: f64, last: u64) -> Result<Curve, Fault> {
    let (q, p) = instance.initial::<f64>();
    let period: f64 = instance.period();
    let numbers = numbers(last);
    let times: Vec<f64> = numbers.iter().map(|&n| (n as f64 + 0.3) * period).collect();
    let end = (last as f64 + 0.3) * period;
    let run = method
        .tolerance(tolerance)
        .record(Record::Ends)
        .output_at(&times)
        .integrate(instance.hamiltonian(), &q, &p, 0.0..=end)
        .map_err(Fault::undrawn)?;
    let error = |(t, q, p): (f64, &[f64], &[f64])| {
        let (exact_q, exact_p) = instance.exact(t).unwrap_or_default();
        let pairs = q.iter().chain(p).zip(exact_q.iter().chain(&exact_p));
        pairs.fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()))
    };
    Ok(Curve {
        eccentricity: String::new(),
        tolerance: String::new(),
        is_equip: false,
        points: numbers.into_iter().zip(run.outputs().map(error)).collect(),
        revolutions: last as f64 + 0.3,
        certificate: run.certificate().clone(),
    })
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
    text += " steps per revolution | refused for their error, per step | unsolved, per step | ∇H per step | uncorrected | largest energy error | in round-off levels |\n|";
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
        let point = curve.points.iter().find(|point| point.0 == n);
        let _ = write!(text, " {:.1e} |", point.map_or(f64::NAN, |point| point.1));
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
        c.energy_in_floors
            .map_or_else(String::new, |floors| format!("{floors:.1}")),
    );
    text
}

fn table(curves: &[Curve]) -> String {
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
