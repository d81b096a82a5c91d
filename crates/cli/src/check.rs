//! `equip check`: the catalogue of stiff and extreme cases, run and judged.
//!
//! Rows are data ([`case::Case`]), grouped by theme; [`measure::row`] runs one with EQUIP and with Gauss, and
//! [`verdict::judge`] holds its figures against what its definition expects.

mod case;
mod cases;
mod documents;
mod html;
mod leg;
mod measure;
mod measured;
mod outcomes;
mod reference;
mod summary;
mod table;
mod verdict;

use crate::args::CheckArgs;
use crate::fault::Fault;
use crate::run::progress::steps_of;
use crate::text::Print;
use crate::write::outputs::{Output, apart, printed};
use case::Case;
use cases::catalogue;
use measure::Row;
use reference::Cache;
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;
use summary::Summary;

pub(crate) fn check(args: &CheckArgs) -> Result<(), Fault> {
    let begun = Instant::now();
    let wanted = args.only.as_deref().unwrap_or("").to_lowercase();
    let mut cases = catalogue();
    cases.retain(|case| {
        let text = format!("{} {} {}", case.theme, case.name, case.setting());
        (case.quick || !args.quick) && text.to_lowercase().contains(&wanted)
    });
    if cases.is_empty() {
        let expected = "a part of the theme, name or setting of a row";
        return Err(Fault::option("--only", wanted, expected));
    }
    apart(&[
        ("--json", args.json.as_deref()),
        ("--csv", args.csv.as_deref()),
        ("--html", args.html.as_deref()),
        printed(),
    ])?;
    let open = |path: &Option<PathBuf>| path.as_deref().map(Output::open).transpose();
    let (json, csv, html) = (open(&args.json)?, open(&args.csv)?, open(&args.html)?);
    let mut out = Print::default();
    let rows = run_all(&cases, &mut out)?;
    let summary = Summary::of(&rows, begun);
    table::end(&mut out, &rows, &summary)?;
    if let Some(file) = json {
        file.write(&documents::json(&rows, &summary)?)?;
    }
    if let Some(file) = csv {
        file.write(&documents::csv(&rows)?)?;
    }
    if let Some(file) = html {
        file.write(&html::document(&rows, &summary))?;
    }
    match summary.failed {
        0 => Ok(out.end()?),
        failed => Err(Fault::Check {
            failed,
            rows: summary.rows,
        }),
    }
}

/// Runs the cases on all cores and prints each as soon as all before it are printed.
fn run_all<'a>(cases: &'a [Case], out: &mut Print) -> Result<Vec<Row<'a>>, Fault> {
    let bar = steps_of("rows", cases.len());
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    let (next, cache) = (AtomicUsize::new(0), Cache::default());
    // Long runs first: they would keep one core busy at the end while the others wait.
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(cases[i].steps / 500_000));
    let (send, receive) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.min(cases.len()) {
            let send = send.clone();
            let (next, cache, order) = (&next, &cache, &order);
            scope.spawn(move || {
                while let Some(&index) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                    // All rows are received.
                    let _ = send.send((index, measure::row(&cases[index], cache)));
                }
            });
        }
        drop(send);
        let mut waiting: Vec<Option<Row<'_>>> = cases.iter().map(|_| None).collect();
        let mut rows = Vec::with_capacity(cases.len());
        let mut theme = "";
        for (index, row) in receive {
            waiting[index] = Some(row);
            bar.inc(1);
            while let Some(row) = waiting.get_mut(rows.len()).and_then(Option::take) {
                bar.suspend(|| {
                    if row.case.theme != theme {
                        theme = row.case.theme;
                        table::head(out, theme)?;
                    }
                    table::line(out, &row)
                })?;
                rows.push(row);
            }
        }
        bar.finish_and_clear();
        Ok(rows)
    })
}

#[cfg(test)]
mod tests {
    use super::case::Reference;
    use super::catalogue;
    use super::leg::stride;
    use std::collections::HashSet;

    #[test]
    fn rows_are_distinct_and_shared_references_have_their_times() {
        let mut seen = HashSet::new();
        for case in catalogue() {
            let row = (case.name.clone(), case.setting(), case.steps);
            assert!(seen.insert(row.clone()), "{row:?}");
            if let Reference::Shared { grid, end, .. } = case.reference {
                let apart = case.h * stride(case.steps) as f64 / grid;
                assert!((apart - apart.round()).abs() < 1e-9, "{row:?}");
                assert!(case.h * case.steps as f64 <= end * (1.0 + 1e-9), "{row:?}");
            }
        }
    }

    #[test]
    fn every_problem_can_be_built() {
        for case in catalogue() {
            assert!((case.problem)().is_ok(), "{}", case.name);
        }
    }
}
