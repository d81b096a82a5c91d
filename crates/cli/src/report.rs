//! `equip report`: EQUIP compared with Gauss. First long runs with step control and close encounters, then
//! for each scene error against run time.
//!
//! All methods get the same H, the same gradient (derived from the traced H), the same initial state and the
//! same end; the error is the largest difference from the end state in any component of q and p. One thread;
//! [`measure`] describes how the times are measured.

mod accuracy;
mod conclusion;
mod contender;
mod csv;
mod long;
mod measure;
mod page;
mod peers;
mod picture;
mod results;
mod subject;

use crate::args::ReportArgs;
use crate::commands::growth;
use crate::fault::Fault;
use crate::limits::LEVELS;
use crate::run::progress::steps_of;
use crate::text::wrapped;
use crate::write::lock::{Claim, unwritten};
use contender::contenders;
use equip_scalar::{DoubleDouble, Float};
use indicatif::ProgressBar;
use measure::{Budget, curves};
use results::{Results, round_off};
use std::fs;
use std::io::{Write, stdout};
use std::time::{Duration, Instant};
use subject::{ENTRIES, Entry, Subject};

/// How long the scenes may take; long runs come before.
const QUICK: Duration = Duration::from_secs(15);
const COMPLETE: Duration = Duration::from_secs(540);

pub(crate) fn report(args: &ReportArgs) -> Result<(), Fault> {
    let begun = Instant::now();
    let peers = args.peers.as_deref().map(peers::read).transpose()?;
    let wanted = args.only.as_deref().unwrap_or("").to_lowercase();
    // (scene, whether in double-double)
    let mut jobs: Vec<(&Entry, bool)> = ENTRIES.iter().map(|e| (e, false)).collect();
    jobs.extend(ENTRIES.iter().filter(|e| e.extended).map(|e| (e, true)));
    jobs.retain(|(entry, extended)| {
        let precision = match extended {
            true => DoubleDouble::NAME,
            false => f64::NAME,
        };
        let name = format!("{}-{precision}", entry.name);
        let quick = entry.quick && (!extended || entry.name.starts_with("kepler"));
        name.contains(&wanted) && (quick || !args.quick)
    });
    let has_long = [long::LONG, long::CLOSE]
        .iter()
        .any(|name| name.contains(&wanted));
    if jobs.is_empty() && !has_long {
        let expected = "text that occurs in the name of a part, such as kepler-0.6-f64";
        return Err(Fault::option("--only", wanted, expected));
    }
    // A directory that cannot be made is worth knowing before the work.
    fs::create_dir_all(&args.out).map_err(|source| unwritten(&args.out, source))?;
    let page = args.out.join("report.html");
    // Two reports in one directory would mix.
    let _claim = Claim::new("--out", &page)?;
    let total = match (args.seconds, args.quick) {
        (Some(seconds), _) => Duration::from_secs_f64(seconds),
        (None, true) => QUICK,
        (None, false) => COMPLETE,
    };
    let bar = steps_of("scenes", jobs.len());
    let long = long::measure(&wanted, args.quick, &bar)?;
    let scenes_begun = Instant::now();
    let mut results = Vec::new();
    for (i, (entry, extended)) in jobs.iter().enumerate() {
        let left = total.saturating_sub(scenes_begun.elapsed());
        let scene = left / (jobs.len() - i) as u32;
        let budget = Budget {
            run: scene / 30,
            scene,
        };
        let stages: &[usize] = match (extended, args.quick) {
            (true, true) => &[8, 12],
            (true, false) => &[6, 8, 10, 12],
            (false, true) => &[4, 6, 8],
            (false, false) => &[3, 4, 6, 8, 10],
        };
        let result = match extended {
            true => measured::<DoubleDouble>(entry, stages, EXTENDED, budget, &bar)?,
            false => measured::<f64>(entry, stages, DOUBLE, budget, &bar)?,
        };
        bar.inc(1);
        results.push(result);
    }
    bar.finish_and_clear();
    let facts = facts(&results, begun);
    let sentences = conclusion::conclusion(&long, &results);
    let texts = (&sentences[..], &facts[..]);
    let mut files = vec![
        (
            "report.html".to_owned(),
            page::page(texts, &long, &results, peers.as_ref()),
        ),
        ("runs.csv".to_owned(), csv::runs(&results)),
        ("times.csv".to_owned(), csv::accuracies(&results)),
    ];
    for (name, curves) in [(long::LONG, &long.regular), (long::CLOSE, &long.close)] {
        if !curves.is_empty() {
            files.push((format!("{name}.csv"), growth::table(curves)));
            let title = "Kepler’s problem with step size control";
            files.push((format!("{name}.svg"), long::figure(title, curves).svg()));
        }
    }
    let pictures = results
        .iter()
        .map(|r| (format!("{}.svg", r.id()), &r.figure));
    files.extend(pictures.map(|(name, figure)| (name, figure.svg())));
    for scene in peers.iter().flat_map(|p| &p.scenes) {
        files.push((
            format!("peers-{}.svg", scene.scene.replace(['/', '\\'], "-")),
            scene.figure().svg(),
        ));
    }
    for (name, text) in &files {
        let path = args.out.join(name);
        fs::write(&path, text).map_err(|source| unwritten(&path, source))?;
    }
    let scenes = match results.len() {
        0 => "report".into(),
        1 => "1 scene".into(),
        several => format!("{several} scenes"),
    };
    let mut out = stdout().lock();
    for sentence in &sentences {
        writeln!(out, "{}\n", wrapped("", 0, sentence))?;
    }
    writeln!(
        out,
        "{scenes} in {:.0} s: {}",
        begun.elapsed().as_secs_f64(),
        page.display()
    )?;
    Ok(())
}

/// Errors to be reached.
const DOUBLE: &[f64] = &[1e-6, 1e-8, 1e-10, 1e-12];
const EXTENDED: &[f64] = &[1e-12, 1e-16, 1e-20, 1e-25];

fn measured<T: Float>(
    entry: &Entry,
    stages: &[usize],
    targets: &'static [f64],
    budget: Budget,
    bar: &ProgressBar,
) -> Result<Results, Fault> {
    let subject = Subject::<T>::new(entry)?;
    let say = |text| bar.set_message(text);
    let curves = curves(&subject, &contenders(stages), budget, say);
    let invariants: Vec<_> = (subject.instance.invariants().iter())
        .map(|invariant| invariant.name)
        .collect();
    let title = match T::NAME {
        f64::NAME => subject.title,
        _ => format!("{}, in double-double", subject.title),
    };
    let figure = picture::scene(&title, &curves, round_off(&curves));
    Ok(Results {
        name: subject.name,
        precision: T::NAME,
        invariants,
        title,
        source: subject.source,
        targets,
        curves,
        figure,
    })
}

/// The machine and how it was measured, a sentence each.
fn facts(results: &[Results], begun: Instant) -> Vec<String> {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let cpu = model.map_or("unknown processor", |(_, name)| name);
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let repeats = || {
        results
            .iter()
            .flat_map(|r| &r.curves)
            .flat_map(|c| &c.points)
            .map(|p| p.milliseconds.len())
    };
    let (fewest, most) = (repeats().min().unwrap_or(0), repeats().max().unwrap_or(0));
    let build = if cfg!(debug_assertions) {
        "built without optimisation: times mean nothing"
    } else {
        "release build"
    };
    vec![
        format!("equip {}, {build}", env!("CARGO_PKG_VERSION")),
        format!("{cpu}, {cores} cores, {} on {}; one thread is used", std::env::consts::OS, std::env::consts::ARCH),
        format!("CPU time of complete runs in which H is not measured; medians of {fewest} to {most} interleaved repetitions; the tables have their spread"),
        "error: the largest difference in any component of q and p at the end; H is given as a closure, and all methods use the gradient derived from it".into(),
        format!("hollow marks: |ΔH| exceeds {LEVELS} round-off levels of H"),
        "times to an error: interpolated linearly in both logarithms; a setting reaches an error only if the next finer setting reaches it too".into(),
        format!("measured in {:.0} s", begun.elapsed().as_secs_f64()),
    ]
}
