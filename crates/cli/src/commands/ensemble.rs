//! `equip ensemble`: many members of one scene over threads, each a row of a file that can be gone on with.

use crate::args::{EnsembleArgs, Shard};
use crate::fault::Fault;
use crate::number::number;
use crate::run::integrator::Integrator;
use crate::run::method::method;
use crate::run::progress::steps_of;
use crate::run::signals;
use crate::write::lock::unwritten;
use crate::write::members::{self, Growing, Head, Row, Seal};
use crate::write::outputs::ordinary;
use equip_integrate::{IntegrateError, Record, Run, RunFailure, Starts, drawn_start};
use equip_scenes::Instance;
use std::io::{Write, stdout};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Members of a shard at most: all their rows are in memory at the end, some 200 bytes each.
const MOST_MEMBERS: u128 = 10_000_000;
/// How often rows are brought to the disk.
const EVERY: Duration = Duration::from_secs(1);

/// A finished member: its number and its row.
type Made = (u64, String);

pub(crate) fn ensemble(args: &EnsembleArgs) -> Result<(), Fault> {
    let instance = args.problem.instance()?;
    let (head, integrator) = asked(args, &instance)?;
    ordinary("--out", &args.out)?;
    let threads = args.threads.map_or(0, |threads| threads as usize);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|source| Fault::Threads {
        threads,
        source: source.into(),
    })?;
    signals::catch()?;
    let (mut growing, found) = Growing::open(&args.out, &head)?;
    let missing = found.missing();
    let mut rows = found.rows;
    let resumed = rows.len();

    let starts = missing.iter().map(|&i| start(&instance, &head, i));
    let (q, p): (Vec<_>, Vec<_>) = starts.unzip();
    let (q, p) = (q.concat(), p.concat());
    let starts = Starts::new(&q, &p, 0.0..=head.until);
    let (sender, receiver) = channel::<Made>();
    // Set when a row cannot be written.
    let is_lost = AtomicBool::new(false);
    let (m, missing) = (head.m, &missing);
    let seal = Seal::of(&head).map_err(|source| unwritten(&args.out, source))?;
    let make = move |i: usize, run: Result<Run<f64>, RunFailure<f64>>| {
        let start = (&starts.q0[i * m..][..m], &starts.p0[i * m..][..m]);
        // Nobody takes rows any more once one could not be written.
        let _ = sender.send((missing[i], row(missing[i], start, &run, seal)));
    };
    let stop = || is_lost.load(Relaxed) || signals::caught().is_some();
    let pool = &pool;
    let (made, written) = std::thread::scope(|scope| {
        // `make` has the sender: rows end with it.
        let work = || integrator.ensemble(instance.hamiltonian(), starts, make, stop);
        let work = scope.spawn(move || pool.install(work));
        let written = collect(receiver, &mut growing, missing.len(), args.quiet);
        is_lost.store(written.is_err(), Relaxed);
        (work.join(), written)
    });
    let made = made.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    drop(made.map_err(Fault::start)?);
    rows.extend(written?);
    if let Some(signal) = signals::caught()
        && rows.len() < head.members().count()
    {
        return Err(Fault::EnsembleInterrupted {
            signal,
            exit_code: signals::exit_code(signal),
            made: rows.len(),
            members: head.members().count(),
            path: args.out.clone(),
        });
    }
    members::write(&args.out, &head, rows.values())?;
    if !args.quiet {
        summary(&head, resumed, rows.values(), &args.out)?;
    }
    Ok(())
}

/// The options, and what makes the runs; all faults of theirs are found here.
fn asked(args: &EnsembleArgs, instance: &Instance) -> Result<(Head, Integrator<f64>), Fault> {
    let read = |option, text: &Option<String>| match text {
        Some(text) => number::<f64>(option, text).map(Some),
        None => Ok(None),
    };
    let tolerance = read("--tolerance", &args.stepping.tolerance)?;
    let step = read("--step", &args.stepping.step)?;
    let tolerance = tolerance.or(step.is_none().then_some(1e-12));
    let until = read("--until", &args.span.until)?;
    let periods = read("--periods", &args.span.periods)?.map(|p| p * instance.period::<f64>());
    let until = until.or(periods).unwrap_or(instance.suggested_end());
    let Shard { number: k, count } = args.shard;
    let members = u128::from(args.n).div_ceil(u128::from(count));
    if members > MOST_MEMBERS {
        return Err(Fault::Option {
            option: "--n",
            value: format!("{}, {members} members in shard {k}/{count}", args.n),
            expected: "at most 10000000 for each shard; make more of them with --shard K/COUNT",
        });
    }
    let spread = number::<f64>("--spread", &args.spread)?;
    if !(0.0..=1.0).contains(&spread) {
        return Err(Fault::Option {
            option: "--spread",
            value: args.spread.clone(),
            expected: "from 0 to 1",
        });
    }
    let method = method::<f64>(args.stepping.stages, &args.stepping.method)?;
    let h = instance.hamiltonian();
    let integrator = match (step, tolerance) {
        (Some(step), _) => {
            let steps = method.step(step).record(Record::Ends);
            drop(steps.prepare(h).map_err(Fault::start)?);
            Integrator::Fixed(steps)
        }
        (None, tolerance) => {
            let steps = method.tolerance(tolerance.unwrap_or_default());
            let steps = steps.record(Record::Ends);
            drop(steps.prepare(h).map_err(Fault::start)?);
            Integrator::Variable(steps)
        }
    };
    let (start, end) = (0.0, until);
    if !until.is_finite() {
        return Err(Fault::start(IntegrateError::Interval { start, end }));
    }
    if let Some(step) = step.filter(|step| step * until < 0.0) {
        return Err(Fault::start(IntegrateError::StepsLeadAway {
            step,
            start,
            end,
        }));
    }
    let text = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
    let head = Head {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: instance.scene().name.into(),
        parameters: instance.parameters().map(text).collect(),
        n: args.n,
        seed: args.seed,
        spread,
        method: args.stepping.method.to_string(),
        stages: args.stepping.stages,
        step,
        tolerance,
        until,
        m: instance.initial::<f64>().0.len(),
        shard: args.shard.into(),
    };
    Ok((head, integrator))
}

fn start(instance: &Instance, head: &Head, member: u64) -> (Vec<f64>, Vec<f64>) {
    let (q, p) = instance.initial::<f64>();
    drawn_start(&q, &p, head.spread, head.seed, member)
}

/// The row of a member from its run.
fn row(
    member: u64,
    start: (&[f64], &[f64]),
    run: &Result<Run<f64>, RunFailure<f64>>,
    seal: Seal,
) -> String {
    let nowhere = vec![f64::NAN; start.0.len()];
    match run {
        Ok(run) => {
            let (t, q, p) = run.last();
            let certificate = run.certificate();
            let energy = certificate.energy.as_ref();
            Row {
                member,
                start,
                t,
                end: (q, p),
                energy_defect: energy.map_or(f64::NAN, |energy| energy.max),
                steps: certificate.counts.steps,
                energy_kept: certificate.energy_kept_on_every_step(),
                error: "",
            }
            .text(seal)
        }
        Err(failure) => Row {
            member,
            start,
            t: f64::NAN,
            end: (&nowhere, &nowhere),
            energy_defect: f64::NAN,
            steps: 0,
            energy_kept: false,
            error: &failure.to_string(),
        }
        .text(seal),
    }
}

/// Writes rows as they come, until no thread makes any more.
fn collect(
    receiver: Receiver<Made>,
    growing: &mut Growing,
    count: usize,
    is_quiet: bool,
) -> Result<Vec<Made>, Fault> {
    let bar = match is_quiet {
        true => indicatif::ProgressBar::hidden(),
        false => steps_of("members", count),
    };
    let mut all = Vec::new();
    let mut synced = Instant::now();
    for (member, row) in receiver {
        growing.add(&row)?;
        all.push((member, row));
        bar.inc(1);
        if synced.elapsed() > EVERY {
            growing.sync()?;
            synced = Instant::now();
        }
    }
    bar.finish_and_clear();
    growing.sync()?;
    Ok(all)
}

fn summary<'a>(
    head: &Head,
    resumed: usize,
    rows: impl Iterator<Item = &'a String>,
    path: &Path,
) -> Result<(), Fault> {
    let (number, count) = head.shard;
    let members = head.members();
    let failed = rows.filter(|row| !row.contains(",\"\",")).count();
    let mut out = stdout().lock();
    writeln!(out, "{:<24}{}", "scene", head.scene)?;
    write!(out, "{:<24}{}", "members", members.clone().count())?;
    if count > 1 {
        write!(out, " of {}, shard {number}/{count}", head.n)?;
    }
    if resumed > 0 {
        write!(out, ", {resumed} of them there before")?;
    }
    writeln!(out)?;
    writeln!(out, "{:<24}{failed}", "failed")?;
    writeln!(out, "{:<24}{}", "members written to", path.display())?;
    Ok(())
}
