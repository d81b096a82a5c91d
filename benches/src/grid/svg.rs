//! One page of heat maps: for each scene time and error over Gauss's, stages upwards, steps to the right.

use crate::cell::{Cell, Regime};
use crate::contestant::Ending;
use std::fmt::Write;

/// Width and height of a cell, pixels.
const SQUARE: f64 = 13.0;
/// Room of one scene.
const PANEL: [f64; 2] = [400.0, 245.0];
/// Scenes side by side.
const COLUMNS: usize = 4;
/// The colour is full at this ratio and at its inverse.
const FULL: f64 = 100.0;
const TOP: f64 = 70.0;

pub(crate) fn page(cells: &[Cell]) -> String {
    let own: Vec<&Cell> = cells.iter().filter(|cell| cell.start == 0).collect();
    let mut scenes: Vec<&str> = own.iter().map(|cell| cell.scene).collect();
    scenes.dedup();
    let rows = scenes.len().div_ceil(COLUMNS);
    let (width, height) = (
        COLUMNS as f64 * PANEL[0] + 20.0,
        rows as f64 * PANEL[1] + TOP,
    );
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    legend(&mut text);
    for (i, scene) in scenes.iter().enumerate() {
        let of: Vec<&&Cell> = own.iter().filter(|cell| cell.scene == *scene).collect();
        let (column, row) = (i % COLUMNS, i / COLUMNS);
        let at = [10.0 + column as f64 * PANEL[0], TOP + row as f64 * PANEL[1]];
        panel(&mut text, at, scene, &of);
    }
    text.push_str("</svg>\n");
    text
}

fn panel(text: &mut String, [x, y]: [f64; 2], scene: &str, cells: &[&&Cell]) {
    let (mut stages, mut steps): (Vec<usize>, Vec<f64>) =
        cells.iter().map(|cell| (cell.stages, cell.step)).unzip();
    stages.sort_unstable();
    stages.dedup();
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    let _ = writeln!(
        text,
        "<text x=\"{x}\" y=\"{}\" font-weight=\"bold\">{scene}</text>",
        y + 10.0
    );
    let bottom = y + 22.0 + SQUARE * stages.len() as f64;
    for (map, name) in ["time", "error"].into_iter().enumerate() {
        let left = x + 22.0 + map as f64 * (PANEL[0] / 2.0 - 5.0);
        let _ = writeln!(
            text,
            "<text x=\"{left}\" y=\"{}\" fill=\"#555\">{name}</text>",
            y + 21.0
        );
        for cell in cells {
            let column = steps.partition_point(|&h| h < cell.step) as f64;
            let row = stages.partition_point(|&s| s < cell.stages) as f64;
            let ratio = if map == 0 {
                cell.time_ratio()
            } else {
                cell.error_ratio()
            };
            let _ = writeln!(
                text,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{SQUARE}\" height=\"{SQUARE}\" fill=\"{}\" stroke=\"{}\" \
                 stroke-width=\"0.4\"><title>{}</title></rect>",
                left + SQUARE * column,
                bottom - SQUARE * row - SQUARE + 3.0,
                colour(cell, ratio),
                if cell.regime == Regime::Unresolved {
                    "#777"
                } else {
                    "white"
                },
                title(cell),
            );
        }
        for (row, s) in stages.iter().enumerate() {
            let _ = writeln!(
                text,
                "<text x=\"{}\" y=\"{:.1}\" font-size=\"8\" text-anchor=\"end\" fill=\"#555\">{s}</text>",
                left - 3.0,
                bottom - SQUARE * row as f64
            );
        }
        let ends = [
            (steps.first(), 0.0, "start"),
            (steps.last(), SQUARE * steps.len() as f64, "end"),
        ];
        for (h, along, anchor) in ends {
            let _ = writeln!(
                text,
                "<text x=\"{}\" y=\"{}\" font-size=\"8\" text-anchor=\"{anchor}\" fill=\"#555\">h = {:.2e}</text>",
                left + along,
                bottom + 13.0,
                h.copied().unwrap_or_default()
            );
        }
    }
}

fn title(cell: &Cell) -> String {
    let show = |x: Option<f64>| x.map_or("-".into(), |x| format!("{x:.2e}"));
    format!(
        "s = {}, h = {:.3e}, h omega = {:.2}: time {}, error {} ({:.1e} over {:.1e}), {}",
        cell.stages,
        cell.step,
        cell.angle,
        show(cell.time_ratio()),
        show(cell.error_ratio()),
        cell.errors[0],
        cell.errors[1],
        cell.regime.label()
    )
}

fn colour(cell: &Cell, ratio: Option<f64>) -> String {
    match (&cell.gauss.ending, &cell.equip.ending, ratio) {
        (Ending::Failed(_), _, _) => "#bbbbbb".into(),
        (_, Ending::Failed(_), _) => "black".into(),
        (_, Ending::Cut, _) => "#5c0010".into(),
        (_, _, Some(ratio)) => blend((ratio.ln() / FULL.ln()).clamp(-1.0, 1.0)),
        (_, _, None) => "#eeeeee".into(),
    }
}

/// White at 0, blue at −1, red at 1.
fn blend(x: f64) -> String {
    let full = if x < 0.0 {
        [33.0, 102.0, 172.0]
    } else {
        [178.0, 24.0, 43.0]
    };
    let weight = x.abs().powf(0.75);
    let [r, g, b] = full.map(|c: f64| (255.0 + (c - 255.0) * weight).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn legend(text: &mut String) {
    let _ = writeln!(
        text,
        "<text x=\"10\" y=\"22\" font-size=\"16\" font-weight=\"bold\">EQUIP over Gauss on the same steps</text>"
    );
    for i in 0..=40 {
        let x = f64::from(i) / 20.0 - 1.0;
        let at = 330.0 + 6.0 * f64::from(i);
        let fill = blend(x);
        let _ = writeln!(
            text,
            "<rect x=\"{at}\" y=\"10\" width=\"6\" height=\"14\" fill=\"{fill}\"/>"
        );
    }
    for (label, at) in [
        ("1/100", 330.0),
        ("1/10", 391.5),
        ("1", 453.0),
        ("10", 514.5),
        ("100", 576.0),
    ] {
        let _ = writeln!(
            text,
            "<text x=\"{at}\" y=\"36\" text-anchor=\"middle\">{label}</text>"
        );
    }
    let kinds = [
        ("black", "EQUIP ends in an error"),
        ("#5c0010", "cut at 60 x the time"),
        ("#bbbbbb", "Gauss ends in an error"),
        ("#eeeeee", "both errors below 1e-12"),
    ];
    for (i, (fill, label)) in kinds.into_iter().enumerate() {
        let at = 620.0 + 190.0 * i as f64;
        let _ = writeln!(
            text,
            "<rect x=\"{at}\" y=\"10\" width=\"14\" height=\"14\" fill=\"{fill}\"/><text x=\"{}\" y=\"21\">{label}</text>",
            at + 19.0
        );
    }
    let _ = writeln!(
        text,
        "<text x=\"10\" y=\"48\" fill=\"#555\">Stages upwards, step to the right; cells with a grey frame are unresolved.</text>"
    );
}
