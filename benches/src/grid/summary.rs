//! Shares and quantiles by regime, the targets, and the worst cells.

use crate::cell::{Cell, Regime};
use crate::contestant::Ending;
use std::fmt::Write;

/// Worst cells listed.
const WORST: usize = 20;

pub(crate) fn text(cells: &[Cell]) -> String {
    let mut text = String::new();
    let (own, random): (Vec<&Cell>, Vec<&Cell>) = cells.iter().partition(|cell| cell.start == 0);
    if !own.is_empty() {
        let _ = writeln!(text, "\nScenes x stages x steps, EQUIP over Gauss\n{HEAD}");
        by_regime(&mut text, &own);
    }
    if !random.is_empty() {
        let _ = writeln!(text, "\nRandom starts, or systems\n{HEAD}");
        by_regime(&mut text, &random);
    }
    let all: Vec<&Cell> = cells.iter().collect();
    short(&mut text, &own, &random);
    targets(&mut text, &all);
    let _ = writeln!(text, "\nWorst by time{WORST_HEAD}");
    worst(&mut text, &all, Cell::time_ratio);
    let _ = writeln!(text, "\nWorst by error{WORST_HEAD}");
    worst(&mut text, &all, |cell| {
        cell.error_ratio()
            .filter(|_| cell.regime != Regime::Unresolved)
    });
    let _ = writeln!(text, "\nWorst by energy{WORST_HEAD}");
    worst(&mut text, &all, Cell::energy_ratio);
    exits(&mut text, &all);
    text
}

const HEAD: &str = "\
regime         cells | time: median   90 %   99 %     max  > 1.3   > 4   > 10 | work median  99 %    > 4 | \
error: cells   mean   98 %      max | kept steps | energy max | exits";

const WORST_HEAD: &str = "
scene                 start   s          h      hω  regime            time     error of EQUIP    Gauss    ratio  \
energy of EQUIP    Gauss  outcomes";

fn by_regime(text: &mut String, cells: &[&Cell]) {
    for regime in Regime::ALL {
        let of: Vec<&Cell> = cells
            .iter()
            .copied()
            .filter(|cell| cell.regime == regime)
            .collect();
        if of.is_empty() {
            continue;
        }
        let time = Sorted::of(&of, Cell::time_ratio);
        let work = Sorted::of(&of, |cell| {
            let [equip, gauss] = cell.work();
            cell.time_ratio()
                .map(|_| equip as f64 / gauss.max(1) as f64)
        });
        let error = Sorted::of(&of, Cell::error_ratio);
        let _ = write!(
            text,
            "{:<14}{:>6} | {:>12}{:>7}{:>7}{:>8}",
            regime.label(),
            of.len(),
            ratio(time.quantile(0.5)),
            ratio(time.quantile(0.9)),
            ratio(time.quantile(0.99)),
            ratio(time.quantile(1.0)),
        );
        for limit in [1.3, 4.0, 10.0] {
            let _ = write!(text, "{:>6.1}%", 100.0 * time.share_above(limit));
        }
        let _ = writeln!(
            text,
            " | {:>11}{:>6}{:>6.1}% | {:>12}{:>7}{:>7}{:>9} | {:>9.2}% | {:>10} | {:>5}",
            ratio(work.quantile(0.5)),
            ratio(work.quantile(0.99)),
            100.0 * work.share_above(4.0),
            error.0.len(),
            ratio(error.mean()),
            ratio(error.quantile(0.98)),
            ratio(error.quantile(1.0)),
            100.0 * kept(&of),
            ratio(Sorted::of(&of, Cell::energy_ratio).quantile(1.0)),
            of.iter().filter(|cell| cell.fails_alone()).count(),
        );
    }
}

/// The table of docs/extremes.md.
fn short(text: &mut String, own: &[&Cell], random: &[&Cell]) {
    let _ = writeln!(
        text,
        "\n| regime | time ratio: median, 99th percentile | error ratio: geometric mean, 98th percentile, largest | steps at round-off |\n|---|---|---|---|"
    );
    let mut row = |name: &str, cells: &[&Cell], regime: Regime| {
        let of = cells.iter().copied().filter(|cell| cell.regime == regime);
        let of: Vec<&Cell> = of.collect();
        if of.is_empty() {
            return;
        }
        let time = Sorted::of(&of, Cell::time_ratio);
        let error = Sorted::of(&of, Cell::error_ratio);
        let _ = writeln!(
            text,
            "| {name} | {}, {} | {}, {}, {} | {:.1} % |",
            ratio(time.quantile(0.5)),
            ratio(time.quantile(0.99)),
            ratio(error.mean()),
            ratio(error.quantile(0.98)),
            ratio(error.quantile(1.0)),
            100.0 * kept(&of),
        );
    };
    let solved = Regime::ALL.into_iter().filter(|&x| x != Regime::Unsolved);
    for regime in solved {
        row(regime.label(), own, regime);
    }
    row("random starts, resolved", random, Regime::Resolved);
}

/// Share of EQUIP's steps whose energy is at its round-off level.
fn kept(cells: &[&Cell]) -> f64 {
    let sum = |count: fn(&Cell) -> u64| cells.iter().map(|cell| count(cell)).sum::<u64>() as f64;
    sum(|cell| cell.equip.kept) / sum(|cell| cell.equip.steps).max(1.0)
}

fn targets(text: &mut String, cells: &[&Cell]) {
    let resolved: Vec<&Cell> = cells
        .iter()
        .copied()
        .filter(|cell| cell.regime == Regime::Resolved)
        .collect();
    let several = |least: usize| -> Vec<&Cell> {
        let of = resolved.iter().copied();
        of.filter(|cell| cell.stages >= least).collect()
    };
    let time = Sorted::of(cells, Cell::time_ratio);
    let error = Sorted::of(&several(3), Cell::error_ratio);
    let energy = Sorted::of(cells, Cell::energy_ratio);
    let exits = cells.iter().filter(|cell| cell.fails_alone()).count();
    let _ = writeln!(text, "\n| all starts | measured | |\n|---|---|---|");
    let mut line = |what: &str, value: f64, holds: bool| {
        let verdict = if holds { "holds" } else { "MISSED" };
        let _ = writeln!(text, "| {what} | {} | {verdict} |", ratio(value));
    };
    let mut most = |what: &str, value: f64, limit: f64| line(what, value, value <= limit);
    most("time in the median, at most 1.3", time.quantile(0.5), 1.3);
    most("time in 99 %, at most 4", time.quantile(0.99), 4.0);
    most("time in all, at most 10", time.quantile(1.0), 10.0);
    most(
        "error, resolved, s >= 3, mean, at most 0.9",
        error.mean(),
        0.9,
    );
    most(
        "error, resolved, s >= 3, in 98 %, at most 3",
        error.quantile(0.98),
        3.0,
    );
    most(
        "error, resolved, s >= 3, in all, at most 30",
        error.quantile(1.0),
        30.0,
    );
    most(
        "energy beside Gauss's or round-off, at most 2",
        energy.quantile(1.0),
        2.0,
    );
    most("error exits where Gauss has none", exits as f64, 0.0);
    let kept = 100.0 * kept(&several(4));
    line(
        "energy at round-off, resolved, s >= 4, % of the steps, 99",
        kept,
        kept >= 99.0,
    );
}

fn worst(text: &mut String, cells: &[&Cell], of: impl Fn(&Cell) -> Option<f64>) {
    let mut ranked: Vec<(f64, &Cell)> = cells
        .iter()
        .filter_map(|cell| of(cell).map(|ratio| (ratio, *cell)))
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (_, cell) in ranked.iter().take(WORST) {
        let cut = if cell.equip.ending == Ending::Cut {
            ">"
        } else {
            " "
        };
        let outcomes: Vec<String> = cell
            .equip
            .outcomes
            .iter()
            .map(|(name, steps)| format!("{name} {steps}"))
            .collect();
        let _ = writeln!(
            text,
            "{:<21}{:>6}{:>4}{:>11.3e}{:>8}  {:<14}{cut}{:>8}{:>19.2e}{:>9.1e}{:>9}{:>17.1e}{:>9.1e}  {}",
            cell.scene,
            cell.start,
            cell.stages,
            cell.step,
            ratio(cell.angle),
            cell.regime.label(),
            cell.time_ratio().map_or("-".into(), ratio),
            cell.errors[0],
            cell.errors[1],
            cell.error_ratio().map_or("-".into(), ratio),
            cell.equip.energy,
            cell.gauss.energy,
            outcomes.join(", "),
        );
    }
}

fn exits(text: &mut String, cells: &[&Cell]) {
    let failed: Vec<&&Cell> = cells.iter().filter(|cell| cell.fails_alone()).collect();
    if failed.is_empty() {
        return;
    }
    let _ = writeln!(text, "\nError exits where Gauss has none: {}", failed.len());
    for cell in failed.iter().take(WORST) {
        if let Ending::Failed(error) = &cell.equip.ending {
            let short: String = error.chars().take(90).collect();
            let (scene, start, s, h) = (cell.scene, cell.start, cell.stages, cell.step);
            let _ = writeln!(text, "{scene:<21}{start:>6}{s:>4}{h:>11.3e}  {short}");
        }
    }
}

/// A ratio with three digits.
fn ratio(x: f64) -> String {
    match x {
        x if x.is_nan() => "-".into(),
        x if x != 0.0 && !(0.01..9999.5).contains(&x) => format!("{x:.0e}"),
        x if x < 9.995 => format!("{x:.2}"),
        x if x < 99.95 => format!("{x:.1}"),
        x => format!("{x:.0}"),
    }
}

/// Numbers in ascending order.
struct Sorted(Vec<f64>);

impl Sorted {
    fn of(cells: &[&Cell], of: impl Fn(&Cell) -> Option<f64>) -> Self {
        let mut numbers: Vec<f64> = cells.iter().filter_map(|cell| of(cell)).collect();
        numbers.sort_by(f64::total_cmp);
        Sorted(numbers)
    }

    /// The smallest number that this share of all does not exceed.
    fn quantile(&self, share: f64) -> f64 {
        let place = (share * self.0.len() as f64).ceil() as usize;
        self.0
            .get(place.saturating_sub(1))
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// The geometric mean.
    fn mean(&self) -> f64 {
        (self.0.iter().map(|x| x.ln()).sum::<f64>() / self.0.len() as f64).exp()
    }

    fn share_above(&self, limit: f64) -> f64 {
        self.0.iter().filter(|&&x| x > limit).count() as f64 / self.0.len().max(1) as f64
    }
}
