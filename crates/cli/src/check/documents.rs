//! The rows as JSON and as CSV: the same columns, numbers with all their digits, what is not finite left
//! empty.

use super::measure::Row;
use super::summary::Summary;
use crate::write::csv::cell;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Debug, Serialize)]
struct Quantity<'a> {
    name: &'a str,
    max_error: f64,
    in_round_offs: f64,
}

#[derive(Debug, Serialize)]
struct Document<'a> {
    theme: &'a str,
    name: &'a str,
    stages: usize,
    step: f64,
    h_omega: Option<f64>,
    precision: &'a str,
    steps_wanted: u64,
    steps: u64,
    outcomes: BTreeMap<&'a str, u64>,
    energy_in_round_off_levels: Option<f64>,
    energy_in_round_off_levels_by_double_double: Option<f64>,
    energy: f64,
    energy_gauss: f64,
    invariants: Vec<Quantity<'a>>,
    error: Option<f64>,
    error_gauss: Option<f64>,
    error_ratio: Option<f64>,
    round_off_of_trajectory: Option<f64>,
    ended_with: Option<&'a str>,
    gauss_ended_with: Option<&'a str>,
    seconds: f64,
    seconds_gauss: f64,
    seconds_all: f64,
    verdict: &'a str,
    notes: &'a [String],
}

impl<'a> From<&'a Row> for Document<'a> {
    fn from(row: &'a Row) -> Self {
        let m = &row.measured;
        Document {
            theme: row.theme,
            name: &row.name,
            stages: row.stages,
            step: row.h,
            h_omega: row.omega.map(|omega| omega * row.h),
            precision: row.numbers,
            steps_wanted: row.wanted,
            steps: m.steps,
            outcomes: m.outcomes.iter().copied().collect(),
            energy_in_round_off_levels: m.levels,
            energy_in_round_off_levels_by_double_double: m.independent_levels,
            energy: m.energy,
            energy_gauss: m.gauss_energy,
            invariants: m
                .invariants
                .iter()
                .map(|i| Quantity {
                    name: &i.name,
                    max_error: i.error,
                    in_round_offs: i.in_roundoff,
                })
                .collect(),
            error: m.error,
            error_gauss: m.gauss_error,
            error_ratio: m.ratio(),
            round_off_of_trajectory: m.noise,
            ended_with: m.ended.as_ref().map(|e| e.text.as_str()),
            gauss_ended_with: m.gauss_ended.as_ref().map(|e| e.text.as_str()),
            seconds: m.seconds,
            seconds_gauss: m.gauss_seconds,
            seconds_all: row.all_seconds,
            verdict: row.verdict.word.label(),
            notes: &row.verdict.notes,
        }
    }
}

/// `{"version": …, "summary": …, "rows": […]}`.
pub(crate) fn json(rows: &[Row], summary: &Summary) -> serde_json::Result<String> {
    #[derive(Serialize)]
    struct Whole<'a> {
        version: &'static str,
        summary: &'a Summary,
        rows: Vec<Document<'a>>,
    }
    serde_json::to_string_pretty(&Whole {
        version: env!("CARGO_PKG_VERSION"),
        summary,
        rows: rows.iter().map(Document::from).collect(),
    })
}

const HEADER: &str = "theme,name,stages,step,h_omega,precision,steps_wanted,steps,outcomes,energy_in_round_off_levels,\
    energy_in_round_off_levels_by_double_double,energy,energy_gauss,worst_invariant,invariant_error,error,error_gauss,error_ratio,\
    round_off_of_trajectory,seconds,seconds_gauss,seconds_all,verdict,notes";

/// One header line and one line a row.
pub(crate) fn csv(rows: &[Row]) -> String {
    let mut text = format!("{HEADER}\n");
    for row in rows {
        let m = &row.measured;
        let number = |x: Option<f64>| x.map_or(String::new(), cell);
        let outcomes = m.outcomes.iter().map(|(label, n)| format!("{label}: {n}"));
        let worst = m.worst_invariant();
        let cells = [
            quoted(row.theme),
            quoted(&row.name),
            row.stages.to_string(),
            cell(row.h),
            number(row.omega.map(|omega| omega * row.h)),
            row.numbers.to_owned(),
            row.wanted.to_string(),
            m.steps.to_string(),
            quoted(&outcomes.collect::<Vec<_>>().join("; ")),
            number(m.levels),
            number(m.independent_levels),
            cell(m.energy),
            cell(m.gauss_energy),
            quoted(worst.map_or("", |i| &i.name)),
            number(worst.map(|i| i.error)),
            number(m.error),
            number(m.gauss_error),
            number(m.ratio()),
            number(m.noise),
            cell(m.seconds),
            cell(m.gauss_seconds),
            cell(row.all_seconds),
            quoted(row.verdict.word.label()),
            quoted(&row.verdict.notes.join("; ")),
        ];
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use super::{HEADER, csv, json};
    use crate::check::Summary;
    use crate::check::measure::Row;
    use crate::check::measured::Measured;
    use crate::check::verdict::Verdict;

    fn rows() -> Vec<Row> {
        vec![Row {
            theme: "units",
            name: "a \"name\", with a comma".into(),
            setting: "s=4".into(),
            stages: 4,
            h: 0.1,
            omega: None,
            numbers: "f64",
            wanted: 10,
            measured: Measured {
                error: Some(f64::INFINITY),
                outcomes: vec![("energy solved", 10)],
                ..Measured::default()
            },
            verdict: Verdict::failed("why, and \"how\"".into()),
            all_seconds: 0.5,
        }]
    }

    #[test]
    fn the_table_has_a_cell_for_every_column() {
        let text = csv(&rows());
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
        let text = json(&rows(), &Summary::default()).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(value["rows"][0]["error"].is_null());
        assert_eq!(value["rows"][0]["verdict"], "FAIL");
    }
}
