//! What commands measure: the JSON of the program, or tables that they print.

use crate::compare::numbers;
use crate::pages::root;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

/// What a command measures.
pub(crate) enum Measured {
    Json(Value),
    /// Rows between other lines.
    Tables(Vec<String>),
}

/// Commands of the program by their first word, others by the shell, from the root.
pub(crate) fn measure(command: &str) -> Measured {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures");
    std::fs::create_dir_all(&home).unwrap();
    let run = |more: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
        let words = command.split(' ').chain(more.iter().copied());
        output(program.current_dir(&home).args(words))
    };
    match command.split(' ').next() {
        Some("run") => Measured::Json(serde_json::from_str(&run(&["--json"])).unwrap()),
        Some("check") => {
            run(&["--json", "check.json"]);
            let text = std::fs::read(home.join("check.json")).unwrap();
            Measured::Json(serde_json::from_slice(&text).unwrap())
        }
        Some("growth") => Measured::Tables(tables(&run(&[]))),
        _ => {
            let mut shell = Command::new("sh");
            let text = output(shell.current_dir(root()).args(["-c", command]));
            Measured::Tables(tables(&text))
        }
    }
}

/// Its printed text; a command that measures a known deficit fails, and prints its figures all the same.
fn output(command: &mut Command) -> String {
    let done = command.output().unwrap();
    if !done.status.success() {
        let text = String::from_utf8_lossy(&done.stderr);
        let last: Vec<&str> = text.lines().rev().take(3).collect();
        println!("{command:?}: {}: {last:?}", done.status);
    }
    String::from_utf8(done.stdout).unwrap()
}

pub(crate) fn tables(text: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    for line in text.split_inclusive('\n') {
        if line.starts_with('|') {
            all.last_mut().unwrap().push_str(line);
        } else if !all.last().unwrap().is_empty() {
            all.push(String::new());
        }
    }
    all.retain(|table| !table.is_empty());
    all
}

impl Measured {
    /// The table of this number, from 1 on.
    pub(crate) fn table(&self, number: usize) -> Option<&str> {
        match self {
            Measured::Tables(all) => all.get(number.checked_sub(1)?).map(String::as_str),
            Measured::Json(_) => None,
        }
    }

    /// The number at a place: `energy/max` or `invariants/momentum/max` in JSON, `ROW/COLUMN` in tables.
    pub(crate) fn at(&self, place: &str) -> Option<f64> {
        match self {
            Measured::Json(document) => in_json(document, place),
            Measured::Tables(all) => all.iter().find_map(|table| in_table(table, place)),
        }
    }
}

fn in_json(document: &Value, place: &str) -> Option<f64> {
    let mut value = document;
    for name in place.split('/') {
        value = match value {
            Value::Array(list) => match (name.parse::<usize>(), name.split_once('=')) {
                (Ok(number), _) => list.get(number)?,
                (_, Some(_)) => list.iter().find(|x| has_all(x, name))?,
                _ => list.iter().find(|x| x["name"] == name)?,
            },
            other => &other[name],
        };
    }
    value.as_f64()
}

/// `verdict=known deficit, theme=stiff`.
fn has_all(value: &Value, conditions: &str) -> bool {
    let mut conditions = conditions.split(", ");
    conditions.all(|condition| match condition.split_once('=') {
        Some((key, wanted)) => value[key] == wanted,
        None => false,
    })
}

/// The first number in the cell.
fn in_table(table: &str, place: &str) -> Option<f64> {
    let (row, column) = place.rsplit_once('/')?;
    let mut rows = table.lines().map(|row| row.split('|').map(str::trim));
    let column = rows.next()?.position(|title| title == column)?;
    let mut row = rows.find(|cells| cells.clone().nth(1) == Some(row))?;
    let (_, found) = numbers(row.nth(column)?);
    found.first().map(|number| number.value)
}
