//! The rows as JSON and as CSV: the same columns, numbers with all their digits, what is not finite left
//! empty.

use super::measure::Row;
use super::summary::Summary;
use crate::write::csv::cell;
use crate::write::json::object;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io;

fn document<'a>(row: &'a Row<'_>) -> impl Serialize + 'a {
    let (case, m) = (row.case, &row.measured);
    let outcomes = m.equip.outcomes().map(|(o, n)| (o.label(), n));
    let invariants = m.equip.invariants.iter();
    let invariants = invariants.map(|kept| {
        object! {
            name: &kept.name,
            max_error: kept.error,
            in_round_offs: kept.in_roundoff,
        }
    });
    object! {
        theme: case.theme,
        name: &case.name,
        stages: case.stages,
        step: case.h,
        h_omega: case.omega.map(|omega| omega * case.h),
        precision: case.numbers.name(),
        steps_wanted: case.steps,
        steps: m.equip.counts.steps,
        outcomes: outcomes.collect::<BTreeMap<_, _>>(),
        energy_in_round_off_levels: m.equip.levels,
        energy_in_round_off_levels_by_double_double: m.equip.independent_levels,
        energy: m.equip.energy,
        energy_gauss: m.gauss.energy,
        invariants: invariants.collect::<Vec<_>>(),
        error: m.error,
        error_gauss: m.gauss_error,
        error_ratio: m.ratio(),
        round_off_of_trajectory: m.noise,
        ended_with: m.equip.ended.as_ref().map(|e| &e.text),
        gauss_ended_with: m.gauss.ended.as_ref().map(|e| &e.text),
        seconds: m.equip.seconds,
        seconds_gauss: m.gauss.seconds,
        seconds_all: row.all_seconds,
        verdict: row.verdict.word.label(),
        notes: &row.verdict.notes,
    }
}

/// `{"version": …, "summary": …, "rows": […]}`.
pub(crate) fn json(rows: &[Row<'_>], summary: &Summary) -> io::Result<String> {
    let text = serde_json::to_string_pretty(&object! {
        version: env!("CARGO_PKG_VERSION"),
        summary: summary,
        rows: rows.iter().map(document).collect::<Vec<_>>(),
    })?;
    Ok(text)
}

const HEADER: &str = "theme,name,stages,step,h_omega,precision,steps_wanted,steps,outcomes,energy_in_round_off_levels,\
    energy_in_round_off_levels_by_double_double,energy,energy_gauss,worst_invariant,invariant_error,error,error_gauss,error_ratio,\
    round_off_of_trajectory,seconds,seconds_gauss,seconds_all,verdict,notes";

/// One header line and one line a row; members of [`json`] that are no lists have the same names.
pub(crate) fn csv(rows: &[Row<'_>]) -> io::Result<String> {
    let mut text = format!("{HEADER}\n");
    for row in rows {
        let members = serde_json::to_value(document(row))?;
        let outcomes = row.measured.equip.outcomes();
        let outcomes: Vec<_> = outcomes
            .map(|(o, n)| format!("{}: {n}", o.label()))
            .collect();
        let worst = row.measured.worst_invariant();
        let cells = HEADER.split(',').map(|column| match column {
            "precision" => row.case.numbers.name().to_owned(),
            "outcomes" => quoted(&outcomes.join("; ")),
            "worst_invariant" => quoted(worst.map_or("", |kept| &kept.name)),
            "invariant_error" => worst.map_or(String::new(), |kept| cell(kept.error)),
            "notes" => quoted(&row.verdict.notes.join("; ")),
            _ => match &members[column] {
                Value::String(text) => quoted(text),
                Value::Number(count) if count.is_u64() => count.to_string(),
                number => number.as_f64().map_or(String::new(), cell),
            },
        });
        text.push_str(&cells.collect::<Vec<_>>().join(","));
        text.push('\n');
    }
    Ok(text)
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use super::{HEADER, csv, json};
    use crate::check::Summary;
    use crate::check::case::Case;
    use crate::check::measure::Row;
    use crate::check::measured::Measured;
    use crate::check::verdict::Verdict;

    fn case() -> Case {
        Case::new("a \"name\", with a comma", || Err("none".into()))
    }

    fn rows(case: &Case) -> [Row<'_>; 1] {
        [Row {
            case,
            measured: Measured {
                error: Some(f64::INFINITY),
                ..Measured::default()
            },
            verdict: Verdict::failed("why, and \"how\"".into()),
            all_seconds: 0.5,
        }]
    }

    #[test]
    fn the_table_has_a_cell_for_every_column() {
        let text = csv(&rows(&case())).unwrap();
        let row = text.lines().nth(1).unwrap();
        let mut inside = false;
        let commas = row.chars().filter(|&c| {
            inside ^= c == '"';
            c == ',' && !inside
        });
        assert_eq!(commas.count(), HEADER.matches(',').count());
        assert!(!row.contains("inf"));
    }

    #[test]
    fn json_is_json_also_with_infinities() {
        let text = json(&rows(&case()), &Summary::default()).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(value["rows"][0]["error"].is_null());
        assert_eq!(value["rows"][0]["verdict"], "FAIL");
    }
}
