//! `equip run`: one scene, one method, one certificate.

mod comparison;
mod curve;
pub(crate) mod finished;
pub(crate) mod integrator;
mod json;
mod method;
mod picture;
pub(crate) mod progress;
mod requested;
pub(crate) mod signals;
mod watch;

use crate::args::{AlphaPolicyName, MethodName, Precision, RunArgs, number, positive};
use crate::draw::samples::Picture;
use crate::fault::Fault;
use crate::text::{significant, without_long_numbers};
use crate::write::checkpoint::{self, Saved, Saver, unfinished};
use crate::write::csv::Mark;
use crate::write::lock::{Claim, ordinary};
use crate::write::outputs::behind_link;
use comparison::Comparison;
use curve::curve;
use equip_integrate::{
    AlphaPolicy, Checkpoint, Gauss, IntegrateError, Integrator, Invariant, Method, Target,
};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;
use finished::{EndError, Finished, end_error};
use integrator::{integrate, integrator};
use method::method;
use picture::{components, draw};
use progress::Progress;
use std::io::{Write, stdout};
use std::time::Duration;
use watch::{Resumed, Watch};

pub(crate) fn run(args: &mut RunArgs) -> Result<(), Fault> {
    args.checkpoint = args.checkpoint.take().map(behind_link);
    requested::check(args)?;
    let instance = args.instance()?;
    match args.precision {
        Precision::F64 => run_in::<f64>(args, &instance),
        Precision::Dd => run_in::<DoubleDouble>(args, &instance),
    }
}

/// The whole command in floating-point type `T`.
fn run_in<T: Float>(args: &RunArgs, instance: &Instance) -> Result<(), Fault> {
    let (h, end) = time_scale::<T>(args, instance)?;
    let method = method::<T>(args.stages, &args.method)?;
    let h = match &args.target_error {
        None => h,
        Some(text) => step_for(positive("--target-error", text)?, instance, method, end)?,
    };
    let tolerance = args
        .tolerance()
        .map(|text| number::<T>("--tolerance", text));
    let tolerance = tolerance.transpose()?;
    let mut options = integrator(method, tolerance, h).alpha_policy(match args.alpha_policy {
        AlphaPolicyName::WithinError => AlphaPolicy::WithinError,
        AlphaPolicyName::Always => AlphaPolicy::Always,
        AlphaPolicyName::Refuse => AlphaPolicy::Refuse,
    });
    if args.lyapunov {
        options = options.chaos();
    }
    for invariant in instance.invariants() {
        options = options.invariant(Invariant::new(invariant.name, invariant.quantity.clone()));
    }

    let (q0, p0) = instance.initial::<T>();
    let components = if args.plot.is_some() {
        components(instance)
    } else {
        Vec::new()
    };
    let steps = (end / h).abs().to_f64().ceil() as u64;
    // How many steps a tolerance will take is not known.
    let shown = !args.quiet && tolerance.is_none();
    let progress = Progress::new("integrating", steps, shown);
    let mut watch = Watch::new((&q0, &p0), end, Picture::new(components), progress);
    watch.plot.clone_from(&args.plot);
    watch.follows_chaos = args.lyapunov;
    watch.grid = tolerance.is_none().then_some(h);
    watch.out =
        (args.out.clone()).map(|path| (path, Mark::new(q0.len(), args.every, args.lyapunov)));
    let (mut from, mut claim) = (None, None);
    if let Some(path) = &args.checkpoint {
        let seconds = args.checkpoint_every;
        let every = Duration::try_from_secs_f64(seconds).map_err(|_| {
            let expected = "a number of seconds from 0 to 1e18";
            Fault::option("--checkpoint-every", seconds, expected)
        })?;
        for replaced in [path, &unfinished(path)] {
            ordinary("--checkpoint", replaced)?;
        }
        claim = Some(Claim::new("--checkpoint", path)?);
        watch.saver = Some(Saver::new(path, every, instance));
        if let Some(saved) = checkpoint::load(path)? {
            saved.check(path, instance)?;
            from = Some(resume(args, saved, &mut watch, end)?);
        }
    }
    signals::catch()?;

    let made = integrate(&options, instance, from.as_ref(), end, &mut watch);
    let (run, error) = match made {
        Ok(run) => (run, None),
        Err(failure) => match failure.partial {
            Some(partial) => (*partial, Some(failure.error)),
            None => return Err(Fault::start(failure.error)),
        },
    };
    let written = watch.finish(&run);
    let finished = Finished {
        // A run without a step ends where it started, which says nothing of it.
        end_error: (error.is_none() || run.certificate().counts.steps > 0)
            .then(|| end_error(instance, &run))
            .flatten(),
        instance,
        run,
        error,
    };
    let gauss = integrator(Gauss::stages(method.degree()), tolerance, h);
    let drawn = match &written {
        Ok(()) => picture(args, [options, gauss], &finished, &mut watch),
        Err(_) => Ok(()),
    };
    drop(watch);
    drop(claim);
    // What cannot be written does not take the certificate along, nor does a closed pipe hide a fault.
    let printed = report(args, &finished);
    written.and(drawn)?;
    if let Some(signal) = signals::caught()
        && finished.run.stopped()
        && finished.error.is_none()
    {
        return Err(Fault::Interrupted {
            signal,
            exit_code: signals::exit_code(signal),
            reached: significant(finished.run.certificate().end.to_f64(), 7),
            next: match &args.checkpoint {
                Some(path) => format!("the same command resumes from {}", path.display()),
                None => "with --checkpoint FILE a run can be resumed".to_owned(),
            },
        });
    }
    match finished.error {
        None => printed,
        Some(error) => Err(Fault::integration(
            &error,
            finished.run.certificate().end.to_f64(),
            match (&args.out, &args.plot) {
                (None, None) => "--out FILE.csv writes the steps up to that time",
                _ => "the steps up to that time are written",
            },
        )),
    }
}

/// Makes `watch` go on from a checkpoint: its table must be there as far as it was written.
fn resume<T: Float>(
    args: &RunArgs,
    saved: Saved,
    watch: &mut Watch<'_, T>,
    end: T,
) -> Result<Checkpoint, Fault> {
    let Saved {
        table,
        picture,
        checkpoint,
        ..
    } = saved;
    let time = checkpoint.time::<T>().map_err(Fault::start)?;
    let reached = significant(time.to_f64(), 7);
    // Behind the start of the run is for the integrator to refuse. The last point of a grid of steps may lie
    // beyond the end by the rounding of time.
    let rounding = T::int(4) * T::EPSILON * end.abs();
    if time * end > T::int(0) && time.abs() > end.abs() + rounding {
        let option = match args.periods {
            Some(_) => "--periods",
            None => "--until",
        };
        let (value, expected) = (format!("t = {end}"), "not earlier than the checkpoint");
        return Err(Fault::option(option, value, expected));
    }
    let mut resumed = Resumed::default();
    match (&mut watch.out, table) {
        (Some((path, mark)), Some(stored)) => {
            resumed.table = Some(stored.open(path, mark)?);
            *mark = stored;
        }
        (Some((path, _)), None) => {
            return Err(Fault::Table {
                path: path.clone(),
                what: format!("the run of the checkpoint, at t = {time}, wrote no table"),
            });
        }
        (None, Some(_)) => resumed.notes.push(format!(
            "note: there is no --out, so the table written up to the checkpoint ends at t = {reached}"
        )),
        (None, None) => {}
    }
    match picture.filter(|picture| picture.is_like(&watch.picture)) {
        Some(picture) => watch.picture = picture,
        None if args.plot.is_some() => resumed.notes.push(format!(
            "note: nothing was drawn before the checkpoint; the picture begins at t = {reached}"
        )),
        None => {}
    }
    if !args.quiet {
        resumed.notes.push(format!("resuming at t = {reached}"));
    }
    watch.resumed = Some(resumed);
    Ok(checkpoint)
}

/// Draws the finished run into the file made for it, if there is one.
fn picture<T: Float>(
    args: &RunArgs,
    [options, gauss]: [Integrator<T>; 2],
    finished: &Finished<'_, T>,
    watch: &mut Watch<'_, T>,
) -> Result<(), Fault> {
    let Some(file) = watch.drawing.take() else {
        return Ok(());
    };
    let compare =
        !args.no_compare && args.method != MethodName::Gauss && signals::caught().is_none();
    let comparison = compare.then(|| {
        let shown = !args.quiet && args.tolerance().is_none();
        let progress = Progress::new("Gauss for comparison", watch.progress.steps(), shown);
        let end = finished.run.certificate().end;
        Comparison::new(
            (&gauss, args.tolerance().is_some()),
            finished.instance,
            end,
            progress,
        )
    });
    let curve = curve(
        options,
        finished.instance,
        &finished.run,
        components(finished.instance),
    );
    file.write(&draw(finished, watch, comparison.as_ref(), curve.as_ref()))
}

/// Step and end time.
fn time_scale<T: Float>(args: &RunArgs, instance: &Instance) -> Result<(T, T), Fault> {
    let period = || instance.period::<T>();
    let h = match (&args.step, &args.steps_per_period) {
        (Some(text), _) => number::<T>("--step", text)?,
        (None, Some(text)) => period() / positive::<T>("--steps-per-period", text)?,
        (None, None) => T::exact(instance.suggested_step()),
    };
    let end = match (&args.until, &args.periods) {
        (Some(text), _) => number::<T>("--until", text)?,
        (None, Some(text)) => number::<T>("--periods", text)? * period(),
        (None, None) => T::exact(instance.suggested_end()),
    };
    Ok((h, end))
}

/// The step for an error at the end, from trial runs over a period, forward or back in time as the run.
fn step_for<T: Float>(target: T, instance: &Instance, method: Method, end: T) -> Result<T, Fault> {
    if end == T::int(0) {
        // A run of no steps has no error.
        return Ok(T::exact(instance.suggested_step()));
    }
    let period = instance.period::<T>();
    let whole = end.abs() < T::int(2) * period;
    let (stretch, target) = if whole {
        (end, target)
    } else {
        let period = if end < T::int(0) { -period } else { period };
        (period, target * (period / end))
    };
    let (q, p) = instance.initial::<T>();
    let interval = T::int(0)..=stretch;
    let wanted = Target::Trajectory(target);
    let suggested = method.suggest_step(instance.hamiltonian(), &q, &p, interval, wanted);
    suggested.map_err(|error| Fault::start(of_whole_run(error, (end / stretch).abs())))
}

/// The errors that trial runs have reached, and the target, as those of a run so many times as long.
fn of_whole_run<T: Float>(error: IntegrateError<T>, times: T) -> IntegrateError<T> {
    use IntegrateError as E;
    match error {
        E::TargetBelowRoundOff {
            target,
            reached,
            step,
        } => E::TargetBelowRoundOff {
            target: target * times,
            reached: reached * times,
            step,
        },
        E::TargetNotReached {
            target,
            error,
            step,
        } => E::TargetNotReached {
            target: target * times,
            error: error * times,
            step,
        },
        other => other,
    }
}

/// Prints the certificate in the requested form.
fn report<T: Float>(args: &RunArgs, finished: &Finished<'_, T>) -> Result<(), Fault> {
    let mut out = stdout().lock();
    if args.json {
        let text = json::document(finished).map_err(std::io::Error::from)?;
        writeln!(out, "{text}")?;
    } else if !args.quiet {
        let parameters: Vec<_> = finished
            .instance
            .parameters()
            .map(|(name, value)| format!(" {name}={value}"))
            .collect();
        let certificate = finished.run.certificate().to_string();
        let certificate = without_long_numbers(&certificate);
        let (verdict, lines) = certificate.split_once('\n').unwrap_or_default();
        let (scene, parameters) = (finished.instance.scene().name, parameters.concat());
        writeln!(
            out,
            "{verdict}\n{:<24}{scene}{parameters}\n{lines}",
            "scene"
        )?;
        if let Some(EndError { against, q, p }) = &finished.end_error {
            writeln!(
                out,
                "{:<24}q {q:.2e}, p {p:.2e} against {against}",
                "end state error"
            )?;
        }
        for (label, path) in [
            ("steps written to", &args.out),
            ("plot written to", &args.plot),
        ] {
            if let Some(path) = path {
                writeln!(out, "{label:<24}{}", path.display())?;
            }
        }
    }
    Ok(())
}
